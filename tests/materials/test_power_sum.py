"""Sums of powers as functions of the invariants, against the stretches themselves."""

from __future__ import annotations

import decimal
from decimal import Decimal

import numpy as np
import pytest

from materials.power_sum import PowerSums

EXPONENTS = (-8.0, -2.0, 0.01, 1.3, 5.0, 12.0, 25.0)


class Functions:
    """numpy's."""

    acos = staticmethod(np.arccos)
    cos = staticmethod(np.cos)
    ln = staticmethod(np.log)
    sqrt = staticmethod(np.sqrt)
    larger = staticmethod(np.maximum)
    smaller = staticmethod(np.minimum)


def stretches() -> np.ndarray:
    """Triples from 0.3 to 4: at rest, two equal and almost equal, and any, (n, 3)."""
    single = np.geomspace(0.3, 4, 15)
    double = np.geomspace(0.5, 1.8, 15)
    rng = np.random.default_rng(1)
    a, b = np.exp(rng.uniform(np.log(0.3), np.log(4), (2, 400)))
    anyhow = np.column_stack([a, b, 1 / (a * b)])
    anyhow = anyhow[(anyhow[:, 2] > 0.3) & (anyhow[:, 2] < 4)]
    near = np.column_stack([single, single**-0.5])
    slightly = 1 + np.array([[0.0, 1e-5, 1e-9, 1e-13]])
    almost = np.stack(
        [np.broadcast_to(near[:, :1], (15, 4)), near[:, 1:] * slightly, near[:, 1:] / slightly], -1
    )
    return np.concatenate(
        [
            np.ones((1, 3)),
            almost.reshape(-1, 3),
            np.column_stack([double, double, double**-2.0]),
            np.column_stack([single, 1 / single, np.ones(15)]),
            anyhow,
        ]
    )


def sums(triples: np.ndarray) -> PowerSums:
    a, b, c = (triples**2).T
    return PowerSums(a + b + c, a * b + b * c + c * a, Functions())


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_value(exponent: float) -> None:
    # the exponential multiplies the error of ln λ by the exponent
    triples = stretches()
    expected = (triples**exponent).sum(axis=1)
    assert 3 + sums(triples)(exponent)[0] == pytest.approx(expected, rel=2e-11)


@pytest.mark.parametrize("exponent", EXPONENTS)
def test_derivatives(exponent: float) -> None:
    # exactly: ∂S/∂I1 = Σ s μ^(s+1)/p'(μ) and so on, p the cubic of the μ = λ²; in 200 digits, equal
    # stretches parted by 1e-20, which changes the sums by 1e-40
    triples = stretches()[::3]
    found = np.array(sums(triples)(exponent)[1:])
    for k, triple in enumerate(triples):
        expected = exact(triple, exponent)
        first, second = np.abs(expected[:2]).max(), np.abs(expected[2:]).max()
        floor = first / (triple**2).sum() / (triple**-2.0).sum()
        assert np.abs(found[:2, k] - expected[:2]).max() <= 2e-12 * first
        assert np.abs(found[2:, k] - expected[2:]).max() <= 2e-12 * max(second, floor)


@pytest.mark.parametrize("exponent", [2.0, -2.0, 4.0])
def test_even_powers_are_polynomials(exponent: float) -> None:
    # S(2) = I1, S(−2) = I2, S(4) = I1² − 2 I2
    triples = stretches()
    i1 = (triples**2).sum(axis=1)
    one, two, zero = np.ones_like(i1), 2 * np.ones_like(i1), np.zeros_like(i1)
    expected = {
        2.0: [one, zero, zero, zero, zero],
        -2.0: [zero, one, zero, zero, zero],
        4.0: [2 * i1, -two, two, zero, zero],
    }[exponent]
    scale = np.abs(expected[0]) + np.abs(expected[1])
    for found, value in zip(sums(triples)(exponent)[1:], expected, strict=True):
        assert np.abs(found - value).max() <= 1e-11 * scale.max()


def exact(triple: np.ndarray, exponent: float) -> np.ndarray:
    """∂S/∂I1, ∂S/∂I2, ∂²S/∂I1², ∂²S/∂I1∂I2, ∂²S/∂I2², in 200 digits."""
    with decimal.localcontext() as context:
        context.prec = 200
        logs = [Decimal(float(x)).ln() for x in triple]
        part = Decimal(10) ** -20
        middle = sum(logs, Decimal(0)) / 3
        mu = [(2 * (h - middle + k * part)).exp() for h, k in zip(logs, (1, 0, -1), strict=True)]
        s = Decimal(exponent) / 2
        i1 = sum(mu)
        i2 = mu[0] * mu[1] + mu[1] * mu[2] + mu[2] * mu[0]

        def slope(m: Decimal) -> Decimal:
            return 3 * m * m - 2 * i1 * m + i2

        def first(power: int, sign: int) -> Decimal:
            return sum((sign * s * m ** (s - 1 + power) / slope(m) for m in mu), Decimal(0))

        def second(power: int, sign: int, by: int, by_sign: int) -> Decimal:
            total = Decimal(0)
            for m in mu:
                d, k = slope(m), s - 1 + power
                moved = by_sign * m**by / d
                bent = (6 * m - 2 * i1) * moved + (-2 * m if by == 2 else 1)
                total += sign * s * (k * m ** (k - 1) * moved / d - m**k * bent / d**2)
            return total

        values = [first(2, 1), first(1, -1)]
        values += [second(2, 1, 2, 1), second(2, 1, 1, -1), second(1, -1, 1, -1)]
        return np.array([float(v) for v in values])

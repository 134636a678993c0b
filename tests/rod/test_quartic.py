"""A law to the fourth order: its derivatives, and a fiber that it is of."""

from __future__ import annotations

import numpy as np
import pytest

from rod.quartic import Quartic

TINY = 1e-6
LEVERS = np.array([[1.0, 6.0, -2.0], [1.0, -4.0, 3.0], [1.0, 0.0, 5.0], [1.0, 2.0, 1.0]])
"""Of fibers: λ = ε · lever."""
SLOPES = np.array([[3.0, -6.0, 24.0], [30.0, -60.0, 250.0], [1.0, 2.0, 5.0], [8.0, 0.0, 90.0]])
REST = np.array([1.0, 0.0, 0.0])
STRAINS = np.array([[1.02, 0.01, 0.004], [0.95, -0.02, 0.01]])


def law() -> Quartic:
    second, third, fourth = SLOPES.T
    return Quartic(
        np.einsum("q,qi,qj->ij", second, *[LEVERS] * 2),
        np.einsum("q,qi,qj,qk->ijk", third, *[LEVERS] * 3),
        np.einsum("q,qi,qj,qk,ql->ijkl", fourth, *[LEVERS] * 4),
        REST,
    )


def test_it_is_the_sum_of_its_fibers() -> None:
    e = (STRAINS - REST) @ LEVERS.T
    value = (SLOPES[:, 0] * e**2 / 2 + SLOPES[:, 1] * e**3 / 6 + SLOPES[:, 2] * e**4 / 24).sum(1)
    assert law().value(STRAINS, 0.1) == pytest.approx(value, rel=1e-12)
    assert law().times(1.5).value(STRAINS, 0.1) == pytest.approx(1.5 * value, rel=1e-12)


def test_derivatives_are_those_of_differences() -> None:
    for number, away in enumerate(TINY * np.eye(3)):
        one, other = law().value(STRAINS + away, 0.0), law().value(STRAINS - away, 0.0)
        gradient = law().gradient(STRAINS, 0.0)[:, number]
        assert (one - other) / (2 * TINY) == pytest.approx(gradient, rel=1e-7)
        more, less = law().gradient(STRAINS + away, 0.0), law().gradient(STRAINS - away, 0.0)
        hessian = law().hessian(STRAINS, 0.0)[:, number]
        assert (more - less) / (2 * TINY) == pytest.approx(hessian, rel=1e-7)


def test_it_has_no_chamber() -> None:
    assert not law().chamber(STRAINS, 0.1).any()
    assert not law().chamber_gradient(STRAINS, 0.1).any()
    assert not law().chamber_slope(STRAINS, 0.1).any()
    assert not law().outside(STRAINS, 0.1)

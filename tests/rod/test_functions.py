"""Stumpff's functions and the maps made of them, beside scipy and differences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm

from rod.functions import ORDER, Pair, axial, cross, cross_matrix, stumpff

STEP = 1e-5


@pytest.mark.parametrize("greatest", [1e-4, 0.04, 0.4, 3.9, 4.1, 90.0])
def test_stumpff_is_its_series(greatest: float) -> None:
    s = np.linspace(0.0, greatest, 7)
    found = stumpff(s)
    for k in range(ORDER):
        for at, value in zip(s, found[k], strict=True):
            terms = [(-at) ** j / math.factorial(2 * j + k) for j in range(60)]
            assert value == pytest.approx(math.fsum(terms), rel=1e-11, abs=1e-13 / (k + 1))


def test_the_first_functions_are_cosine_and_sine() -> None:
    angle = np.linspace(0.1, 7.0, 20)
    found = stumpff(angle**2)
    np.testing.assert_allclose(found[0], np.cos(angle), atol=1e-13)
    np.testing.assert_allclose(found[1] * angle, np.sin(angle), atol=1e-13)


def test_products_by_matrices() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(2, 5, 3))
    np.testing.assert_allclose(cross(a, b), np.cross(a, b), atol=1e-15)
    np.testing.assert_allclose((cross_matrix(a) @ b[..., None])[..., 0], np.cross(a, b), atol=1e-15)
    dyad = a[:, :, None] * b[:, None, :]
    np.testing.assert_allclose(axial(dyad), np.cross(a, b), atol=1e-15)


@pytest.mark.parametrize("size", [0.0, 1e-9, 1e-3, 0.3, 2.5, 5.0])
def test_rotation_and_its_mean(size: float) -> None:
    phi = size * np.array([[2.0, -1.0, 2.0]]) / 3
    c = stumpff(np.sum(phi**2, axis=-1))
    rotation, mean = Pair(phi, c, 1).matrix()[0], Pair(phi, c, 2).matrix()[0]
    np.testing.assert_allclose(rotation, expm(cross_matrix(phi[0])), atol=1e-13)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    parts = [
        w / 2 * expm((x + 1) / 2 * cross_matrix(phi[0]))
        for x, w in zip(nodes, weights, strict=True)
    ]
    np.testing.assert_allclose(mean, sum(parts), atol=1e-13)


@pytest.mark.parametrize("k", [1, 2])
@pytest.mark.parametrize("size", [1e-3, 0.4, 3.0])
def test_derivatives_are_those_of_differences(k: int, size: float) -> None:
    rng = np.random.default_rng(k)
    phi, x = size * rng.normal(size=(1, 3)), rng.normal(size=(1, 3))
    z = rng.normal(size=(1, 3, 3))

    def pair(at: np.ndarray) -> Pair:
        return Pair(at, stumpff(np.sum(at**2, axis=-1)), k)

    for axis in range(3):
        step = STEP * np.eye(3)[axis]
        up, down = pair(phi + step), pair(phi - step)
        slope = ((up.matrix() - down.matrix()) @ x[..., None])[..., 0] / (2 * STEP)
        np.testing.assert_allclose(pair(phi).slope(x)[..., axis], slope, atol=1e-9)
        gradient = np.sum(z * (up.matrix() - down.matrix())) / (2 * STEP)
        assert pair(phi).gradient(z)[0, axis] == pytest.approx(gradient, abs=1e-9)
        second = (up.gradient(z) - down.gradient(z)) / (2 * STEP)
        np.testing.assert_allclose(pair(phi).hessian(z)[..., axis], second, atol=1e-9)

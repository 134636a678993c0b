"""Exact solutions: the known numbers, and equilibrium by differentiating the fields themselves."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
import pytest

from analytic.stress import PrincipalStresses
from materials.material import Material
from tests.exact.solutions import (
    Flexure,
    Floats,
    Torsion,
    Tube,
    closed_tube,
    sphere_limit,
    sphere_pressure,
    wound_tube,
)

YEOH = Material("yeoh", {"c1": 0.11, "c2": 0.02}).principal
TWO = Material("ogden", {"mu1": 0.2, "alpha1": 2.0, "mu2": 0.08, "alpha2": -2.0}).principal
"""Mooney and Rivlin's law as Ogden's, C10 = 0.1 MPa and C01 = 0.04 MPa."""
HALF_DIGIT = 0.5000001
"""Of the last digit that a reference number gives."""


def agrees(computed: float, stated: str) -> bool:
    """The computed number rounds to the stated one, in all its digits."""
    digits = len(stated.split(".")[1])
    return abs(computed - float(stated)) <= HALF_DIGIT * 10.0**-digits


def test_tube_in_plane_strain() -> None:
    # numbers worked out independently of this project
    assert agrees(Tube(YEOH, 8, 10, 8.8).pressure, "0.01327694")
    assert agrees(Tube(YEOH, 8, 10, 10.0).pressure, "0.02710791")


def test_tube_with_closed_ends() -> None:
    tube = closed_tube(YEOH, 8, 10, 8.8)
    assert agrees(tube.stretch, "1.00417997")
    assert agrees(tube.pressure, "0.01347609")
    assert abs(tube.axial_force) < 1e-12


@pytest.mark.parametrize(("stretch", "stated"), [(1.1, "0.03107830"), (1.5, "0.12667995")])
def test_hoop_wound_tube(stretch: float, stated: str) -> None:
    tube = wound_tube(YEOH, 8, 10, stretch)
    assert agrees(tube.pressure, stated)
    assert float(tube.radius(10.0)) == pytest.approx(10.0, abs=1e-13)
    assert tube.outside > 0, "the hoops must hold the tube in"
    assert abs(tube.axial_force) < 1e-12


def test_hoops_that_stretch() -> None:
    # soft hoops are no hoops: the closed tube; stiff ones the inextensible winding
    stiff, soft = (wound_tube(YEOH, 8, 10, 1.1, k) for k in (1e9, 1.0))
    assert stiff.pressure == pytest.approx(wound_tube(YEOH, 8, 10, 1.1).pressure, rel=1e-8)
    tension = 1.0 * (float(soft.radius(10.0)) / 10 - 1)
    assert soft.outside * float(soft.radius(10.0)) * 1.1 == pytest.approx(tension, rel=1e-9)
    assert abs(soft.axial_force) < 1e-10


def test_sphere_and_its_limit_point() -> None:
    assert agrees(sphere_pressure(YEOH, 10, 11, 12), "0.02459874")
    ratio, pressure = sphere_limit(Material("yeoh", {"c1": 0.11}).principal, 10, 11)
    assert agrees(ratio, "1.426385")
    assert agrees(pressure, "0.02596276")


def test_torsion() -> None:
    bar = Torsion(YEOH, 10, 0.05)
    assert agrees(bar.moment, "183.259571")
    assert agrees(bar.axial_force, "-4.581489")


def test_flexure() -> None:
    block = Flexure(YEOH, 2, 10)
    assert agrees(block.radii[0], "9.05430231")
    assert agrees(block.radii[1], "11.04447329")
    assert agrees(block.moment, "0.05847868")


# --- equilibrium of the fields ---------------------------------------------------------------


class Solution(Protocol):
    """Fields of an exact solution."""

    @property
    def law(self) -> PrincipalStresses:
        """The rubber."""

    def displacement(self, X: Floats) -> Floats:
        """Displacement."""

    def multiplier(self, X: Floats) -> Floats:
        """Mean stress."""


RNG = np.random.default_rng(5)


def _around(inner: float, outer: float) -> Floats:
    radius, angle = RNG.uniform(inner, outer, 20), RNG.uniform(0, 2 * math.pi, 20)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle), RNG.uniform(0, 5, 20)])


SOLUTIONS: dict[str, tuple[Solution, Floats]] = {
    "tube": (Tube(YEOH, 8, 10, 10.0), _around(8, 10)),
    "closed": (closed_tube(YEOH, 8, 10, 8.8), _around(8, 10)),
    "wound": (wound_tube(YEOH, 8, 10, 1.5), _around(8, 10)),
    "torsion": (Torsion(YEOH, 10, 0.05), _around(1, 10)),
    "flexure": (Flexure(YEOH, 2, 10), RNG.uniform([0, 0, 0], [1, 2, 62], (20, 3))),
    "tube of two": (Tube(TWO, 8, 10, 10.0), _around(8, 10)),
    "torsion of two": (Torsion(TWO, 10, 0.05), _around(1, 10)),
    "flexure of two": (Flexure(TWO, 2, 10), RNG.uniform([0, 0, 0], [1, 2, 62], (20, 3))),
}


def _gradient(f: Callable[[Floats], Floats], X: Floats, step: float) -> Floats:
    """∂f/∂X_j by differences of order 6, the last index j."""
    columns = []
    for j in range(3):
        e = np.zeros(3)
        e[j] = step
        change = sum(c * (f(X + k * e) - f(X - k * e)) for k, c in ((1, 45), (2, -9), (3, 1)))
        columns.append(np.asarray(change) / (60 * step))
    return np.stack(columns, axis=-1)


def _deformation(solution: Solution, X: Floats) -> Floats:
    return np.eye(3) + _gradient(solution.displacement, X, 2e-2)


def _nominal(solution: Solution, X: Floats) -> Floats:
    """First Piola–Kirchhoff stress of W(Ī1, Ī2) + p (J − 1) at J = 1, the normal's index last."""
    F = _deformation(solution, X)
    inverse = np.linalg.inv(F).swapaxes(1, 2)
    i1 = np.einsum("nij,nij->n", F, F)[:, None, None]
    first, second = (0.11 + 0.04 * (i1 - 3), 0.0) if solution.law is YEOH else (0.1, 0.04)
    stress = 2 * (first * F + second * (i1 * F - F @ F.swapaxes(1, 2) @ F))
    mean = np.einsum("nij,nij->n", stress, F)[:, None, None] / 3
    return stress - mean * inverse + solution.multiplier(X)[:, None, None] * inverse


@pytest.mark.parametrize("name", SOLUTIONS)
def test_fields_keep_the_volume_and_are_in_equilibrium(name: str) -> None:
    # a wrong sign of p, or a field that belongs to another load, fails here; the differences
    # themselves are exact to 1e-9 of the terms that cancel
    solution, X = SOLUTIONS[name]
    assert np.linalg.det(_deformation(solution, X)) == pytest.approx(1, abs=1e-9)
    terms = _gradient(lambda at: _nominal(solution, at), X, 2e-2)
    divergence = np.einsum("nijj->ni", terms)
    assert np.abs(divergence).max() < 1e-7 * np.abs(terms).max()


@pytest.mark.parametrize("name", ["tube", "closed", "wound"])
def test_tube_surfaces_carry_the_pressures(name: str) -> None:
    tube, _ = SOLUTIONS[name]
    assert isinstance(tube, Tube)
    for R, pressure in ((8.0, tube.pressure), (10.0, tube.outside)):
        X = np.array([[R, 0.0, 1.0]])
        F, stress = _deformation(tube, X)[0], _nominal(tube, X)[0]
        cauchy = stress @ F.T
        assert cauchy[0, 0] == pytest.approx(-pressure, abs=1e-9)


def test_end_loads_are_the_resultants_of_the_fields() -> None:
    # moment and axial force come from other integrals than the fields
    bar, block = Torsion(YEOH, 10, 0.05), Flexure(YEOH, 2, 10)
    t, w = np.polynomial.legendre.leggauss(30)
    R = 5 * (t + 1)
    X = np.column_stack([R, np.zeros_like(R), np.zeros_like(R)])
    stress = _nominal(bar, X)
    ring = 2 * math.pi * R * 5 * w
    assert ring @ stress[:, 2, 2] == pytest.approx(bar.axial_force, rel=1e-8)
    assert ring @ (R * stress[:, 1, 2]) == pytest.approx(bar.moment, rel=1e-8)
    Y = t + 1
    X = np.column_stack([np.zeros_like(Y), Y, np.zeros_like(Y)])
    stress = _nominal(block, X)
    arm = Y + block.displacement(X)[:, 1] + block.length_per_angle
    assert w @ (arm * stress[:, 2, 2]) == pytest.approx(block.moment, rel=1e-8)
    assert abs(w @ stress[:, 2, 2]) < 1e-9, "pure bending"

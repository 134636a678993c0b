"""The fiber law: stiffness of the paper's Kevlar, consistent derivatives, tension-only."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest

from materials.fiber import FIBERS, Fiber, energy, force, tangent


def test_kevlar_stiffness() -> None:
    # the paper: 31 076 MPa, 0.38 mm with half the radius gives 881 N
    assert FIBERS["kevlar"].stiffness == pytest.approx(881, abs=0.5)


@pytest.mark.parametrize("tension_only", [False, True])
def test_force_and_tangent_are_derivatives(tension_only: bool) -> None:
    strain, step = np.array([-0.02, -0.001, 0.001, 0.03]), 1e-6
    up, down = strain + step, strain - step
    slope = (energy(up, 881.0, tension_only) - energy(down, 881.0, tension_only)) / (2 * step)
    assert force(strain, 881.0, tension_only) == pytest.approx(slope, abs=1e-6)
    slope = (force(up, 881.0, tension_only) - force(down, 881.0, tension_only)) / (2 * step)
    assert tangent(strain, 881.0, tension_only) == pytest.approx(slope, abs=1e-6)


def test_tension_only_fiber_does_not_push() -> None:
    strain = np.array([-0.1, 0.0, 0.1])
    assert np.array_equal(force(strain, 10.0, True), [0.0, 0.0, 1.0])
    assert tangent(strain, 10.0, True)[1] == 10.0


@pytest.mark.parametrize("name", ["modulus", "diameter", "radius_factor"])
def test_numbers_without_meaning_are_refused(name: str) -> None:
    change: dict[str, Any] = {name: 0.0}
    with pytest.raises(ValueError, match=name):
        dataclasses.replace(Fiber(1.0, 1.0), **change)

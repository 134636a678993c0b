"""Shear under pressure: at rest that of the flexibility, and more where walls are taut."""

from __future__ import annotations

import numpy as np
import pytest

from fiberbend.beam.kept import beam_of
from fiberbend.beam.stressed import shear_stiffness
from fiberbend.slender.beside import section_case
from tests.slender.rods import case

PRESSURES = (0.005, 0.01, 0.02)


@pytest.fixture(scope="module")
def found() -> np.ndarray:
    return shear_stiffness(section_case(case()), PRESSURES)


def test_at_rest_it_is_that_of_the_flexibility(found: np.ndarray) -> None:
    chamber = beam_of(section_case(case()), PRESSURES[-1]).chamber
    assert found[0] == pytest.approx(1 / chamber[1, 1], rel=3e-3)


def test_pressure_stiffens(found: np.ndarray) -> None:
    assert np.all(np.diff(found) > 0)
    # smoothly: half the pressure adds half
    assert found[2] - found[0] == pytest.approx((found[3] - found[0]) / 2, rel=0.2)
    # by more than the thrust on the chamber, P A (Fichter 1966): threads are taut too
    assert found[3] - found[0] > PRESSURES[-1] * np.pi * 8.0**2 / 2

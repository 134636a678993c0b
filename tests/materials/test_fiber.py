"""Fibers: stiffness of the paper's Kevlar, and the refusals of bad numbers."""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest

from materials.fiber import Fiber
from materials.named.table import named_thread


def test_kevlar_stiffness() -> None:
    # the paper: 31 076 MPa, 0.38 mm with half the radius gives 881 N
    assert named_thread("kevlar").stiffness == pytest.approx(881, abs=0.5)


@pytest.mark.parametrize("name", ["modulus", "diameter", "radius_factor"])
def test_numbers_without_meaning_are_refused(name: str) -> None:
    change: dict[str, Any] = {name: 0.0}
    with pytest.raises(ValueError, match=name):
        dataclasses.replace(Fiber(1.0, 1.0), **change)

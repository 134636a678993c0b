"""Derivatives by the tangent are those of whole solves."""

from __future__ import annotations

import dataclasses
import math

import pytest

from fiberbend.schema.problems import CaseError
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.solve import Trials
from fiberbend.trial.wanted import Answer, Point, Wanted
from tests.trial.cases import checked, radians, under
from tests.trial.test_solve import BENT

SECTION = {
    "actuator.wall",
    "actuator.floor",
    "actuator.radius",
    "actuator.length",
    "materials.wall.c1",
    "effects.1.winding.pitch",
    "effects.1.winding.fiber.modulus",
}
FIELDS: dict[str, set[str]] = {
    "hemicircle": SECTION,
    "cell": {"actuator.wall", "effects.1.winding.pitch", "materials.sheath.c1"},
    "families": {"actuator.wall", "effects.1.winding.families.0.angle_from_axis"},
    "single helix": {"actuator.radius", "effects.1.winding.pitch"},
    "calibrated": {"actuator.wall", "effects.1.winding.bulging.stiffness"},
}
STEP = 3e-4
"""Of whole solves, as a part of a number; its square is left in their differences."""


def pairs(one: Answer, other: Answer) -> list[tuple[Point, Point]]:
    return list(zip(one.free + one.straight, other.free + other.straight, strict=True))


@pytest.mark.parametrize("name", FIELDS)
def test_they_are_differences_of_whole_solves(name: str) -> None:
    data = under(BENT[name], angle="100 deg")
    if name == "cell":
        # four layers for any pitch nearby
        data["mesh"] = {"section": 1, "axial": "0.4 mm"}
    case = checked(data)
    plane = name in ("hemicircle", "calibrated")
    wanted = Wanted(radians(100), (0.03,), (0.03,)) if plane else Wanted(radians(60))
    trials = Trials()
    found = trials.sensitivities(case, wanted, sorted(FIELDS[name]))
    assert found.answer.converged, found.answer.reason
    for field in FIELDS[name]:
        value = number(case, field)
        size = STEP * value
        more, less = (
            trials.solve(with_number(case, field, value + step), wanted) for step in (size, -size)
        )
        slopes = pairs(found.by_field[field], found.by_field[field])
        for (up, down), (slope, _), (here, _) in zip(
            pairs(more, less), slopes, pairs(found.answer, found.answer), strict=True
        ):
            for item in dataclasses.fields(Point):
                got = getattr(slope, item.name)
                whole = (getattr(up, item.name) - getattr(down, item.name)) / (2 * size)
                # of what hardly answers no digit counts: as a part of the quantity over the number
                scale = 1e-5 * abs(getattr(here, item.name) / value)
                assert got == pytest.approx(whole, rel=1e-4, abs=scale + 1e-12), (field, item.name)


def test_where_the_mesh_jumps_the_other_side_tells() -> None:
    """A longer pitch has one more layer of elements, a shorter one has not."""
    pitch = "effects.1.winding.pitch"
    found = []
    for axial in ("0.375 mm", "0.4 mm"):
        mesh = {"section": 1, "axial": axial}
        case = checked(under(BENT["cell"], angle="100 deg") | {"mesh": mesh})
        slopes = Trials().sensitivities(case, Wanted(radians(60)), [pitch])
        found.append(slopes.by_field[pitch].free[0].pressure)
    assert found[0] == pytest.approx(found[1], rel=1e-4)


@pytest.mark.parametrize("path", ["actuator.section", "actuator.sheets", "effects.7.winding.pitch"])
def test_what_is_no_number_is_refused(path: str) -> None:
    case = checked(under(BENT["hemicircle"], angle="100 deg"))
    with pytest.raises(CaseError, match="no number"):
        Trials().sensitivities(case, Wanted(radians(50)), [path])


def test_numbers_of_named_materials_and_fibers() -> None:
    case = checked(BENT["hemicircle"])
    assert number(case, "materials.wall.c1") == 0.11
    assert number(case, "effects.1.winding.fiber.modulus") == 31076.0
    changed = with_number(case, "materials.wall.c1", 0.2)
    assert number(changed, "materials.wall.c1") == 0.2
    assert changed.materials.floor == case.materials.floor
    assert math.isclose(number(changed, "actuator.wall"), 2.0)

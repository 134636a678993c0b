"""A pressure by its angle is refused where the section bends neither way, and only there."""

from __future__ import annotations

import copy
from typing import Any

import pytest

from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError

ONE = "elastosil-m4601"
SAME = {"law": "yeoh", "c1": "0.11 MPa", "c2": "0.02 MPa"}
OTHER = {"law": "yeoh", "c1": "0.12 MPa", "c2": "0.02 MPa"}
HEAVY = {"name": ONE, "density": "1.07 g/cm^3"}
TUBE = {"section": "circle", "radius": "8 mm", "length": "80 mm", "wall": "2 mm"}
BOX = {"section": "rectangle", "width": "12 mm", "height": "9 mm", "length": "80 mm"}
BOX |= {"wall": "3 mm", "floor": "3 mm"}
ROUND_FLOOR = TUBE | {"floor": "1 mm"}
LAYERED = BOX | {"floor": "2 mm", "layer": "1 mm"}
HALF = {"section": "hemicircle", "radius": "8 mm", "length": "80 mm", "wall": "2 mm"}
HALF |= {"floor": "2 mm"}


def wound(pattern: str) -> dict[str, Any]:
    """A winding of a pattern."""
    return {"winding": {"pattern": pattern, "pitch": "6 mm", "fiber": "kevlar"}}


def problems(actuator: dict[str, Any], materials: dict[str, Any], *more: dict[str, Any]) -> str:
    """What a case that drives the angle is told; empty where it is valid."""
    case = {
        "actuator": actuator,
        "materials": materials,
        "effects": [{"pressure": {"angle": "20 deg"}}, *more],
    }
    try:
        parse_case(copy.deepcopy(case))
    except CaseError as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("actuator", "materials"),
    [
        (TUBE, {"wall": ONE}),
        (TUBE | {"sheath": "1 mm"}, {"wall": ONE, "sheath": "ecoflex-0030"}),
        (ROUND_FLOOR, {"wall": ONE, "floor": ONE}),
        (ROUND_FLOOR, {"wall": SAME, "floor": SAME}),
        (BOX, {"wall": ONE, "floor": ONE}),
        (LAYERED, {"wall": ONE, "floor": ONE, "layer": ONE}),
    ],
)
@pytest.mark.parametrize("more", [(), (wound("double-helix"),), (wound("single-helix-left"),)])
def test_a_section_that_is_its_own_image_upside_down_is_refused(
    actuator: dict[str, Any], materials: dict[str, Any], more: tuple[dict[str, Any], ...]
) -> None:
    text = problems(actuator, materials, *more)
    assert text.startswith(
        'effects.0.pressure.angle: "20 deg", but no pressure bends this section: turned upside down'
    )
    assert "\n" not in text


@pytest.mark.parametrize(
    ("actuator", "materials", "more"),
    [
        (ROUND_FLOOR, {"wall": ONE, "floor": "combined-base"}, ()),
        (ROUND_FLOOR, {"wall": SAME, "floor": OTHER}, ()),
        (BOX, {"wall": SAME, "floor": OTHER}, ()),
        (BOX | {"floor": "3.1 mm"}, {"wall": ONE, "floor": ONE}, ()),
        (LAYERED | {"layer": "2 mm"}, {"wall": ONE, "floor": ONE, "layer": ONE}, ()),
        (LAYERED, {"wall": ONE, "floor": ONE, "layer": "combined-base"}, ()),
        (HALF, {"wall": ONE, "floor": ONE}, ()),
        # what acts from one side bends it, and the pressure may then move it
        (TUBE, {"wall": HEAVY}, ({"gravity": {"direction": "-y"}},)),
        (TUBE, {"wall": ONE}, ({"contact": {"plane": {"point": ["0 mm", "-9 mm", "0 mm"]}}},)),
    ],
)
def test_what_can_bend_is_not_refused(
    actuator: dict[str, Any], materials: dict[str, Any], more: tuple[dict[str, Any], ...]
) -> None:
    assert "no pressure bends" not in problems(actuator, materials, *more)


def test_weight_across_the_plane_of_bending_does_not_bend_it() -> None:
    gravity = {"gravity": {"direction": "+x"}}
    assert "no pressure bends" in problems(TUBE, {"wall": HEAVY}, gravity)


def test_a_pressure_by_its_value_may_be_asked_of_any_section() -> None:
    case = {"actuator": TUBE, "materials": {"wall": ONE}}
    parse_case(case | {"effects": [{"pressure": {"to": "20 kPa"}}]})

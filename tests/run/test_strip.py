"""Strips of fabric: a tube that bends wherever its strip lies, and what symmetry makes of that."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest

from fiberbend import run
from fiberbend.case import convert
from fiberbend.case.symmetry import Symmetry
from fiberbend.effects.wound.family import FamilySpec
from fiberbend.models.choice import MODELS
from fiberbend.models.result import RunResult
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import as_case
from fiberbend.schema.problems import CaseError

ALIKE = ("chamber_mm3", "axis_stretch", "fiber_min_N", "fiber_max_N", "stored_mJ")
"""Columns that no turn and no mirror image changes."""
NO_FILES = {"fields": False, "pictures": False}


def _strip(at: Any, width: str = "6 mm", **more: Any) -> dict[str, Any]:
    return {"strip": {"at": at, "width": width, "thickness": "0.2 mm", "modulus": "2 GPa"} | more}


def _case(*strips: dict[str, Any], pattern: str = "double-helix", **more: Any) -> dict[str, Any]:
    winding = {"pattern": pattern, "pitch": "6 mm", "fiber": "kevlar", "as": "smeared"}
    return {
        "title": "A tube with a strip of fabric",
        "actuator": {
            "section": "circle",
            "radius": "8 mm",
            "length": "100 mm",
            "wall": "2 mm",
            "cap": "5 mm",
        },
        "materials": {"wall": "elastosil-m4601"},
        "effects": [{"pressure": {"to": "30 kPa"}}, {"winding": winding}, *strips],
        "model": "section",
        "solver": {"tolerance": 1e-12},
        "output": NO_FILES,
    } | more


@functools.cache
def _at(degrees: float, pattern: str = "double-helix", model: str = "section") -> RunResult:
    """A run with a strip at an angle from the top toward +x."""
    case = _case(_strip({"angle": f"{degrees} deg"}), pattern=pattern, model=model)
    return run(case | {"mesh": {"section": 1, "axial": "1.5 mm"}})


def _same(result: RunResult, other: RunResult, rel: float) -> None:
    for column in ALIKE:
        assert result.last(column) == pytest.approx(other.last(column), rel=rel), column


@pytest.mark.parametrize(
    "degrees",
    [90.0, 225.0, *(pytest.param(each, marks=pytest.mark.long) for each in (270.0, 135.0, 45.0))],
)
def test_a_tube_bends_toward_its_strip_wherever_that_lies(degrees: float) -> None:
    # the mesh is its own image turned by 45°: half a section in its plane, whole ones to the side
    below, turned = _at(180.0), _at(degrees)
    bend = below.last("angle_deg")
    assert bend > 30
    lean = math.radians(degrees)
    assert turned.last("angle_deg") == pytest.approx(-bend * math.cos(lean), abs=1e-9)
    assert turned.last("side_angle_deg") == pytest.approx(bend * math.sin(lean), abs=1e-9)
    assert turned.last("twist_deg") == 0
    _same(turned, below, 1e-10)
    # the tip goes where it bends: the middle of the section is 10 mm above y = 0
    aside = -(below.last("tip_y_mm") - 10)
    assert turned.last("tip_x_mm") == pytest.approx(aside * math.sin(lean), abs=1e-9)
    assert turned.last("tip_y_mm") - 10 == pytest.approx(aside * math.cos(lean), abs=1e-9)
    assert turned.last("tip_z_mm") == pytest.approx(below.last("tip_z_mm"), rel=1e-10)


@pytest.mark.long
def test_mirrored_it_bends_and_twists_the_other_way() -> None:
    right, left = _at(100.0, "single-helix-right"), _at(-100.0, "single-helix-left")
    for column in ("angle_deg", "tip_y_mm", "tip_z_mm"):
        assert right.last(column) == pytest.approx(left.last(column), rel=1e-10)
    for column in ("side_angle_deg", "twist_deg", "tip_x_mm"):
        assert abs(right.last(column)) > 10
        assert right.last(column) == pytest.approx(-left.last(column), rel=1e-10)
    _same(right, left, 1e-10)


def test_half_a_turn_about_the_axis_turns_the_bend_and_keeps_the_twist() -> None:
    # with every unknown: a helix is its own image, a strip lies opposite
    one, other = _at(100.0, "single-helix-right"), _at(280.0, "single-helix-right")
    for column in ("angle_deg", "side_angle_deg", "tip_x_mm"):
        assert one.last(column) == pytest.approx(-other.last(column), rel=1e-10)
    assert one.last("twist_deg") == pytest.approx(other.last("twist_deg"), rel=1e-10)
    _same(one, other, 1e-10)


def test_a_cell_is_the_section_to_round_off() -> None:
    section, cell = (_at(100.0, "single-helix-right", model) for model in ("section", "cell"))
    for column in ("angle_deg", "side_angle_deg", "twist_deg", "tip_x_mm", "tip_y_mm", "tip_z_mm"):
        assert cell.last(column) == pytest.approx(section.last(column), rel=1e-10), column
    _same(cell, section, 1e-10)


@pytest.mark.long
def test_without_twist_too() -> None:
    section, cell = (_at(135.0, model=model) for model in ("section", "cell"))
    for column in ("angle_deg", "side_angle_deg", "tip_x_mm"):
        assert cell.last(column) == pytest.approx(section.last(column), rel=1e-10), column
    _same(cell, section, 1e-10)


@pytest.mark.long
def test_two_strips_opposite_each_other_keep_it_straight() -> None:
    result = run(_case(_strip("right"), _strip("left")))
    for column in ("angle_deg", "side_angle_deg"):
        assert result.last(column) == pytest.approx(0, abs=1e-9)
    assert result.last("axis_stretch") == pytest.approx(1, abs=0.01)


@pytest.mark.long
def test_kept_straight_it_pushes_to_its_side() -> None:
    below, right = (run(_case(_strip(at), {"straight": {}})) for at in ("bottom", "right"))
    moment = below.last("blocked_moment_Nmm")
    assert moment > 10
    assert right.last("blocked_moment_Nmm") == pytest.approx(0, abs=1e-9)
    assert right.last("moment_y_Nmm") == pytest.approx(moment, rel=1e-10)


def test_a_strip_over_the_whole_floor_is_a_thin_stiff_layer() -> None:
    # E t = 400 N/mm, as a layer 0.05 mm thick has, which bends by itself too, and not for nothing
    actuator = {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "100 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "cap": "5 mm",
    }
    rubber = {"wall": "elastosil-m4601", "floor": "elastosil-m4601"}
    fabric = _case(_strip("bottom", "20 mm"), actuator=actuator, materials=rubber)
    stiff = {"law": "neo-hooke", "mu": f"{400 / 0.05 / 3} MPa"}
    layer = _case(actuator=actuator | {"layer": "0.05 mm"}, materials=rubber | {"layer": stiff})
    one, other = run(fabric), run(layer)
    assert one.last("angle_deg") > 15
    assert one.last("angle_deg") == pytest.approx(other.last("angle_deg"), rel=0.04)


@pytest.mark.long
def test_a_body_bends_to_the_side_as_its_section() -> None:
    case = _case(_strip("right"), model="body")
    case["mesh"] = {"axial": "5 mm", "section": 1}
    body, section = run(case | {"solver": {}}), _at(90.0)
    assert body.last("angle_deg") == pytest.approx(0, abs=0.5)
    ratio = body.last("uniform_side_angle_deg") / section.last("side_angle_deg")
    assert ratio == pytest.approx(1, abs=0.05)


# --- which unknowns -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("at", "pattern", "scalars", "half"),
    [
        ("bottom", "double-helix", ("curvature", "stretch"), True),
        ({"angle": "360 deg"}, "double-helix", ("curvature", "stretch"), True),
        ("top", "single-helix-left", ("curvature", "stretch", "twist"), True),
        ("right", "double-helix", ("curvature", "stretch", "side_curvature"), False),
        (
            {"arc": "3 mm"},
            "single-helix-left",
            ("curvature", "stretch", "side_curvature", "twist"),
            False,
        ),
    ],
    ids=str,
)
def test_unknowns_follow_from_what_symmetry_is_left(
    at: Any, pattern: str, scalars: tuple[str, ...], half: bool
) -> None:
    case = as_case(_case(_strip(at), pattern=pattern))
    assert Symmetry.of(case.effects).scalars() == scalars
    assert MODELS["section"].half(case)[0] is half
    rows = dict(make_plan(case).rows)
    assert rows["unknowns"][0].endswith(f", and {', '.join(scalars)}")
    assert rows["half"][0].startswith("half (" if half else "full (")


def test_plan_says_which_symmetry_is_left_and_what_took_the_others() -> None:
    def said(at: str, pattern: str) -> str:
        return dict(make_plan(as_case(_case(_strip(at), pattern=pattern))).rows)["half"][0]

    assert said("bottom", "double-helix") == (
        "half (mirror planes x = 0 and z = 0: it bends in its plane, no side, twist or warping)"
    )
    assert said("bottom", "single-helix-left") == (
        "half (half a turn about y maps it onto itself: it bends about x and twists, its section "
        "warps, no side (a single helix is not its own mirror image))"
    )
    assert said("left", "double-helix") == (
        "full (mirror plane z = 0 alone: it bends about x and y, no twist or warping (a strip at "
        "left is not its own mirror image))"
    )
    assert said("left", "single-helix-left") == (
        "full (none: it bends about x and y and twists, its section warps (a single helix is not "
        "its own mirror image; a strip at left is not its own mirror image))"
    )


@pytest.mark.long
def test_a_single_helix_as_a_whole_section_is_what_half_of_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    half = run(_case(_strip("bottom"), pattern="single-helix-left"))
    monkeypatch.setattr(Symmetry, "sideways", True)
    whole = run(_case(_strip("bottom"), pattern="single-helix-left"))
    assert whole.last("side_angle_deg") == pytest.approx(0, abs=1e-7)
    for column in ("angle_deg", "twist_deg", *ALIKE):
        assert whole.last(column) == pytest.approx(half.last(column), rel=1e-10), column


@pytest.mark.parametrize("degrees", [40.0, 90.0, 140.0, 180.0, 260.0])
def test_an_angle_is_the_share_of_the_outline_that_it_is_of_threads(degrees: float) -> None:
    # no circle: a ray's angle would be another place
    dimensions = {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "100 mm",
        "wall": "2 mm",
        "floor": "2 mm",
    }
    rubber = {"wall": "elastosil-m4601", "floor": "elastosil-m4601"}
    thread = {"angle_from_axis": "0 deg", "at": [f"{degrees} deg"]}
    case = as_case(
        _case(_strip({"angle": f"{degrees} deg"}), actuator=dimensions, materials=rubber)
    )
    actuator = convert.dimensions(case.actuator)
    ((window,),) = (e.windows(actuator) for e in case.effects if e.several)
    assert window.middle == pytest.approx(degrees / 360 * actuator.winding_perimeter)
    family = FamilySpec.model_validate(thread, context=None).laid(actuator, "all")[0]
    assert family.offset == pytest.approx(window.middle)


# --- what is refused ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("strips", "path", "text"),
    [
        ([_strip({})], "effects.2.strip.at", "0 places"),
        ([_strip({"angle": "3 deg", "arc": "3 mm"})], "effects.2.strip.at", "2 places"),
        ([_strip("bottom", "63 mm")], "effects.2.strip.width", "than the outline is long"),
        ([_strip({"arc": "70 mm"})], "effects.2.strip.at.arc", "from zero to that"),
        (
            [_strip("bottom"), _strip({"angle": "170 deg"})],
            "effects.3.strip",
            "lies over effects.2",
        ),
        ([_strip("top"), _strip({"arc": "62 mm"})], "effects.3.strip", "lies over effects.2"),
    ],
    ids=str,
)
def test_what_cannot_be_is_refused(strips: list[dict[str, Any]], path: str, text: str) -> None:
    with pytest.raises(CaseError) as refused:
        as_case(_case(*strips))
    (problem,) = refused.value.problems
    assert problem.path == path
    assert text in problem.text


def test_no_closed_form_has_it() -> None:
    with pytest.raises(CaseError, match="no closed form has a strip of fabric"):
        as_case(_case(_strip("bottom"), model="analytic"))


def test_neighbours_may_touch() -> None:
    perimeter = 2 * np.pi * 10
    strips = [_strip({"arc": f"{arc:.12g} mm"}) for arc in (3.0, 9.0, perimeter - 3)]
    assert len(as_case(_case(*strips)).effects) == 5


# --- threads instead of fabric ------------------------------------------------------------------


def _threaded(*at: str, model: str = "section", kind: str = "smeared") -> dict[str, Any]:
    """The tube with crossing families and threads along the axis at places of their own."""
    families = [
        {"pitch": "6 mm", "hand": "right"},
        {"pitch": "6 mm", "hand": "left"},
        {"angle_from_axis": "0 deg", "at": list(at)},
    ]
    case = _case(model=model, mesh={"section": 1, "axial": "1.5 mm"})
    case["effects"] = [
        {"pressure": {"to": "20 kPa"}},
        {"winding": {"families": families, "fiber": "kevlar", "as": kind}},
    ]
    return case


@pytest.mark.long
@pytest.mark.parametrize("kind", ["smeared", "discrete"])
def test_a_tube_bends_toward_a_thread_along_its_axis(kind: str) -> None:
    # spread, or every turn of the crossing families in a cell
    model = "section" if kind == "smeared" else "cell"
    below, right = (run(_threaded(at, model=model, kind=kind)) for at in ("180 deg", "90 deg"))
    bend = below.last("angle_deg")
    assert bend > 15
    rel = 1e-9 if kind == "smeared" else 0.01
    assert right.last("side_angle_deg") == pytest.approx(bend, rel=rel)
    assert right.last("angle_deg") == pytest.approx(0, abs=1e-7 if kind == "smeared" else 0.2)
    assert right.last("chamber_mm3") == pytest.approx(below.last("chamber_mm3"), rel=rel)


def test_a_thread_on_each_side_is_symmetric_again() -> None:
    case = as_case(_threaded("90 deg", "270 deg"))
    assert Symmetry.of(case.effects).plane
    assert not Symmetry.of(as_case(_threaded("90 deg", "271 deg")).effects).plane

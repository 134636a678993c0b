"""Windings by families in section, cell and body: exact tubes, mirror images, starts, limits."""

from __future__ import annotations

import math
from typing import Any

import pytest
import yaml

from fiberbend import run
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from tests.conftest import ROOT
from tests.run.conftest import small
from tests.verify.helix_tube import HelixTube

NO_FILES = {"fields": False, "pictures": False}
INNER, OUTER = 6.35, 8.35
THREAD = {"modulus": "31067 MPa", "diameter": "0.1778 mm"}
EA = 31067.0 * math.pi * 0.0889**2
COARSE = {"section": 1, "axial": "1.5 mm"}
TIGHT = {"tolerance": 1e-12}


def family(**given: Any) -> dict[str, Any]:
    """A family as a case has it."""
    return given


def helices(angle: float, starts: int, **more: Any) -> list[dict[str, Any]]:
    """Right and left at one angle from the axis, in degrees."""
    common = {"angle_from_axis": f"{angle} deg", "starts": starts} | more
    return [common | {"hand": hand} for hand in ("right", "left")]


def solved(families: list[dict[str, Any]], model: str, kind: str, **changes: Any) -> RunResult:
    """The small actuator with families."""
    winding = {"families": families, "fiber": "kevlar", "as": kind} | changes.pop("winding", {})
    pressure = changes.pop("pressure", {"to": "40 kPa"})
    case = small(effects=[{"pressure": pressure}, {"winding": winding}], model=model)
    case |= {"mesh": COARSE, "output": NO_FILES, "solver": TIGHT}
    case["actuator"] |= {"length": "80 mm"}
    return run(case | changes)


def alike(one: RunResult, other: RunResult, names: dict[str, int], rel: float) -> None:
    """Both end in the same state, up to signs."""
    assert one.status == other.status == "converged"
    for name, sign in names.items():
        found, expected = one.last(name), sign * other.last(name)
        assert found == pytest.approx(expected, rel=rel, abs=rel), name


STATE = {"angle_deg": 1, "axis_stretch": 1, "chamber_mm3": 1, "fiber_max_N": 1, "tip_y_mm": 1}
SCREW = {**STATE, "twist_deg": -1, "tip_x_mm": -1}


@pytest.mark.parametrize(("angle", "starts"), [(65.0, 1), (54.0, 8), (20.0, 24)])
def test_a_tube_under_families_is_the_exact_tube(angle: float, starts: int) -> None:
    fiber = {"families": helices(angle, starts), "fiber": THREAD, "as": "smeared"}
    result = run(
        {
            "title": "A tube",
            "actuator": {
                "section": "circle",
                "radius": f"{INNER} mm",
                "length": "320 mm",
                "wall": f"{OUTER - INNER} mm",
            },
            "materials": {"wall": {"law": "neo-hooke", "mu": "0.24 MPa"}},
            "effects": [{"pressure": {"to": "20 kPa"}}, {"winding": fiber}],
            "model": "section",
            "output": NO_FILES,
        }
    )
    pitch = 2 * math.pi * OUTER / math.tan(math.radians(angle))
    exact = HelixTube(0.12, 0.0, INNER, OUTER, pitch, starts * EA, (1, -1))
    stretch, turn = exact.at_pressure(0.02)
    assert result.last("axis_stretch") == pytest.approx(stretch, rel=1e-5)
    assert turn == pytest.approx(0, abs=1e-12)
    assert result.last("angle_deg") == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize(("model", "kind"), [("section", "smeared"), ("cell", "discrete")])
def test_the_families_of_a_pattern_give_its_numbers(model: str, kind: str) -> None:
    families = [family(pitch="3 mm", hand=hand) for hand in ("right", "left")]
    by_families = solved(families, model, kind)
    pattern = {"pattern": "double-helix", "pitch": "3 mm", "families": None}
    alike(by_families, solved([], model, kind, winding=pattern), STATE, 1e-12)


@pytest.mark.parametrize(("model", "kind"), [("section", "smeared"), ("cell", "discrete")])
def test_mirrored_hands_give_mirrored_answers(model: str, kind: str) -> None:
    right, left = (
        solved(
            [
                family(angle_from_axis="70 deg", hand=hand, starts=6, phase="40 deg"),
                family(angle_from_axis="0 deg", at=["90 deg", "270 deg"], fiber=THREAD),
            ],
            model,
            kind,
        )
        for hand in ("right", "left")
    )
    alike(right, left, SCREW, 1e-10)
    assert abs(right.last("twist_deg")) > 1


@pytest.mark.long
def test_a_stiff_braid_on_a_fine_section_converges_to_its_round_off() -> None:
    """Force and moment of its threads round off by 1e-11 of themselves: no more can be asked."""
    tube = {"section": "circle", "radius": "5 mm", "length": "97.344 mm", "wall": "1.5 mm"}
    fine, rough = (
        solved(
            helices(40.0, 6),
            "section",
            "smeared",
            actuator=tube,
            materials={"wall": "dragon-skin-30"},
            pressure={"to": "30 kPa"},
            mesh={"section": 8},
            solver={"tolerance": tolerance},
        )
        for tolerance in (1e-12, 1e-10)
    )
    for name in ("axis_stretch", "chamber_mm3", "stored_mJ"):
        assert fine.last(name) == pytest.approx(rough.last(name), rel=1e-9)
    assert (fine.status, fine.run["cutbacks"]) == ("converged", 0)


@pytest.mark.long
def test_starts_fill_a_slice_of_a_part_of_the_pitch() -> None:
    # n starts in p/n are those in 2p/n: twice half of them, one start further on
    def cell(starts: int, *phases: str) -> RunResult:
        families = [
            family(pitch="18 mm", hand=hand, starts=starts, phase=phase)
            for hand in ("right", "left")
            for phase in phases
        ]
        return solved(families, "cell", "discrete", mesh={"section": 1, "axial": "0.75 mm"})

    whole, twice = cell(6, "0 deg"), cell(3, "0 deg", "60 deg")
    assert twice.run["elements"] == 2 * whole.run["elements"]
    alike(whole, twice, STATE, 1e-9)


def test_where_a_slice_begins_does_not_matter() -> None:
    # half a turn of phase for both hands is the same threads further up
    alike(
        solved(helices(70, 6), "cell", "discrete"),
        solved(helices(70, 6, phase="25 deg"), "cell", "discrete"),
        STATE,
        1e-9,
    )


@pytest.mark.long
def test_discrete_hoops_come_to_the_smeared_ones() -> None:
    # the same thread in finer and finer hoops: what rubber bulges between them goes
    def end(spacing: float, kind: str) -> float:
        thread = {"modulus": f"{1000 * spacing} MPa", "diameter": "0.3 mm"}
        hoops = [family(angle_from_axis="90 deg", spacing=f"{spacing} mm", fiber=thread)]
        mesh = COARSE | {"axial": f"{spacing / 4} mm"}
        found = solved(
            hoops, "cell" if kind == "discrete" else "section", kind,
            winding={"fiber": None}, mesh=mesh, pressure={"angle": "40 deg"},
        )  # fmt: skip
        return found.last("pressure_kPa")

    smeared = end(1.0, "smeared")
    off = [end(spacing, "discrete") / smeared - 1 for spacing in (4.0, 2.0, 1.0)]
    assert off[0] > off[1] > off[2] > 0
    assert off[2] < 0.3 * off[0]


@pytest.mark.long
def test_threads_along_the_floor_and_around_the_wall_alone() -> None:
    # a strip that does not stretch makes it bend further at one pressure; no hoops under the floor
    hoops = family(angle_from_axis="90 deg", spacing="2 mm", around="wall")
    floor = family(angle_from_axis="0 deg", at=["170 deg", "180 deg", "190 deg"])
    materials = {"wall": "elastosil-m4601", "floor": "elastosil-m4601", "sheath": "ecoflex-0030"}
    bare, held = (
        solved(families, "section", "smeared", materials=materials)
        for families in ([hoops], [hoops, floor])
    )
    assert held.last("angle_deg") > 1.05 * bare.last("angle_deg")
    stretches = [result.last("floor_stretch") - 1 for result in (held, bare)]
    assert abs(stretches[0]) < 0.3 * stretches[1]


@pytest.mark.long
def test_threads_along_the_axis_are_the_same_in_section_and_cell() -> None:
    places = [family(angle_from_axis="0 deg", at=["40 deg", "180 deg", "320 deg"], fiber=THREAD)]
    section, discrete, cell = (
        solved(places, model, kind, winding={"fiber": None}, pressure={"to": "10 kPa"})
        for model, kind in (("section", "smeared"), ("section", "discrete"), ("cell", "discrete"))
    )
    alike(section, discrete, STATE, 1e-12)
    alike(section, cell, STATE, 1e-8)
    even = [family(angle_from_axis="0 deg", starts=200, fiber=THREAD)]
    spread, each = (
        solved(even, "section", kind, winding={"fiber": None}, pressure={"to": "10 kPa"})
        for kind in ("smeared", "discrete")
    )
    assert each.last("angle_deg") == pytest.approx(spread.last("angle_deg"), rel=1e-3)


@pytest.mark.long
@pytest.mark.parametrize("kind", ["smeared", "discrete"])
def test_half_a_body_is_the_whole_one(kind: str) -> None:
    families = [
        *helices(60, 4, phase="30 deg"),
        family(angle_from_axis="90 deg", spacing="4 mm", phase="90 deg", fiber=THREAD),
        family(angle_from_axis="0 deg", at=["0 deg", "100 deg", "180 deg", "260 deg"]),
    ]
    mesh = {"section": 1, "axial": "4 mm"}
    half, whole = (
        solved(
            families,
            "body",
            kind,
            mesh=mesh | {"symmetry": symmetry},
            actuator=small()["actuator"],
            pressure={"to": "20 kPa"},
        )
        for symmetry in ("half", "full")
    )
    # the stretch of a half's axis is that of the half section's centroids
    same = {name: sign for name, sign in STATE.items() if name != "axis_stretch"}
    alike(half, whole, same, 1e-9)
    assert whole.last("twist_deg") == pytest.approx(0, abs=1e-9)


@pytest.mark.long
def test_the_whole_body_of_one_hand_twists_as_its_section() -> None:
    given = family(angle_from_axis="75 deg", hand="right", starts=3)
    section = solved([given], "section", "smeared")
    body = solved([given], "body", "smeared", mesh={"section": 1, "axial": "8 mm"})
    assert body.last("uniform_twist_deg") == pytest.approx(section.last("twist_deg"), rel=0.05)
    assert section.last("twist_deg") < -5


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "column", "rest", "lost"),
    [
        ("contracting", "stretch", 1.0, 0.096),
        pytest.param("twisting", "twist_deg", 0.0, 0.040, marks=pytest.mark.hard),
        pytest.param("extending", "stretch", 1.0, 0.003, marks=pytest.mark.hard),
    ],
)
def test_caps_take_as_much_of_a_tube_s_motion_as_is_said(
    name: str, column: str, rest: float, lost: float
) -> None:
    """docs/models.md and the expected error have these numbers."""
    case = yaml.safe_load((ROOT / "cases" / f"{name}.yaml").read_text(encoding="utf-8"))
    cell = run({**case, "output": NO_FILES})
    body = run({**case, "model": "body", "output": NO_FILES})
    whole = body.last("axis_stretch" if column == "stretch" else column) - rest
    middle = body.last(f"uniform_{column}") - rest
    far = cell.last("axis_stretch" if column == "stretch" else column) - rest
    assert 1 - whole / middle == pytest.approx(lost, abs=0.0006)
    assert middle + rest == pytest.approx(far + rest, rel=3e-4)


def test_what_a_model_cannot_have_is_refused() -> None:
    def refusal(families: list[dict[str, Any]], model: str, kind: str = "discrete") -> str:
        with pytest.raises(Exception, match=r"effects\.1\.winding") as raised:
            solved(families, model, kind)
        return str(raised.value)

    odd = [*helices(70, 6), family(angle_from_axis="90 deg", spacing="3 mm")]
    assert 'families.2 with a spacing of "' in refusal(odd, "cell")
    assert "80° or more" in refusal(helices(70, 6), "analytic", "smeared")
    assert "only cell and body have turns" in refusal(helices(70, 6), "section")
    fixing = small(model="analytic", output=NO_FILES)
    del fixing["effects"][1]["winding"]["pattern"], fixing["effects"][1]["winding"]["pitch"]
    fixing["effects"][1]["winding"]["families"] = helices(85, 1)
    assert parse_case(fixing).model == "analytic"

"""The answer of a run: what the rows say, nothing that they do not, in words a person reads.

Most tests have rows made by hand, of which every number is known. The runs at the end show that the
answers are the rows' and the exact values.
"""

from __future__ import annotations

import io
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fiberbend import run
from fiberbend.answer.answer import WIDTH, Answer, Entry, answer, lines
from fiberbend.answer.numbers import number, quantity
from fiberbend.answer.strain import greatest_strain
from fiberbend.answer.touch import touches
from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.results.reading import read_history
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import MeshData
from tests.conftest import ROOT
from tests.run.conftest import small

CONVERGED: dict[str, Any] = {"status": "converged", "reason": "", "warnings": []}


def case_of(name: str = "section", **sections: Any) -> Case:
    """A shipped case with changes to it."""
    data = yaml.safe_load((ROOT / "cases" / f"{name}.yaml").read_text(encoding="utf-8"))
    for key, change in sections.items():
        data[key] = {**data[key], **change} if isinstance(change, dict) else change
    return parse_case(data)


def row(step: int, kpa: float, degrees: float, **more: Any) -> dict[str, Any]:
    place = {"tip_x_mm": 0.0, "tip_y_mm": 5.0 - degrees, "tip_z_mm": 175.0 - step}
    return {"step": step, "pressure_kPa": kpa, "angle_deg": degrees, **place, **more}


def found(said: Answer, label: str) -> Entry:
    (entry,) = [entry for entry in said.entries if entry.label == label]
    return entry


def test_measured_points_are_part_of_the_answer() -> None:
    """Who names a file of points wants to read of them, without --verbose."""
    text = "run: pressure 3.3 % lower than measured (trial.csv) at 38.0°, as expected"
    other = "analytic (own rubber): pressure 43.6 % higher at 10.0°"
    check = {"measured": {"text": text}, "lines": [other, text]}
    run = {**CONVERGED, "crosscheck": check}
    said = answer(case_of(), [row(0, 0, 0), row(1, 50, 90), row(2, 200, 360)], run)
    assert found(said, "measured points").value == text
    assert said.comparisons == (other,)


def labels(said: Answer) -> list[str]:
    return [entry.label for entry in said.entries]


# --- numbers ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (45.11124, "45.11"),
        (360.0, "360"),
        (999.96, "1000"),
        (0.0012345, "0.0012"),
        (-1e-9, "0"),
        (-0.04, "-0.04"),
        (123456.7, "123457"),
    ],
)
def test_numbers_have_four_digits_and_no_exponent(value: float, text: str) -> None:
    assert number(value) == text


def test_units() -> None:
    assert quantity(89.9999999, "°") == "90°"
    assert quantity(181.5233, "kPa") == "181.5 kPa"
    assert quantity(-0.001, "mm") == "0 mm"
    assert quantity(41.0816, "kPa", 3) == "41.1 kPa"


# --- what is asked for ------------------------------------------------------------------------


def test_pressures_at_angles_and_angles_at_pressures() -> None:
    case = case_of(
        effects=[{"pressure": {"to": "200 kPa"}}, *case_of().resolved()["effects"][1:]],
        output={"at_angles": ["90 deg", "180 deg"], "at_pressures": ["50 kPa"]},
    )
    rows = [row(0, 0, 0), row(1, 45.1112, 90.0), row(2, 50.0, 99.972), row(3, 200.0, 170.5)]
    said = answer(case, rows, CONVERGED)
    assert found(said, "pressure at 90°") == Entry("pressure at 90°", "45.11 kPa")
    assert found(said, "pressure at 180°").value == "not reached"
    assert found(said, "angle at 50 kPa").value == "99.97°"
    assert found(said, "end of the run").value == "200 kPa, 170.5°"
    tip = found(said, "tip at the end")
    assert (tip.value, tip.note) == (
        "y = -165.5 mm, z = 172 mm",
        "at rest y = 5 mm, z = 175 mm",
    )
    # free bending, in its plane: no force, no twist, no contact
    words = " ".join(labels(said))
    assert not re.search("force|twist|side|touch|moment|limit|strain", words)


def test_a_state_that_is_met_twice_is_said_twice() -> None:
    case = case_of(output={"at_angles": ["90 deg"]})
    rows = [row(0, 0, 0), row(1, 60, 90.0), row(2, 80, 120), row(3, 70, 90.0 + 1e-8)]
    entry = found(answer(case, rows, CONVERGED), "pressure at 90°")
    assert (entry.value, entry.note) == ("60 kPa", "and again 70 kPa")


def test_rest_answers_nothing() -> None:
    """What a body is before any load is no answer of a run."""
    said = answer(case_of(), [row(0, 0, 90.0), row(1, 5, 99.0)], CONVERGED)
    assert found(said, "pressure at 90°").value == "not reached"


def test_a_case_without_pressure_has_none() -> None:
    heavy = case_of(
        "free_bending_smeared",
        effects=[{"gravity": {"direction": "-y"}}],
        materials={"floor": {"name": "combined-base", "density": "1.2 g/cm^3"}},
        output={"at_angles": []},
        compare=[],
    )
    said = answer(heavy, [row(0, 0, 0), row(1, 0, 12.5)], CONVERGED)
    assert said.sentence == "The actuator ends at 12.5° (body model)."
    assert "kPa" not in "\n".join(lines(said))


def test_turns_out_of_the_plane() -> None:
    rows = [
        row(0, 0, 0, twist_deg=0.0, side_angle_deg=0.0),
        row(1, 100, 197, twist_deg=83.28, side_angle_deg=1e-9),
    ]
    rows[-1]["tip_x_mm"] = 84.09
    said = answer(case_of("single_helix"), rows, CONVERGED)
    assert said.sentence.startswith("The actuator bends to 197° and twists by 83.28° at 100 kPa")
    assert found(said, "twist at the end").value == "83.28°"
    assert "side angle at the end" not in labels(said)
    assert found(said, "tip at the end").value.startswith("x = 84.09 mm, y = ")


@pytest.mark.parametrize(
    ("more", "sentence", "end"),
    [
        ({"twist_deg": -148.3}, "twists by -148.3°", "twist -148.3°"),
        ({"axis_stretch": 1.23456}, "lengthens by 23.5 %", "stretch 1.235"),
        ({"axis_stretch": 0.9}, "shortens by 10 %", "stretch 0.9"),
        ({"side_angle_deg": 12.0}, "bends by 12° to the side", "side angle 12°"),
        ({"axis_stretch": 1.00001}, "bends to 0°", "0°"),
    ],
)
def test_what_does_not_bend_does_something_else(
    more: dict[str, float], sentence: str, end: str
) -> None:
    said = answer(case_of("single_helix"), [row(0, 0, 0), row(1, 50, 1e-9, **more)], CONVERGED)
    assert said.sentence.startswith(f"The actuator {sentence} at 50 kPa")
    assert found(said, "end of the run").value == f"50 kPa, {end}"
    effects = [{"pressure": {"to": "60 kPa"}}, *case_of("twisting").resolved()["effects"][1:]]
    case = case_of("twisting", effects=effects, output={"at_pressures": ["50 kPa"]})
    said = answer(case, [row(0, 0, 0), row(1, 50, 1e-9, **more)], CONVERGED)
    name, value = end.rsplit(" ", 1) if " " in end else ("angle", end)
    # one line, of what it does: no angle of 0° where it twists or lengthens
    assert [e.value for e in said.entries if e.label.endswith(" at 50 kPa")] == [value]
    assert found(said, f"{name} at 50 kPa").value == value


def test_an_s_is_told_by_the_bends_of_its_zones() -> None:
    """The whole does not bend, and lengthens by the way."""
    case = case_of("s_shape")
    rows = [row(0, 0, 0, zone_1_angle_deg=0.0, zone_2_angle_deg=0.0, axis_stretch=1.0)]
    for step, kpa, degrees in ((1, 12.0, 25.0), (2, 24.0, 49.02)):
        zones = {"zone_1_angle_deg": degrees, "zone_2_angle_deg": -degrees}
        rows.append(row(step, kpa, 1e-12, axis_stretch=1.04, **zones))
    said = answer(case, rows, CONVERGED)
    assert said.sentence.startswith("The actuator bends to 49.02°, -49.02° in its zones at 24 kPa")
    assert found(said, "angles of the zones at 12 kPa").value == "25°, -25°"
    assert found(said, "end of the run").value == "24 kPa, angles of the zones 49.02°, -49.02°"
    # zones that bend the same way add up
    rows[-1].update(angle_deg=60.0, zone_2_angle_deg=10.98)
    assert answer(case, rows, CONVERGED).sentence.startswith("The actuator bends to 60° at 24 kPa")


# --- held -------------------------------------------------------------------------------------


def test_what_is_held_is_told_by_its_forces() -> None:
    """By those of what is held alone, and a motion that is held is no answer."""
    held: dict[str, Any] = {"stretch": 1.02, "twist": "-10 deg"}
    effects = [{"hold": held}, *case_of("twisting").resolved()["effects"]]
    case = case_of("twisting", effects=effects, output={"at_pressures": ["10 kPa"]})
    forces = {"axial_force_N": -0.3, "torque_Nmm": 2.5, "moment_x_Nmm": 0.0, "moment_y_Nmm": 0.0}
    moved = {"axis_stretch": 1.02, "twist_deg": -10.0}
    rows = [row(0, 0, 0), row(1, 10, 0, **moved, **forces), row(2, 30, 0, **moved, **forces)]
    rows[-1] |= {"axial_force_N": 1.25, "torque_Nmm": 20.5}
    said = answer(case, rows, CONVERGED)
    assert found(said, "axial force at 10 kPa").value == "-0.3 N"
    assert found(said, "torque at 10 kPa").value == "2.5 N mm"
    wanted = Entry("axial force", "1.25 N", "at the end, on what holds its stretch at 1.02")
    assert found(said, "axial force") == wanted
    wanted = Entry("torque", "20.5 N mm", "at the end, on what holds its twist at -10°")
    assert found(said, "torque") == wanted
    assert not any("moment" in label for label in labels(said))
    assert not any(label.startswith(("twist at 10", "stretch at")) for label in labels(said))
    # the bend is free, and is what is told beside the forces
    assert found(said, "angle at 10 kPa").value == "0°"


@pytest.mark.parametrize(
    ("held", "columns", "signs"),
    [
        ({"stretch": 1.0}, ["axial_force_N"], [1]),
        ({"bend": "0 deg", "twist": "0 deg"}, ["moment_x_Nmm", "torque_Nmm"], [1, 1]),
    ],
)
def test_forces_that_hold_are_those_of_the_history(
    held: dict[str, Any], columns: list[str], signs: list[int]
) -> None:
    spread = case_of("single_helix").resolved()["effects"][1]["winding"] | {"as": "smeared"}
    effects = [{"hold": held}, {"pressure": {"to": "20 kPa"}}, {"winding": spread}]
    quiet: dict[str, Any] = {"at_angles": [], "at_pressures": []}
    case = case_of("single_helix", effects=effects, model="section", output=quiet)
    result = run_case(case, None)
    last, said = result.rows[-1], answer(case, result.rows, result.run)
    names = {"axial_force_N": "axial force", "moment_x_Nmm": "bending moment"}
    names |= {"torque_Nmm": "torque"}
    for column, sign in zip(columns, signs, strict=True):
        unit = column.rsplit("_", 1)[1].replace("Nmm", "N mm")
        assert found(said, names[column]).value == quantity(last[column], unit)
        assert sign * last[column] > 0


# --- ends -------------------------------------------------------------------------------------


def test_ends_are_told_by_what_the_actuator_does() -> None:
    """A tube does not bend further near its caps."""

    def ends(name: str, **sections: Any) -> str:
        case = case_of(name, **sections)
        said = answer(case, [row(0, 0, 0), row(1, 1, 1)], CONVERGED)
        (line,) = [entry.value for entry in said.entries if entry.value.startswith("ends: ")]
        return line

    assert "twists up to 4 % less" in ends("twisting")
    assert "twists up to 4 % less" in ends("twisting", model="body")
    for name in ("extending", "contracting"):
        assert "lengthens 0.3 % less" in ends(name)
        assert "twists" not in ends(name)
    for name in ("section", "single_helix", "free_bending"):
        assert "the whole body bends further than its middle" in ends(name)
    strip = {"at": "right", "width": "5 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
    effects = [*case_of("extending").resolved()["effects"], {"strip": strip}]
    assert "bends further" in ends("extending", effects=effects)
    effects = [*case_of("extending").resolved()["effects"], {"hold": {"stretch": 1.0}}]
    assert "the hold acts all along the body" in ends("extending", effects=effects)


# --- blocked ----------------------------------------------------------------------------------


def test_a_blocked_tip_leads_with_its_force_and_names_it() -> None:
    rows = [row(0, 0, 0), row(1, 50.0, 4.67, tip_force_N=1.587, roof_force_N=3.2)]
    rows.append(row(2, 200.0, 15.86, tip_force_N=7.781, roof_force_N=14.95))
    case = case_of("blocked_tip", output={"at_pressures": ["50 kPa", "150 kPa"]})
    said = answer(case, rows, CONVERGED)
    assert said.sentence == "At 200 kPa the tip presses on its post with 7.781 N (body model)."
    assert labels(said)[0] == "tip force at 50 kPa"
    assert found(said, "tip force at 50 kPa").value == "1.587 N"
    assert found(said, "tip force at 150 kPa").value == "not reached"
    assert found(said, "this force is").value == "that of the body's tip on the post"
    assert found(said, "force of the roof").value == "14.95 N"
    assert found(said, "end of the run").value == "7.781 N, 200 kPa, 15.86°"
    assert "tip at the end" not in labels(said)


def test_a_straight_section_is_no_blocked_tip() -> None:
    rows = [row(0, 0, 0), row(1, 200.0, 0.0, tip_force_N=13.56, blocked_moment_Nmm=203.4)]
    case = case_of("straight", output={"at_pressures": []})
    said = answer(case, rows, CONVERGED)
    wanted = "Kept straight at 200 kPa, the section model gives a tip force of 13.56 N."
    assert said.sentence == wanted
    assert found(said, "tip force at 200 kPa").value == "13.56 N"
    assert found(said, "this force is").value.startswith("M/L_f, of a section kept straight")
    assert found(said, "this force is").value.endswith("L_f = 15 mm")
    # θ ≡ 0 is no answer
    assert found(said, "end of the run").value == "13.56 N, 200 kPa"
    analytic = case_of("straight", model="analytic", output={"at_pressures": []})
    assert found(answer(analytic, rows, CONVERGED), "this force is").value.startswith("κP/L_f")


# --- touches ----------------------------------------------------------------------------------


def bar(gap: float | None, area: float = 0.0, **more: float) -> dict[str, Any]:
    name = "contact_cylinder_"
    return {f"{name}gap_mm": gap, f"{name}area_mm2": area, **more}


def closing(*gaps: float) -> list[dict[str, Any]]:
    """Steps of 10 kPa and 20°; the last one touches."""
    rows = [row(i + 1, 10.0 * (i + 1), 20.0 * (i + 1), **bar(gap)) for i, gap in enumerate(gaps)]
    touching = bar(-1e-4, 1.5, contact_cylinder_y_N=0.3, contact_cylinder_z_N=0.4)
    n = len(rows) + 1
    return [row(0, 0, 0), *rows, row(n, 10.0 * n, 20.0 * n, **touching)]


def test_a_touch_between_steps_follows_from_the_gaps_before() -> None:
    # 3 mm a step: closed 2/3 of a step after the second
    (touch,) = touches(closing(5.0, 2.0))
    assert (touch.obstacle, touch.value) == ("cylinder", "at 26.7 kPa, 53.3°")
    assert "steps 1 and 2 extrapolated, within step 3" in touch.note
    # 3 mm, 4 N : 5
    assert touch.force == pytest.approx(0.5)


@pytest.mark.parametrize("gaps", [(2.0, 5.0), (9.0, 8.0), (5.0,)])
def test_a_touch_that_gaps_do_not_give_is_between_its_steps(gaps: tuple[float, ...]) -> None:
    """The gap opened before, or would close later, or only one is known."""
    (touch,) = touches(closing(*gaps))
    n = len(gaps)
    wanted = f"between {10 * n} kPa, {20 * n}° and {10 * n + 10} kPa, {20 * n + 20}°"
    assert touch.value == wanted


def test_touches_in_the_first_step_and_never() -> None:
    (touch,) = touches(closing())
    assert (touch.value, touch.note) == ("by 10 kPa, 20°", "within the first load step")
    (never,) = touches([row(0, 0, 0), row(1, 10, 20, **bar(5.0)), row(2, 20, 40, **bar(3.21))])
    assert (never.value, never.note) == ("", "the body comes as near as 3.21 mm")
    assert never.force is None
    # the file's empty cells are None
    assert list(touches([row(0, 0, 0, **bar(None, 0.0)), row(1, 9, 9)])) != []
    assert list(touches([row(0, 0, 0), row(1, 9, 9)])) == []


def test_an_obstacle_that_is_left_again() -> None:
    rows = [*closing(5.0, 2.0), row(4, 40, 80, **bar(1.0))]
    (touch,) = touches(rows)
    assert touch.force is None
    assert touch.note.endswith("it has left it at the end")


def test_touches_in_the_answer() -> None:
    case = case_of("grasp", output={"at_pressures": []})
    said = answer(case, closing(5.0, 2.0), CONVERGED)
    assert found(said, "touches the cylinder").value == "at 26.7 kPa, 53.3°"
    assert found(said, "force of the cylinder") == Entry(
        "force of the cylinder", "0.5 N", "at the end"
    )
    never = answer(case, [row(0, 0, 0), row(1, 10, 20, **bar(5.0))], CONVERGED)
    assert found(never, "touch of the cylinder").value == "none"


# --- how far to trust it ----------------------------------------------------------------------


def test_errors_are_those_of_the_plan() -> None:
    from fiberbend.models.choice import choose_model
    from fiberbend.plan.plan import errors

    for name in ("section", "cell", "straight", "grasp", "blocked_tip"):
        case = case_of(name)
        said = answer(case, [row(0, 0, 0), row(1, 1, 1)], CONVERGED)
        first = labels(said).index("expected error")
        told = [entry.value for entry in said.entries[first:]]
        assert told == list(errors(case, choose_model(case)[0]))
        assert all(not entry.label for entry in said.entries[first + 1 :])


def test_a_run_that_failed_says_up_to_where_it_is_valid() -> None:
    rows = [row(0, 0, 0), row(1, 45.0, 88.0)]
    said = answer(case_of(), rows, CONVERGED | {"status": "failed", "reason": "no convergence"})
    assert said.sentence == (
        "The run failed at 45 kPa, 88°: the answer is valid up to there (section model)."
    )
    assert said.trust.startswith("Trust: the values up to the end of the run are valid")
    none = answer(case_of(), rows[:1], CONVERGED | {"status": "failed"})
    assert none.sentence.startswith("The run failed before its first load step: it has no answer")


def test_trust_has_the_section_beside_it_and_counts_warnings() -> None:
    rows = [row(0, 0, 0), row(1, 45.0, 88.0)]
    text = "section model: pressure 4.0 % lower at 360.0°, as expected for a pitch of 3 mm"
    beside = {"section": {"text": text, "band_percent": 6.0}, "lines": [text, "another"]}
    run = CONVERGED | {"crosscheck": beside}
    said = answer(case_of(), rows, run)
    assert said.trust == f"Trust: {text}; no doubt beyond the expected error is known."
    assert said.comparisons == (text, "another")
    # loads that act in the run alone: the difference says nothing
    alone = {"section": {"text": text, "band_percent": None}}
    assert text not in answer(case_of(), rows, CONVERGED | {"crosscheck": alone}).trust
    warned = answer(case_of(), rows, run | {"warnings": ["one", "two"]})
    assert warned.trust.endswith("read the 2 warnings below.")
    assert lines(warned)[-3:] == ["2 warnings:", "  one", "  two"]
    # a difference that is a warning is said once
    twice = answer(case_of(), rows, run | {"warnings": [text]})
    assert twice.trust == "Trust: read the warning below."
    assert "another" not in lines(warned)
    assert "another" in lines(warned, verbose=True)


def test_limit_points_and_lost_stability() -> None:
    limit = {
        "kind": "limit",
        "load": "pressure",
        "pressure_kPa": 45.21,
        "angle_deg": 88.1,
        "unstable_modes_before": 0,
        "unstable_modes_beyond": 1,
    }
    buckles = limit | {"kind": "bifurcation", "pressure_kPa": -12.0}
    gravity = {
        "kind": "bifurcation",
        "load": "gravity",
        "value": 0.31,
        "unstable_modes_before": 0,
        "unstable_modes_beyond": 2,
    }
    regained = buckles | {"unstable_modes_before": 1, "unstable_modes_beyond": 0}
    run = CONVERGED | {"critical_points": [limit, buckles, regained]}
    said = answer(case_of(), [row(0, 0, 0), row(1, 45.0, 88.0)], run)
    assert found(said, "limit point").value == "45.21 kPa, 88.1°"
    assert found(said, "limit point").note == "beyond it the pressure falls"
    assert found(said, "stability lost").value == "-12 kPa, 88.1°"
    said = answer(
        case_of(), [row(0, 0, 0), row(1, 45.0, 88.0)], CONVERGED | {"critical_points": [gravity]}
    )
    assert found(said, "stability lost").value == "gravity 0.31"


def test_lines_fit_and_keep_numbers_with_their_units() -> None:
    strain = {"nominal": 0.5754, "logarithmic": 0.45449, "place": "wall, " + "x" * 60}
    run = CONVERGED | {"greatest_strain": {**strain, "x_mm": 8.0, "y_mm": 2.0}}
    said = answer(case_of(), [row(0, 0, 0), row(1, 45.0, 88.0)], run)
    text = lines(said)
    assert max(map(len, text)) <= WIDTH
    assert not any(line.rstrip().endswith((" =", " x", "= 8")) for line in text)
    assert "\u00a0" not in "".join(text)
    assert found(said, "greatest strain").value == "58 %, logarithmic 0.454"
    assert found(said, "greatest strain").note.endswith("at rest x = 8 mm, y = 2 mm")


# --- the greatest strain ----------------------------------------------------------------------


def test_strain_of_a_bar_that_is_pulled_is_exact() -> None:
    """A slice stretched by λ along its axis, √λ less across: λ1 − 1 everywhere."""
    case = case_of("cell")
    from fiberbend.models.choice import meshed

    mesh: MeshData = meshed(case).mesh(case)
    from fiberbend.case import convert

    materials = convert.site(case).materials
    space = ModelMesh(mesh, {n: materials[n] for n in mesh.regions}, None, False, "", uniform=False)
    stretch = 1.3
    across = stretch**-0.5 - 1
    moved = mesh.nodes * [across, across, stretch - 1]
    shot = Snapshot("last", 3, 20.0, 0.0, moved, np.zeros(mesh.cells.shape), None)
    strain = greatest_strain(case, space, shot)
    assert strain["nominal"] == pytest.approx(0.3, rel=1e-9)
    assert strain["logarithmic"] == pytest.approx(math.log(1.3), rel=1e-9)
    assert (strain["step"], strain["pressure_kPa"]) == (3, 20.0)
    # more where one node's region is pulled further: found, and named
    crown = int(np.argmax(mesh.nodes[:, 1]))
    moved[crown, 1] += 0.5
    strain = greatest_strain(case, space, shot)
    assert strain["nominal"] > 0.31
    assert strain["region"] == "sheath"
    assert strain["place"].startswith("sheath, crown")


WINDING = {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}}


def test_the_upper_corner_of_a_box_is_named(tmp_path: Path) -> None:
    quiet = {"pictures": False, "fields": False, "report": True, "at_angles": ["40 deg"]}
    effects = [{"pressure": {"angle": "40 deg"}}, WINDING]
    case = case_of("rectangle", effects=effects, output=quiet)
    strain = run_case(case, tmp_path / "run").run["greatest_strain"]
    assert (strain["x_mm"], strain["y_mm"]) == pytest.approx((8.0, 10.0))
    assert strain["place"] == "wall, upper corner of the chamber"


# --- of runs ----------------------------------------------------------------------------------


def ran(
    case: Case,
    folder: Path | None,
    quiet: bool = False,
    verbose: bool = False,
    answers: bool = False,
) -> tuple[RunResult, list[str]]:
    """What a run hands back, and what it has printed."""
    stream = io.StringIO()
    progress = Progress(quiet, stream, verbose=verbose, answers=answers)
    result = run_case(case, folder, progress=progress)
    return result, stream.getvalue().splitlines()


def test_a_section_answers_from_its_folder_as_on_the_screen(tmp_path: Path) -> None:
    case = case_of(output={"pictures": False, "fields": False})
    result, printed = ran(case, tmp_path / "run")
    rows = read_history(tmp_path / "run" / "history.csv")
    run_json = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    again = read_case(tmp_path / "run" / "case.resolved.yaml")
    said = answer(again, rows, run_json)
    assert said == answer(case, result.rows, result.run)
    assert printed[-len(lines(said)) :] == lines(said)
    assert not any(line.endswith("…") or "unknowns" in line for line in printed)
    # docs/evidence/uniform.md: an independent section model, 45.1 to 181.5 kPa
    for angle, kpa in ((90, 45.1), (180, 89.2), (270, 134.3), (360, 181.5)):
        value = found(said, f"pressure at {angle}°").value
        assert float(value.removesuffix(" kPa")) == pytest.approx(kpa, abs=0.1)
    # a full circle ends where it began, but for the cap
    assert found(said, "tip at the end").value == "y = 5.08 mm, z = 15 mm"
    # its crown, λ of history.csv, is stretched less than the greatest strain
    crown = rows[-1]["crown_stretch"]
    assert crown is not None
    assert run_json["greatest_strain"]["nominal"] >= crown - 1 - 1e-6
    # where the numbers come from
    assert run_json["command"]
    assert run_json["machine"]["cores"] >= run_json["machine"]["usable_cores"] >= 1
    assert run_json["blas"]["library"]
    log = (tmp_path / "run" / "run.log").read_text(encoding="utf-8").splitlines()
    for line in (*printed, "mesh …", "882 unknowns: 36 steps"):
        assert any(line in entry for entry in log), line
    assert log[-3].endswith("  converged")
    assert log[-2].endswith(f"  results in {tmp_path / 'run'}")
    assert log[-1].endswith(f"  report in {tmp_path / 'run' / 'report.html'}")


def test_a_verbose_run_says_phases_counts_and_comparisons(tmp_path: Path) -> None:
    case = case_of("cell", output={"pictures": False, "fields": False})
    _, printed = ran(case, tmp_path / "run", verbose=True)
    assert printed[:3] == ["mesh …", "compile …", "solve …"]
    assert any(re.match(r"\d+ unknowns: ", line) for line in printed)
    wanted = "section model: pressure 4.0 % lower at 360.0°, as expected for a pitch of 3 mm"
    assert wanted in printed
    assert not any("BEYOND" in line for line in printed)
    trust = next(line for line in printed if line.startswith("Trust: "))
    assert trust.startswith(f"Trust: {wanted}")


def test_a_quiet_run_gives_its_answer_where_that_is_wanted() -> None:
    case = case_of("straight", output={"pictures": False, "fields": False})
    assert ran(case, None, quiet=True)[1] == []
    result, printed = ran(case, None, quiet=True, answers=True)
    assert printed == lines(answer(case, result.rows, result.run))
    force = result.rows[-1]["tip_force_N"]
    assert f"a tip force of {quantity(force, 'N')}" in printed[1]
    # a pressure presses the tip away from its crown: positive, and M = F L_f
    moment = float(re.findall(r"([\d.]+) N mm", "\n".join(printed))[0])
    assert force * 15 == pytest.approx(moment, rel=1e-3)
    # no states are kept without a folder: no strain
    assert not any("strain" in line for line in printed)


def test_a_closed_form_answers_too(tmp_path: Path) -> None:
    data = {"output": {"at_angles": ["90 deg"], "at_pressures": ["50 kPa"], "pictures": False}}
    case = case_of("free_bending", model="analytic", **data)
    result, printed = ran(case, tmp_path / "run")
    said = answer(case, result.rows, result.run)
    closed = next(r for r in result.rows if abs(r["angle_deg"] - 90) < 1e-9)
    assert found(said, "pressure at 90°").value == quantity(closed["pressure_kPa"], "kPa")
    assert printed[-len(lines(said)) :] == lines(said)
    assert (tmp_path / "run" / "run.log").exists()


def test_a_resumed_run_goes_on_with_its_log(tmp_path: Path) -> None:
    spread = small()["effects"][1]["winding"] | {"as": "smeared"}
    effects = [{"pressure": {"to": "10 kPa"}}, {"winding": spread}]
    case = parse_case(small(effects=effects, output={"pictures": False, "fields": False}))
    folder = tmp_path / "run"
    run(case, folder)
    first = (folder / "run.log").read_text(encoding="utf-8")
    run_case(case, folder, resume=True)
    both = (folder / "run.log").read_text(encoding="utf-8")
    assert both.startswith(first)
    assert "resumed after step" in both[len(first) :]
    run_case(case, folder, overwrite=True)
    assert "resumed after" not in (folder / "run.log").read_text(encoding="utf-8")

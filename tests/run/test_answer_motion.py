"""What is asked for: answered by what the actuator does, and by what holds it."""

from __future__ import annotations

import re
from typing import Any

import pytest

from fiberbend.answer.answer import Entry, answer, lines
from fiberbend.answer.numbers import quantity
from fiberbend.running.runner import run_case
from tests.run.answers import CONVERGED, case_of, found, labels, row

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

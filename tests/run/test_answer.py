"""The answer of a run: what the rows say, nothing that they do not, in words a person reads.

Most tests have rows made by hand, of which every number is known. The runs at the end show that the
answers are the rows' and the exact values.
"""

from __future__ import annotations

from typing import Any

import pytest

from fiberbend.answer.answer import WIDTH, Entry, answer, lines
from fiberbend.answer.numbers import number, quantity
from fiberbend.answer.touch import touches
from tests.run.answers import CONVERGED, case_of, found, labels, row


def test_measured_points_are_part_of_the_answer() -> None:
    """Who names a file of points wants to read of them, without --verbose."""
    text = "run: pressure 3.3 % lower than measured (trial.csv) at 38.0°, as expected"
    other = "analytic (own rubber): pressure 43.6 % higher at 10.0°"
    check = {"measured": {"text": text}, "lines": [other, text]}
    run = {**CONVERGED, "crosscheck": check}
    said = answer(case_of(), [row(0, 0, 0), row(1, 50, 90), row(2, 200, 360)], run)
    assert found(said, "measured points").value == text
    assert said.comparisons == (other,)


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

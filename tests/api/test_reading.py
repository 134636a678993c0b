"""Values at a pressure, an angle or a step: exact where solved, else between two steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fiberbend.api.reading import asked, read_at
from fiberbend.schema.problems import CaseError


def rows(pressures: list[float], **more: list[Any]) -> list[dict[str, Any]]:
    """Rows of a made-up history; the angle is twice the pressure unless given."""
    columns = {"angle_deg": [2 * p for p in pressures], **more}
    return [
        {"step": step, "pressure_kPa": p, **{name: v[step] for name, v in columns.items()}}
        for step, p in enumerate(pressures)
    ]


def refusal(history: list[dict[str, Any]], key: str, goal: float) -> str:
    with pytest.raises(CaseError) as error:
        read_at(history, key, goal)
    return str(error.value)


def test_a_step_is_taken_as_it_is() -> None:
    history = rows([0.0, 10.0, 25.0], newton_iterations=[0, 4, 3], tip_force_N=[None, 1.0, 2.0])
    for key, goal in (("step", 1), ("pressure", 10.0), ("pressure", 10 + 1e-9), ("angle", 20.0)):
        found = read_at(history, key, goal)
        assert found.exact
        assert found.steps == (1,)
        assert dict(found) == history[1]
    rest = read_at(history, "step", 0)
    with pytest.raises(KeyError, match="'tip_force_N' is not known at step 0"):
        rest["tip_force_N"]


def test_between_steps_a_line_is_a_line() -> None:
    history = rows([0.0, 10.0, 25.0, 40.0], tip_y_mm=[1.0, -1.0, -4.0, -7.0])
    found = read_at(history, "pressure", 12.0)
    assert not found.exact
    assert found.steps == (1, 2)
    assert found["pressure_kPa"] == 12.0
    assert found["angle_deg"] == pytest.approx(24.0, rel=1e-12)
    assert found["tip_y_mm"] == pytest.approx(-1.4, rel=1e-12)
    assert "step" not in found
    with pytest.raises(KeyError, match="'step' is not interpolated between steps 1 and 2"):
        found["step"]


def test_a_smooth_curve_is_met_closer_than_by_lines_and_never_left() -> None:
    pressure = np.linspace(0, 100, 11)
    history = rows(list(pressure), angle_deg=list(np.tanh(pressure / 40)))
    for goal in (3.0, 47.0, 88.8):
        found = read_at(history, "pressure", goal)["angle_deg"]
        exact = np.tanh(goal / 40)
        line = np.interp(goal, pressure, np.tanh(pressure / 40))
        assert abs(found - exact) < 0.5 * abs(line - exact)
    kinked = rows([0.0, 10.0, 20.0, 30.0], tip_force_N=[0.0, 0.0, 5.0, 5.0])
    for goal in np.linspace(0.1, 29.9, 50):
        assert 0 <= read_at(kinked, "pressure", goal)["tip_force_N"] <= 5


def test_vacuum() -> None:
    history = rows([0.0, -10.0, -25.0])
    assert read_at(history, "pressure", -20.0)["angle_deg"] == pytest.approx(-40.0)


def test_what_is_not_known_on_both_sides_is_left_out() -> None:
    history = rows(
        [0.0, 10.0, 20.0, 30.0],
        tip_force_N=[None, None, 2.0, 3.0],
        analytic_kPa=[0.0, 9.0, float("nan"), None],
        unstable_modes=[None, 0, 0, 1],
    )
    found = read_at(history, "pressure", 15.0)
    assert not {"tip_force_N", "analytic_kPa", "unstable_modes"} & {*found}
    # two points that are known: a line
    assert read_at(history, "pressure", 24.0)["tip_force_N"] == pytest.approx(2.4)
    assert read_at(history, "pressure", 4.0)["analytic_kPa"] == pytest.approx(3.6)


def test_outside_the_run() -> None:
    history = rows([0.0, 10.0, 25.0])
    text = refusal(history, "pressure", 30.0)
    assert text == (
        "pressure: 30 kPa, which the run does not reach, expected a value from 0 to 25 kPa"
    )
    assert "expected a value from 0 to 50 deg" in refusal(history, "angle", -1.0)
    assert refusal(history, "step", 3) == "step: 3, expected from 0 to 2"
    assert "a run with steps" in refusal([], "pressure", 3.0)


def test_where_the_pressure_falls_the_branch_is_not_guessed() -> None:
    """Beyond a limit point the pressure falls: a value has several states."""
    history = rows([0.0, 10.0, 20.0, 15.0, 8.0], angle_deg=[0.0, 5.0, 20.0, 60.0, 120.0])
    text = refusal(history, "pressure", 12.0)
    assert text == (
        "pressure: 12 kPa is passed between steps 1 and 2, between steps 3 and 4: expected a step"
    )
    assert "at step 1, between steps 3 and 4" in refusal(history, "pressure", 10.0)
    # the angle grows all along, and each branch is interpolated by itself
    found = read_at(history, "angle", 40.0)
    assert found.steps == (2, 3)
    assert 15 < found["pressure_kPa"] <= 20
    assert read_at(history, "pressure", 20.0).steps == (2,)


def test_a_load_before_the_pressure_leaves_it_at_zero() -> None:
    history = rows([0.0, 0.0, 10.0], angle_deg=[0.0, -3.0, 5.0])
    assert "is passed at step 0, at step 1: expected" in refusal(history, "pressure", 0.0)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "at: nothing given, expected one of pressure, angle, step"),
        ({"pressure": "1 kPa", "step": 3}, "at: pressure and step given, expected one of"),
        ({"pressure": 100}, "pressure: 100, expected a pressure with its unit"),
        ({"pressure": "100"}, "expected a pressure with its unit"),
        ({"pressure": "90 deg"}, "expected a pressure with its unit"),
        ({"angle": "90"}, "expected an angle with its unit"),
        ({"step": 1.5}, "step: 1.5, expected a whole number"),
        ({"step": True}, "expected a whole number"),
    ],
)
def test_what_is_asked(given: dict[str, Any], message: str) -> None:
    every = {"pressure": None, "angle": None, "step": None}
    with pytest.raises(CaseError) as error:
        asked("at", **(every | given))
    assert message in str(error.value)


def test_units_of_what_is_asked() -> None:
    assert asked("at", pressure="0.1 MPa") == ("pressure", pytest.approx(100.0))
    assert asked("at", pressure=None, angle="3.141592653589793 rad")[1] == pytest.approx(180.0)
    assert asked("at", step=np.int64(3)) == ("step", 3)

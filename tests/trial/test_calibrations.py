"""Trials of calibrated windings: with numbers of their own, or with those of a like case."""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.calibration import calibrate as calibrating
from fiberbend.calibration import cases
from fiberbend.calibration.store import FOLDER, Store
from fiberbend.case.case import Case
from fiberbend.trial import calibrations
from fiberbend.trial.calibrations import Calibrations
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.loads import bent
from fiberbend.trial.solve import Trials
from fiberbend.trial.wanted import Wanted
from tests.trial.cases import checked, radians, run, shipped, under, wound

WINDING = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "calibrated"}
DATA = under(wound(shipped("section"), **WINDING), angle="100 deg")


@pytest.fixture(autouse=True)
def store(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Store:
    """A cell of two layers with two states bent and one straight, and a cache of its own."""
    monkeypatch.setattr(cases, "LAYERS", 2)
    monkeypatch.setattr(cases, "PARTS", (0.25, 0.5))
    monkeypatch.setattr(cases, "PRESSED", (0.5,))
    folder = tmp_path / FOLDER
    monkeypatch.setattr(calibrating, "Store", lambda: Store(folder))
    return Store(folder)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[Case]:
    """Cases that were calibrated."""
    found: list[Case] = []

    def calibrate(case: Case) -> calibrating.Calibrated:
        found.append(case)
        return calibrating.calibrate(case)

    monkeypatch.setattr(calibrations, "calibrate", calibrate)
    return found


def times(case: Case, path: str, factor: float) -> Case:
    return with_number(case, path, factor * number(case, path))


def test_it_gives_what_a_run_gives(made: list[Case]) -> None:
    """The run makes the calibration, the trial takes it from the store."""
    rows = run(DATA, at_angles=["50 deg", "100 deg"]).rows
    answer = Trials().solve(checked(DATA), Wanted(radians(100)))
    assert answer.converged
    assert 1e3 * answer.free[0].pressure == pytest.approx(rows[-1]["pressure_kPa"], rel=1e-9)
    smeared = checked(under(shipped("section"), angle="100 deg"))
    other = Trials().solve(smeared, Wanted(radians(100))).free[0]
    assert answer.free[0].pressure > 1.01 * other.pressure


def test_it_is_calibrated_as_far_as_it_is_asked_for() -> None:
    """The case asks for 100°; further on another class of curvature holds."""
    far = Trials().solve(checked(DATA), Wanted(radians(410)))
    rows = run(under(DATA, angle="410 deg")).rows
    assert 1e3 * far.free[0].pressure == pytest.approx(rows[-1]["pressure_kPa"], rel=1e-9)


@pytest.mark.long
def test_numbers_of_a_like_case_are_taken_over(made: list[Case]) -> None:
    """Within the error that is allowed, which is told; what is found is off by less."""
    case, wanted = checked(DATA), Wanted(radians(100), (), (0.05,))
    trials = Trials(calibration_error=1.5)
    first = trials.solve(case, wanted)
    assert first.calibration_error == 0
    assert len(made) == 2, "bent, and kept straight"
    thicker = times(case, "actuator.wall", 1.1)
    near = trials.solve(thicker, wanted)
    assert len(made) == 2
    assert 0.5 < near.calibration_error < 1.5
    own = Trials().solve(thicker, wanted)
    for one, other in zip(near.free + near.straight, own.free + own.straight, strict=True):
        assert one.pressure == pytest.approx(other.pressure, rel=near.calibration_error / 100)
        assert one.moment == pytest.approx(other.moment, rel=near.calibration_error / 100)
    assert near.free[0].pressure != own.free[0].pressure
    beyond = times(case, "actuator.wall", 1.5)
    assert trials.solve(beyond, wanted).calibration_error == 0


@pytest.mark.long
def test_unlike_cases_have_their_own(made: list[Case]) -> None:
    taken = Calibrations(percent=2.0)
    case = bent(checked(DATA), radians(50))
    assert taken.ready(case).error == 0
    errors = [
        taken.ready(times(case, "effects.1.winding.pitch", factor)).error
        for factor in (1.05, 1.1025)
    ]
    assert 0 < 2 * errors[0] == pytest.approx(errors[1], rel=1e-6)
    helix = wound(DATA, **{**WINDING, "pattern": "double-helix", "tension_only": True})
    assert taken.ready(bent(checked(helix), radians(50))).error == 0
    gent = {"wall": {"law": "gent", "mu": "0.22 MPa", "jm": 30.0}}
    other = checked(DATA | {"materials": DATA["materials"] | gent})
    assert taken.ready(bent(other, radians(50))).error == 0
    assert len(made) == 3
    assert taken.ready(case).error == 0
    assert len(made) == 3, "its own, again"


def test_names_stand_for_their_numbers(made: list[Case]) -> None:
    """A wall by its law is the named one; length and caps enter nothing."""
    taken = Calibrations(percent=1.0)
    base = bent(checked(DATA), radians(50))
    taken.ready(base)
    wall = {"wall": {"law": "yeoh", "c1": "0.112 MPa", "c2": "0.02 MPa"}}
    longer = DATA["actuator"] | {"length": "200 mm", "cap": "10 mm"}
    other = checked(DATA | {"materials": DATA["materials"] | wall, "actuator": longer})
    pitch = taken.ready(times(base, "effects.1.winding.pitch", 1.05)).error
    assert 0 < taken.ready(bent(other, radians(50))).error < 0.5 * pitch


def test_what_needs_no_calibration_is_left_alone() -> None:
    case = checked(under(shipped("section"), angle="100 deg"))
    ready = Calibrations(1.0).ready(case)
    assert ready.case is case
    assert not ready.error


@pytest.mark.long
def test_derivatives_have_the_change_of_the_calibration_in_them(made: list[Case]) -> None:
    """The pitch acts by the calibration alone, all but; the length not at all."""
    case, wanted, path = checked(DATA), Wanted(radians(90), (), (0.03,)), "effects.1.winding.pitch"
    trials = Trials()
    found = trials.sensitivities(case, wanted, [path, "actuator.length"])
    assert {number(one, "actuator.length") for one in made} == {160.0}
    more, less = (trials.solve(times(case, path, factor), wanted) for factor in (1.05, 0.95))
    held = wound(DATA, **WINDING, bulging={"stiffness": "0.6 MPa/mm"})
    frozen = trials.sensitivities(checked(held), wanted, [path]).by_field[path]
    for name, kind in (("pressure", "free"), ("moment", "straight")):
        up, down, slope, alone = (
            getattr(getattr(one, kind)[0], name)
            for one in (more, less, found.by_field[path], frozen)
        )
        whole = (up - down) / (0.1 * 3.0)
        assert slope == pytest.approx(whole, rel=2e-2), name
        assert abs(alone - whole) > 0.3 * abs(whole)

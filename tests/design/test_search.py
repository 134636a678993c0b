"""The search for a case: against scans, at bounds, among choices, out of reach, in trade-offs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from fiberbend.design.search.confirm import Confirmed
from fiberbend.design.search.front import Front, trade_off
from fiberbend.design.search.search import Search
from fiberbend.design.solving.models import Section
from fiberbend.design.solving.tries import Tries
from fiberbend.design.told.limits import limits
from fiberbend.design.told.outcome import FAILED, INTERRUPTED, MET, UNMET, Times, best, outcome
from tests.design.made_up import MadeUp, design, none, search

_HANDS = ("right", "left")
RADIUS = {"actuator.radius": {"from": "4 mm", "to": "12 mm"}}
WALL = {"actuator.wall": {"from": "1 mm", "to": "3 mm"}}
ANGLE = {"angle": {"at": "60 kPa", "is": "90 deg"}}


def test_one_number_is_what_a_scan_finds(tmp_path: Path) -> None:
    made = design(tmp_path, vary=RADIUS, targets=[ANGLE])
    tried = search(made)
    found = tried.whole(none(made), None)
    assert found is not None
    assert found.met
    scan = np.linspace(0, 1, 2001)
    radii = 4 + 8 * scan
    best = radii[np.argmin(np.abs(0.06 * radii**2 / 2 - math.pi / 2))]
    assert tried.tries.inner(found.x)[0] == pytest.approx(best, abs=0.004)


def test_the_least_of_a_goal_lies_at_an_end_that_is_told(tmp_path: Path) -> None:
    goals: list[dict[str, Any]] = [{"minimise": {"rubber": {}}}]
    made = design(tmp_path, vary=RADIUS | WALL, targets=[ANGLE], goals=goals)
    tried = search(made)
    found = tried.whole(none(made), 0)
    assert found is not None
    assert found.met
    radius, wall = tried.tries.inner(found.x)
    # of all radii and walls with the angle, the thinnest have the least rubber
    assert wall == pytest.approx(1.0)
    assert radius == pytest.approx(math.sqrt(math.pi / 2 / 0.06), rel=1e-3)
    first, *others = limits(made, found)
    assert first.name == "actuator.wall"
    assert "wall is at its lower limit 1 mm; 0.1 mm less would save" in first.text
    # the wall and with it the radius that has the angle, solved anew
    rubber = found.quantities()[1]
    thinner = design(
        tmp_path,
        vary=RADIUS | {"actuator.wall": {"from": "0.9 mm", "to": "3 mm"}},
        targets=[ANGLE],
        goals=goals,
    )
    less = search(thinner).whole(none(thinner), 0)
    assert less is not None
    told = float(first.text.split("would save ")[1].split()[0])
    assert told == pytest.approx((rubber - less.quantities()[1]) / 1e3, rel=0.1)
    assert any("is held at 90°" in other.text for other in others)


def test_a_bound_on_a_size_is_kept(tmp_path: Path) -> None:
    targets = [{"width": {"most": "20 mm"}}]
    goals = [{"maximise": {"angle": {"at": "60 kPa"}}}]
    made = design(tmp_path, vary=RADIUS | WALL, targets=targets, goals=goals)
    found = search(made).whole(none(made), 0)
    assert found is not None
    assert found.met
    assert found.quantities()[0] == pytest.approx(20.0, abs=0.02)


def test_the_better_of_two_rubbers_is_chosen(tmp_path: Path) -> None:
    rubbers = {"materials.wall": ["elastosil-m4601", "dragon-skin-30"]}
    goals = [{"maximise": {"angle": {"at": "60 kPa"}}}]
    made = design(tmp_path, vary=WALL | rubbers, goals=goals)
    found = search(made).whole(none(made), 0)
    assert found is not None
    assert found.chosen == (("materials.wall", "dragon-skin-30"),)


def test_choices_alone_are_enumerated(tmp_path: Path) -> None:
    made = design(tmp_path, vary={"actuator.wall": ["1 mm", "2 mm", "2.5 mm"]}, targets=[ANGLE])
    tried = search(made)
    found = tried.whole(none(made), None)
    assert found is not None
    assert found.chosen == (("actuator.wall", "1 mm"),) if found.met else not found.met
    assert len(tried.tries.all) == 3


def test_an_angle_out_of_reach_is_not_met_and_the_limit_is_named(tmp_path: Path) -> None:
    far = {"angle": {"at": "60 kPa", "is": "900 deg"}}
    made = design(tmp_path, vary=RADIUS | WALL, targets=[far, {"width": {"most": "26 mm"}}])
    tried = search(made)
    found = tried.whole(none(made), None)
    assert found is not None
    assert not found.met
    told = outcome(made, tried.tries, Confirmed(found, tuple(none(made))), [], None, Times())
    assert told.status == UNMET
    assert "wall is at its lower limit 1 mm" in told.reason
    assert "nearer" in told.reason
    assert "angle at 60 kPa" in told.reason
    # the envelope is kept, and no part of what is missed
    assert found.quantities()[1] <= 26.03
    assert "outer width is at its limit, at most 26 mm" in told.reason


def test_two_values_are_met_as_nearly_as_they_are_asked_for(tmp_path: Path) -> None:
    # one wall cannot have both exactly: 81.4° at 50 kPa goes with 97.7° at 60 kPa
    near = {"angle": {"at": "50 kPa", "is": "81.4 deg", "within": "5 deg"}}
    far = {"angle": {"at": "60 kPa", "is": "90 deg", "within": "5 deg"}}
    made = design(tmp_path, vary=WALL, targets=[near, far])
    tried = search(made)
    found = tried.whole(none(made), None)
    assert found is not None
    told = outcome(made, tried.tries, Confirmed(found, tuple(none(made))), [], None, Times())
    assert told.status == MET
    first, second = np.degrees(found.quantities())
    assert abs(first - 81.4) <= 5
    assert abs(second - 90) <= 5


def test_a_target_that_is_all_but_met_leaves_room_for_the_goal(tmp_path: Path) -> None:
    # 89.1° at most, which is within 2 % of 90°
    vary = {"actuator.wall": {"from": "2.469 mm", "to": "3 mm"}}
    made = design(tmp_path, vary=vary, targets=[ANGLE], goals=[{"minimise": {"rubber": {}}}])
    tried = search(made)
    found = tried.whole(none(made), 0)
    assert found is not None
    assert found.wishes.loose
    told = outcome(made, tried.tries, Confirmed(found, tuple(none(made))), [], None, Times())
    assert told.status == MET
    assert best(told) == "possible"
    assert tried.tries.inner(found.x)[0] == pytest.approx(2.469, abs=1e-3)


def test_cases_without_states_are_no_answer(tmp_path: Path) -> None:
    goals = [{"maximise": {"angle": {"at": "60 kPa"}}}]
    made = design(tmp_path, vary=RADIUS | WALL, goals=goals)
    tried = search(made, MadeUp(ends=1.5))
    found = tried.whole(none(made), 0)
    assert found is not None
    assert 1.45 < found.quantities()[0] <= 1.5
    assert any(each.reason == "it ends before" for each in tried.tries.all)
    nowhere = search(made, MadeUp(ends=0.0))
    assert nowhere.whole(none(made), 0) is None
    told = outcome(made, nowhere.tries, None, [], None, Times())
    assert told.status == FAILED
    assert "it ends before" in told.reason


def test_one_that_is_stopped_before_its_first_case_says_so(tmp_path: Path) -> None:
    made = design(tmp_path, vary=WALL, targets=[ANGLE])
    told = outcome(made, search(made).tries, None, [], None, Times(), interrupted=True)
    assert told.status == INTERRUPTED
    assert "before the first search" in told.reason


def test_dimensions_that_do_not_fit_are_no_answer(tmp_path: Path) -> None:
    goals: list[dict[str, Any]] = [{"minimise": {"rubber": {}}}]
    pitch = {"effects.1.winding.pitch": {"from": "0.01 mm", "to": "4 mm"}}
    made = design(tmp_path, vary=pitch | WALL, targets=[], goals=goals)
    tried = search(made)
    found = tried.whole(none(made), 0)
    assert found is not None
    assert all(each.quantities is not None or each.reason for each in tried.tries.all)


def test_numbers_of_a_case_are_round_in_their_unit_and_between_the_ends(tmp_path: Path) -> None:
    place = "effects.1.winding.families"
    angles = {f"{place}.0.angle_from_axis": {"from": "60.5 deg", "to": "89 deg"}}
    family = [{"angle_from_axis": "80 deg", "hand": hand, "starts": 8} for hand in _HANDS]
    winding = {"winding": {"families": family, "fiber": "kevlar", "as": "smeared"}}
    made = design(
        tmp_path,
        set={"effects.1": winding, "output": {}, "compare": []},
        vary=angles,
        targets=[ANGLE],
    )
    tries = search(made).tries
    assert tries.pairs((), (1.0,))[0][1] == "89 deg"
    assert tries.pairs((), (0.0,))[0][1] == "60.5 deg"
    assert tries.pairs((), (0.5,))[0][1] == "74.75 deg"


def test_the_same_seed_tries_the_same_cases(tmp_path: Path) -> None:
    def tries(seed: int) -> list[tuple[float, ...]]:
        made = design(tmp_path, vary=RADIUS | WALL, targets=[ANGLE], search={"seed": seed})
        tried = search(made)
        tried.whole(none(made), None)
        return [each.x for each in tried.tries.all]

    assert tries(0) == tries(0)
    assert tries(0) != tries(1)


def test_a_trade_off_is_sorted_and_no_case_beats_another(tmp_path: Path) -> None:
    goals = [{"maximise": {"straight-moment": {"at": "60 kPa"}}}, {"minimise": {"rubber": {}}}]
    made = design(tmp_path, vary=RADIUS | WALL, goals=goals, search={"front": 6})
    front = trade_off(search(made), none(made), lambda _line: None)
    assert isinstance(front, Front)
    values = np.array([found.quantities() for found in front.found])
    assert len(values) >= 5
    assert np.all(np.diff(values[:, 0]) < 0)
    assert np.all(np.diff(values[:, 1]) < 0)
    assert 0 <= front.knee < len(values)


def test_the_section_has_the_wall_that_bisection_finds(tmp_path: Path) -> None:
    made = design(tmp_path, vary=WALL, targets=[ANGLE])
    tries = Tries(made, Section(1))
    found = Search(made, tries).whole(none(made), None)
    assert found is not None

    def off(x: float) -> float:
        values = tries.at((), (x,)).quantities
        assert values is not None
        return values[0] - math.pi / 2

    assert found.met
    assert found.x[0] == pytest.approx(brentq(off, 0, 1, xtol=1e-6), abs=1e-3)

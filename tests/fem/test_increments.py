"""How long increments are: what easy, slow and failed ones change."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from fem.march.hooks import AfterStep
from fem.march.march import Ramp, Rules
from fem.march.records import Critical, State
from fem.solver.newton import Newton, Outcome, SideCondition
from tests.fem.parts import Floats, bender
from tests.fem.test_limit import sphere

FIRST = 1e-3
"""MPa; far below any other limit of an increment."""
FAILS = -1


class _Told:
    """A Newton that says how many iterations it took, or that it failed."""

    def __init__(self, newton: Newton, told: Sequence[int]) -> None:
        self._newton = newton
        self._told = list(told)
        self.tried: list[float] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._newton, name)

    def solve(
        self, w: Floats, unknown: Sequence[str] = (), conditions: Sequence[SideCondition] = ()
    ) -> Outcome:
        """Solve, and say what the test wants."""
        self.tried.append(self._newton.problem.scalar("pressure"))
        outcome = self._newton.solve(w, unknown, conditions)
        said = self._told.pop(0) if self._told else 6
        if said == FAILS:
            return dataclasses.replace(outcome, converged=False, reason="so says the test")
        return dataclasses.replace(outcome, iterations=said)


def _march(ramp: Ramp, told: Sequence[int], rules: Rules | None = None) -> tuple[Any, Any]:
    """The pressures of the states and those that were tried."""
    newton: list[_Told] = []

    def wrap(real: Newton) -> Any:
        newton.append(_Told(real, told))
        return newton[0]

    body = bender(rules, wrap=wrap)
    report = body.run([ramp])
    assert report.status == "converged", report.reason
    return np.array([state.scalars["pressure"] for state in body.states]), newton[0].tried


def test_easy_ones_grow_and_slow_ones_shrink() -> None:
    rules = Rules()
    pressures, _ = _march(
        Ramp("pressure", 6 * FIRST, first=FIRST),
        [rules.easy + 1, rules.easy, rules.slow, rules.slow - 1, 6],
    )
    size = FIRST * np.array([1, 1, rules.grow, rules.grow * rules.shrink])
    assert np.diff(pressures)[:4] == pytest.approx(size, rel=1e-12)
    assert np.diff(pressures)[4] == pytest.approx(size[3], rel=1e-12)


def test_the_greatest_increment_is_not_outgrown() -> None:
    largest = 1.2 * FIRST
    pressures, _ = _march(Ramp("pressure", 6 * FIRST, first=FIRST, largest=largest), [1, 1, 1, 1])
    assert np.diff(pressures)[:3] == pytest.approx([FIRST, largest, largest], rel=1e-12)


def test_after_a_failure_a_part_of_what_was_tried() -> None:
    # the stop had clipped the second increment: cut from its full size, the next were the same
    rules = Rules()
    stop = 1.5 * FIRST
    ramp = Ramp("pressure", 1.6 * FIRST, first=FIRST, stops=(stop,))
    _, tried = _march(ramp, [6, FAILS, *[1] * 9])
    assert tried[:3] == pytest.approx([FIRST, stop, FIRST + rules.cut * (stop - FIRST)], rel=1e-12)


def test_failures_that_are_not_in_a_row_do_not_add_up() -> None:
    rules = Rules(cutbacks=1)
    pressures, _ = _march(Ramp("pressure", 2 * FIRST, first=FIRST), [FAILS, 1, FAILS, 1], rules)
    assert pressures[-1] == pytest.approx(2 * FIRST, rel=1e-12)


def test_slow_ones_that_shrink_to_nothing_end_with_that_reason() -> None:
    body = bender(
        Rules(slow=0, easy=-1, least=0.1),
        wrap=lambda newton: _Told(newton, []),  # type: ignore
    )
    report = body.run([Ramp("pressure", 100 * FIRST, first=FIRST)])
    # 1, 0.6, 0.36, 0.216, 0.13, and 0.078 is less than a tenth of the first
    assert (report.status, report.steps) == ("failed", 5)
    assert "increments shrink to nothing" in report.reason


def test_where_a_body_meets_itself_lies_between_two_states(monkeypatch: pytest.MonkeyPatch) -> None:
    # a quarter of the way through the second increment; the first one is clear
    shares = iter([None, 0.25])
    monkeypatch.setattr("fem.march.selfcontact.first_contact", lambda *_: next(shares))
    body = bender()
    monkeypatch.setattr(body.march, "_rod", object())
    report = body.run([Ramp("pressure", 3 * FIRST, first=FIRST, largest=FIRST)])
    old, new = (state.measures for state in body.states[1:3])
    assert report.self_contact is not None
    assert report.self_contact.keys() == old.keys()
    for name, value in report.self_contact.items():
        assert value == pytest.approx(0.75 * old[name] + 0.25 * new[name], rel=1e-12), name


@pytest.mark.long
def test_the_way_beyond_a_limit_point_ends_by_that_point_alone() -> None:
    # not by another load's limit, or by where the load rises again
    volume = 1e-3
    others = [
        Critical("limit", "gravity", 0.01, volume, None, 0, 1),
        Critical("limit", "pressure", 0.01, volume, None, 1, 0),
    ]
    found: list[Critical] = []

    def add(_state: State, _outcome: Outcome) -> None:
        critical = body.march.report.critical
        if critical and not found:
            found.extend(critical)
            critical.extend(others)

    body = sphere(hooks=[AfterStep(add)])
    report = body.march.run([Ramp("pressure", 0.03)])
    assert report.status == "stopped"
    end = body.states[-1].measures["conjugate pressure"]
    assert end == pytest.approx(Rules().beyond * found[0].conjugate, rel=1e-9)

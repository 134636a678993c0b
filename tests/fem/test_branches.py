"""Bifurcations are pinned down and left for the branch on which the body rests."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp
from fem.kinematics.domain import Domain
from fem.march.branches import Branches
from fem.march.frames import Frames
from fem.march.hooks import AfterStep, Hook, Marching
from fem.march.march import LOST, March
from fem.march.records import Ramp, Report, Rules, State
from fem.results.checkpoint import Archive
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from tests.exact.solids import box

COLUMN = (2.0, 1.0, 20.0)
"""Sides and height, mm."""
SHEAR = 0.22
GREENHILL = 7.8373 * 3 * SHEAR / 12 / COLUMN[2] ** 3
"""Weight per volume, N/mm³, at which a heavy column 1 mm thick buckles (Greenhill 1881)."""
TOP = 1.2
"""Weight at the end, in parts of Greenhill's."""


@dataclasses.dataclass
class Column:
    """A column that stands under a growing weight, in parts of Greenhill's."""

    march: March
    states: list[State]

    def lean(self, state: State) -> float:
        """Displacement of the top across the thin side, mm."""
        body = self.march.equilibrium.scene.body
        data = body.domain.data
        top = int(np.argmax(data.nodes @ (1e-3, 1e-3, 1.0)))
        return float(state.w[body.node_dofs[top, 1]])


def standing() -> Column:
    """The column without weight."""
    domain = Domain(box(COLUMN, (1, 1, 6)))
    scene = Scene(
        domain,
        [
            Elastic("neo-hooke", {"solid": {"mu": SHEAR}}),
            Incompressible(),
            Clamp("bottom"),
            Gravity({"solid": 1.0}, (0.0, 0.0, -GREENHILL)),
        ],
    )
    states: list[State] = []

    def keep(state: State, _outcome: Outcome) -> None:
        states.append(state)

    newton = Newton(scene, domain.comm, Settings())
    frames = Frames(scene.body)
    return Column(March(scene, newton, Rules(), frames=frames, hooks=[AfterStep(keep)]), states)


@functools.cache
def loaded(largest: float | None) -> tuple[Column, Report]:
    """The column under its weight, put on in steps."""
    column = standing()
    report = column.march.run([Ramp("gravity", TOP, first=largest, largest=largest)])
    return column, report


STEPS = (1.2, 0.31, 0.11)


@pytest.mark.parametrize("step", STEPS)
def test_a_heavy_column_buckles_at_greenhills_weight(step: float) -> None:
    # within 4 %: slenderness 20, and the clamp holds the sides too
    _, report = loaded(step)
    (point,) = report.critical
    assert (point.kind, point.before, point.after) == ("bifurcation", 0, 1)
    assert point.value == pytest.approx(1.0, abs=0.04)
    assert point.value == pytest.approx(loaded(STEPS[-1])[1].critical[0].value, rel=1e-3)


@pytest.mark.parametrize("step", STEPS)
def test_it_leans_over_and_rests_whatever_the_step(step: float) -> None:
    # a step over the bifurcation used to end upright, with one unstable mode
    column, report = loaded(step)
    end = column.states[-1]
    fine, _ = loaded(STEPS[-1])
    assert report.status == "converged"
    assert end.measures["modes"] == 0
    assert end.scalars["gravity"] == TOP
    assert abs(column.lean(end)) > COLUMN[2] / 4
    assert column.lean(end) == pytest.approx(fine.lean(fine.states[-1]), rel=1e-3)


def test_no_state_that_is_kept_is_unstable() -> None:
    for step in STEPS:
        assert all(state.measures["modes"] == 0 for state in loaded(step)[0].states)


def test_the_side_is_chosen_where_both_are_alike() -> None:
    assert [point.side for point in loaded(STEPS[0])[1].critical] == ["chosen"]


def test_a_branch_is_entered_at_what_is_asked_for() -> None:
    # the first state on the branch lies beyond it
    column = standing()
    critical = loaded(STEPS[0])[1].critical[0].value
    report = column.march.run([Ramp("gravity", critical * 1.001, first=1.0)])
    assert report.status == "converged"
    assert column.states[-1].scalars["gravity"] == pytest.approx(critical * 1.001, rel=1e-12)
    assert column.states[-1].measures["modes"] == 0
    assert abs(column.lean(column.states[-1])) > 0.1


def test_a_march_goes_on_from_a_branch_after_a_restart() -> None:
    whole, _ = loaded(STEPS[0])

    class KilledError(Exception):
        pass

    column = standing()

    def kill(state: State, _outcome: Outcome) -> None:
        if column.march.report.critical:
            raise KilledError

    ramp = Ramp("gravity", TOP, first=1.2, largest=1.2)
    with pytest.raises(KilledError):
        column.march.run([ramp], [AfterStep(kill)])
    again = standing()
    archive = Archive(again.march.equilibrium.scene, Frames(again.march.equilibrium.scene.body))
    again.march.resume(archive.unpack(archive.pack(column.march.position)))
    assert again.march.run([ramp]).status == "converged"
    end, other = again.states[-1], whole.states[-1]
    assert again.lean(end) == pytest.approx(whole.lean(other), rel=1e-6)


def test_a_branch_that_is_not_found_is_a_failure(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing(_self: Branches, *_: object) -> object:
        return [], Outcome(False, 0, 0, "", [], 1.0)

    monkeypatch.setattr(Branches, "leave", nothing)
    column = standing()
    report = column.march.run([Ramp("gravity", TOP, first=1.2)])
    assert (report.status, report.reason) == ("failed", LOST)
    assert column.states[-1].measures["modes"] == 0
    assert [point.side for point in report.critical] == [""]


class _Entering(Hook):
    """Keeps whether a march was still entering a branch at each state, and its way off the path."""

    def __init__(self, column: Column) -> None:
        self._column = column
        self.seen: list[tuple[bool, float]] = []

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        self.seen.append((march.position.entering, abs(self._column.lean(state))))


def test_states_near_a_crossing_are_none_to_go_on_from() -> None:
    # a march that is saved there goes on by its load, which tells no side, and may come back
    column = standing()
    hook = _Entering(column)
    column.march.run([Ramp("gravity", TOP, first=0.3)], [hook])
    entering = [lean for entering, lean in hook.seen if entering]
    after = [lean for entering, lean in hook.seen if not entering and lean > 1e-3]
    assert len(entering) >= 2
    assert max(entering) < min(after)
    assert not column.march.position.entering

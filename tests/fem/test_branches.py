"""Bifurcations are pinned down and left for the branch on which the body rests."""

from __future__ import annotations

import functools
import json

import numpy as np
import pytest
from mpi4py import MPI

from fem.march.branches import Branches
from fem.march.frames import Frames
from fem.march.hooks import AfterStep, Hook, Marching
from fem.march.march import LOST
from fem.march.records import Ramp, Report, State
from fem.results.checkpoint import Archive
from fem.solver.newton import Outcome
from tests.conftest import MpiRun
from tests.fem.column import COLUMN, Column, measure, standing

TOP = 1.2
"""Weight at the end, in parts of Greenhill's."""


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
    assert abs(column.lean(end)) > COLUMN[2] / 12
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
    assert abs(column.lean(column.states[-1])) > 0.04


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


@pytest.mark.long
@pytest.mark.mpi
def test_two_ranks_take_the_same_branch(mpirun: MpiRun) -> None:
    run = mpirun(2, ["-m", "tests.fem.column"])
    assert run.returncode == 0, run.stderr
    found = json.loads(run.stdout.splitlines()[-1])
    serial = measure(MPI.COMM_SELF)
    assert serial["modes"] == 0
    assert abs(serial["lean"]) > COLUMN[2] / 20
    for name, value in serial.items():
        assert found[name] == pytest.approx(value, rel=1e-6), name


def test_waves_as_short_as_elements_are_rough() -> None:
    # along the column of six elements: 1 − (sin(πh/l)/(πh/l))² of a wave of length l, a bit less
    # where it is taken at three nodes in place of all points
    equilibrium = standing().march.equilibrium
    body = equilibrium.scene.body
    z = body.domain.data.nodes[body.owned_nodes, 2] / COLUMN[2] * 6
    rough = []
    for elements in (2, 3, 6, 24):
        w = np.zeros(body.owned)
        w[body.node_dofs[body.owned_nodes, 1]] = np.cos(2 * np.pi * z / elements)
        rough.append(equilibrium.roughness(w))
    assert rough == sorted(rough, reverse=True)
    assert rough[0] > 0.6
    assert rough[2] < 0.2
    assert rough[3] < 0.02

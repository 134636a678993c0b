"""One zone of an actuator: its section or cell, marched to pressures that all zones share."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from mpi4py import MPI

from fem.march.hooks import Hook, Marching
from fem.march.position import Position
from fem.march.records import Report, State, measure
from fem.results.checkpoint import Archive
from fem.results.walls import Walls
from fem.solver.newton import Outcome
from fiberbend import columns as col
from fiberbend.case.case import Case, Output
from fiberbend.models.model import MeshedModel
from fiberbend.process import signals
from fiberbend.running import messages
from fiberbend.running.assembly import assemble
from fiberbend.running.history import Recorder
from fiberbend.running.hooks import SAME
from fiberbend.running.progress import Progress
from fiberbend.states.bend import Bend
from fiberbend.states.snapshot import ModelMesh, Snapshot

PRESSURE = "pressure"
_NEIGHBOURS = 4
"""States from which one between them is interpolated."""


@dataclasses.dataclass(frozen=True)
class Kept:
    """A state of a zone at a pressure that all zones share.

    Attributes:
        state: of its march.
        row: of its own history.
        shot: of its own mesh, in the turning frame.
        bend: how it bends.
    """

    state: State
    row: dict[str, Any]
    shot: Snapshot
    bend: Bend


@dataclasses.dataclass(frozen=True)
class Solved:
    """What the march of a zone has found.

    Attributes:
        position: where it stands, its states those at shared pressures, in the order of the march.
        pressures: of the states, MPa.
        rows: of its own history, of the states.
        walls: what is remembered of opposite walls.
    """

    position: Position
    pressures: list[float]
    rows: list[dict[str, Any]]
    walls: dict[str, Any]


class ZoneMarch:
    """A zone compiled and at rest.

    Args:
        case: the uniform case of the zone.
        number: of the zone, from 0.
        model: that solves it.

    Attributes:
        case: the uniform case of the zone.
        mesh: of its section or slice.
        archive: moves its states to arrays and back.
        report: of its march through all pressures.
        rest: its state at rest.
        kept: states by the pressure in MPa that was asked for.
    """

    def __init__(self, case: Case, number: int, model: MeshedModel) -> None:
        quiet = Output(pictures=False, fields=False, report=False)
        self.case = case.model_copy(update={"output": quiet})
        self.number, self._model = number, model
        self.mesh = model.mesh(self.case)
        self.assembly = assemble(self.case, self.mesh, MPI.COMM_SELF)
        scene = self.assembly.scene
        self.archive, self._gauge = Archive(scene, None), self.assembly.observables.gauge()
        self.walls = Walls(scene)
        self.rod = self.assembly.observables.rod()
        self._counts = Report()
        rows = Recorder(scene, self._gauge, model, self.assembly.march.rest).rows
        self.rest = self._kept(self.assembly.march.rest, rows[0])
        self.kept: dict[float, Kept] = {0.0: self.rest}
        self.report = Report()
        self._path: list[float] = []

    @property
    def name(self) -> str:
        """As messages call it."""
        return f"zone {self.number + 1}"

    def model_mesh(self, title: str) -> ModelMesh:
        """Mesh, materials and fibers of its section or slice."""
        return dataclasses.replace(self.assembly.model_mesh(self.case), title=title)

    def march(self, pressures: Sequence[float], progress: Progress, zones: int) -> None:
        """Go through all pressures in MPa as far as it comes, and keep the states there.

        Args:
            pressures: from the one nearest to zero on, the last one the end.
            progress: reports to the user.
            zones: how many there are; those before it are done.
        """
        (ramp,) = self.assembly.ramps
        ramp = dataclasses.replace(ramp, target=pressures[-1], stops=tuple(pressures))
        march = self.assembly.march
        rows = Recorder(self.assembly.scene, self._gauge, self._model, march.rest)
        listener = _Listener(self, rows, pressures, progress, zones)
        self.report = march.run([ramp], [self.walls, listener])
        self._count(self.report)
        self._path = list(self.kept)

    def solved(self) -> Solved:
        """What its march has found, to be taken up by another process."""
        found = [(pressure, kept) for pressure, kept in self.kept.items() if pressure in self._path]
        states = [kept.state for _, kept in found]
        position = dataclasses.replace(self.assembly.march.saved(), states=states)
        position.report = self.report
        rows = [kept.row for _, kept in found]
        return Solved(position, [pressure for pressure, _ in found], rows, self.walls.memory())

    def take_up(self, solved: Solved) -> None:
        """Be where a march of the same zone has ended."""
        march = self.assembly.march
        march.resume(solved.position)
        for pressure, state, row in zip(
            solved.pressures, solved.position.states, solved.rows, strict=True
        ):
            march.equilibrium.restore(state)
            self.keep(pressure, state, row)
        self.walls.recall(solved.walls)
        self.report = solved.position.report
        self._count(self.report)
        self._path = list(self.kept)

    def solve(self, pressure: float) -> Kept | None:
        """The state at a pressure in MPa between those that are kept; None where it has none."""
        if pressure in self.kept:
            return self.kept[pressure]
        march, key = self.assembly.march, measure("value", PRESSURE)
        near = sorted(self._path, key=lambda known: abs(known - pressure))[:_NEIGHBOURS]
        states = [self.kept[known].state for known in sorted(near)]
        equilibrium = march.equilibrium
        equilibrium.restore(self.kept[near[0]].state)
        outcome = equilibrium.find(PRESSURE, "value", pressure, (states, key, pressure))
        self._counts.count(outcome)
        if not outcome.converged:
            return None
        state = equilibrium.capture()
        equilibrium.assess_stability(state, self.kept[near[0]].state, PRESSURE, exactly=True)
        rows = Recorder(self.assembly.scene, self._gauge, self._model, march.rest, [])
        self.keep(pressure, state, rows.add(state, outcome))
        self._counts.steps += 1
        signals.check()
        return self.kept[pressure]

    def counts(self) -> dict[str, int]:
        """What all its marches together have cost."""
        found = self._counts
        return {
            "load_steps": found.steps,
            "newton_iterations": found.iterations,
            "factorisations": found.factorisations,
            "cutbacks": found.cutbacks,
        }

    def remarks(self, until: float) -> list[str]:
        """Lines on what has happened to it up to a pressure in MPa."""
        within = dataclasses.replace(
            self.report,
            critical=[c for c in self.report.critical if abs(c.value) <= abs(until)],
            self_contact=None,
        )
        lines = messages.remarks(within)
        passed = self.walls.passed
        if passed is not None and abs(passed[measure("value", PRESSURE)]) <= abs(until):
            lines.append(messages.walls_passed(passed))
        return [f"{self.name}: {line}" for line in lines]

    def why_ended(self) -> str:
        """Why its march ended before the last pressure."""
        report, (ramp,) = self.report, self.assembly.ramps
        if report.status == "stopped":
            return messages.stopped(report, ramp, self.assembly.march.rules.beyond)
        return report.reason

    def keep(self, pressure: float, state: State, row: dict[str, Any]) -> None:
        """Keep the present state as that at a pressure in MPa."""
        self.kept[pressure] = self._kept(state, row)

    def _kept(self, state: State, row: dict[str, Any]) -> Kept:
        scene, archive = self.assembly.scene, self.archive
        displacement, multiplier = archive.displacement(), archive.multiplier()
        assert displacement is not None
        assert multiplier is not None
        shot = Snapshot(
            label=self.name.replace(" ", "-"),
            step=row[col.STEP],
            pressure_kpa=row[col.PRESSURE],
            angle_deg=row[col.ANGLE],
            displacement=displacement,
            multiplier=multiplier,
            fiber_force=archive.fiber_force(),
        )
        natural: dict[str, Any] = {name: scene.scalar(name) for name in scene.body.natural}
        shot = dataclasses.replace(shot, **natural)
        return Kept(state, row, shot, Bend.of(shot, self.mesh))

    def _count(self, report: Report) -> None:
        total = self._counts
        total.steps += report.steps
        total.iterations += report.iterations
        total.factorisations += report.factorisations
        total.cutbacks += report.cutbacks


class _Listener(Hook):
    """Keeps the states at the pressures that are asked for, and tells of every step."""

    def __init__(
        self,
        zone: ZoneMarch,
        recorder: Recorder,
        pressures: Sequence[float],
        progress: Progress | None = None,
        zones: int = 1,
    ) -> None:
        self._zone, self._recorder, self._pressures = zone, recorder, pressures
        self._progress, self._zones = progress, zones

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Record the step."""
        row, pressure = self._recorder.add(state, outcome), state.scalars[PRESSURE]
        if self._progress is not None:
            own = min(max(pressure / self._pressures[-1], 0.0), 1.0)
            self._progress.step(
                row[col.STEP],
                (self._zone.number + own) / self._zones,
                row[col.PRESSURE],
                row[col.ANGLE],
                outcome.iterations,
            )
        # beyond a limit point a pressure may come again: the first state is that of the path
        for goal in self._pressures:
            if goal not in self._zone.kept and abs(pressure - goal) <= SAME * abs(goal):
                self._zone.keep(goal, state, row)
        signals.check()

    def after_cutback(self, march: Marching, reason: str) -> None:
        """Report it."""
        if self._progress is not None:
            self._progress.detail(f"{self._zone.name}: increment cut back: {reason}")

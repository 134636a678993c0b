"""What is done with a hard case: run, or something that no case file describes."""

from __future__ import annotations

import dataclasses
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from bench.hard_cases import Hard
from fem.march.hooks import Hook, Marching
from fem.march.records import Ramp, Report, State
from fem.results.measures import Tip
from fem.solver.newton import Outcome
from fem.solver.side_conditions import Stationary
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.models.choice import meshed
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from fiberbend.running import messages
from fiberbend.running.assembly import assemble
from fiberbend.running.history import Recorder
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from geometry.mesh.data import Floats, MeshData

Check = tuple[str, float, float, float]
"""What was measured, its value, and the least and the greatest one that is right."""

BESIDE = {"cell": (0.99, 1.08), "body": (0.97, 1.03)}
"""Pressure of a model over that of the section, where the case has no other bounds: rubber bulges
between the turns of a cell, 3 to 6 % at a pitch of 3 mm; the middle half of a short and coarse body
feels its caps."""


@dataclasses.dataclass
class Done:
    """What a procedure has found.

    Attributes:
        rows: of history.csv.
        run: of run.json.
        checks: what was compared.
    """

    rows: list[dict[str, Any]]
    run: dict[str, Any]
    checks: list[Check] = dataclasses.field(default_factory=list)


def plain(hard: Hard, model: str) -> Done:
    """Run it; beside the section, and beside the case that it is to agree with."""
    result = run_case(parse_case(hard.case(model)), None)
    done = Done(result.rows, result.run)
    if result.status != "converged":
        return done
    bounds = hard.beside.get(model, BESIDE.get(model))
    if bounds is not None:
        done.checks.append(_beside(hard, model, result, bounds))
    if model in hard.against:
        done.checks.append(_against(hard, model, result))
    return done


def _beside(hard: Hard, model: str, result: RunResult, bounds: tuple[float, float]) -> Check:
    """Pressure over that of the section that bends as much."""
    angle = result.last("uniform_angle_deg" if model == "body" else "angle_deg")
    case = as_section(parse_case(hard.case(model)), inflate(angle=float(np.deg2rad(angle))))
    section = run_case(case, None)
    if section.status == "converged":
        ratio = result.last("pressure_kPa") / section.last("pressure_kPa")
        return ("pressure over the section's", ratio, *bounds)
    # a body that bends to and fro has no pressure for an angle
    pressure = result.last("pressure_kPa") * 1e-3
    section = run_case(as_section(parse_case(hard.case(model)), inflate(to=pressure)), None)
    off = angle / section.last("angle_deg") if section.status == "converged" else np.nan
    return ("angle over the section's", off, *bounds)


def _against(hard: Hard, model: str, result: RunResult) -> Check:
    """Angle over that of another case at the same load."""
    name, measure, within = hard.against[model]
    other = run_case(parse_case(hard.other(name).case(measure)), None)
    off = result.last("angle_deg") / other.last("angle_deg") - 1
    return f"angle over that of {name}, {measure}, less one", off, -within, within


# --- what no case file describes ---------------------------------------------------------------


class Driven(Hook):
    """A case that is marched by hand.

    Args:
        hard: the case.
        model: its model.
        mesh: another mesh than its own.
    """

    def __init__(self, hard: Hard, model: str, mesh: MeshData | None = None) -> None:
        self.case = parse_case(hard.case(model))
        kind = meshed(self.case)
        mesh = mesh or kind.mesh(self.case)
        self.built = assemble(self.case, mesh, MPI.COMM_SELF)
        self.scene, self.newton, self.march = self.built.scene, self.built.newton, self.built.march
        self.recorder = Recorder(self.scene, self.built.observables.gauge(), kind, self.march.rest)
        self.extra: list[Floats] = []
        self.tip = Tip(self.scene.body) if model == "body" else None
        self._note()

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Record it."""
        self.recorder.add(state, outcome)
        self._note()

    def _note(self) -> None:
        if self.tip is not None:
            self.extra.append(np.array(self.tip.position()))

    def run(self, ramps: Sequence[Ramp] | None = None) -> Done:
        """March through the case's ramps, or others."""
        report = self.march.run(self.built.ramps if ramps is None else ramps, [self])
        self.recorder.integrate()
        return Done(self.recorder.rows, self._entry(report))

    def _entry(self, report: Report) -> dict[str, Any]:
        return {
            "status": report.status,
            "reason": report.reason,
            "load_steps": report.steps,
            "cutbacks": report.cutbacks,
            "newton_iterations": report.iterations,
            "warnings": messages.remarks(report),
        }


def unloaded(hard: Hard, model: str) -> Done:
    """Load, and back to zero: everything is where it was."""
    driven = Driven(hard, model)
    up = driven.built.ramps
    done = driven.run([*up, Ramp("pressure", 0.0)])
    body = driven.scene.body
    moved = driven.scene.w[~driven.scene.volumetric]
    left = float(np.max(np.abs(moved))) / driven.case.actuator.length
    done.checks.append(("displacement that is left over the length", left, 0.0, 1e-8))
    for name in body.natural:
        state, rest = driven.scene.scalar(name), driven.march.rest.scalars[name]
        off = abs(state - rest) / body.size_of(name)
        done.checks.append((f"{name} that is left", off, 0.0, 1e-8))
    last = done.rows[-1]
    top = max(row["stored_mJ"] for row in done.rows)
    done.checks.append(("work of the loop over the greatest", last["work_mJ"] / top, -1e-3, 1e-3))
    return done


def perturbed(hard: Hard, model: str) -> Done:
    """From starts that are off at random, Newton finds the same state."""
    driven = Driven(hard, model)
    done = driven.run()
    scene, newton = driven.scene, driven.newton
    end = driven.march.states[-1]
    conditions = [Stationary(scene, name) for name in scene.natural]
    span = driven.case.actuator.length
    volumetric = scene.volumetric
    rng = np.random.default_rng(4)
    # 0.02 mm from node to node of elements of 2 mm: strains of 4 %; pressures by a tenth
    for number in range(3):
        driven.march.equilibrium.restore(end)
        # as a step of a march begins: stiff fibers with the forces of the state before
        scene.extrapolate([end.discrete], np.ones(1))
        start = end.w.copy()
        start[~volumetric] += rng.uniform(-0.02, 0.02, np.count_nonzero(~volumetric))
        start[volumetric] *= rng.uniform(0.9, 1.1, np.count_nonzero(volumetric))
        for name in scene.natural:
            size = scene.body.size_of(name)
            scene.set_scalar(name, end.scalars[name] + 0.01 * size * rng.uniform(-1, 1))
        outcome = newton.solve(start, scene.natural, conditions)
        done.run["newton_iterations"] += outcome.iterations
        off = float(np.max(np.abs(scene.w - end.w)[~volumetric])) / span
        for name in scene.natural:
            off = max(off, abs(scene.scalar(name) - end.scalars[name]) / scene.body.size_of(name))
        off = off if outcome.converged else np.inf
        done.checks.append((f"start {number + 1}: distance of its end", off, 0.0, 1e-8))
    return done


class _KilledError(RuntimeError):
    """Ends a run in its middle."""


class _Kill(Progress):
    """Ends a run after some steps."""

    def __init__(self, after: int) -> None:
        super().__init__(quiet=True)
        self.after = after

    def step(self, step: int, *rest: Any) -> None:  # type: ignore[override]
        """Report a step, or end the run before its checkpoint is written."""
        if step > self.after:
            raise _KilledError
        super().step(step, *rest)


def resumed(hard: Hard, model: str) -> Done:
    """Killed in the middle and resumed: the same end."""
    case = parse_case(hard.case(model))
    with tempfile.TemporaryDirectory() as folder:
        whole = run_case(case, Path(folder) / "whole")
        cut = Path(folder) / "cut"
        try:
            run_case(case, cut, progress=_Kill(whole.run["load_steps"] // 2))
        except _KilledError:
            pass
        else:
            raise AssertionError("the run was not killed")
        again = run_case(case, cut, resume=True)
    done = Done(again.rows, again.run)
    for name in ("angle_deg", "tip_y_mm", "tip_z_mm", "chamber_mm3", "stored_mJ"):
        off = again.last(name) / whole.last(name) - 1
        done.checks.append((f"{name} over that of the whole run, less one", off, -1e-9, 1e-9))
    steps = float(len(again.rows) - len(whole.rows))
    done.checks.append(("more steps than the whole run", steps, 0.0, 0.0))
    return done


def distorted(hard: Hard, model: str) -> Done:
    """Nodes inside the body moved at random: the angle hardly changes; less so on a finer mesh."""
    done, off, moved = _distort(hard, model)
    done.checks.append(("nodes that were moved", float(moved), 20.0, np.inf))
    done.checks.append(("angle over that of straight elements, less one", off, -1e-2, 1e-2))
    if model == "section":
        finer = dataclasses.replace(hard, changes={**hard.changes, "mesh.section": 4})
        _, less, _ = _distort(finer, model)
        done.checks.append(("the same with half the elements' size, over that", less / off, 0, 0.5))
    return done


def _distort(hard: Hard, model: str) -> tuple[Done, float, int]:
    """The run on a distorted mesh, how far its angle is off, and the number of nodes moved."""
    case = parse_case(hard.case(model))
    mesh = meshed(case).mesh(case)
    fixed = np.unique(np.concatenate([mesh.facet_nodes(name).ravel() for name in mesh.facets]))
    inner = np.setdiff1d(np.arange(len(mesh.nodes)), [*fixed, *mesh.points.values()])
    nodes = mesh.nodes.copy()
    # 0.3 of the distance of neighbours across the sheath, of 1 mm with two nodes an element
    size = 0.3 * 1.0 / (2 * case.mesh.section)
    nodes[inner] += np.random.default_rng(4).uniform(-size, size, (len(inner), nodes.shape[1]))
    straight = Driven(hard, model, mesh).run()
    done = Driven(hard, model, dataclasses.replace(mesh, nodes=nodes)).run()
    off = done.rows[-1]["angle_deg"] / straight.rows[-1]["angle_deg"] - 1
    return done, off, len(inner)


def hanging(hard: Hard, model: str) -> Done:
    """The weight moves the tip its own way, along its own direction first of all."""
    driven = Driven(hard, model)
    done = driven.run()
    direction = hard.case(model)["effects"][0]["gravity"]["direction"]
    pull = np.zeros(3)
    pull["xyz".index(direction[1])] = 1.0 if direction[0] == "+" else -1.0
    at = next(i for i, row in enumerate(done.rows) if row["load_gravity"] == 1.0)
    move = driven.extra[at] - driven.extra[0]
    along = float(move @ pull)
    other = float(np.linalg.norm(move - along * pull))
    done.checks.append((f"tip's move along {direction}, mm", along, 1e-3, 40.0))
    if direction[1] != "z":
        done.checks.append(("its move across over that", other / along, 0.0, 0.5))
    return done

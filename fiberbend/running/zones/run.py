"""A run of section or cell over zones along the length, from the case to its folder."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from fem import kernels
from fiberbend import columns as col
from fiberbend.answer.answer import answer
from fiberbend.case.case import Case
from fiberbend.case.zones import lengths, shared_pressures, zone_cases
from fiberbend.models.model import MeshedModel
from fiberbend.models.result import RunResult
from fiberbend.plan.doubts import doubts
from fiberbend.process.signals import stop_of
from fiberbend.results.folder import MESH, RunFolder
from fiberbend.results.states import LAST, step_label, write_fibers, write_snapshot
from fiberbend.running import messages, record
from fiberbend.running.calibrated import Own
from fiberbend.running.history import departures, work_of
from fiberbend.running.hooks import SAME, shows_states
from fiberbend.running.launch import on_rank_0
from fiberbend.running.outputs import draw, write_page
from fiberbend.running.progress import Progress
from fiberbend.running.zones.chain import Link, find_angle, passes_itself, row_of
from fiberbend.running.zones.kept import save, take_up
from fiberbend.running.zones.march import ZoneMarch
from fiberbend.states.labels import angle_labels, pressure_labels, unused
from fiberbend.states.snapshot import Snapshot


def run_zones(
    case: Case,
    model: MeshedModel,
    folder: RunFolder | None,
    progress: Progress,
    comm: Any,
    own: Own | None,
    scratch: RunFolder | None,
    resume: bool,
) -> RunResult:
    """Solve every zone of a case at the same pressures, and chain them; collective.

    Args:
        case: with zones, under a pressure that is given.
        model: of uniform bending.
        folder: where the results go, or None.
        progress: reports to the user.
        comm: an mpi4py communicator, of which one rank solves it.
        own: what the run has of itself beside its case.
        scratch: where states go without a folder, or None.
        resume: take up the zones that the folder has.
    """
    run = _ZonedRun(case, model, folder, progress, comm.size, own or Own(), scratch)
    try:
        return on_rank_0(comm, lambda: run.go(resume))
    except KeyboardInterrupt as error:
        stop = stop_of(error)
        stop.reason, stop.together = (
            messages.interrupted_zones(run.kept, len(case.zones or ())),
            comm.size == 1 or None,
        )
        if folder is not None and folder.writes:
            known = (run.rows, progress.wall_s, comm.size)
            folder.write_run(**record.unfinished("interrupted", stop.reason, model.name, *known))
        raise stop from None


class _ZonedRun:
    """The steps of one run, and what they share; see `run_zones`.

    Attributes:
        rows: of the history.
        kept: zones from the root on whose marches are in the folder.
    """

    def __init__(
        self,
        case: Case,
        model: MeshedModel,
        folder: RunFolder | None,
        progress: Progress,
        ranks: int,
        own: Own,
        scratch: RunFolder | None,
    ) -> None:
        self.case, self.model, self.folder = case, model, folder
        self.progress, self.ranks, self.own = progress, ranks, own
        self.states = folder or scratch
        self.lengths = lengths(case)
        self.zones: list[ZoneMarch] = []
        self.kept = 0
        self.rows: list[dict[str, Any]] = []
        self.warnings: list[str] = []

    def go(self, resume: bool) -> RunResult:
        """Compile, solve, chain, write; `resume`: with the zones that the folder has."""
        case, progress = self.case, self.progress
        known = doubts(case)
        progress.phase("compile")
        for number, alone in enumerate(zone_cases(case, self.model.name)):
            self.zones.append(ZoneMarch(alone, number, self.model))
        progress.phase("solve")
        goals = shared_pressures(case)
        for zone in self.zones:
            self._march(zone, goals, resume)
        links, status, reason = self._chain(goals)
        self._write_rows(links)
        self.warn(self.own.remarks, silent=True)
        self.warn(known)
        for zone in self.zones:
            self.warn(zone.remarks(links[-1].pressure))
        touching = self._self_contact(links)
        self.warn(self._jumps(), silent=True)
        missed = self._missed()
        if missed:
            self.warn([messages.missed(missed)], silent=True)
            if status == "converged":
                status = "stopped"
                reason = f"{messages.course(self.rows)}: {', '.join(missed)} not reached"
        if status == "converged" and self.rows[-1].get(col.MODES):
            self.warn([messages.UNSTABLE_END], silent=True)
        self.warn(record.doubts(case, self.rows), silent=True)
        return self._finish(links, status, reason, touching)

    def warn(self, lines: Sequence[str], silent: bool = False) -> None:
        """Report each line once; `silent`: with the others at the end only."""
        for text in lines:
            if text not in self.warnings:
                self.warnings.append(text)
                if not silent:
                    self.progress.message(text)

    # --- the path ------------------------------------------------------------------------------

    def _march(self, zone: ZoneMarch, goals: Sequence[float], resume: bool) -> None:
        """A zone's states at all pressures, as far as it comes, and in the folder."""
        if resume and self.folder and take_up(self.folder, zone, goals, self.progress.message):
            self.progress.message(f"{zone.name} taken up as it was solved")
        else:
            zone.march(goals, self.progress, len(self.zones))
            if self.folder is not None:
                save(self.folder, zone)
        self.kept += self.folder is not None

    def _solve(self, pressure: float) -> Link | None:
        """The state at a pressure in MPa; None where a zone has none."""
        parts = []
        for zone in self.zones:
            kept = zone.solve(pressure)
            if kept is None:
                return None
            parts.append(kept)
        return Link.of(pressure, parts, self.lengths)

    def _chain(self, goals: Sequence[float]) -> tuple[list[Link], str, str]:
        """States from rest on at the pressures that all zones reach, and at the asked angles.

        Returns:
            The states, the status of the run, and why it is not 'converged'.
        """
        links = [Link.of(0.0, [zone.rest for zone in self.zones], self.lengths)]
        status, reason, stop = "converged", "", self.case.output.stop_at_angle
        for pressure in goals:
            short = next((zone for zone in self.zones if pressure not in zone.kept), None)
            if short is not None:
                status, reason = short.report.status, f"{short.name}: {short.why_ended()}"
                if status == "converged":
                    status = "failed"
                break
            parts = [zone.kept[pressure] for zone in self.zones]
            link = Link.of(pressure, parts, self.lengths)
            for goal, found in self._crossed(links[-1], link):
                if found is None:
                    text = f"no state of all zones is found at {np.rad2deg(goal):.6g}°"
                    return links, "failed", f"{text} between two pressures around it"
                links.append(found)
                if goal == stop:
                    return links, "converged", ""
            if abs(link.pressure - links[-1].pressure) > SAME * abs(link.pressure):
                links.append(link)
        return links, status, reason

    def _crossed(self, old: Link, new: Link) -> Iterator[tuple[float, Link | None]]:
        """The asked angles between two states, in the order in which they are met."""
        output = self.case.output
        stop = [] if output.stop_at_angle is None else [output.stop_at_angle]
        goals = {
            goal
            for goal in (*output.at_angles, *stop)
            if min(old.angle, new.angle) < goal <= max(old.angle, new.angle)
        }
        for goal in sorted(goals, reverse=new.angle < old.angle):
            yield goal, find_angle(goal, old, new, self._solve)

    def _write_rows(self, links: Sequence[Link]) -> None:
        rows = [row_of(self.case, link, self.lengths) for link in links]
        for step, row in enumerate(rows):
            row[col.STEP] = step
            col.check(row, self.model)
        self.rows += rows
        work, self._uncertainty = self._work()
        for row, value in zip(rows, np.cumsum(work), strict=True):
            row[col.WORK] = float(value)
        self._each = work

    def _work(self) -> tuple[Any, Any]:
        if len(self.rows) < 2:
            return np.zeros(len(self.rows)), np.zeros(len(self.rows))
        pressures = np.array([[1e-3 * row[col.PRESSURE]] for row in self.rows])
        return work_of(pressures, np.array([[row[col.VOLUME]] for row in self.rows]))

    def _jumps(self) -> list[str]:
        stored = np.array([row[col.STORED] for row in self.rows])
        steps = departures(self._each, self._uncertainty, stored) if len(stored) > 1 else []
        return [messages.jumped(self.rows[step - 1], self.rows[step]) for step in steps]

    def _missed(self) -> list[str]:
        """Angles and pressures that are asked for and no state has, with their units."""
        output = self.case.output
        asked = dict.fromkeys(
            angle for angle in (*output.at_angles, output.stop_at_angle) if angle is not None
        )
        angles = [math.radians(row[col.ANGLE]) for row in self.rows]
        found = [
            f"{np.rad2deg(goal):.6g}°"
            for goal in asked
            if min(abs(angle - goal) for angle in angles) > 1e-7
        ]
        for goal in dict.fromkeys(output.at_pressures):
            if min(abs(row[col.PRESSURE] / 1e3 - goal) for row in self.rows) > SAME * abs(goal):
                found.append(f"{1e3 * goal:.6g} kPa")
        return found

    def _self_contact(self, links: Sequence[Link]) -> int | None:
        """Number of the first state in which the whole passes through itself."""
        rods = [zone.rod for zone in self.zones]
        for step, link in enumerate(links):
            if step and passes_itself(link, rods, self.lengths):
                self.warn([f"at the latest {messages.self_contact(_measures(link))}"])
                return step
        return None

    # --- what is left --------------------------------------------------------------------------

    def _shots(self, links: Sequence[Link], joined: Any, touching: int | None) -> list[Snapshot]:
        """The states that are asked for and the last one; all of them go to the folder."""
        output = self.case.output
        angles, pressures = angle_labels(output.at_angles), pressure_labels(output.at_pressures)
        shots: list[Snapshot] = []
        for step, (link, row) in enumerate(zip(links, self.rows, strict=True)):
            if step == 0:
                continue
            taken = [shot.label for shot in shots]
            asked = [
                *(label for goal, label in angles.items() if abs(link.angle - goal) <= 1e-7),
                *(
                    label
                    for goal, label in pressures.items()
                    if abs(link.pressure - goal) <= SAME * abs(goal)
                ),
                *([LAST] if step == len(links) - 1 else []),
            ]
            label = unused(asked[0], taken) if asked else step_label(step)
            remark = self._remark(link, touching is not None and step >= touching)
            shot = joined.snapshot(link, label, row, remark)
            if asked:
                shots.append(shot)
            if self.states is not None:
                write_snapshot(self.states, shot)
        return shots

    def _remark(self, link: Link, touches: bool) -> str:
        for zone in self.zones:
            passed = zone.walls.passed
            if passed is not None and abs(passed["value pressure"]) <= abs(link.pressure):
                return f"chamber walls pass through each other in {zone.name}: not modelled"
        return "passes through itself: not modelled" if touches else ""

    def _finish(
        self, links: Sequence[Link], status: str, reason: str, touching: int | None
    ) -> RunResult:
        case, folder, progress = self.case, self.folder, self.progress
        check = None
        if folder is not None:
            from fiberbend.compare.beside import check_run

            progress.phase("crosscheck")
            check = check_run(case, self.model, self.rows)
            self.warn(check.doubts(), silent=True)
        progress.phase("output")
        joined, shots = None, list[Snapshot]()
        if self.states is not None and (folder is None or shows_states(case.output)):
            from fiberbend.running.zones.joined import Joined

            joined = Joined(case, self.zones, self.model.name)
            self.states.write(MESH, joined.model_mesh.mesh.save)
            if joined.model_mesh.fibers is not None:
                write_fibers(self.states, joined.model_mesh.fibers, joined.model_mesh.smeared)
            shots = self._shots(links, joined, touching)
        strain: dict[str, Any] = {}
        if joined is not None and shots:
            space = joined.model_mesh
            strain, beyond = record.strain(case, lambda: space, shots[-1])
            self.warn(beyond, silent=True)
        rows = check.beside(self.rows) if check else self.rows
        run = record.entries(
            status,
            reason,
            self.model.name,
            self._counted(links[-1].pressure),
            self._wall(),
            record.peak_memory_mb(),
            self.ranks,
            kernels.versions(),
        )
        run |= record.of_effects(case, self.rows) | record.beside(check) | self.own.entries
        run |= strain
        if folder is not None:
            folder.write_history(rows)
            folder.write_run(**run)
            if joined is not None and folder.writes:
                why = f"{status}: {reason}" if reason else None
                say = self._say
                draw(
                    folder,
                    case,
                    joined.model_mesh,
                    shots,
                    rows,
                    why,
                    say,
                    check,
                    self.model.name,
                )
                if case.output.report:
                    progress.phase("report")
                    write_page(folder, case, rows, run, say)
            progress.close()
            run |= {"wall_s": self._wall(), "warnings": list(self.warnings)}
            folder.write_run(**run)
        for line in record.cost(run):
            progress.detail(line)
        progress.answer(answer(case, rows, run))
        return RunResult(status, reason, rows, run, folder.path if folder else None)

    def _say(self, text: str) -> None:
        self.warn([text])

    def _wall(self) -> dict[str, float]:
        return {name: round(value, 3) for name, value in self.progress.wall_s.items()}

    def _counted(self, until: float) -> dict[str, Any]:
        """What the marches of all zones have counted, together and each, up to a pressure."""
        each, critical = [], []
        for zone, length in zip(self.zones, self.lengths, strict=True):
            scene = zone.assembly.scene
            data = scene.domain.data
            each.append(
                {
                    "length_mm": length,
                    "half": data.half,
                    "unknowns": scene.body.size,
                    "elements": len(data.cells),
                    **zone.counts(),
                }
            )
            points = messages.critical_points(zone.report, scene.body.symmetry_factor)
            within = (abs(point.value) <= abs(until) for point in zone.report.critical)
            kept = itertools.compress(points, within)
            critical += [{"zone": zone.number + 1, **point} for point in kept]
        sums = ("unknowns", "elements", "newton_iterations", "factorisations", "cutbacks")
        first = self.zones[0].assembly
        return {
            "half": all(found["half"] for found in each),
            "element": first.scene.domain.data.cell_type,
            "effects": sorted({k for zone in self.zones for k in zone.assembly.scene.keys}),
            "load_steps": len(self.rows) - 1,
            **{name: sum(found[name] for found in each) for name in sums},
            "warnings": list(self.warnings),
            "stability_checked": all(
                zone.assembly.march.equilibrium.tells_stability for zone in self.zones
            ),
            "critical_points": critical,
            "zones": each,
        }


def _measures(link: Link) -> dict[str, float]:
    return {"control": link.angle, "value pressure": link.pressure}

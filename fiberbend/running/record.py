"""Content of run.json."""

from __future__ import annotations

import platform
import resource
import shlex
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend import columns as col
from fiberbend.answer.strain import greatest_strain
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.resolution import winding_remark
from fiberbend.models.result import RunResult
from fiberbend.results.folder import RunFolder
from fiberbend.running import messages
from fiberbend.running.assembly import Assembly
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.states.snapshot import ModelMesh, Snapshot
from fiberbend.version import __version__
from machine import origin

if TYPE_CHECKING:
    from fiberbend.compare.check import Check


def versions(*libraries: Mapping[str, str]) -> dict[str, str]:
    """Versions that a result depends on: the program's, Python's and those of libraries."""
    found = {"fiberbend": __version__, "python": platform.python_version()}
    for more in libraries:
        found |= more
    return found


def provenance() -> dict[str, Any]:
    """Command line, commit of the source, machine and BLAS: what else a result depends on."""
    name, *arguments = sys.argv or [""]
    program = Path(name).name
    return {
        "command": shlex.join(["fiberbend" if program == "__main__.py" else program, *arguments]),
        "commit": origin.commit(Path(__file__).resolve().parents[2]),
        "machine": origin.machine(),
        "blas": origin.blas(),
    }


def header() -> list[str]:
    """First lines of a log."""
    known = provenance()
    commit = f" (commit {known['commit'][:12]})" if known["commit"] else ""
    machine, blas = known["machine"], known["blas"]
    linear = f"; {blas['library']} {blas['kernel'] or ''}" if blas else ""
    return [
        known["command"],
        f"fiberbend {__version__}{commit}, Python {platform.python_version()}, "
        f"{machine['processor']}, {machine['usable_cores']} cores, {machine['system']}{linear}",
    ]


def peak_memory_mb() -> float:
    """Greatest memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def entries(
    status: str,
    reason: str,
    model: str,
    counts: Mapping[str, Any],
    wall_s: Mapping[str, float],
    memory_mb: float,
    ranks: int,
    libraries: Mapping[str, str],
) -> dict[str, Any]:
    """Entries of run.json for a run of any model, in this order.

    Args:
        status: 'converged', 'stopped' or 'failed'; see `unfinished`.
        reason: why not converged, or empty.
        model: name of the model.
        counts: "unknowns", "load_steps", "newton_iterations", "cutbacks" and what the model adds.
        wall_s: seconds by phase.
        memory_mb: greatest memory of all ranks together, MB.
        ranks: number of ranks.
        libraries: versions beside the program's and Python's.
    """
    return {
        "status": status,
        "reason": reason,
        "model": model,
        **counts,
        "wall_s": dict(wall_s),
        "peak_memory_MB": round(memory_mb, 1),
        "ranks": ranks,
        "versions": versions(libraries),
        **provenance(),
    }


def unfinished(
    status: str,
    reason: str,
    model: str,
    rows: Sequence[col.Row],
    wall_s: Mapping[str, float],
    ranks: int,
) -> dict[str, Any]:
    """Entries of run.json for a run that has not come to its end; asks no other rank.

    Args:
        status: 'running', also where a run was killed; 'interrupted' by a signal.
        reason: what is kept.
        model: name of the model.
        rows: of the history so far.
        wall_s: seconds by phase that has ended.
        ranks: number of ranks.
    """
    return {
        "status": status,
        "reason": reason,
        "model": model,
        "load_steps": max(0, len(rows) - 1),
        "newton_iterations": sum(row[col.ITERATIONS] for row in rows),
        "wall_s": {name: round(value, 3) for name, value in wall_s.items()},
        "peak_memory_MB": round(peak_memory_mb(), 1),
        "ranks": ranks,
        "versions": versions(),
        **provenance(),
    }


def refused(
    folder: RunFolder | None,
    model: str,
    rows: Sequence[col.Row],
    wall_s: dict[str, float],
    ranks: int,
    error: Exception,
) -> CaseError:
    """What a run says that the iterative solver refuses; run.json says it too, on one rank.

    Args:
        folder: of the run, or None.
        model: name of the model.
        rows: of the history so far.
        wall_s: seconds by phase that has ended.
        ranks: number of ranks.
        error: why.
    """
    problem = Problem("solver.linear", f'"iterative", expected direct: {error}')
    if folder is not None:
        entries = unfinished("failed", str(problem), model, rows, wall_s, ranks)
        folder.write_run(**entries)
    return CaseError([problem])


def counted(assembly: Assembly, warnings: Sequence[str]) -> dict[str, Any]:
    """What a run of finite elements has counted, and what it warns of."""
    scene, report = assembly.scene, assembly.march.report
    data = scene.domain.data
    return {
        "half": data.half,
        "unknowns": scene.body.size,
        "elements": len(data.cells),
        "element": data.cell_type,
        "effects": scene.keys,
        "load_steps": report.steps,
        "newton_iterations": report.iterations,
        "factorisations": report.factorisations,
        "cutbacks": report.cutbacks,
        "warnings": list(warnings),
        "stability_checked": assembly.march.equilibrium.tells_stability,
        "critical_points": messages.critical_points(report, scene.body.symmetry_factor),
    }


def of_effects(case: Case, rows: Sequence[col.Row]) -> dict[str, Any]:
    """What the effects of a case report of a body, and whether its winding is resolved."""
    found: dict[str, Any] = {"winding": winding_remark(case)}
    for effect in case.effects:
        found |= effect.summary(convert.site(case), rows)
    return found


def doubts(case: Case, rows: Sequence[col.Row]) -> list[str]:
    """What the effects of a case find doubtful in its history, a line each."""
    site = convert.site(case)
    return [line for effect in case.effects for line in effect.doubts(site, rows)]


def accuracy(
    case: Case,
    status: str,
    rows: Sequence[dict[str, Any]],
    entries: Mapping[str, Any],
    solve: Callable[[Case], RunResult],
    phase: Callable[[str], None],
) -> tuple[dict[str, Any], list[str]]:
    """The entry 'accuracy' and a warning of one that is missed, where a case asks for one.

    Args:
        case: the case; see `fiberbend.accuracy.computed.estimated`, also of the others.
        status: of the run.
        rows: its history.
        entries: of run.json so far.
        solve: solves a case on this rank alone.
        phase: takes the name of the phase that begins.
    """
    if case.accuracy is None:
        return {}, []
    from fiberbend.accuracy.computed import estimated, missed

    found = estimated(case, status, rows, entries, solve, phase)
    return found, missed(found)


def beside(check: Check | None) -> dict[str, Any]:
    """How the run compares with other models, where that is known."""
    return {} if check is None else {"crosscheck": check.entry()}


def strain(
    case: Case, mesh: Callable[[], ModelMesh], last: Snapshot | None
) -> tuple[dict[str, Any], list[str]]:
    """The greatest strain of the last state, where that is at hand, and warnings; on rank 0.

    Args:
        case: the case.
        mesh: gives the mesh of its model.
        last: the last state, or None.
    """
    if last is None:
        return {}, []
    found = greatest_strain(case, mesh(), last)
    return {"greatest_strain": found}, found.get("beyond_tests", [])


def cost(run: Mapping[str, Any]) -> list[str]:
    """Lines on what a run of finite elements has cost, from its run.json."""
    phases = ", ".join(f"{name} {value:.1f} s" for name, value in run["wall_s"].items())
    ranks = f"{run['ranks']} rank{'' if run['ranks'] == 1 else 's'}"
    return [
        f"{run['unknowns']} unknowns: {run['load_steps']} steps, {run['newton_iterations']} "
        f"iterations, {run['factorisations']} factorisations, {run['cutbacks']} cut-backs",
        f"{phases}; peak memory {run['peak_memory_MB']:.0f} MB on {ranks}",
    ]

"""What runs of rods share, at rest and in time: rows and warnings so far, and how they end."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.answer.answer import answer
from fiberbend.case.case import Case
from fiberbend.compare.check import Check
from fiberbend.models.model import ModelKind
from fiberbend.models.result import RunResult
from fiberbend.results.folder import MESH, RunFolder
from fiberbend.running import record
from fiberbend.running.calibrated import Own
from fiberbend.running.hooks import shows_states
from fiberbend.running.outputs import draw, write_page
from fiberbend.running.progress import Progress
from fiberbend.running.slender.solid import Solid
from fiberbend.slender.actuator import Slender
from fiberbend.states.snapshot import Snapshot

Shots = Callable[[Solid], list[Snapshot]]
"""States that are asked for, of the rod as a solid; it writes all that are kept."""


class RodFrame:
    """A run of a rod.

    Args:
        case: of a model that solves rods.
        model: its model.
        folder: where the results go, or None.
        progress: reports to the user.
        ranks: of which one solves it.
        own: what the run has of itself beside its case.
        scratch: where states go without a folder, or None.

    Attributes:
        rows: of the history.
        warnings: so far.
    """

    def __init__(
        self,
        case: Case,
        model: ModelKind,
        folder: RunFolder | None,
        progress: Progress,
        ranks: int,
        own: Own,
        scratch: RunFolder | None,
    ) -> None:
        self.case, self.folder = case, folder
        self.progress, self.own = progress, own
        self.states = folder or scratch
        self.rows: list[dict[str, Any]] = []
        self.warnings: list[str] = []
        self._model, self._ranks = model, ranks

    def add(self, row: dict[str, Any]) -> None:
        """One more row of the history, checked."""
        col.check(row, self._model)
        self.rows.append(row)

    def warn(self, lines: Sequence[str], silent: bool = False) -> None:
        """Report each line once; `silent`: with the others at the end only."""
        for text in lines:
            if text not in self.warnings:
                self.warnings.append(text)
                if not silent:
                    self.progress.message(text)

    def say(self, text: str) -> None:
        """Report a line once."""
        self.warn([text])

    def finish(
        self,
        rod: Slender,
        ended: tuple[str, str],
        counts: dict[str, Any],
        shots: Shots,
        more: Mapping[str, Any] | None = None,
        check: Check | None = None,
        pictures: Callable[[RunFolder, str | None], None] | None = None,
    ) -> RunResult:
        """Write what is asked for, and answer.

        Args:
            rod: the actuator as a rod.
            ended: status of the run, and why it is not 'converged'.
            counts: what it has counted.
            shots: states that are asked for.
            more: entries of run.json of its own.
            check: what stands beside its rows.
            pictures: draws more into a folder; takes why the run ended early.
        """
        case, folder, progress = self.case, self.folder, self.progress
        progress.phase("output")
        solid, shown = None, list[Snapshot]()
        if self.states is not None and (folder is None or shows_states(case.output)):
            solid = Solid(case, rod)
            self.states.write(MESH, solid.model_mesh.mesh.save)
            shown = shots(solid)
        status, reason = ended
        rows = check.beside(self.rows) if check else self.rows
        run = record.entries(
            status,
            reason,
            self._model.name,
            counts | {"warnings": list(self.warnings), "section_law": _law(rod)},
            self._wall(),
            record.peak_memory_mb(),
            self._ranks,
            {"numpy": np.__version__},
        )
        run |= record.of_effects(case, self.rows) | record.beside(check) | self.own.entries
        run |= more or {}
        if folder is not None:
            folder.write_history(rows)
            folder.write_run(**run)
            if solid is not None and folder.writes:
                why = f"{status}: {reason}" if reason else None
                drawn = (solid.model_mesh, shown, rows, why, self.say)
                draw(folder, case, *drawn, check, self._model.name)
                if case.output.pictures and pictures is not None:
                    pictures(folder, why)
                if case.output.report:
                    progress.phase("report")
                    write_page(folder, case, rows, run, self.say)
            progress.close()
            run |= {"wall_s": self._wall(), "warnings": list(self.warnings)}
            folder.write_run(**run)
        progress.answer(answer(case, rows, run))
        return RunResult(status, reason, rows, run, folder.path if folder else None)

    def _wall(self) -> dict[str, float]:
        return {name: round(value, 3) for name, value in self.progress.wall_s.items()}


def _law(rod: Slender) -> dict[str, Any]:
    """The law of the section, as run.json has it."""
    section = rod.section
    return {
        "model": section.model,
        "states": section.states,
        "seconds": round(section.seconds, 3),
        "error": section.error,
    }

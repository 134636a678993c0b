"""The winding of a run that waits for its numbers: calibrated before anything is built."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend.case.case import Case
from fiberbend.reader.reader import read_case
from fiberbend.results.folder import CASE_FILE
from fiberbend.running.launch import on_rank_0
from fiberbend.running.progress import Progress
from fiberbend.schema.problems import CaseError

if TYPE_CHECKING:
    from fiberbend.calibration.record import Calibrated
    from materials.bedding import Bedding
    from materials.bulging import Bulging


@dataclasses.dataclass(frozen=True)
class Own:
    """What a run has of itself beside its case.

    Attributes:
        entries: of run.json.
        remarks: warnings.
        lines: of its log.
    """

    entries: dict[str, Any] = dataclasses.field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    lines: tuple[str, ...] = ()

    def also(self, remark: str) -> Own:
        """With one more warning."""
        return dataclasses.replace(self, remarks=(*self.remarks, remark))


def calibrated(case: Case, comm: Any, progress: Progress, resumed: Path | None) -> tuple[Case, Own]:
    """The case with the numbers that its winding waits for; collective.

    Args:
        case: any case.
        comm: an mpi4py communicator; rank 0 solves the cell.
        progress: reports to the user.
        resumed: folder of a run that goes on: with the numbers with which it began.

    Raises:
        CaseError: the winding cannot be calibrated.
    """
    if not any(effect.uncalibrated() for effect in case.effects):
        numbers = next((n for e in case.effects if (n := e.bulges()) is not None), None)
        return case, Own() if numbers is None else _given(numbers)
    from fiberbend.calibration.calibrate import with_bulging

    progress.phase("calibration")
    before, found = on_rank_0(comm, lambda: _numbers(case, progress, resumed))
    if found is None:
        assert before is not None
        return with_bulging(case, before), _given(before)
    line = found.line()
    progress.detail(line)
    own = Own({"calibration": found.entry()}, found.remarks, (line,))
    return with_bulging(case, found.found.bulging()), own


def _numbers(
    case: Case, progress: Progress, resumed: Path | None
) -> tuple[Bulging | Bedding | None, Calibrated | None]:
    """Those of a run that goes on, or of a calibration; a run keeps the ones it began with."""
    from fiberbend.calibration.calibrate import calibrate, known

    before = None if resumed is None else _before(resumed)
    if before is None:
        return None, calibrate(case, tell=progress.message)
    kept = known(case)
    return before, kept if kept is not None and kept.found.bulging() == before else None


def _before(folder: Path) -> Bulging | Bedding | None:
    """The numbers in the case of a run folder; None where there are none."""
    try:
        case = read_case(folder / CASE_FILE)
    except CaseError:
        # no run, or another one: said where its folder is opened
        return None
    return next((n for effect in case.effects if (n := effect.bulges()) is not None), None)


def _given(numbers: Bulging | Bedding) -> Own:
    from fiberbend.calibration.record import named, words

    text = f"winding: rubber bulges between its turns as the case says ({words(numbers)})"
    entry = {**named(numbers), "text": text}
    return Own({"calibration": entry}, (), (text,))

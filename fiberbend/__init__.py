"""Soft fiber-reinforced bending actuators: cases, runs and their results."""

from __future__ import annotations

import os
import sys

# `python -m fiberbend` puts the working folder first in the path: before anything else is imported
# it is taken out, or a file yaml.py beside a case would be yaml.
if (
    sys.argv[:1] == ["-m"]
    and not sys.flags.safe_path
    and sys.path[:1] != [os.path.dirname(os.path.dirname(__file__))]
):
    del sys.path[0]

# Nothing slow here: until fiberbend.__main__ takes the signals, Ctrl-C is a traceback.
TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path
    from typing import Any

    from fiberbend.case.case import Case
    from fiberbend.models.result import RunResult
    from fiberbend.version import __version__ as __version__


def __getattr__(name: str) -> str:
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from fiberbend.version import __version__

    return __version__


def run(
    case: Case | Mapping[str, Any] | Path | str,
    out: Path | str | None = None,
    overwrite: bool = False,
    quiet: bool = True,
    force: bool = False,
) -> RunResult:
    """Solve a case.

    Args:
        case: a case, a mapping as its YAML gives it, or the path of a case file.
        out: run folder; without one nothing is written.
        overwrite: replace an earlier run in `out`.
        quiet: report no progress.
        force: run whether the memory that it is expected to need is free or not.

    Returns:
        What was computed.

    Raises:
        fiberbend.schema.problems.CaseError: everything that is wrong with the case, or not
            enough memory for it.
    """
    from pathlib import Path

    from fiberbend.reader.reader import as_case
    from fiberbend.running import launch
    from fiberbend.running.progress import Progress

    checked = as_case(case)
    launch.start_mpi()
    from fiberbend.running.runner import run_case

    progress = Progress(quiet=quiet)
    folder = None if out is None else Path(out)
    try:
        return run_case(checked, folder, overwrite, progress, force=force)
    finally:
        progress.close()

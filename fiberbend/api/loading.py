"""Runs and sweeps read back from their folders."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fiberbend.api.result import Result
from fiberbend.api.sweep import Sweep
from fiberbend.case.case import Case
from fiberbend.reader.reader import parse_case
from fiberbend.reader.yaml_file import load_yaml
from fiberbend.results.folder import CASE_FILE, HISTORY_FILE, POINTS, RUN_FILE, TABLE
from fiberbend.results.reading import read_history, read_run
from fiberbend.schema.problems import CaseError, Problem

_MEASURED = "output.measured"


def load(path: Path | str) -> Result | Sweep:
    """Read a run or a sweep from its folder, whatever became of it.

    Args:
        path: run folder, also of a run that failed, was interrupted or killed, or still runs; or
            the folder of a sweep.

    Returns:
        The run as `run` would return it, or the sweep.

    Raises:
        CaseError: there is no such folder, or neither a run nor a sweep is in it; or a file in it
            cannot be read.
    """
    path = Path(path)
    if not path.is_dir():
        what = "is a file" if path.exists() else "no such folder"
        raise CaseError([Problem(str(path), f"{what}, expected the folder of a run or a sweep")])
    if (path / CASE_FILE).exists() or (path / RUN_FILE).exists():
        return load_run(path)
    if (path / POINTS).is_dir() or (path / TABLE).exists():
        return Sweep(path, load_run)
    names = sorted(entry.name for entry in path.iterdir())
    text = f"contains {', '.join(names[:6]) or 'nothing'}, expected the folder of a run or a sweep"
    raise CaseError([Problem(str(path), text)])


def load_run(path: Path) -> Result:
    """Read the folder of a run.

    Raises:
        CaseError: a file in it is missing or cannot be read.
    """
    run = read_run(path)
    case = _read_case(path / CASE_FILE, run)
    history = path / HISTORY_FILE
    rows = read_history(history) if history.exists() else []
    return Result(
        status=str(run.get("status")),
        reason=str(run.get("reason") or ""),
        rows=rows,
        run=run,
        folder=path,
        case=case,
        kept_in=path,
    )


def _read_case(path: Path, run: dict[str, Any]) -> Case:
    if not path.exists():
        why = f"; the run {run['status']}: {run['reason']}" if run.get("reason") else ""
        text = f"no such file, expected the case of a run that began{why}"
        raise CaseError([Problem(str(path), text)])
    data = load_yaml(path)
    try:
        return parse_case(data)
    except CaseError as error:
        output = data.get("output")
        if not all(p.path.startswith(_MEASURED) for p in error.problems) or output is None:
            raise CaseError(
                Problem(f"{path}: {problem.path}", problem.text) for problem in error.problems
            ) from None
        # measured points that are gone since are no part of the run
        rest = {key: value for key, value in output.items() if key != "measured"}
        return parse_case({**data, "output": rest})

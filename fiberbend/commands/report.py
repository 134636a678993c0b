"""The command `fiberbend report`."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem


def report(
    folder: Annotated[Path, Parameter(name="FOLDER")],
    /,
    *,
    out: Path | None = None,
    open_it: Annotated[bool, Parameter(name="--open")] = False,
) -> None:
    """Write report.html of a run or a sweep again.

    The page is one HTML file that needs no network: case, plan, answer, curves, the body in space
    at every load step, tables and files. Nothing is solved. A run and a sweep write it at their
    end; so do those that were stopped, as far as they came, by this command.

    Args:
        folder: Folder of a run or a sweep.
        out: Where the page goes; report.html in the folder unless given.
        open_it: Open the page in the browser.
    """
    from fiberbend.results.folder import REPORT, RunFolder

    settle_folders()
    target = out or folder / REPORT
    page = _page(folder, _links(folder, target))
    try:
        if out is None:
            RunFolder(folder).write_text(REPORT, page)
        else:
            out.parent.mkdir(parents=True, exist_ok=True)
            out.write_text(page, encoding="utf-8")
    except OSError as error:
        text = f"{error.strerror}, expected a file that can be written"
        raise CaseError([Problem(str(target), text)]) from None
    say(f"report in {target}")
    if open_it:
        from fiberbend.commands.opening import open_file

        open_file(target)


def _links(folder: Path, target: Path) -> str:
    """What leads from a page to a folder; empty where it is in it."""
    if target.resolve().parent == folder.resolve():
        return ""
    return Path(os.path.relpath(folder.resolve(), target.resolve().parent)).as_posix() + "/"


def _page(folder: Path, links: str) -> str:
    from fiberbend.report.sweep_page import TABLE, sweep_report
    from fiberbend.results.folder import CASE_FILE, HISTORY_FILE, read_history

    if (folder / TABLE).exists():
        return sweep_report(folder, links=links)
    if not (folder / CASE_FILE).exists():
        text = "contains no run and no sweep, expected the folder of one"
        raise CaseError([Problem(str(folder), text)])
    from fiberbend.reader.reader import read_case
    from fiberbend.report.run_page import report

    history = folder / HISTORY_FILE
    rows = read_history(history) if history.exists() else []
    return report(folder, read_case(folder / CASE_FILE), rows, _run(folder), links)


def _run(folder: Path) -> dict[str, Any]:
    """Content of run.json; of a run that was killed before it could write any: nothing."""
    from fiberbend.results.folder import RUN_FILE

    try:
        content = json.loads((folder / RUN_FILE).read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except ValueError as error:
        raise CaseError([Problem(str(folder / RUN_FILE), f"{error}, expected JSON")]) from None
    if not isinstance(content, dict):
        raise CaseError([Problem(str(folder / RUN_FILE), "expected a mapping")])
    return content

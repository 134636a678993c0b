"""The command `fiberbend report`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

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
    """Write report.html of a run, a sweep or a design again.

    The page is one HTML file that needs no network: case, plan, answer, curves, the body in space
    at every load step, tables and files. Nothing is solved. A run and a sweep write it at their
    end; so do those that were stopped, as far as they came, by this command.

    Args:
        folder: Folder of a run, a sweep or a design.
        out: Where the page goes; report.html in the folder unless given.
        open_it: Open the page in the browser.
    """
    from fiberbend.api.loading import load
    from fiberbend.report.design_page import write_design_page
    from fiberbend.results.folder import DESIGN, REPORT

    settle_folders()
    design = (folder / DESIGN).exists()
    write = partial(write_design_page, folder) if design else load(folder).report
    try:
        target = write(out)
    except OSError as error:
        text = f"{error.strerror}, expected a file that can be written"
        raise CaseError([Problem(str(out or folder / REPORT), text)]) from None
    say(f"report in {target}")
    if open_it:
        from fiberbend.commands.opening import open_file

        open_file(target)

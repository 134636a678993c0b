"""The command `fiberbend table`: the law of a section, for rods."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running import launch
from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem

FILES = ("table.npz", "table.csv", "table.png")


def table(
    case: CaseFile,
    /,
    *,
    settings: Changes = (),
    error: Annotated[str, Parameter(metavar="PERCENT")] = "0.1 %",
    least: Annotated[str, Parameter(name="--from", metavar="PRESSURE")] = "",
    out: Annotated[Path | None, Parameter(metavar="FOLDER")] = None,
    overwrite: bool = False,
    open_it: Annotated[bool, Parameter(name="--open")] = False,
) -> int:
    """Write the law of a section as a table: energy, force, moment by stretch, curvature, pressure.

    Of a section that twists or bends to the side by itself it is one about its free states.

    States are solved until force, moment and chamber are known to the error, then kept: the
    next call takes no time. The range is what the case takes, with margins for loads.

    Args:
        case: Case file of model section or cell.
        settings: Changes to it.
        error: Greatest error, of strains by errors of forces, of the chamber and of the free angle.
        least: Least pressure; zero unless given.
        out: Folder of table.npz, table.csv and table.png; tables/CASE unless given.
        overwrite: Replace files that are there.
        open_it: Show the picture.
    """
    from fiberbend.reader.reader import read_case

    checked = read_case(case, settings)
    asked, start = _error(error), _pressure(least)
    folder = out or Path("tables") / case.stem
    files = [folder / name for name in FILES]
    taken = [path for path in files if path.exists()]
    if taken and not overwrite:
        text = "exists, expected a new folder by --out, or --overwrite"
        raise CaseError([Problem(str(path), text) for path in taken])
    settle_folders()
    launch.start_mpi()
    from fiberbend.drawing.page import save
    from fiberbend.sectionlaw.shown import shown

    found = shown(checked, asked, start, lambda line: say(line, sys.stderr))
    for line in found.lines:
        say(line)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        files[0].write_bytes(found.packed)
        files[1].write_text(found.text, encoding="utf-8")
        save(found.page, files[2])
    except OSError as stop:
        raise CaseError([Problem(str(folder), f"{stop.strerror}, expected a folder")]) from None
    say(f"table: {files[0]}, {files[1]}")
    say(f"picture: {files[2]}")
    if open_it:
        from fiberbend.commands.opening import open_file

        open_file(files[2])
    return 0


def _error(text: str) -> float:
    """In parts."""
    from fiberbend.schema.units import parse

    try:
        percent = parse(text, "accuracy")
    except ValueError as error:
        raise CaseError([Problem("--error", f'"{text}", {error}')]) from None
    if not 0.001 <= percent <= 10:
        raise CaseError([Problem("--error", f'"{text}", expected 0.001 to 10 %')])
    return percent / 100


def _pressure(text: str) -> float | None:
    """In MPa."""
    from fiberbend.schema.units import parse

    if not text:
        return None
    try:
        return parse(text, "pressure")
    except ValueError as error:
        raise CaseError([Problem("--from", f'"{text}", {error}')]) from None

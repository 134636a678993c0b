"""The command `fiberbend plot`: a figure for a paper, of runs, sweeps and measured points."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, get_args

from cyclopts import Parameter

from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import parse, show

FormatName = Literal["pdf", "svg", "png"]
_WIDTHS = (20.0, 2000.0)
"""Least and greatest width and height of a page, mm."""
_DPI = (20.0, 2400.0)
_FONT = (2.0, 72.0)
# A docstring's line breaks would be those of the help.
_X = (
    "Column along the lower axis, of history.csv or of a sweep's sweep.csv; repeatable, such as "
    "pressure_kPa and section_kPa; pressure_kPa by default."
)
_LABEL = (
    "Name of a curve in the legend, in the order of the curves; repeatable. By default what "
    "differs between the runs, or their titles."
)
_OUT = (
    "File; by default such as pressure_angle.pdf, in the folder of the run, or in the working "
    "folder for several runs."
)


def plot(
    *runs: Annotated[Path, Parameter(name="RUN")],
    x: Annotated[
        tuple[str, ...], Parameter(consume_multiple=False, metavar="COLUMN", help=_X)
    ] = (),
    y: Annotated[tuple[str, ...], Parameter(consume_multiple=False, metavar="COLUMN")] = (),
    measured: Annotated[tuple[Path, ...], Parameter(consume_multiple=False, metavar="CSV")] = (),
    label: Annotated[
        tuple[str, ...], Parameter(consume_multiple=False, metavar="TEXT", help=_LABEL)
    ] = (),
    format: Annotated[FormatName | None, Parameter(metavar="pdf|svg|png")] = None,
    width: Annotated[str, Parameter(metavar="LENGTH")] = "85 mm",
    height: Annotated[str, Parameter(metavar="LENGTH")] = "",
    dpi: Annotated[float, Parameter(metavar="N")] = 300.0,
    font_size: Annotated[float, Parameter(metavar="N")] = 8.0,
    out: Annotated[Path | None, Parameter(help=_OUT)] = None,
    open: bool = False,
) -> int:
    """Draw a figure for a paper: curves of runs, sweeps and measured points.

    Without --x and --y it shows what the runs were made for over the pressure: the tip force of a
    blocked tip, the force of contact of a body that touches something, else the bending angle.

    Args:
        runs: Folders of runs or sweeps; each point of a sweep is a curve.
        x: Columns along the lower axis.
        y: Column along the left axis; repeatable, of one unit.
        measured: CSV file of measured points with the columns x and y; repeatable.
        label: Names of curves in the legend.
        format: pdf by default, or as --out ends.
        width: Width of the figure; 85 mm by default, one column of a journal.
        height: Height of the figure; 0.7 of its width by default, more for a long legend.
        dpi: Pixels per inch of a PNG; 300 by default.
        font_size: Size of the names of axes in pt, other text somewhat smaller; 8 by default.
        out: File.
        open: Show the figure.
    """
    from fiberbend.api.plot import Plot, select, write
    from fiberbend.drawing.style import Style

    if not runs:
        raise CaseError([Problem("RUN", "none, expected the folder of a run or of a sweep")])
    style = Style(
        _format(format, out),
        _length("--width", width),
        _length("--height", height) if height else None,
        _number("--dpi", dpi, _DPI, "dots per inch"),
        _number("--font-size", font_size, _FONT, "pt"),
    )
    settle_folders()
    shown: Plot = select(runs, x, y, measured, label)
    target = out
    if target is None:
        target = (runs[0] if len(runs) == 1 else Path()) / f"{shown.name}.{style.format}"
    figure = shown.draw(style)
    write(figure, target, style)
    across, up = (25.4 * inch for inch in figure.get_size_inches())
    curves = len(shown.curves)
    say(f"{target}: {across:.4g} mm × {up:.4g} mm, {curves} curve{'s' * (curves > 1)}")
    if open:
        from fiberbend.commands.opening import open_file

        open_file(target)
    return 0


def _format(name: FormatName | None, out: Path | None) -> FormatName:
    """The format that is asked for, by its name, by the ending of a file, or by both alike."""
    if out is None:
        return name or "pdf"
    known: tuple[FormatName, ...] = get_args(FormatName)
    ending = next((each for each in known if out.suffix.lower() == f".{each}"), None)
    if ending is None or (name is not None and name != ending):
        wanted = f".{name}" if name else "an ending .pdf, .svg or .png"
        raise CaseError([Problem("--out", f'"{out}", expected {wanted}')])
    return ending


def _length(option: str, text: str) -> float:
    """A length in mm."""
    least, most = _WIDTHS
    try:
        value = parse(text, "length")
    except ValueError as error:
        raise CaseError([Problem(option, f'"{text}", {error}')]) from None
    if not least <= value <= most:
        bounds = f"from {show(least, 'length')} to {show(most, 'length')}"
        raise CaseError([Problem(option, f'"{text}", expected a length {bounds}')])
    return value


def _number(option: str, value: float, bounds: tuple[float, float], unit: str) -> float:
    least, most = bounds
    if not least <= value <= most:
        text = f"{value:g}, expected {least:g} to {most:g} {unit}"
        raise CaseError([Problem(option, text)])
    return value

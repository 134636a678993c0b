"""Figures for a paper: curves of runs, of sweeps and of measured points in one plot."""

from __future__ import annotations

import dataclasses
import io
import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend import columns as col
from fiberbend.api.runs import (
    BLOCKED,
    RunData,
    SweepData,
    axis_label,
    check_column,
    common_label,
    names_of,
    read_source,
    unit_of,
    words_of,
)
from fiberbend.drawing.overlay import Curve, draw_overlay
from fiberbend.drawing.page import own_style, save
from fiberbend.drawing.style import Style
from fiberbend.process import remains
from fiberbend.results.folder import CASE_FILE, FILES, TABLE
from fiberbend.schema.problems import CaseError, Problem, found

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fiberbend.case.case import Case

PAPER = Style("pdf", width=85.0, dpi=300.0, font_size=8.0)
"""One column of a journal."""
Source = Path | str | RunData
"""A run or sweep folder, or a run that is in no folder."""
Columns = tuple[str, ...]


@dataclasses.dataclass(frozen=True)
class Plot:
    """What a figure shows.

    Attributes:
        x: columns along the lower axis, of one unit.
        y: columns along the left axis, of one unit.
        curves: runs first, measured points last.
        remark: what the values are, in the name of the left axis; may be empty.
    """

    x: tuple[str, ...]
    y: tuple[str, ...]
    curves: tuple[Curve, ...]
    remark: str = ""

    @property
    def name(self) -> str:
        """Name of a file for it, without an ending: "pressure_angle"."""
        return "_".join(_short(name) for name in (self.x[0], *self.y))

    def draw(self, style: Style) -> Figure:
        """A matplotlib figure.

        Raises:
            CaseError: the page is too small for its text.
        """
        up = axis_label(self.y[0]) if len(self.y) == 1 else common_label(self.y)
        if self.remark:
            up = f"{words_of(self.y[0])}, {self.remark} ({unit_of(self.y[0])})"
        try:
            with own_style():
                return draw_overlay(self.curves, axis_label(self.x[0]), up, style)
        except ValueError as error:
            width, height = (25.4 * inch for inch in style.inches)
            text = f"{width:.4g} mm × {height:.4g} mm at {style.font_size:g} pt: {error}"
            expected = "a larger page, a smaller font_size or fewer curves"
            raise CaseError([Problem("size", f"{text}, expected {expected}")]) from None


def plot(
    runs: Source | Sequence[Source],
    x: str | Sequence[str] = "",
    y: str | Sequence[str] = "",
    measured: Path | str | Sequence[Path | str] = (),
    target: Path | str | None = None,
    style: Style = PAPER,
    labels: Sequence[str] = (),
) -> Figure:
    """Draw curves of runs, sweeps and measured points in one figure.

    Args:
        runs: run folders, sweep folders, or runs without a folder.
        x: column of history.csv along the lower axis, or of a sweep's sweep.csv; the pressure
            unless given. Several of one unit, such as "pressure_kPa" and "section_kPa", show a run
            beside other models.
        y: one or several columns of one unit; by default the tip force of a blocked tip, the force
            of contact of a body that touches something, and the bending angle of any other run.
        measured: CSV files of measured points with the columns x and y.
        target: file to write; None: none is written.
        style: format, size and letters of the figure.
        labels: names of the curves in the legend, in their order, in place of what differs between
            the runs.

    Returns:
        The matplotlib figure.

    Raises:
        CaseError: no run, no such column, wrong measured data, too little room, or a file of a run
            as the target.
    """
    shown = select(runs, x, y, measured, labels)
    figure = shown.draw(style)
    if target is not None:
        write(figure, Path(target), style)
    return figure


def select(
    runs: Source | Sequence[Source],
    x: str | Sequence[str] = "",
    y: str | Sequence[str] = "",
    measured: Path | str | Sequence[Path | str] = (),
    labels: Sequence[str] = (),
) -> Plot:
    """Read what a figure shows; arguments and errors are those of `plot`."""
    sources = [
        source if isinstance(source, RunData) else read_source(Path(source))
        for source in ([runs] if isinstance(runs, Path | str | RunData) else runs)
    ]
    if not sources:
        raise CaseError([Problem("runs", "none, expected the folder of a run or of a sweep")])
    across, up = (tuple(filter(None, [c] if isinstance(c, str) else c)) for c in (x, y))
    all_runs = [run for s in sources for run in (s.points if isinstance(s, SweepData) else [s])]
    in_runs = {name for run in all_runs for name in run.columns}
    sweeps = [source for source in sources if isinstance(source, SweepData)]
    if sweeps and any(
        name not in in_runs and any(name in s.header for s in sweeps) for name in across + up
    ):
        across, up, curves = _of_tables(sources, across, up)
    else:
        across, up, curves = _of_runs(all_runs, across, up)
    files = [measured] if isinstance(measured, Path | str) else list(measured)
    case = all_runs[0].case if all_runs else None
    for file in map(Path, files):
        label = "measured" if len(files) == 1 else f"measured, {file.stem}"
        curves.append(_curve(label, _measured(file, across, up, case), measured=True))
    if len(labels) > len(curves):
        text = f"{len(labels)} labels, expected at most {len(curves)}, one for each curve"
        raise CaseError([Problem("labels", text)])
    remark = ""
    if up == (BLOCKED,):
        models = sorted({model for sweep in sweeps for model in sweep.force_models})
        remark = models[0] if len(models) == 1 else ""
    named = [dataclasses.replace(c, label=text) for c, text in zip(curves, labels, strict=False)]
    return Plot(across, up, (*named, *curves[len(named) :]), remark)


def write(figure: Figure, target: Path, style: Style) -> None:
    """Write a figure into a file; one that is there is replaced, unless it is a run's own.

    Raises:
        CaseError: the file belongs to a run, or cannot be written.
    """
    target = target.absolute()
    for folder in target.parents:
        inside = target.relative_to(folder).as_posix()
        if _owned(folder) and remains.matches(inside, FILES):
            text = f"is a file of the run in {folder}, expected another name"
            raise CaseError([Problem(str(target), text)])
    content = io.BytesIO()
    with own_style():
        save(figure, content, style)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content.getvalue())
    except OSError as error:
        text = f"{error.strerror}, expected a file that can be written"
        raise CaseError([Problem(str(target), text)]) from None


def _owned(folder: Path) -> bool:
    return any((folder / name).exists() for name in (CASE_FILE, TABLE, "control.json"))


def _of_runs(
    runs: Sequence[RunData], x: Columns, y: Columns
) -> tuple[Columns, Columns, list[Curve]]:
    """Curves of the histories of runs."""
    if not y:
        leading = {run.leading: run.name for run in runs}
        if len(leading) > 1:
            which = " and ".join(f"{name} ({run})" for name, run in leading.items())
            text = f"not given, the runs lead with {which}, expected one column for all of them"
            raise CaseError([Problem("y", text)])
        y = tuple(leading)
    if not x:
        # where other loads act at one pressure, there is nothing to see over it
        inflated = any(len({*run.pairs(col.PRESSURE, col.PRESSURE)}) > 1 for run in runs)
        x = (col.PRESSURE,) if inflated else (col.STEP,)
        x = (col.ANGLE,) if y == (col.PRESSURE,) else x
    _one_unit(x, y)
    for run in runs:
        for place, name in _places(x, y):
            check_column(place, name, run.columns, f"the history of {run.name}")
    curves = []
    for run, label in zip(runs, names_of(runs), strict=True):
        for along, name in itertools.product(x, y):
            pairs = run.pairs(along, name)
            if not pairs:
                text = f"{found(name)}, no row of {run.name} has it beside {along}"
                raise CaseError([Problem("y", f"{text}, expected columns of the same rows")])
            parts = [label] if len(runs) > 1 else []
            parts += [run.teller(along)] if len(x) > 1 else []
            parts += [words_of(name)] if len(y) > 1 else []
            curves.append(_curve(", ".join(parts) or label, pairs))
    return x, y, curves


def _of_tables(
    sources: Sequence[RunData | SweepData], x: Columns, y: Columns
) -> tuple[Columns, Columns, list[Curve]]:
    """Curves of the tables of sweeps."""
    curves = []
    for source in sources:
        if isinstance(source, RunData):
            text = (
                f"is a run, columns of {TABLE} are in sweeps only, expected the folder of a sweep"
            )
            raise CaseError([Problem(source.name, text)])
        where = f"{TABLE} of {source.name}"
        x = x or tuple(source.varied[:1])
        if not y:
            raise CaseError(
                [Problem("y", f"not given, expected one of {', '.join(source.numbers)}")]
            )
        for place, name in _places(x, y):
            check_column(place, name, source.numbers, where)
        for along, name in itertools.product(x, y):
            for shared, pairs in source.curves(along, name).items():
                parts = [source.name] if len(sources) > 1 else []
                parts += [words_of(along)] if len(x) > 1 else []
                parts += [words_of(name)] if len(y) > 1 else []
                parts += [shared] if shared else []
                curves.append(_curve(", ".join(parts) or source.name, pairs))
    _one_unit(x, y)
    if not curves:
        raise CaseError([Problem("y", f"{found(y[0])}, no point has it, expected solved points")])
    return x, y, curves


def _curve(label: str, pairs: Sequence[tuple[float, float]], measured: bool = False) -> Curve:
    across, up = zip(*pairs, strict=True)
    return Curve(label, across, up, measured)


def _places(x: Columns, y: Columns) -> list[tuple[str, str]]:
    return [*(("x", name) for name in x), *(("y", name) for name in y)]


def _one_unit(x: Columns, y: Columns) -> None:
    for place, names in (("x", x), ("y", y)):
        units = {name: unit_of(name) for name in names}
        if len({*units.values()}) > 1:
            given = ", ".join(f"{name} in {unit or 'no unit'}" for name, unit in units.items())
            raise CaseError([Problem(place, f"{given}, expected columns of one unit")])


def _measured(
    file: Path, x: Columns, y: Columns, case: Mapping[str, Any] | None
) -> list[tuple[float, float]]:
    """Measured points: as a case reads them where it can, other columns by their names.

    Of several columns those are measured that are named first.
    """
    from analytic.table import read_columns

    pair = (x[0], y[0])
    checked = _with_measured(case, file, pair) if case is not None else None
    if checked is not None:
        from fiberbend.case.measured import read_measured

        points = read_measured(checked)
        if points is not None:
            pressure, value = points.shown()
            order = (pressure, value) if x[0] == col.PRESSURE else (value, pressure)
            return list(zip(*(part.tolist() for part in order), strict=True))
    try:
        return [(a, b) for a, b in read_columns(file, pair)]
    except FileNotFoundError:
        text = f"no such file, expected a CSV file with columns {x[0]} and {y[0]}"
    except OSError as error:
        text = f"{error.strerror}, expected a CSV file with columns {x[0]} and {y[0]}"
    except ValueError as error:
        text = f"{error}, expected columns {x[0]} and {y[0]}"
    raise CaseError([Problem(str(file), text)])


def _with_measured(case: Mapping[str, Any], file: Path, columns: tuple[str, str]) -> Case | None:
    """A case that names a file of measured points; None where its run shows something else.

    Raises:
        CaseError: what is wrong with the file.
    """
    from fiberbend.case.measured import expected_quantity
    from fiberbend.reader.reader import parse_case

    output = {key: value for key, value in case.get("output", {}).items() if key != "measured"}
    try:
        plain = parse_case({**case, "output": output})
    except CaseError:
        # of another version
        return None
    if {*columns} != {col.PRESSURE, expected_quantity(plain.straight)}:
        return None
    output["measured"] = str(file.absolute())
    try:
        return parse_case({**case, "output": output})
    except CaseError as error:
        raise CaseError(_of_file(problem, file) for problem in error.problems) from None


def _of_file(problem: Problem, file: Path) -> Problem:
    """A problem of a case's measured points as one of the file, which it names once."""
    if not problem.path.startswith("output.measured"):
        return problem
    return Problem(str(file), problem.text.removeprefix(file.name).lstrip(":, "))


def _short(name: str) -> str:
    """A column in the name of a file, without its unit."""
    return name.rsplit("_", 1)[0] if unit_of(name) else name

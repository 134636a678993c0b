"""What can be drawn of run folders and sweep folders: their columns, and curves of them."""

from __future__ import annotations

import dataclasses
import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from fiberbend import columns as col
from fiberbend.drawing.curves import SMALL_ANGLE, contact_forces
from fiberbend.reader.yaml_file import load_yaml
from fiberbend.results.folder import CASE_FILE, HISTORY_FILE, POINTS, TABLE
from fiberbend.results.reading import read_history, read_table
from fiberbend.schema.paths import differences, value_at
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.sweep.fields import labels
from fiberbend.sweep.quantities import FORCE_MODEL

BLOCKED = "blocked_force_N"
_FIRST, _STATUS = "point", "status"
"""Columns of sweep.csv before and after those of the varied fields."""
_BESIDE = ("title", "output", "compare")
"""Parts of a case in which two runs may differ and be runs of the same thing."""
_MOST = 2
"""So many differences at most name a run."""
_FORCE = re.compile(r"contact_(.+)_force_N")
_AT = re.compile(r"(.*pressure|.*angle)_([-+.\de]+)(deg|kPa)_(?:kPa|deg)")
"""Columns of a sweep's table at an asked state: "pressure_360deg_kPa"."""
_WORDS = {
    col.PRESSURE: "pressure P",
    col.ANGLE: "bending angle θ",
    col.VOLUME: "chamber volume",
    col.MOMENT: "moment kept straight",
    col.STEP: "load step",
}
_KINDS = {
    "kPa": "pressure",
    "MPa": "pressure",
    "°": "angle",
    "mm": "length",
    "mm²": "area",
    "mm³": "volume",
    "N": "force",
    "N mm": "moment",
    "mJ": "energy",
    "s": "time",
}
_UNITS = {
    "kPa": "kPa",
    "MPa": "MPa",
    "deg": "°",
    "mm": "mm",
    "mm2": "mm²",
    "mm3": "mm³",
    "N": "N",
    "Nmm": "N mm",
    "mJ": "mJ",
    "s": "s",
}


@dataclasses.dataclass(frozen=True)
class RunData:
    """A run, as far as its curves go.

    Attributes:
        name: of the run, that of its folder.
        case: its resolved case.
        rows: of its history.
    """

    name: str
    case: Mapping[str, Any]
    rows: Sequence[col.Row]

    @property
    def columns(self) -> list[str]:
        """Columns with a value in some row, and the whole force of every obstacle."""
        names = dict.fromkeys(key for row in self.rows for key in row)
        known = [name for name in names if any(row.get(name) is not None for row in self.rows)]
        forces = [f"contact_{force.name}_force_N" for force in contact_forces(self.rows)]
        return [*known, *(name for name in forces if name not in known)]

    @property
    def leading(self) -> str:
        """The column that the run was made for: a force where there is one, or the angle."""
        if col.TIP_FORCE in self.columns:
            return col.TIP_FORCE
        for force in contact_forces(self.rows):
            if force.acts:
                return f"contact_{force.name}_force_N"
        turned = {
            name: max(abs(row[name]) for row in self.rows if row.get(name) is not None)
            for name in (col.ANGLE, col.TWIST)
            if name in self.columns
        }
        if turned.get(col.ANGLE, 0.0) <= SMALL_ANGLE < turned.get(col.TWIST, 0.0):
            return col.TWIST
        return col.ANGLE

    def teller(self, name: str) -> str:
        """Who gives a column: another model beside the run, or the run's own."""
        try:
            beside = col.column(name).beside
        except KeyError:
            beside = False
        if beside:
            return words_of(name)
        model = self.case.get("model", "auto")
        return words_of(name) if name != col.PRESSURE or model == "auto" else str(model)

    def pairs(self, x: str, y: str) -> list[tuple[float, float]]:
        """Values of two columns in the rows that have both."""
        values = zip(self._values(x), self._values(y), strict=True)
        return [(a, b) for a, b in values if a is not None and b is not None]

    def _values(self, name: str) -> list[float | None]:
        match = _FORCE.fullmatch(name)
        if match is None or any(name in row for row in self.rows):
            return [row.get(name) for row in self.rows]
        parts = [
            (row.get(col.contact(match[1], "y_N")), row.get(col.contact(match[1], "z_N")))
            for row in self.rows
        ]
        if all(y is None for y, _ in parts):
            # a strip that is kept in place has a force and no obstacle
            column = col.ROOF_FORCE if match[1] == "roof" else col.TIP_FORCE
            return [row.get(column) for row in self.rows]
        return [None if y is None or z is None else float((y**2 + z**2) ** 0.5) for y, z in parts]


@dataclasses.dataclass(frozen=True)
class SweepData:
    """The folder of a sweep.

    Attributes:
        name: of the folder.
        header: columns of its table; none where the sweep has not ended.
        rows: of its table, as text.
        points: the runs of its points.
    """

    name: str
    header: Sequence[str]
    rows: Sequence[Mapping[str, str]]
    points: Sequence[RunData]

    @property
    def varied(self) -> list[str]:
        """Columns of the varied fields."""
        names = list(self.header)
        end = names.index(_STATUS) if _STATUS in names else len(names)
        return [name for name in names[:end] if name != _FIRST]

    @property
    def numbers(self) -> list[str]:
        """Columns of numbers."""
        return [
            name for name in self.header if any(_number(row, name) is not None for row in self.rows)
        ]

    @property
    def force_models(self) -> list[str]:
        """What the blocked forces of its points are."""
        return sorted({row[FORCE_MODEL] for row in self.rows if row.get(FORCE_MODEL)})

    def curves(self, x: str, y: str) -> dict[str, list[tuple[float, float]]]:
        """A column over another one, a curve for each group of points that differ in x alone.

        Returns:
            Points in the order of x, by what a group shares; empty for what all share.
        """
        rest = [
            name
            for name in self.varied
            if name not in (x, y) and len({row[name] for row in self.rows}) > 1
        ]
        # forces of a section and of a closed form are no curve
        kinds = [FORCE_MODEL] if y == BLOCKED and len(self.force_models) > 1 else []
        groups: dict[str, list[tuple[float, float]]] = {}
        for row in self.rows:
            a, b = _number(row, x), _number(row, y)
            if a is not None and b is not None:
                parts = [_described(name, row[name]) for name in rest]
                shared = ", ".join([*parts, *(row.get(name, "") for name in kinds)])
                groups.setdefault(shared, []).append((a, b))
        return {shared: sorted(points) for shared, points in groups.items()}


def read_source(path: Path) -> RunData | SweepData:
    """What is in the folder of a run or of a sweep.

    Raises:
        CaseError: neither, or nothing that can be drawn yet.
    """
    if not path.is_dir():
        what = "is a file" if path.exists() else "no such folder"
        raise CaseError([Problem(str(path), f"{what}, expected the folder of a run or of a sweep")])
    if (path / CASE_FILE).exists():
        if not (path / HISTORY_FILE).exists():
            text = f"contains no {HISTORY_FILE}, expected a run that has solved a load step"
            raise CaseError([Problem(str(path), text)])
        return _run(path)
    if (path / TABLE).exists() or (path / POINTS).is_dir():
        return _sweep(path)
    raise CaseError(
        [Problem(str(path), "contains no run, expected the folder of a run or of a sweep")]
    )


def _run(path: Path) -> RunData:
    rows = read_history(path / HISTORY_FILE)
    return RunData(path.resolve().name, load_yaml(path / CASE_FILE), rows)


def _sweep(path: Path) -> SweepData:
    header: list[str] = []
    rows: list[dict[str, str]] = []
    if (path / TABLE).exists():
        header, rows = read_table(path)
    folders = sorted((path / POINTS).glob("*/"))
    if header:
        # in the order of the sweep
        folders = [path / POINTS / row[_FIRST] for row in rows if row.get(_FIRST)]
    points = [
        _run(folder)
        for folder in folders
        if (folder / CASE_FILE).exists() and (folder / HISTORY_FILE).exists()
    ]
    if not points and not rows:
        raise CaseError([Problem(str(path), "no point is solved, expected a sweep with results")])
    return SweepData(path.resolve().name, header, rows, points)


def names_of(runs: Sequence[RunData]) -> list[str]:
    """How runs are told apart: by what differs between their cases, by title, or by folder."""
    paths = list(
        dict.fromkeys(
            path
            for run in runs[1:]
            for path in differences(runs[0].case, run.case)
            if path.split(".")[0] not in _BESIDE
        )
    )
    if paths and len(paths) <= _MOST:
        words = labels(paths)
        values = [[value_at(run.case, path) for path in paths] for run in runs]
        if all(not isinstance(v, dict | list) for row in values for v in row):
            shown = [
                ", ".join(_value(words[path], v) for path, v in zip(paths, row, strict=True))
                for row in values
            ]
            if len({*shown}) == len(runs):
                return shown
    titles = [str(run.case.get("title") or "") for run in runs]
    if all(titles) and len({*titles}) == len(runs):
        return titles
    names = [run.name for run in runs]
    if len({*names}) == len(runs):
        return names
    return [f"{number}: {name}" for number, name in enumerate(names, start=1)]


def axis_label(name: str) -> str:
    """A column as the name of an axis, with its unit: "pressure P (kPa)"."""
    try:
        unit = col.column(name).unit
    except KeyError:
        unit = unit_of(name)
    return f"{words_of(name)} ({unit})" if unit else words_of(name)


def common_label(names: Sequence[str]) -> str:
    """Several columns of one unit as the name of an axis: "force (N)"."""
    unit = unit_of(names[0])
    return f"{_KINDS[unit]} ({unit})" if unit else "value"


def words_of(name: str) -> str:
    """A column in words, without its unit: "chamber volume"."""
    end = name.rsplit("_", 1)[-1]
    stem = name.removesuffix(f"_{end}") if end in _UNITS else name
    force, at = _FORCE.fullmatch(name), _AT.fullmatch(name)
    words = f"force of the {force[1]}" if force else _WORDS.get(name, stem)
    if at:
        words = f"{at[1]} at {at[2]}{'°' if at[3] == 'deg' else ' kPa'}"
    return words.replace("_", " ")


def unit_of(name: str) -> str:
    """The unit that ends the name of a column; empty for none."""
    return _UNITS.get(name.rsplit("_", 1)[-1], "")


def check_column(place: str, name: str, known: Iterable[str], where: str) -> None:
    """Refuse a column that is not there, with the nearest names and the list.

    Args:
        place: what asks for it, "x" or "y".
        name: of the column.
        known: those that are there.
        where: they are.

    Raises:
        CaseError: it is not among them.
    """
    known = list(known)
    if name in known:
        return
    close = difflib.get_close_matches(name, known, n=3)
    meant = f"; did you mean {' or '.join(close)}?" if close else ""
    text = f"{found(name)}, no such column in {where}{meant} Expected one of {', '.join(known)}"
    raise CaseError([Problem(place, text if close else text.replace(" Expected", ", expected"))])


def _number(row: Mapping[str, str], name: str) -> float | None:
    try:
        return float(row.get(name) or "")
    except ValueError:
        return None


def _described(name: str, value: str) -> str:
    unit = unit_of(name)
    stem = name.rsplit("_", 1)[0] if unit else name
    return f"{stem.replace('_', ' ')} {value or 'none'}{' ' + unit if unit and value else ''}"


def _value(word: str, value: Any) -> str:
    word = word.replace("_", " ").replace(".", " ")
    if value is None:
        return f"no {word}"
    if isinstance(value, bool):
        return f"{word}: {'yes' if value else 'no'}"
    if isinstance(value, str) and not value[:1].isdigit():
        return f"{value} {word}"
    return f"{word} {value}"

"""What `fiberbend.sweep` returns, and `fiberbend.load` of a sweep's folder."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from fiberbend.results.folder import POINTS, REPORT, TABLE, RunFolder
from fiberbend.results.reading import read_table
from fiberbend.schema.problems import CaseError, Problem, found

if TYPE_CHECKING:
    import pandas as pd

    from fiberbend.api.result import Result

Cell = float | str | None
"""A number, a text, or None of an empty cell."""


class Points(Mapping[str, "Result"]):
    """The runs of a sweep by the names of their points, each read when it is asked for.

    Args:
        path: folder of the sweep.
        read: reads the folder of a run.
    """

    def __init__(self, path: Path, read: Callable[[Path], Result]) -> None:
        self._path, self._read = path / POINTS, read

    def __getitem__(self, name: str) -> Result:
        if name not in self._names:
            raise KeyError(f"{name!r}, expected one of {', '.join(self._names) or 'no point'}")
        return self._read(self._path / name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @functools.cached_property
    def _names(self) -> tuple[str, ...]:
        if not self._path.is_dir():
            return ()
        return tuple(sorted(entry.name for entry in self._path.iterdir() if entry.is_dir()))


class Sweep:
    """A sweep in its folder: its table, and the run of every point.

    Args:
        folder: the folder.
        read: reads the folder of a run.

    Attributes:
        folder: as given.
        points: the runs that have begun, by name; of a point with the same body kept straight,
            `fiberbend.load(result.folder / "blocked")` gives that one.
    """

    def __init__(self, folder: Path, read: Callable[[Path], Result]) -> None:
        self.folder = folder
        self.points = Points(folder, read)

    @functools.cached_property
    def rows(self) -> tuple[dict[str, Cell], ...]:
        """The rows of sweep.csv, one a point, in the order of the sweep; units in their names.

        Raises:
            CaseError: the sweep has no table yet, or one that cannot be read.
        """
        _, rows = read_table(self.folder)
        return tuple({name: _value(text) for name, text in row.items()} for row in rows)

    @functools.cached_property
    def frame(self) -> pd.DataFrame:
        """The table as a pandas.DataFrame, a row a point; columns without text are float64."""
        import pandas as pd

        frame = pd.DataFrame(list(self.rows))
        names = {*frame} - {name for row in self.rows for name in row if isinstance(row[name], str)}
        return frame.astype(dict.fromkeys(names, float))

    @property
    def status(self) -> dict[str, int]:
        """How many points ended how, 'converged', 'stopped', 'failed' or 'not run'."""
        names = [str(row["status"]) for row in self.rows]
        return {name: names.count(name) for name in dict.fromkeys(names)}

    def point(self, **values: float | str) -> Result:
        """The run of the point whose columns of the table have given values.

        Args:
            values: by column, `sweep.point(wall_mm=2, radius_mm=8)`.

        Raises:
            CaseError: no such column, no such point, or several.
        """
        unknown = [name for name in values if self.rows and name not in self.rows[0]]
        if unknown:
            known = ", ".join(self.rows[0])
            raise CaseError([Problem(unknown[0], f"no column of sweep.csv, expected {known}")])
        named = [row for row in self.rows if all(_alike(row[n], v) for n, v in values.items())]
        if len(named) != 1:
            text = f"{found(values)}: {len(named)} points of {len(self.rows)}, expected one"
            raise CaseError([Problem("point", text)])
        return self.points[str(named[0]["point"])]

    def report(self, out: Path | str | None = None) -> Path:
        """Write the sweep's page, one HTML file that needs no network.

        Args:
            out: the file; report.html in the folder of the sweep unless given.

        Returns:
            Where it is.

        Raises:
            CaseError: the sweep has no table yet.
        """
        from fiberbend.report.page import links_to
        from fiberbend.report.sweep_page import sweep_report, write_sweep_report

        if out is None:
            write_sweep_report(RunFolder(self.folder))
            return self.folder / REPORT
        target = Path(out)
        page = sweep_report(self.folder, links=links_to(self.folder, target))
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(page, encoding="utf-8")
        return target

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def complete(self) -> bool:
        """Whether it has its table."""
        return (self.folder / TABLE).exists()

    def _repr_html_(self) -> str:
        """How the points ended, and the table, as a notebook shows it."""
        from fiberbend.api import shown

        return shown.sweep(self)

    def __repr__(self) -> str:
        """How the points ended, and where they are."""
        if not self.complete:
            return f"<Sweep without a table, {len(self.points)} points begun, in {self.folder}>"
        ends = ", ".join(f"{number} {name}" for name, number in self.status.items())
        return f"<Sweep of {len(self)} points: {ends}, in {self.folder}>"


def _value(text: str) -> Cell:
    try:
        return float(text)
    except ValueError:
        return text or None


def _alike(cell: Cell, value: float | str) -> bool:
    if isinstance(cell, float) and not isinstance(value, str):
        return abs(cell - value) <= 1e-9 * max(abs(cell), abs(value))
    return cell == value

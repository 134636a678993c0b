"""A pressure over time that a case reads from a CSV file, checked when it is read."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

from analytic.table import read_table
from fiberbend.case.measured import PRESSURE, Wanted, place_of, unit_of
from fiberbend.schema.units import factor, show

_COLUMNS = (
    Wanted("time_s", "time", frozenset({"time", "t"}), "t [ms]", setting=""),
    dataclasses.replace(PRESSURE, setting=""),
)
_WANTED = "columns time_s and pressure_kPa"
MOST = 100_000
"""Rows of a file: a case keeps them all."""


def points(path: Path) -> dict[str, Any]:
    """What a file says, as a case gives it in its place.

    Args:
        path: CSV file with columns of times and pressures and their units.

    Returns:
        Values of a `fiberbend.case.timed.spec.PointsSpec`, with units.

    Raises:
        ValueError: what was found and what was expected; begins with the file's name.
    """
    try:
        table = read_table(path)
        places = [place_of(table, wanted, None) for wanted in _COLUMNS]
        factors = [
            factor(unit_of(table, wanted, table.columns[place], None), wanted.kind)
            for wanted, place in zip(_COLUMNS, places, strict=True)
        ]
        rows = table.values(places)
    except OSError as error:
        missing = isinstance(error, FileNotFoundError)
        said = "no such file" if missing else error.strerror
        raise ValueError(f'"{path}", {said}, expected a CSV file with {_WANTED}') from None
    except ValueError as error:
        text = str(error)
        raise ValueError(text if "expected" in text else f"{text}, expected {_WANTED}") from None
    if not 2 <= len(rows) <= MOST:
        raise ValueError(f"{path.name}: {len(rows)} rows, expected from 2 to {MOST}")
    if rows[0][0] != 0:
        first = show(factors[0] * rows[0][0], "time")
        raise ValueError(f"{path.name}: times begin at {first}, expected 0")
    for number in range(1, len(rows)):
        if not rows[number][0] > rows[number - 1][0]:
            before, after = (f"{rows[i][0]:.9g}" for i in (number - 1, number))
            line = table.rows[number][0]
            name = table.columns[places[0]]
            raise ValueError(
                f"{path.name}, line {line}: {name!r} is {after} after {before}, expected rising "
                "times"
            )
    times, pressures = (
        [show(scale * row[place], kind) for row in rows]
        for place, (scale, kind) in enumerate(zip(factors, ("time", "pressure"), strict=True))
    )
    return {"times": times, "pressures": pressures, "source": path.name}

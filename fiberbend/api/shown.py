"""Runs, sweeps and readings as a notebook shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fiberbend import columns as col
from fiberbend.api.reading import Reading
from fiberbend.api.runs import axis_label
from fiberbend.notebook import blocks

if TYPE_CHECKING:
    from fiberbend.api.result import Result
    from fiberbend.api.sweep import Sweep

_COLUMNS = (col.STEP, col.PRESSURE, col.ANGLE, col.TIP_FORCE, col.TIP_Y, col.TIP_Z)
"""Of the load steps."""
_MOST = 6
"""Columns of results of a sweep that are shown."""


def run(result: Result) -> str:
    """A run: its end, its curve, its answer and its load steps."""
    title, rows = result.case.title or f"A run of the {result.model} model", result.rows
    ended = []
    if result.status != "converged":
        ended = [blocks.warning(": ".join(filter(None, (result.status, result.reason))))]
    kept = blocks.words("" if result.folder is None else f"Files in {result.folder}")
    if not rows:
        return blocks.block(title, *ended, blocks.words("No load step."), kept)
    data = result.drawn()
    across, up = col.PRESSURE, data.leading
    picture = blocks.curve(data.pairs(across, up), axis_label(across), axis_label(up))
    names = [name for name in _COLUMNS if any(row.get(name) is not None for row in rows)]
    number = len(rows) - 1
    steps = blocks.folded(
        f"{number} load step{'' if number == 1 else 's'}",
        blocks.table(
            [*map(axis_label, names)], [[row.get(name) for name in names] for row in rows]
        ),
        blocks.words(f"All {len({key for row in rows for key in row})} columns: .frame"),
    )
    return blocks.block(title, *ended, *result.answer.shown(picture), steps, kept)


def sweep(found: Sweep) -> str:
    """A sweep: how its points ended, and its table; of one without a table how many began."""
    if not found.complete or not found.rows:
        began = f"{len(found.points)} points begun, no table yet"
        return blocks.block("A sweep", blocks.warning(began), blocks.words(f"In {found.folder}"))
    rows = found.rows
    columns = [name for name in rows[0] if any(row[name] is not None for row in rows)]
    end = columns.index("status")
    varied, results = columns[1:end], columns[end + 1 :]
    names = [*varied, *results[:_MOST], "status"]
    ends = ", ".join(f"{number} {name}" for name, number in found.status.items())
    more = len(results) - _MOST
    return blocks.block(
        f"A sweep of {len(rows)} points: {ends}",
        blocks.table(
            [*map(axis_label, names)], [[_whole(row[name]) for name in names] for row in rows]
        ),
        blocks.words(f"{more} more columns: .frame" if more > 0 else ""),
        blocks.words(f"Files in {found.folder}"),
    )


def reading(found: Reading) -> str:
    """The values of a run in one state."""
    values: list[tuple[str, Any]] = [(axis_label(name), _whole(v)) for name, v in found.items()]
    listed = blocks.table(("column", "value"), values, most=len(values))
    return blocks.block(f"{found.at}, {found.where}", listed)


def _whole(value: float | str | None) -> float | int | str | None:
    """A number without digits after its point as a whole one."""
    return int(value) if isinstance(value, float) and value.is_integer() else value

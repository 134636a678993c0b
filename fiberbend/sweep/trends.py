"""How the results of a sweep change with each varied field while the others stay."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.sweep.fields import VariedField
from fiberbend.sweep.table import ReportedQuantity, TableRow
from geometry.mesh.data import Floats

INSENSITIVE = 0.01
"""A relative change from the least to the greatest value that counts as none."""


@dataclasses.dataclass(frozen=True)
class Group:
    """Points that differ in one field only.

    Attributes:
        shared: the values of the other fields, as text such as "length 160 mm".
        x: values of the field, rising, (n,).
        rows: the rows of the table, (n,).
    """

    shared: str
    x: Floats
    rows: tuple[TableRow, ...]

    def values(self, name: str) -> Floats:
        """A column of the rows, nan where it is empty, (n,)."""
        found = [row.get(name) for row in self.rows]
        return np.array([np.nan if value is None else value for value in found], dtype=float)


def groups(
    columns: Sequence[VariedField], rows: Sequence[TableRow], column: VariedField
) -> list[Group]:
    """All groups of two points or more along a numeric field, the largest first.

    Args:
        columns: all varied fields.
        rows: the table.
        column: the field along which the points of a group differ.
    """
    others = [other for other in columns if other is not column]
    found: dict[tuple[Any, ...], list[TableRow]] = {}
    for row in rows:
        found.setdefault(tuple(row[other.name] for other in others), []).append(row)
    result = []
    for values, members in found.items():
        ordered = sorted(members, key=lambda row: float(row[column.name]))
        if len(ordered) > 1:
            x = np.array([row[column.name] for row in ordered], dtype=float)
            pairs = zip(others, values, strict=True)
            shared = ", ".join(described(other, value) for other, value in pairs)
            result.append(Group(shared, x, tuple(ordered)))
    return sorted(result, key=lambda group: -len(group.x))


def described(column: VariedField, value: Any) -> str:
    """A field with its value, "length 160 mm"."""
    shown = f"{value:g}" if isinstance(value, float) else value
    return " ".join(str(part) for part in (in_words(column), shown, column.unit) if part)


def in_words(column: VariedField) -> str:
    """The name of a field in words."""
    return column.label.replace("_", " ").replace(".", " ")


def sign(found: Sequence[Group], name: str) -> str:
    """How a column changes along a field, over all groups that have values of it.

    Returns:
        ↑ or ↓ where it rises or falls throughout, ∪ or ∩ where it turns once, ~ oftener, — where
        it stays, each with the number of groups where they differ, and the relative changes from
        the least to the greatest value of the field; empty where nothing is known.
    """
    known = [group.values(name) for group in found]
    known = [y[~np.isnan(y)] for y in known]
    known = [y for y in known if len(y) > 1]
    if not known:
        return ""
    counts = Counter(_shape(y) for y in known)
    shapes = ", ".join(f"{shape} {n}" if len(counts) > 1 else shape for shape, n in counts.items())
    changes = [100 * (y[-1] / y[0] - 1) for y in known]
    ends = dict.fromkeys(f"{bound:+.1f} %" for bound in (min(changes), max(changes)))
    return f"{shapes} ({' … '.join(ends)})".replace("-", "−")


def _shape(y: Floats) -> str:
    if np.ptp(y) < INSENSITIVE * abs(y[0]):
        return "—"
    rises = np.diff(y) > 0
    turns = int(np.count_nonzero(np.diff(rises)))
    if turns > 1:
        return "~"
    return ("↑" if rises[0] else "↓") if turns == 0 else ("∩" if rises[0] else "∪")


def as_markdown(
    columns: Sequence[VariedField], rows: Sequence[TableRow], quantities: Sequence[ReportedQuantity]
) -> str:
    """A table of the signs for each quantity.

    Args:
        columns: the varied fields; those that are no numbers are left out.
        rows: the table of the sweep.
        quantities: those of the table.
    """
    along = [(column, groups(columns, rows, column)) for column in columns if column.numeric]
    blocks = []
    for quantity in quantities:
        lines = [
            f"| {quantity.axis}; increase in | groups | " + " | ".join(quantity.lines) + " |",
            "|" + "---|" * (len(quantity.lines) + 2),
        ]
        for column, found in along:
            if found:
                values = ", ".join(f"{x:g}" for x in sorted({x for g in found for x in g.x}))
                cells = [sign(found, name) for name in quantity.lines.values()]
                lines.append(
                    f"| {described(column, values)} | {len(found)} | " + " | ".join(cells) + " |"
                )
        blocks.append("\n".join(lines) + "\n")
    return "\n".join(blocks)

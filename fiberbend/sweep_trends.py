"""How the results of a sweep change with each varied field while the others stay."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.sweep_fields import Column
from fiberbend.sweep_table import Quantity, Row
from geometry.mesh import Floats

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
    rows: tuple[Row, ...]

    def values(self, name: str) -> Floats:
        """A column of the rows, nan where it is empty, (n,)."""
        found = [row.get(name) for row in self.rows]
        return np.array([np.nan if value is None else value for value in found], dtype=float)


def groups(columns: Sequence[Column], rows: Sequence[Row], column: Column) -> list[Group]:
    """All groups of two points or more along a numeric field, the largest first.

    Args:
        columns: all varied fields.
        rows: the table.
        column: the field along which the points of a group differ.
    """
    others = [other for other in columns if other is not column]
    found: dict[tuple[Any, ...], list[Row]] = {}
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


def described(column: Column, value: Any) -> str:
    """A field with its value, "length 160 mm"."""
    shown = f"{value:g}" if isinstance(value, float) else value
    return " ".join(str(part) for part in (spoken(column), shown, column.unit) if part)


def spoken(column: Column) -> str:
    """The name of a field as one says it."""
    return column.label.replace("_", " ").replace(".", " ")


def sign(found: Sequence[Group], name: str) -> str:
    """Whether a column rises (↑), falls (↓), stays (—) or does neither (mixed) along a field.

    Returns:
        The sign, with the relative changes from the least to the greatest value of the field over
        all groups; empty where nothing is known.
    """
    changes, signs = [], set()
    for group in found:
        y = group.values(name)
        y = y[~np.isnan(y)]
        if len(y) < 2:
            continue
        change = y[-1] / y[0] - 1
        changes.append(100 * change)
        steps = np.diff(y)
        if np.ptp(y) < INSENSITIVE * abs(y[0]):
            signs.add("—")
        elif np.all(steps > 0) or np.all(steps < 0):
            signs.add("↑" if steps[0] > 0 else "↓")
        else:
            signs.add("mixed")
    if not changes:
        return ""
    low, high = (f"{bound:+.1f} %" for bound in (min(changes), max(changes)))
    span = low if low == high else f"{low} to {high}"
    only = signs.pop() if len(signs) == 1 else "mixed"
    return f"{only} ({span.replace('-', '−')})"


def as_markdown(
    columns: Sequence[Column], rows: Sequence[Row], quantities: Sequence[Quantity]
) -> str:
    """Table of the signs.

    Args:
        columns: the varied fields; those that are no numbers are left out.
        rows: the table of the sweep.
        quantities: what to tell of each field.
    """
    shown = {
        f"{quantity.label}, {caption}": name
        for quantity in quantities
        for caption, name in quantity.lines.items()
    }
    lines = [
        "| increase in | groups | " + " | ".join(shown) + " |",
        "|" + "---|" * (len(shown) + 2),
    ]
    for column in columns:
        found = groups(columns, rows, column) if column.numeric else []
        if found:
            values = ", ".join(f"{x:g}" for x in sorted({x for g in found for x in g.x}))
            label = described(column, values)
            cells = [sign(found, name) for name in shown.values()]
            lines.append(f"| {label} | {len(found)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"

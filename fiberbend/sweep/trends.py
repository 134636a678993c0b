"""How the results of a sweep change with each varied field while the others stay."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.sweep.fields import VariedField, shown
from fiberbend.sweep.quantities import ReportedQuantity, TableRow
from geometry.mesh.data import Floats

INSENSITIVE = 0.01
"""A relative change from the least to the greatest value that counts as none."""
_ROUND_OFF = 1e-9
"""Part of the greatest value, or of the whole change, that no solver keeps."""
_WORDS = {
    "↑": "rises",
    "↓": "falls",
    "∩": "has a greatest value in between",
    "∪": "has a least value in between",
    "~": "turns more than once",
    "—": "stays within 1 %",
}
_KEY = (
    "A group of points differs in one field alone. ↑ rises, ↓ falls, ∩ rises, then falls, ∪ falls, "
    "then rises, ~ turns more than once, — stays within 1 %, each with the number of its groups; "
    "in brackets the change from the first to the last value.\n"
)


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
    return " ".join(part for part in (in_words(column), shown(value), column.unit) if part)


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
    known = _known(found, name)
    if not known:
        return ""
    counts = Counter(_shape(y) for y in known)
    shapes = ", ".join(f"{shape} {n}" if len(counts) > 1 else shape for shape, n in counts.items())
    changes = _changes(found, name, " … ")
    return f"{shapes} ({changes})" if changes else shapes


def in_a_sentence(column: VariedField, found: Sequence[Group], name: str) -> str:
    """The same as `sign` in words, "radius 6 to 12 mm: falls in 7 of 9 groups, …"; or empty."""
    known = _known(found, name)
    if not known:
        return ""
    counts = Counter(_shape(y) for y in known)
    total = len(known)
    if len(counts) == 1:
        where = "" if total == 1 else " in both groups" if total == 2 else f" in all {total} groups"
        shapes = _WORDS[next(iter(counts))] + where
    else:
        (first, most), *others = counts.most_common()
        shapes = f"{_WORDS[first]} in {most} of {total} groups"
        shapes += "".join(f", {_WORDS[shape]} in {n}" for shape, n in others)
    ends = sorted({float(x) for group in found for x in group.x})
    unit = f" {column.unit}" if column.unit else ""
    span = f"{in_words(column)} {ends[0]:g} to {ends[-1]:g}{unit}"
    changes = _changes(found, name, " to ")
    text = f"{span}: {shapes}" + (f"; from first to last {changes}" if changes else "")
    lacking = len(found) - sum(_whole(group.values(name)) for group in found)
    noun = "group" if len(found) == 1 else "groups"
    return f"{text} ({lacking} of {len(found)} {noun} without one of the two)" if lacking else text


def _known(found: Sequence[Group], name: str) -> list[Floats]:
    """A column along each group, where it has two values or more."""
    values = [group.values(name) for group in found]
    values = [y[~np.isnan(y)] for y in values]
    return [y for y in values if len(y) > 1]


def _whole(y: Floats) -> bool:
    """Whether a column has its first and its last value along a group."""
    return not bool(np.isnan(y[[0, -1]]).any())


def _changes(found: Sequence[Group], name: str, between: str) -> str:
    """The relative changes from the first to the last value: the least and the greatest.

    A group that lacks one of the two would pass the change along a part of it for that of all.
    """
    values = [y for group in found if _whole(y := group.values(name))]
    if not values:
        return ""
    changes = [_change(float(y[0]), float(y[-1])) for y in values]
    ends = dict.fromkeys(f"{bound:+.1f} %" for bound in (min(changes), max(changes)))
    return between.join(ends).replace("-", "−")


def _change(first: float, last: float) -> float:
    """In percent of the first value's size: a vacuum that grows is a pressure that falls."""
    if first == last:
        return 0.0
    if abs(first) > _ROUND_OFF * abs(last):
        return 100 * (last - first) / abs(first)
    return math.copysign(math.inf, last)


def _shape(y: Floats) -> str:
    if np.ptp(y) == 0 or np.ptp(y) < INSENSITIVE * abs(y[0]):
        return "—"
    steps = np.diff(y)
    # a plateau neither rises nor falls, whatever its last digits do
    rises = steps[np.abs(steps) > _ROUND_OFF * np.ptp(y)] > 0
    turns = int(np.count_nonzero(np.diff(rises)))
    if turns > 1:
        return "~"
    return ("↑" if rises[0] else "↓") if turns == 0 else ("∩" if rises[0] else "∪")


def extremes(
    columns: Sequence[VariedField], rows: Sequence[TableRow], quantity: ReportedQuantity
) -> str:
    """The least and the greatest value of a quantity with their points, or an empty text."""
    known = [row for row in rows if quantity.value(row) is not None]
    if not known:
        return ""
    ends = [known[0]]
    if len(known) > 1:
        ends = [end(known, key=lambda row: quantity.value(row) or 0.0) for end in (min, max)]
    return " to ".join(f"{amount(quantity, row)} ({place(columns, row)})" for row in ends)


def amount(quantity: ReportedQuantity, row: TableRow) -> str:
    """The value of a quantity at a point with its unit."""
    unit = quantity.unit if quantity.unit == "°" else f" {quantity.unit}".rstrip()
    return f"{quantity.value(row):.4g}{unit}"


def place(columns: Sequence[VariedField], row: TableRow) -> str:
    """The values of a point, "radius 6 mm, wall 1 mm"."""
    return ", ".join(described(column, row[column.name]) for column in columns)


def as_markdown(
    title: str,
    columns: Sequence[VariedField],
    rows: Sequence[TableRow],
    quantities: Sequence[ReportedQuantity],
    notes: Sequence[str] = (),
) -> str:
    """Each quantity in words and as a table of signs, what was asked for first.

    Args:
        title: of the sweep.
        columns: the varied fields; trends along those that are no numbers are left out.
        rows: the table of the sweep.
        quantities: those of the table, in their order.
        notes: sentences at the end.
    """
    counts = Counter(row["status"] for row in rows)
    states = ", ".join(f"{number} {status}" for status, number in counts.items())
    blocks = [f"# {title or 'Sweep'}\n\n{len(rows)} points: {states}.\n"]
    signs = False
    for quantity in quantities:
        whole = [row for row in rows if quantity.compares(row)]
        along = [(column, groups(columns, whole, column)) for column in columns if column.numeric]
        along = [(column, found) for column, found in along if found]
        blocks.append(_in_words(quantity, columns, rows, along))
        if along:
            blocks.append(_signs(quantity, along))
            signs = True
    if signs:
        blocks.append(_KEY)
    if notes:
        blocks.append("".join(f"- {note}\n" for note in notes))
    return "\n".join(blocks)


def _in_words(
    quantity: ReportedQuantity,
    columns: Sequence[VariedField],
    rows: Sequence[TableRow],
    along: Sequence[tuple[VariedField, list[Group]]],
) -> str:
    heading = f"{quantity.label[0].upper()}{quantity.label[1:]}"
    span = extremes(columns, rows, quantity) or "no point has a value"
    lines = [f"## {heading}", "", f"{quantity.caption}: {span}.", ""]
    for column, found in along:
        sentence = in_a_sentence(column, found, quantity.column)
        lines += [f"- {sentence}."] if sentence else []
    return "\n".join([*lines, *(["", quantity.remark] if quantity.remark else []), ""])


def _signs(quantity: ReportedQuantity, along: Sequence[tuple[VariedField, list[Group]]]) -> str:
    lines = [
        f"| {quantity.axis}; increase in | groups | " + " | ".join(quantity.lines) + " |",
        "|" + "---|" * (len(quantity.lines) + 2),
    ]
    for column, found in along:
        values = ", ".join(f"{x:g}" for x in sorted({x for g in found for x in g.x}))
        cells = [sign(found, name) for name in quantity.lines.values()]
        lines.append(f"| {described(column, values)} | {len(found)} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"

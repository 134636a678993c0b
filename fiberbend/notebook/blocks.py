"""Blocks of HTML that a notebook shows, in a light and in a dark theme.

They fetch nothing and run nothing, and they have no colour but that of the text around them and one
in the middle that both themes carry. Their styles are within the tags: a notebook that is not
trusted, and a page that shows one, take style sheets out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

ACCENT = "#3d8fd1"
"""Of a curve."""
WARN = "#d9822b"
"""Beside what has to be said of a result."""
MOST = 10
"""Rows of a table that are shown: the first and the last ones."""
_CELL = "text-align:{};vertical-align:top;padding:0.15em 0.9em 0.15em 0;border:0"
# a page without a doctype hands no colour on to its tables
_TABLE = "color:inherit;border:0;border-collapse:collapse;margin:0.3em 0"


def block(title: str, *parts: str) -> str:
    """Parts one below the other.

    Args:
        title: plain text; may be empty.
        parts: HTML.
    """
    head = f'<div style="font-weight:bold;margin:0.2em 0">{escaped(title)}</div>' if title else ""
    # long lines are hard to read across a wide screen
    return f'<div style="max-width:60em">{head}{"".join(parts)}</div>'


def escaped(text: object) -> str:
    """A text that is not HTML, whatever signs are in it."""
    # with its table of names it would take a millisecond of every start
    import html

    return html.escape(str(text))


def words(text: str) -> str:
    """A paragraph of plain text; none of an empty one."""
    return f'<div style="margin:0.3em 0">{escaped(text)}</div>' if text else ""


def warning(text: str) -> str:
    """A paragraph that must be seen."""
    style = f"margin:0.3em 0;padding-left:0.6em;border-left:0.25em solid {WARN}"
    return f'<div style="{style}">{escaped(text)}</div>'


def folded(summary: str, *parts: str) -> str:
    """Parts that are shown when they are asked for.

    Args:
        summary: plain text.
        parts: HTML.
    """
    head = f'<summary style="cursor:pointer">{escaped(summary)}</summary>'
    return f'<details style="margin:0.3em 0">{head}{"".join(parts)}</details>'


def pairs(rows: Sequence[tuple[str, str]]) -> str:
    """A name and a text a line, both plain."""
    lines = [
        f"<tr>{_cell(name, 'th', 'left', 'white-space:nowrap;font-weight:normal;opacity:0.75')}"
        f"{_cell(text, 'td', 'left')}</tr>"
        for name, text in rows
    ]
    return f'<table style="{_TABLE}"><tbody>{"".join(lines)}</tbody></table>' if rows else ""


def table(head: Sequence[str], rows: Sequence[Sequence[Any]], most: int = MOST) -> str:
    """Rows under names with units; of many the first and the last ones.

    Args:
        head: names of the columns, "pressure (kPa)".
        rows: numbers, texts, and None where nothing is known.
        most: rows that are shown.
    """
    some = list(rows)
    if len(some) > most:
        some = [*some[: most // 2], ["…"] * len(head), *some[-(most // 2) :]]
    sides = ["right" if _numeric(rows, index) else "left" for index in range(len(head))]
    top = "".join(_cell(name, "th", side) for name, side in zip(head, sides, strict=True))
    lines = [
        "".join(_cell(shown(value), "td", side) for value, side in zip(row, sides, strict=True))
        for row in some
    ]
    body = "".join(f"<tr>{line}</tr>" for line in lines)
    inner = f'<table style="{_TABLE}"><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>'
    # a table wider than the notebook moves by itself
    return f'<div style="overflow-x:auto">{inner}</div>'


def setting(value: Any) -> str:
    """A value of a case in one line of plain text: "radius 8 mm, length 120 mm"."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name.replace('_', ' ')} {_within(v)}" for name, v in value.items())
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (list, tuple)):
        return " and ".join(map(_within, value)) if value else "none"
    return str(value)


def curve(points: Sequence[tuple[float, float]], across: str, up: str) -> str:
    """A small picture of a curve with the greatest values on its axes; none of a single point.

    Args:
        points: x and y.
        across: name of x, with its unit.
        up: name of y, with its unit.
    """
    known = [(x, y) for x, y in points if math.isfinite(x) and math.isfinite(y)]
    # none is narrower than a pixel
    known = known[:: max(1, len(known) // 200)] + known[-1:]
    x_low, x_high = _range([x for x, _ in known])
    y_low, y_high = _range([y for _, y in known])
    if len(known) < 3 or x_low == x_high or y_low == y_high:
        return ""
    left, top, width, height = 46, 10, 240, 120
    placed = " ".join(
        f"{left + width * (x - x_low) / (x_high - x_low):.1f},"
        f"{top + height * (y_high - y) / (y_high - y_low):.1f}"
        for x, y in known
    )
    bottom, right = top + height, left + width
    text = 'fill="currentColor" font-size="11"'
    return (
        f'<svg viewBox="0 0 {right + 24} {bottom + 34}" width="{right + 24}" '
        'style="max-width:100%;font-family:sans-serif" role="img" '
        f'aria-label="{escaped(up)} over {escaped(across)}">'
        f'<path d="M{left} {top}V{bottom}H{right}" fill="none" stroke="currentColor" '
        'stroke-opacity="0.5"/>'
        f'<polyline points="{placed}" fill="none" stroke="{ACCENT}" stroke-width="2"/>'
        f'<g {text}><g text-anchor="end">'
        f'<text x="{left - 5}" y="{top + 8}">{y_high:.4g}</text>'
        f'<text x="{left - 5}" y="{bottom}">{y_low:.4g}</text></g>'
        f'<g text-anchor="middle"><text x="{left}" y="{bottom + 14}">{x_low:.4g}</text>'
        f'<text x="{right}" y="{bottom + 14}">{x_high:.4g}</text>'
        f'<text x="{left + width / 2}" y="{bottom + 29}">{escaped(across)}</text>'
        f'<text transform="translate(11 {top + height / 2}) rotate(-90)">{escaped(up)}</text>'
        "</g></g></svg>"
    )


def _range(values: Sequence[float]) -> tuple[float, float]:
    """From the least to the greatest value, and zero."""
    return min([0.0, *values]), max([0.0, *values])


def _cell(content: str, tag: str, side: str, more: str = "") -> str:
    return f'<{tag} style="{_CELL.format(side)};{more}">{escaped(content)}</{tag}>'


def _numeric(rows: Sequence[Sequence[Any]], index: int) -> bool:
    known = [row[index] for row in rows if row[index] is not None]
    return bool(known) and all(isinstance(value, (int, float)) for value in known)


def shown(value: Any) -> str:
    """A number with five digits, a text as it is, and a dash where nothing is known."""
    if value is None:
        return "–"
    return f"{value + 0.0:.5g}" if isinstance(value, float) else str(value)


def _within(value: Any) -> str:
    return f"({setting(value)})" if isinstance(value, Mapping) else setting(value)

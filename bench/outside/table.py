"""Rows of docs/validation.md: a computed figure beside one from outside; kept as JSON."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

HEAD = """# Validation

Every row is a figure that this program computes beside one from outside: a measurement, another
program, theory from books and papers, which this project's own code evaluates where the sources say
so. `make validate` computes all of them in {minutes} of processor time and writes this page.
Nothing is tuned but where a row says so.

*Off by* is the computed figure against the other one, unless the row names another measure; *asked*
is how near it was to be; without one a row is printed as it is. Beside a measurement or COMSOL what
was asked was settled before the figure was computed; in all other rows it was chosen while the row
was written, so that it guards what was reached and foretells nothing.
Angles of fibers are measured from the axis. Where ends are held, F > 0 pushes on what holds them,
and signs of angles and torques are the source's: a family above zero turns the ends by M > 0.
"""


@dataclasses.dataclass(frozen=True)
class Row:
    """A line of the table.

    Attributes:
        subject: what is computed, the same for all its rows.
        quantity: which figure of it.
        computed: this program's figure, with its unit.
        outside: the other one.
        error: how far they are apart; a part of the outside figure, unless the quantity says.
        asked: greatest error that was asked for; None: none was.
        source: key of the sources of the page.
        unknown: what is not known and would matter.
    """

    subject: str
    quantity: str
    computed: str
    outside: str
    error: float | None
    asked: float | None
    source: str
    unknown: str = ""

    @property
    def holds(self) -> bool | None:
        """Whether it is as near as asked; None where nothing was."""
        if self.asked is None or self.error is None:
            return None
        return abs(self.error) <= self.asked


def percent(value: float, sign: bool = True) -> str:
    """A part as percent, its digits by its size; a small one as it is."""
    plus, size = "+" if sign else "", abs(value)
    if size < 1e-14:
        return "0"
    if size < 5e-4:
        return f"{value:{plus}.0e}"
    return f"{100 * value:{plus}.{2 if size < 0.01 else 1}f} %"


def _line(row: Row) -> str:
    error = "" if row.error is None else percent(row.error)
    asked = "" if row.asked is None else percent(row.asked, sign=False)
    holds = {None: "", True: "yes", False: "**no**"}[row.holds]
    cells = [row.subject, row.quantity, row.computed, row.outside, error, asked, holds]
    return "| " + " | ".join([*cells, row.source, row.unknown]) + " |"


def page(rows: Sequence[Row], seconds: float, sources: Mapping[str, str]) -> str:
    """The page.

    Args:
        rows: in their order.
        seconds: of processor time that they took.
        sources: by key, where figures from outside are from.

    Raises:
        ValueError: a row whose source is not there.
    """
    for row in rows:
        if row.source not in sources:
            raise ValueError(f"no source {row.source!r} of {row.quantity}")
    asked = [row for row in rows if row.holds is not None]
    missed = [row for row in asked if not row.holds]
    minutes = f"{seconds / 60:.1f} minutes"
    head = ("what", "figure", "computed", "outside", "off by", "asked", "holds", "source")
    lines = [HEAD.format(minutes=minutes)]
    lines.append(f"Of {len(asked)} figures with a bound {len(asked) - len(missed)} keep it.")
    if missed:
        lines.append("Those that do not:\n")
        lines += [
            f"- {row.subject}, {row.quantity}: {percent(row.error or 0.0)} where "
            f"{percent(row.asked or 0.0, sign=False)} was asked. Not known: {row.unknown}."
            for row in missed
        ]
    lines.append("\n## The table\n")
    lines.append("| " + " | ".join([*head, "not known"]) + " |")
    lines.append("|" + "---|" * (len(head) + 1))
    lines += [_line(row) for row in rows]
    lines.append("\n## Sources\n")
    used = {row.source for row in rows}
    lines += [f"- **{key}**: {text}" for key, text in sources.items() if key in used]
    return "\n".join(lines) + "\n"


def save(path: Path, rows: Sequence[Row], seconds: float) -> None:
    """Keep rows as JSON."""
    data = {"seconds": round(seconds, 1), "rows": [dataclasses.asdict(row) for row in rows]}
    path.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def load(path: Path) -> tuple[list[Row], float]:
    """What `save` has kept."""
    data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return [Row(**row) for row in data["rows"]], float(data["seconds"])

"""What a sweep reports: its quantities in the order in which they were asked for, with names.

Every quantity has the run's own column of the table first and closed forms behind it.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from analytic.stress import CALIBRATED_MODULUS
from fiberbend import columns as col
from fiberbend.answer.motion import BEND, SIDE, TWIST, Reading
from fiberbend.answer.motion import STRETCH as LENGTH
from fiberbend.models import lines
from fiberbend.models.choice import MODELS
from fiberbend.schema.units import show
from fiberbend.sweep.file import ReportSpec

TableRow = dict[str, Any]

STRETCH = "stretch"
"""Kind of the quantity that every sweep has, asked for or not."""
FORCE = "blocked-force"
"""Kind of the blocked force."""
FAILED = "failed"
"""Status of a point."""
FORCE_MODEL = "blocked_force_model"
"""Column that says what the blocked force of a point is."""
LINES = {lines.ZERO_FIT: "zero_fit", lines.PAPER: "paper", lines.WINDING: "winding"}
"""Analytical lines in the table, with their names in it."""
CAPTIONS = {
    "paper": f"closed form, eq. (19), the paper's μ̄ = {CALIBRATED_MODULUS:g} MPa",
    "zero_fit": "closed form, eq. (19), own rubber",
    "uniform": "closed form, λ = 1 + h θ/L",
    "paper_force": "closed form, eq. (20)",
    "winding_force": "closed form, pressure acting up to the winding",
}
"""Captions of the analytical lines that are drawn."""
MOTIONS = (BEND, TWIST, SIDE, LENGTH)
"""What is told of a pressure, of those that some point may make."""
_DRAWN = ("zero_fit", "paper")
_PLAIN = str.maketrans({"°": "deg", "²": "2", "³": "3", "%": "percent", " ": None})
"""From a unit to its letters in the name of a column."""
_AT_END = " at the end"
"""End of the label of what a run has at its end."""
_LEVEL = 1e-6
"""A relative spread of a column below which it is the same at every point."""


@dataclasses.dataclass(frozen=True)
class ReportedQuantity:
    """A quantity of the table that is drawn and has its trends listed.

    Attributes:
        kind: an entry of `ReportSpec.maps`.
        name: name of its picture without the ending.
        label: its name in words.
        unit: its unit, or empty.
        lines: columns of the table that have values, by their captions: the run's own first, then
            closed forms.
        column: the run's own column, which may have no value; of the force of a model that gives
            none, the first closed form's.
        caption: what that is.
        remark: what a reader of its values has to know, a sentence; empty where nothing.
    """

    kind: str
    name: str
    label: str
    unit: str
    lines: dict[str, str]
    column: str = ""
    caption: str = ""
    remark: str = ""

    def __post_init__(self) -> None:
        if not self.column:
            caption, column = next(iter(self.lines.items()))
            object.__setattr__(self, "caption", caption)
            object.__setattr__(self, "column", column)

    @property
    def axis(self) -> str:
        """Label of an axis."""
        return f"{self.label} ({self.unit})" if self.unit else self.label

    def value(self, row: Mapping[str, Any]) -> float | None:
        """Its value at a point, or None: not known, or no state to compare with the others."""
        found = row.get(self.column) if self.compares(row) else None
        return None if found is None else float(found)

    def compares(self, row: Mapping[str, Any]) -> bool:
        """Whether a point counts: what failed ended somewhere else than the others."""
        return not (self.label.endswith(_AT_END) and row.get("status") == FAILED)


def quantities(report: ReportSpec, rows: Sequence[TableRow]) -> list[ReportedQuantity]:
    """Quantities of the table of a sweep, what was asked for first.

    Args:
        report: what the sweep reports.
        rows: its table; a quantity of which no row has a value is left out.
    """
    known = {name for row in rows for name, value in row.items() if value is not None}
    solved = sorted({row["solved_by"] for row in rows if row["solved_by"]})
    run = f"{' and '.join(solved)} model" if solved else "model"
    asked = [*_states(report, run, _drawn(solved)), *_force(report, rows), *_history(report, run)]
    if not asked:
        asked = list(_ends(run, rows))
    filled = (
        dataclasses.replace(
            quantity, lines={c: name for c, name in quantity.lines.items() if name in known}
        )
        for quantity in (*asked, _stretch(report, run))
    )
    return [quantity for quantity in filled if quantity.lines]


def degrees(angle: float) -> str:
    """An angle in rad as part of a column's name, 360deg."""
    return f"{math.degrees(angle):.6g}deg"


def kilopascals(pressure: float) -> str:
    """A pressure in MPa as part of a column's name, 100kPa."""
    return f"{1e3 * pressure:.6g}kPa"


def pressure_column(angle: float, line: str = "") -> str:
    """Column of the pressure at an angle, of the run or of an analytical line."""
    return f"{line and line + '_'}pressure_{degrees(angle)}_kPa"


def angle_column(pressure: float, line: str = "") -> str:
    """Column of the angle at a pressure, of the run or of an analytical line."""
    return f"{line and line + '_'}angle_{kilopascals(pressure)}_deg"


def motion_column(motion: Reading, pressure: float | None) -> str:
    """Column of how far an actuator does it at a pressure in MPa, or at the end of a run: None."""
    words, unit = _letters(motion.name), motion.unit.translate(_PLAIN)
    at = f"end_{words}" if pressure is None else f"{words}_{kilopascals(pressure)}"
    return f"{at}_{unit}" if unit else at


def _letters(words: str) -> str:
    return words.replace(" ", "_")


def _drawn(solved: Sequence[str]) -> list[str]:
    """Closed forms beside a run: not the one that is the run."""
    own = {MODELS[name].line for name in solved}
    return [name for line, name in LINES.items() if name in _DRAWN and own != {line}]


def _states(report: ReportSpec, run: str, drawn: Sequence[str]) -> Iterator[ReportedQuantity]:
    """Pressures at angles, angles at pressures."""
    for angle in report.angles:
        found = {run: pressure_column(angle)}
        found |= {CAPTIONS[line]: pressure_column(angle, line) for line in drawn}
        label = f"pressure at {math.degrees(angle):.6g}°"
        yield ReportedQuantity("pressure", f"pressure_{degrees(angle)}", label, "kPa", found)
    for pressure in report.pressures:
        for motion in MOTIONS:
            found = {run: motion_column(motion, pressure)}
            if motion == BEND:
                found |= {CAPTIONS[line]: angle_column(pressure, line) for line in drawn}
            label = f"{motion.name} at {show(pressure, 'pressure')}"
            name = f"{_letters(motion.name)}_{kilopascals(pressure)}"
            yield ReportedQuantity("angle", name, label, motion.unit, found)


def _force(report: ReportSpec, rows: Sequence[TableRow]) -> Iterator[ReportedQuantity]:
    """The blocked force, by what it is."""
    if report.force_at is None:
        return
    named = sorted({row[FORCE_MODEL] for row in rows if row.get(FORCE_MODEL)})
    found = {", or ".join(named): "blocked_force_N"} if named else {}
    found |= {CAPTIONS[line]: f"{line}_N" for line in ("paper_force", "winding_force")}
    remarks = [model.force_remark() for model in MODELS.values() if model.force_named() in named]
    label = f"blocked force at {show(report.force_at, 'pressure')}"
    remark = " ".join(_sentence(text) for text in remarks if text)
    yield ReportedQuantity(FORCE, "blocked_force", label, "N", found, remark=remark)


def _history(report: ReportSpec, run: str) -> Iterator[ReportedQuantity]:
    """Columns of history.csv that were asked for."""
    for name in report.history:
        unit = col.column(name).unit
        words = name.removesuffix(f"_{unit.translate(_PLAIN)}").replace("_", " ")
        yield ReportedQuantity("history", f"end_{name}", f"{words}{_AT_END}", unit, {run: name})


def _ends(run: str, rows: Sequence[TableRow]) -> Iterator[ReportedQuantity]:
    """Where nothing is asked for: what is not given at the end of the runs."""
    ends = [(_letters(each.name), motion_column(each, None), each.unit) for each in MOTIONS]
    for words, name, unit in (*ends, ("pressure", "end_pressure_kPa", "kPa")):
        kind = "pressure" if words == "pressure" else "angle"
        values = [row[name] for row in rows if row.get(name) is not None]
        if values and max(values) - min(values) > _LEVEL * max(map(abs, values)):
            label = f"{words.replace('_', ' ')}{_AT_END}"
            yield ReportedQuantity(kind, f"end_{words}", label, unit, {run: name})


def _stretch(report: ReportSpec, run: str) -> ReportedQuantity:
    at = f" at {math.degrees(max(report.angles, key=abs)):.6g}°" if report.angles else _AT_END
    found = {run: "greatest_stretch", CAPTIONS["uniform"]: "paper_stretch"}
    return ReportedQuantity(STRETCH, STRETCH, f"greatest axial stretch λ{at}", "", found)


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."

"""What a page says of a case and of its history: tables of text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import yaml

from fiberbend import columns as col
from fiberbend.case.case import ActuatorSpec, Case
from fiberbend.case.zones import words
from fiberbend.plan.plan import make_plan
from fiberbend.schema.descriptions import descriptions

_READ = (
    *(col.STEP, col.PRESSURE, col.ANGLE, col.TIP_X, col.TIP_Y, col.TIP_Z, col.VOLUME),
    *(col.TIP_FORCE, col.ROOF_FORCE, col.TWIST, col.SIDE_ANGLE, col.AXIS_STRETCH),
)
"""Columns that a user reads, where they have values other than zero."""
_NOTHING = 1e-9
_OBSTACLE = ("_y_N", "_z_N")
_ROUND_OFF = 1e-12
"""Part of a column's greatest value that no solver keeps."""
_PLANNED = {
    *("effects", "model", "half", "elements", "unknowns", "accuracy", "error"),
    *("left out", "not used", "winding"),
}
"""Headings of a plan that are true of the run as well; time and memory are in run.json."""


class Line(NamedTuple):
    """A line of a table: a name, its value, and a remark."""

    name: str
    value: str
    remark: str = ""


class Head(NamedTuple):
    """The head of a column."""

    name: str
    unit: str
    meaning: str


class Table(NamedTuple):
    """A table of numbers as text."""

    heads: list[Head]
    rows: list[list[str]]


def dimensions(case: Case) -> Iterator[Line]:
    """The dimensions of the actuator."""
    for name, value in case.resolved()["actuator"].items():
        yield Line(name, str(value), descriptions(ActuatorSpec).get(name, ""))


def materials(case: Case) -> Iterator[Line]:
    """The material of every part."""
    for part, material in case.resolved()["materials"].items():
        yield Line(part, in_words(material))


def effects(case: Case) -> Iterator[Line]:
    """Every effect with its settings."""
    for entry in case.resolved()["effects"]:
        for name, settings in entry.items():
            yield Line(name, in_words(settings))
    for number, text in enumerate(words(case), start=1):
        yield Line(f"zone {number}", text)


def case_text(case: Case) -> str:
    """The case with every default, as the file that leads to it again."""
    return yaml.safe_dump(case.resolved(), sort_keys=False, allow_unicode=True)


def plan_lines(case: Case) -> Iterator[Line]:
    """The model and why, its size and its errors."""
    for heading, sentences in make_plan(case).rows:
        if heading in _PLANNED:
            for number, sentence in enumerate(sentences):
                yield Line("" if number else heading, sentence)


def read_columns(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of the columns that a user reads, those of obstacles last."""
    names = [name for name in _READ if any(row.get(name) for row in rows) or name == col.STEP]
    forces = dict.fromkeys(
        key
        for row in rows
        for key, value in row.items()
        if key.startswith("contact_") and key.endswith(_OBSTACLE) and value
    )
    return [*names, *forces]


def steps(rows: Sequence[Mapping[str, Any]], names: Sequence[str]) -> Table:
    """Columns of a history, a line a step; round-off beside a column's greatest value is 0.

    Args:
        rows: of the history.
        names: of the columns.
    """
    heads = []
    for name in names:
        known = col.column(name)
        heads.append(Head(name, known.unit, known.meaning))
    least = {}
    for name in names:
        greatest = max((abs(float(row[name])) for row in rows if row.get(name)), default=0.0)
        # what round-off leaves of a zero angle or length is none; a residual has no unit
        least[name] = max(_ROUND_OFF * greatest, _NOTHING if col.column(name).unit else 0.0)
    return Table(heads, [[_number(row.get(name), least[name]) for name in names] for row in rows])


def all_columns(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Names of all columns that have a value."""
    names = dict.fromkeys(key for row in rows for key, value in row.items() if value is not None)
    return list(names)


def in_words(value: Any) -> str:
    """Settings, or other content of a YAML or JSON file, as a line of text."""
    if isinstance(value, dict):
        return ", ".join(f"{name}: {_inner(part)}" for name, part in value.items())
    return _inner(value)


def _number(value: Any, least: float) -> str:
    """A cell; what is smaller than the least is 0."""
    if value is None or value == "":
        return ""
    number = 0.0 if abs(float(value)) < least else float(value) + 0.0
    text = f"{number:.0f}" if number == round(number) and abs(number) < 1e6 else f"{number:.5g}"
    return text.replace("-", "−")


def _inner(value: Any) -> str:
    if isinstance(value, dict):
        return f"({in_words(value)})"
    if isinstance(value, list):
        return f"[{', '.join(map(_inner, value))}]"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value)

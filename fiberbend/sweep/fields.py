"""Varied fields of a sweep: their short names, their columns, and names of points from them."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

from fiberbend.schema.paths import value_at
from fiberbend.schema.units import KINDS, parse

_QUANTITY = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)? ?[A-Za-z^/0-9]*")
_SHORT = 2
"""A last part of a path with no more letters is no label: to, as, mu, c1, 0."""


@dataclasses.dataclass(frozen=True)
class VariedField:
    """A varied field with its value at every point.

    Attributes:
        path: dotted path in the case.
        label: short name, unique in the sweep.
        unit: unit of the values, empty for pure numbers and for text.
        values: a number each, or text; None where a case leaves the field out.
    """

    path: str
    label: str
    unit: str
    values: tuple[float | str | None, ...]

    @property
    def name(self) -> str:
        """Its name in the table, with the unit."""
        unit = self.unit.replace("/", "_per_").replace("^", "")
        label = self.label.replace(".", "_")
        return f"{label}_{unit}" if unit else label

    @property
    def heading(self) -> str:
        """Its name over a column of text, "wall, mm"."""
        return f"{self.label}, {self.unit}" if self.unit else self.label

    @property
    def numeric(self) -> bool:
        """All its values are numbers."""
        return all(isinstance(value, float) for value in self.values)


def labels(paths: Sequence[str]) -> dict[str, str]:
    """Shortest ends of paths that are labels, `effects.1.winding.pitch` → pitch."""
    result: dict[str, str] = {}
    for path in paths:
        parts = path.split(".")
        others = [other.split(".") for other in paths if other != path]
        counts = (
            count
            for count in range(1, len(parts))
            if len(parts[-count]) > _SHORT
            and not parts[-count].isdecimal()
            and all(other[-count:] != parts[-count:] for other in others)
        )
        result[path] = ".".join(parts[-next(counts, len(parts)) :])
    return result


def columns(names: Mapping[str, str], resolved: Sequence[Any]) -> tuple[VariedField, ...]:
    """The varied fields of a sweep.

    Args:
        names: label of each path.
        resolved: the resolved cases of all points.
    """
    return tuple(
        _varied_field(path, label, [value_at(case, path) for case in resolved])
        for path, label in names.items()
    )


def point_name(values: Mapping[str, Any]) -> str:
    """Name of a point's folder, `radius-6mm_length-100mm`; different values, different names.

    Args:
        values: value of each label in the resolved case.
    """
    shown = [(label, *_slug(value)) for label, value in values.items()]
    name = "_".join(f"{label}-{text}" for label, text, _ in shown)
    if len(name) <= 120 and all(whole for _, _, whole in shown):
        return name
    text = json.dumps(values, sort_keys=True, ensure_ascii=False)
    return f"{name[:100]}_{hashlib.sha256(text.encode()).hexdigest()[:8]}"


def shown(value: float | str | None) -> str:
    """A value of a field for a reader; a mapping, which the table has as JSON, in plain words."""
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, str) and value.startswith("{"):
        return ", ".join(f"{key} {part}" for key, part in json.loads(value).items())
    return "none" if value is None else value


def _slug(value: Any) -> tuple[str, bool]:
    """A value as part of a file name, and whether the value can be read from it."""
    if isinstance(value, str):
        if _QUANTITY.fullmatch(value):
            number, _, unit = value.partition(" ")
            return f"{float(number):.12g}{unit}".replace("/", "per").replace("^", ""), True
        text = re.sub(r"[^A-Za-z0-9.+-]+", "-", value)
        return text, text == value
    if value is None or isinstance(value, bool | int | float):
        return str(value).lower(), True
    text = re.sub(r"[^A-Za-z0-9.+]+", "-", json.dumps(value)).strip("-")
    return text[:40], False


def _varied_field(path: str, label: str, values: Sequence[Any]) -> VariedField:
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return VariedField(path, label, "", tuple(float(value) for value in values))
    units = [str(v).partition(" ")[2] for v in values if isinstance(v, str)]
    texts = all(isinstance(value, str) and _QUANTITY.fullmatch(value) for value in values)
    if texts and len(set(units)) == 1 and units[0]:
        numbers = tuple(_rounded(float(str(value).partition(" ")[0])) for value in values)
        return VariedField(path, label, units[0], numbers)
    for name, kind in KINDS.items() if texts else ():
        if all(unit in (kind.shown, kind.unit) for unit in units):
            factor = parse(f"1 {kind.shown}", name)
            numbers = tuple(_rounded(parse(value, name) / factor) for value in values)
            return VariedField(path, label, kind.shown, numbers)
    return VariedField(path, label, "", tuple(_plain(value) for value in values))


def _rounded(number: float) -> float:
    """Without the round-off that a change of units leaves, 3.0479999999999996 mm."""
    return float(f"{number:.12g}")


def _plain(value: Any) -> str | None:
    if value is None or isinstance(value, str):
        return value
    return json.dumps(value, ensure_ascii=False)

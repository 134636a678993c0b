"""How much every quantity of an answer changes with every dimension and every material."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.design.fields import Pairs, Varied
from fiberbend.design.quantities.seen import Seen
from fiberbend.design.reading import Design
from fiberbend.design.search.confirm import CELL, Confirmed
from fiberbend.design.search.wishes import Correction
from fiberbend.design.solving.models import Cell, UnsolvedError
from fiberbend.design.solving.tries import Tries, moved
from fiberbend.reader.reader import parse_case
from fiberbend.schema.paths import put
from fiberbend.schema.problems import CaseError
from fiberbend.schema.units import KINDS, factor, parse
from fiberbend.sweep.fields import labels
from materials.laws.table import LAWS

_LENGTH_STEP = 0.1
_PART = 0.01
_SMALL = 2e-3
"""Part of a value by which it is changed for a derivative."""
_QUANTITY = re.compile(r"([+-]?[\d.]+(?:[eE][+-]?\d+)?) (\S.*)")
_HEADS = ("actuator", "materials")
_OF_EFFECTS = ("pitch", "width", "thickness", "modulus", "angle_from_axis")


@dataclasses.dataclass(frozen=True)
class Row:
    """A field with what quantities change by.

    Attributes:
        path: of the field.
        label: short name.
        varied: the design may change it.
        value: as the case has it.
        step: the change that is told, such as "0.1 mm" or "1 %".
        changes: of every quantity by that step, internal units; None where it is not known.
    """

    path: str
    label: str
    varied: bool
    value: str
    step: str
    changes: tuple[float | None, ...]


def sensitivities(design: Design, near: Near) -> list[Row]:
    """The table of an answer: fields that vary first, then all other dimensions and numbers.

    By the cell where it has the answer: the section does not know what the pitch does between the
    turns.
    """
    given = dict(near.tries.pairs(near.chosen, near.x))
    own = [(field.path, str(given[field.path])) for field in design.fields.varied]
    case = near.tries.case(near.chosen, near.x)
    others = [
        (path, text)
        for path, text in _numbers(case.resolved())
        if path not in given and not any(path.startswith(f"{known}.") for known in given)
    ]
    names = labels([path for path, _ in (*own, *others)])
    slopes = near.tries.slopes(near.chosen, near.x)
    rows = []
    for index, field in enumerate(design.fields.varied):
        column = None if slopes is None else slopes[:, index] / (field.high - field.low)
        rows.append(_row(near, field, names[field.path], given[field.path], column))
    for path, text in others:
        beside = _field(path, names[path], text)
        column = None if beside is None else _beside(design, near, beside, parse_of(text))
        if beside is not None and column is not None and np.any(np.abs(column) > 0):
            rows.append(_row(near, beside, names[path], text, column, varied=False))
    return [*rows, *_of_laws(design, near, case)]


@dataclasses.dataclass(frozen=True)
class Near:
    """An answer by the finest model that is quick enough for its neighbours.

    Attributes:
        tries: of that model.
        chosen: choices of the answer.
        x: its numbers.
        corrections: from that model to what holds.
    """

    tries: Tries
    chosen: Pairs
    x: tuple[float, ...]
    corrections: tuple[Correction, ...]


def finest(design: Design, done: Confirmed) -> Near:
    """An answer by the cell where it has one, without zones; else by the section."""
    found = done.found
    check = done.last(CELL)
    if check is not None and check.whole and not design.base.zones:
        cells = Tries(design, Cell())
        own = cells.at(found.chosen, found.x).quantities
        if own is not None:
            corrections = tuple(
                Correction.between(fine, rough, quantity.small)
                for fine, rough, quantity in zip(
                    found.quantities(), own, design.quantities, strict=True
                )
            )
            return Near(cells, found.chosen, found.x, corrections)
    return Near(found.wishes.tries, found.chosen, found.x, found.wishes.corrections)


def _of_laws(design: Design, near: Near, case: Case) -> Iterator[Row]:
    """Coefficients of materials that are given by a name, as far as the model tells."""
    tries = near.tries
    here = tries.at(near.chosen, near.x)
    for part, spec in dict(case.materials).items():
        if spec is None or spec.name is None:
            continue
        material = convert.material(spec)
        units = {one.name: one.unit for one in LAWS[material.law].parameters}
        for key, value in material.parameters.items():
            path = f"materials.{part}.{key}"
            slopes = tries.model.slopes(case, tries.wanted, [path]) if value else None
            if slopes is None:
                continue
            sides = []
            for sign in (1.0, -1.0):
                change = sign * _SMALL * abs(value)
                seen = Seen(case, moved(here.states, slopes[path], change))
                sides.append(np.array([q.read(seen) for q in design.quantities]))
            column = (sides[0] - sides[1]) / (2 * _SMALL * abs(value))
            field = Varied(path, f"{part} {key}", value, 2 * value)
            text = f"{value:g}" if units[key] == "1" else f"{value:g} {units[key]}"
            yield _row(near, field, field.label, text, column, varied=False)


def _row(
    near: Near, field: Varied, label: str, value: Any, column: Any, varied: bool = True
) -> Row:
    """A derivative by the internal unit as the change by a step that a maker knows."""
    number = parse_of(value) if isinstance(value, str) else float(value)
    length = bool(field.unit) and _is_length(field.unit)
    step = _LENGTH_STEP if length else _PART * abs(number)
    text = "0.1 mm" if length else "1 %"
    ratios = [c.ratio for c in near.corrections]
    changes = tuple(
        None if column is None else float(ratio * slope * step)
        for ratio, slope in zip(ratios, column if column is not None else ratios, strict=True)
    )
    return Row(field.path, label, varied, str(value), text, changes)


def _beside(design: Design, near: Near, field: Varied, value: float) -> Any | None:
    """Derivatives by a field that does not vary; None: there are none.

    By the tangent of the model, or from two cases beside where it does not know that.
    """
    tries, sides = near.tries, []
    here = tries.at(near.chosen, near.x)
    step = _SMALL * abs(value)
    slopes = None
    if tries.wanted and here.case is not None:
        slopes = tries.model.slopes(here.case, tries.wanted, [field.path])
    for sign in (1.0, -1.0):
        data = design.changed(tries.pairs(near.chosen, near.x))
        try:
            put(data, field.path, field.text(value + sign * step))
            case = parse_case(data)
            if slopes is not None:
                states = moved(here.states, slopes[field.path], sign * step)
            else:
                states = tries.model.states(case, tries.wanted) if tries.wanted else {}
            sides.append(np.array([q.read(Seen(case, states)) for q in design.quantities]))
        except (CaseError, UnsolvedError):
            return None
    return (sides[0] - sides[1]) / (2 * step)


def _numbers(resolved: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Paths and texts of quantities that an actuator is made with."""
    for head in _HEADS:
        yield from _leaves(resolved.get(head, {}), head)
    for index, entry in enumerate(resolved.get("effects", [])):
        for path, text in _leaves(entry, f"effects.{index}"):
            if path.rsplit(".", 1)[-1] in _OF_EFFECTS:
                yield path, text


def _leaves(part: Any, path: str) -> Iterator[tuple[str, str]]:
    if isinstance(part, Mapping):
        for key, value in part.items():
            yield from _leaves(value, f"{path}.{key}")
    elif isinstance(part, list):
        for index, value in enumerate(part):
            yield from _leaves(value, f"{path}.{index}")
    elif isinstance(part, str) and _QUANTITY.fullmatch(part):
        yield path, part


def _field(path: str, label: str, text: str) -> Varied | None:
    """A number of a case as a field; None where its unit is of no kind, or it is zero."""
    match = _QUANTITY.fullmatch(text)
    kind = next((name for name in KINDS if _parses(text, name)), None)
    if match is None or kind is None or float(match[1]) == 0:
        return None
    value = parse(text, kind)
    return Varied(path, label, value, 2 * abs(value) + value, match[2], factor(match[2], kind))


def parse_of(text: str) -> float:
    """A quantity of any kind in the internal unit."""
    for kind in KINDS:
        if _parses(text, kind):
            return parse(text, kind)
    return float(text)


def _parses(text: str, kind: str) -> bool:
    try:
        parse(text, kind)
    except ValueError:
        return False
    return True


def _is_length(unit: str) -> bool:
    return _parses(f"1 {unit}", "length")

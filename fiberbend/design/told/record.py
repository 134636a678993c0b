"""The files of a design: design.json, the winner's case, and tables."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence
from typing import Any

import yaml

from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.reading import Design
from fiberbend.design.search.confirm import BODY
from fiberbend.design.search.search import Found
from fiberbend.design.solving.body import BLOCKED, FREE, body_data
from fiberbend.design.told.outcome import MET, UNCONFIRMED, Outcome, best, cost, sentence
from fiberbend.design.told.values import Told
from fiberbend.results.folder import DESIGN, RunFolder
from fiberbend.version import __version__

TRIES, TABLE, FRONT = "tries.csv", "sensitivity.csv", "front.csv"
_WINNER, _NEAREST = "winner", "nearest"
_HEAD = "# yaml-language-server: $schema=case.schema.json\n"


def write(folder: RunFolder, made: Outcome) -> list[str]:
    """Write everything but pictures and the page; names of the case files."""
    folder.write_text(TRIES, _csv(_tries(made)))
    if made.table:
        folder.write_text(TABLE, _csv(_sensitivities(made)))
    if made.front is not None:
        folder.write_text(FRONT, _csv(_front(made)))
    cases = _cases(made)
    for name, data in cases.items():
        text = yaml.safe_dump(data, sort_keys=False, allow_unicode=True)
        folder.write_text(name, text)
    folder.write_json(DESIGN, content(made, list(cases)))
    return list(cases)


def _cases(made: Outcome) -> dict[str, dict[str, Any]]:
    """Case files of the answer by their names; of one that misses targets, the nearest alone."""
    if made.done is None:
        return {}
    design, found = made.design, made.done.found
    tries = made.tries
    data = design.changed(tries.pairs(found.chosen, found.x))
    if design.title:
        data = {**data, "title": design.title}
    model = BODY if made.done.last(BODY) is not None else None
    parts = body_data(data, design.quantities, tries.wanted, model)
    ordered = parts or {FREE: data}
    if made.status not in (MET, UNCONFIRMED):
        first = next(iter(ordered.values()))
        return {f"{_NEAREST}.yaml": first}
    named: dict[str, dict[str, Any]] = {}
    for end, each in ordered.items():
        # one that is blocked alone is the winner itself
        own = end if len(ordered) > 1 else (end if end == BLOCKED and FREE in ordered else FREE)
        named[f"{_WINNER}{own}.yaml"] = each
    return named


def content(made: Outcome, cases: Sequence[str]) -> dict[str, Any]:
    """Content of design.json."""
    done, tries = made.done, made.tries
    found: dict[str, Any] = {
        "status": made.status,
        "reason": made.reason,
        "sentence": sentence(made),
        "cost": cost(made),
        "doubt": made.doubt,
        "best": best(made),
        "title": made.design.title,
        "cases": list(cases),
        "fields": {} if done is None else dict(tries.pairs(done.found.chosen, done.found.x)),
        "quantities": [_quantity(each) for each in made.told],
        "limits": [{"name": each.name, "text": each.text} for each in made.limits],
        "sensitivity": [
            {
                "path": row.path,
                "value": row.value,
                "step": row.step,
                "varied": row.varied,
                "changes": {
                    _column(q): None if change is None else q.plain(change)
                    for q, change in zip(made.design.quantities, row.changes, strict=True)
                },
            }
            for row in made.table
        ],
        "checks": [] if done is None else [_check(made.design, check) for check in done.checks],
        "front": [] if made.front is None else [_point(made, each) for each in made.front.found],
        "counts": {
            "cases": len(tries.all),
            "sections": tries.counted.solved,
            "of_them_for_derivatives": tries.counted.beside,
            "derivatives_by_the_model": tries.counted.slopes,
            "without_an_answer": tries.counted.failed,
        },
        "cpu_s": {
            "search": round(made.times.search, 3),
            "search_after_corrections": round(made.times.corrected, 3),
            "confirmation": round(made.times.confirmed, 3),
        },
        "search": made.design.search.model_dump(),
        "version": __version__,
    }
    return found


def _quantity(each: Told) -> dict[str, Any]:
    quantity = each.quantity
    low, high = quantity.bounds()
    return {
        "name": _column(quantity),
        "words": quantity.words(),
        "unit": quantity.unit,
        "goal": each.goal or None,
        "least": quantity.plain(low) if math.isfinite(low) else None,
        "most": quantity.plain(high) if math.isfinite(high) else None,
        "wanted": quantity.wanted(),
        "value": quantity.plain(each.value),
        "shown": quantity.shown(each.value),
        "model": each.model,
        "met": each.met,
        "off": quantity.plain(each.off) if not each.goal else None,
        "by_model": {name: quantity.plain(value) for name, value in each.by.items()},
    }


def _check(design: Design, check: Any) -> dict[str, Any]:
    def values(numbers: Sequence[float]) -> dict[str, float | None]:
        return {
            _column(q): q.plain(v) if math.isfinite(v) else None
            for q, v in zip(design.quantities, numbers, strict=True)
        }

    return {
        "model": check.model,
        "values": values(check.values),
        "foreseen": values(check.foreseen),
        "reason": check.reason,
        "cpu_s": round(check.cpu_s, 3),
        "warnings": list(check.warnings),
    }


def _point(made: Outcome, found: Found) -> dict[str, Any]:
    pairs = dict(made.tries.pairs(found.chosen, found.x))
    values = zip(made.design.quantities, found.quantities(), strict=True)
    return {**pairs, **{_column(q): q.plain(v) for q, v in values}}


def _column(quantity: Quantity[Any]) -> str:
    """A quantity as the name of a column, with its unit."""
    return f"{quantity.words()}, {quantity.unit}"


def _tries(made: Outcome) -> Iterator[list[Any]]:
    quantities = made.design.quantities
    fields = [path for path, _ in made.tries.pairs(*made.tries.middle())]
    yield ["try", *fields, *map(_column, quantities), "reason"]
    for each in made.tries.all:
        pairs = [value for _, value in made.tries.pairs(each.chosen, each.x)]
        values: list[Any] = [""] * len(quantities)
        if each.quantities is not None:
            shown = zip(quantities, each.quantities, strict=True)
            values = [f"{q.plain(v):.8g}" for q, v in shown]
        yield [each.number, *pairs, *values, each.reason]


def _sensitivities(made: Outcome) -> Iterator[list[Any]]:
    yield ["field", "value", "varied", "by", *map(_column, made.design.quantities)]
    for row in made.table:
        changes = [
            "" if change is None else f"{q.plain(change):.5g}"
            for q, change in zip(made.design.quantities, row.changes, strict=True)
        ]
        yield [row.path, row.value, "yes" if row.varied else "no", row.step, *changes]


def _front(made: Outcome) -> Iterator[list[Any]]:
    assert made.front is not None
    points = [_point(made, each) for each in made.front.found]
    yield [*points[0], "knee"]
    for index, point in enumerate(points):
        knee = "yes" if index == made.front.knee else ""
        yield [*(f"{v:.8g}" if isinstance(v, float) else v for v in point.values()), knee]


def _csv(rows: Iterator[list[Any]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()

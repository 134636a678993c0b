"""The answer of a run: what its case asks for, in words and numbers, and how far to trust it."""

from __future__ import annotations

import dataclasses
import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fiberbend import columns as col
from fiberbend.answer import timed
from fiberbend.answer.asked import asked
from fiberbend.answer.motion import SEEN, motion, turn
from fiberbend.answer.numbers import number, quantity
from fiberbend.answer.touch import touches
from fiberbend.answer.turned import turned
from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.models.model import ModelKind
from fiberbend.notebook import blocks
from fiberbend.plan.doubts import errors

WIDTH = 100
"""Columns of the printed answer."""
_HARD = "\u00a0"
_TOGETHER = re.compile(r"(?<==) (?=-?\d)|(?<=[a-z]) (?==)|(?<=\d) (?=(?:[a-zA-Z]+³?|%)(?:\W|$))")
"""Spaces within "x = 8 mm"."""


@dataclasses.dataclass(frozen=True)
class Entry:
    """A line of the answer.

    Attributes:
        label: what is answered, such as "pressure at 90°"; empty where it goes on from the line
            before.
        value: the answer with its unit, ready to print.
        note: where it comes from or what limits it; may be empty.
    """

    label: str
    value: str
    note: str = ""


@dataclasses.dataclass(frozen=True)
class Answer:
    """What a run answers; every text is ready to print.

    Attributes:
        title: title of the case; may be empty.
        sentence: how the run ended.
        entries: the answers, in the order in which they are read.
        trust: one line on how far to trust them.
        comparisons: lines on other models and measured points beside the run.
        warnings: what is doubtful, as in run.json.
    """

    title: str
    sentence: str
    entries: tuple[Entry, ...]
    trust: str
    comparisons: tuple[str, ...]
    warnings: tuple[str, ...]

    def _repr_html_(self) -> str:
        """The answer as a notebook shows it."""
        return blocks.block(self.title, *self.shown())

    def shown(self, picture: str = "") -> tuple[str, ...]:
        """Blocks of HTML, without the title.

        Args:
            picture: HTML that follows the sentence.
        """
        rows = [(e.label, f"{e.value} ({e.note})" if e.note else e.value) for e in self.entries]
        return (
            blocks.words(self.sentence),
            picture,
            blocks.pairs(rows),
            blocks.words(self.trust),
            *map(blocks.warning, self.warnings),
        )


def answer(case: Case, rows: Sequence[col.Row], run: Mapping[str, Any]) -> Answer:
    """What a run answers.

    Args:
        case: its case.
        rows: of history.csv, the first at rest; what is not known is None or absent.
        run: content of run.json.
    """
    model = choose_model(case)[0]
    entries = [
        *(Entry(*told) for told in asked(case, model, rows)),
        _end(case, rows),
        *(Entry(*told) for told in timed.entries(rows, run)),
        *_tip(case, rows),
        *(Entry(*told) for told in turned(rows, len(case.zones or ()))),
        *_contacts(case, rows),
        *_critical(case, run),
        *_strain(run),
        *_errors(case, model, run),
        *_calibrated(run),
        *_measured(run),
    ]
    return Answer(
        title=case.title,
        sentence=_sentence(case, model, rows, run),
        entries=tuple(entries),
        trust=_trust(run),
        comparisons=tuple(_comparisons(run)),
        warnings=tuple(run.get("warnings") or ()),
    )


def lines(found: Answer, verbose: bool = False) -> list[str]:
    """An answer as lines of text, at most `WIDTH` columns wide but for warnings.

    Args:
        found: the answer.
        verbose: with the comparisons.
    """
    text = [*_wrapped(found.title), *_wrapped(found.sentence)]
    width = max((len(entry.label) for entry in found.entries), default=0)
    for entry in found.entries:
        note = f" ({entry.note})" if entry.note else ""
        text += _wrapped(f"  {entry.label:<{width}}  {entry.value}{note}", width + 6)
    if verbose:
        for line in found.comparisons:
            text += _wrapped(line, 2)
    text += _wrapped(found.trust, 2)
    if found.warnings:
        number = len(found.warnings)
        text.append(f"{number} warning{'s' if number > 1 else ''}:")
        # a warning stays a line, which scripts can find
        text += [f"  {line}" for line in found.warnings]
    return text


def _wrapped(text: str, indent: int = 0) -> list[str]:
    """A text in lines of `WIDTH` columns; a number and its unit stay together."""
    whole = _TOGETHER.sub(_HARD, text)
    lines = textwrap.wrap(whole, WIDTH, subsequent_indent=" " * indent, break_on_hyphens=False)
    return [line.replace(_HARD, " ") for line in lines]


# --- how it ended -----------------------------------------------------------------------------


def _sentence(case: Case, model: ModelKind, rows: Sequence[col.Row], run: Mapping[str, Any]) -> str:
    last, status = rows[-1], run.get("status")
    here = _state(case, last)
    if status == "converged":
        if case.straight and last.get(col.TIP_FORCE) is not None:
            force = quantity(last[col.TIP_FORCE], "N")
            pressure = quantity(last[col.PRESSURE], "kPa")
            if model.ends:
                return (
                    f"At {pressure} the tip presses on its post with {force} ({model.name} model)."
                )
            return (
                f"Kept straight at {pressure}, the {model.name} model gives a tip force of {force}."
            )
        if case.inflation is None:
            return f"The actuator ends at {here} ({model.name} model)."
        pressure = quantity(last[col.PRESSURE], "kPa")
        return f"The actuator {motion(last)} at {pressure} ({model.name} model)."
    if len(rows) < 2:
        return (
            f"The run {status} before its first load step: it has no answer ({model.name} model)."
        )
    return f"The run {status} at {here}: the answer is valid up to there ({model.name} model)."


def _state(case: Case, row: col.Row) -> str:
    """Pressure and angle of a row, and where the tip is blocked its force first."""
    parts = []
    if case.straight and row.get(col.TIP_FORCE) is not None:
        parts.append(quantity(row[col.TIP_FORCE], "N"))
    if case.inflation is not None:
        parts.append(quantity(row[col.PRESSURE], "kPa"))
    if not case.straight or abs(row[col.ANGLE]) > SEEN:
        parts.append(turn(row))
    return ", ".join(parts)


def _end(case: Case, rows: Sequence[col.Row]) -> Entry:
    return Entry("end of the run", _state(case, rows[-1]))


# --- where it is ------------------------------------------------------------------------------


def _tip(case: Case, rows: Sequence[col.Row]) -> Iterator[Entry]:
    """Where the tip is at the end, and at rest."""
    if case.straight:
        return
    yield Entry("tip at the end", _place(rows[-1]), f"at rest {_place(rows[0])}")


def _place(row: col.Row) -> str:
    keys = {"x": col.TIP_X, "y": col.TIP_Y, "z": col.TIP_Z}
    known = {name: row[key] for name, key in keys.items() if row.get(key) is not None}
    if abs(known.get("x", 0.0)) <= SEEN:
        known.pop("x", None)
    return ", ".join(f"{name} = {quantity(value, 'mm')}" for name, value in known.items())


def _contacts(case: Case, rows: Sequence[col.Row]) -> Iterator[Entry]:
    """First touch of every obstacle, and its force at the end."""
    for touch in touches(rows):
        if touch.value:
            yield Entry(f"touches the {touch.obstacle}", touch.value, touch.note)
        else:
            yield Entry(f"touch of the {touch.obstacle}", "none", touch.note)
        if touch.force is not None and not case.straight:
            yield Entry(f"force of the {touch.obstacle}", quantity(touch.force, "N"), "at the end")


def _critical(case: Case, run: Mapping[str, Any]) -> Iterator[Entry]:
    """Limit points, and where stability is lost; or that nobody has looked for it."""
    if run.get("stability_checked") is False:
        iterative = case.solver.linear == "iterative"
        why = "solver.linear: iterative" if iterative else "a load without a potential"
        yield Entry("stability", "not checked", f"{why}: no unstable modes counted")
    for point in run.get("critical_points") or ():
        before, beyond = point["unstable_modes_before"], point["unstable_modes_beyond"]
        if beyond <= before:
            continue
        load = point["load"]
        parts = [f"{load} {number(point['value'])}"] if "value" in point else []
        units = {col.PRESSURE: "kPa", col.ANGLE: "°"}
        parts += [quantity(point[key], unit) for key, unit in units.items() if key in point]
        if point["kind"] == "limit":
            yield Entry("limit point", ", ".join(parts), f"beyond it the {load} falls")
        else:
            yield Entry("stability lost", ", ".join(parts), "the body buckles")


def _strain(run: Mapping[str, Any]) -> Iterator[Entry]:
    """Greatest strain of the last state, and where it is."""
    found = run.get("greatest_strain")
    if not found:
        return
    at = [
        f"{axis} = {quantity(found[f'{axis}_mm'], 'mm')}"
        for axis in "xyz"
        if found.get(f"{axis}_mm") is not None
    ]
    strain = f"{100 * found['nominal']:.0f} %, logarithmic {found['logarithmic']:.3f}"
    yield Entry("greatest strain", strain, f"at the end, {found['place']}; at rest {', '.join(at)}")


# --- how far to trust it ----------------------------------------------------------------------


def _errors(case: Case, model: ModelKind, run: Mapping[str, Any]) -> Iterator[Entry]:
    """How far the model's answer is expected to be off, with the source."""
    if run.get("accuracy"):
        from fiberbend.accuracy.words import answered

        estimated = answered(run)
        if estimated is not None:
            yield Entry("estimated error", *estimated)
            return
    for index, line in enumerate(errors(case, model)):
        yield Entry("" if index else "expected error", line)


def _calibrated(run: Mapping[str, Any]) -> Iterator[Entry]:
    """By what numbers the rubber between the turns of a winding bulges, and how good they are."""
    text = (run.get("calibration") or {}).get("text")
    if text:
        yield Entry("", text)


def _measured(run: Mapping[str, Any]) -> Iterator[Entry]:
    """How far the run is from what the user has measured; what is not expected is a warning too."""
    text = _beside(run, "measured").get("text")
    if text:
        yield Entry("measured points", text)


def _comparisons(run: Mapping[str, Any]) -> Iterator[str]:
    known = _beside(run, "measured").get("text")
    lines = (run.get("crosscheck") or {}).get("lines", ())
    yield from (line for line in lines if line != known)


def _beside(run: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """A comparison of run.json; empty where there is none."""
    return (run.get("crosscheck") or {}).get(name) or {}


def _trust(run: Mapping[str, Any]) -> str:
    """One line: how it ended, the section model beside it, and how many warnings there are."""
    parts, warnings = [], run.get("warnings") or ()
    if run.get("status") != "converged":
        parts.append("the values up to the end of the run are valid")
    accuracy = ""
    if run.get("accuracy"):
        from fiberbend.accuracy.words import verdict

        accuracy = verdict(run)
        parts += [accuracy] if accuracy else []
    beside = _beside(run, "section")
    text = beside.get("text")
    # what is not expected stands among the warnings
    if text and beside.get("band_percent") is not None and text not in warnings:
        parts.append(text)
    if warnings:
        count = len(warnings)
        parts.append(f"read the {'warning' if count == 1 else f'{count} warnings'} below")
    else:
        error = "estimated" if accuracy else "expected"
        parts.append(f"no doubt beyond the {error} error is known")
    return f"Trust: {'; '.join(parts)}."

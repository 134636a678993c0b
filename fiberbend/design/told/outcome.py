"""What has come of a design: its status, its answer in words, and all that stands behind it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence

from fiberbend.answer.answer import Answer, Entry
from fiberbend.answer.numbers import number
from fiberbend.design.fields import value_words
from fiberbend.design.reading import Design
from fiberbend.design.search.confirm import BODY, CELL, Confirmed
from fiberbend.design.search.front import Front
from fiberbend.design.solving.tries import Tries
from fiberbend.design.told.limits import Limit, limits
from fiberbend.design.told.sensitivity import Row
from fiberbend.design.told.values import Told, told

MET, UNMET, UNCONFIRMED = "met", "not met", "not confirmed"
FAILED, INTERRUPTED = "failed", "interrupted"
_MOST_LIMITS = 6
_STOPS = "; what stops it: "
_AT_END = 1e-3


@dataclasses.dataclass(frozen=True)
class Times:
    """Processor time, s: of the search, of its corrections, and of cell and body."""

    search: float = 0.0
    corrected: float = 0.0
    confirmed: float = 0.0


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What has come of a design.

    Attributes:
        design: the design.
        status: "met", "not met", "not confirmed", "failed" or "interrupted".
        reason: why it is not met; empty where it is.
        done: the answer; None where no case has one.
        told: its quantities.
        limits: what holds it.
        table: its sensitivities.
        front: cases of the trade-off; None without two goals.
        tries: all cases.
        times: what it took.
        doubt: why it may not be the best; empty where nothing speaks against it.
    """

    design: Design
    status: str
    reason: str
    done: Confirmed | None
    told: Sequence[Told]
    limits: Sequence[Limit]
    table: Sequence[Row]
    front: Front | None
    tries: Tries
    times: Times
    doubt: str = ""


def outcome(
    design: Design,
    tries: Tries,
    done: Confirmed | None,
    table: Sequence[Row],
    front: Front | None,
    times: Times,
    interrupted: bool = False,
    doubt: str = "",
) -> Outcome:
    """Judge an answer."""
    if done is None:
        status, why = INTERRUPTED, "interrupted before the first search had ended"
        if not interrupted:
            status, why = FAILED, _no_case(tries)
        return Outcome(design, status, why, None, (), (), (), None, tries, times)
    found = told(design, done)
    held = limits(design, done.found)
    status, reason = _judged(design, done, found, held)
    if interrupted:
        status, reason = INTERRUPTED, "interrupted: the best case so far, not confirmed"
    return Outcome(design, status, reason, done, found, held, table, front, tries, times, doubt)


def _judged(
    design: Design, done: Confirmed, found: Sequence[Told], held: Sequence[Limit]
) -> tuple[str, str]:
    missed = [each for each in found if not each.met]
    last = [check for name in (CELL, BODY) if (check := done.last(name)) is not None]
    failed = [check for check in last if not check.whole and not check.absent]
    if missed and not done.found.met:
        parts = ", ".join(
            f"{each.quantity.words()} {each.quantity.shown(each.value)} where "
            f"{each.quantity.wanted()} is wanted"
            for each in missed
        )
        stops = [limit.text for limit in held[:_MOST_LIMITS]]
        why = f"{_STOPS}{'; '.join(stops)}" if stops else f"{_STOPS}no field that varies moves it"
        return UNMET, f"no case in these ranges meets all targets; the nearest has {parts}{why}"
    if missed:
        parts = ", ".join(
            f"{each.quantity.words()} {each.quantity.shown(each.value)} ({each.model})"
            for each in missed
        )
        return UNCONFIRMED, f"the section meets all targets, and a finer model does not: {parts}"
    if failed:
        return UNCONFIRMED, "; ".join(f"{check.model}: {check.reason}" for check in failed)
    return MET, ""


def _no_case(tries: Tries) -> str:
    """Why nothing is found, by the commonest reason."""
    reasons = [each.reason for each in tries.all if each.reason]
    common = max(dict.fromkeys(reasons), key=reasons.count)
    return f"none of {len(tries.all)} cases has an answer; most often: {common}"


# --- in words ------------------------------------------------------------------------------------


def answer(made: Outcome) -> Answer:
    """The answer as a run prints its own."""
    warnings = [made.doubt] if made.doubt else []
    if made.done is not None:
        for check in made.done.checks[-2:]:
            warnings += check.warnings
    return Answer(
        title=made.design.title,
        sentence=sentence(made),
        entries=tuple(_entries(made)),
        trust=cost(made),
        comparisons=(),
        warnings=tuple(dict.fromkeys(warnings)),
    )


def sentence(made: Outcome) -> str:
    """How it has ended."""
    if made.status != MET:
        text = made.reason.split(_STOPS)[0]
        return f"{text[0].upper()}{text[1:]}."
    assert made.done is not None
    checks = {n: made.done.last(n) for n in (BODY, CELL)}
    finest = next((n for n, c in checks.items() if c is not None and c.whole), None)
    if finest is None:
        by = "the section alone has said so" if made.tries.wanted else "from its dimensions"
        return f"All targets are met; {by}."
    name = {BODY: "the whole body", CELL: "the cell"}[finest]
    if not made.design.targets:
        return f"The best case; its figures are those of {name}."
    return f"All targets are met, confirmed by {name}."


def _entries(made: Outcome) -> Iterator[Entry]:
    if made.done is None:
        return
    yield from _fields(made)
    for each in made.told:
        yield Entry(each.quantity.words(), each.quantity.shown(each.value), _note(made, each))
    head = "held by" if made.done.found.met else "stopped by"
    for limit in made.limits[:_MOST_LIMITS]:
        yield Entry(head, limit.text)
        head = ""
    if made.front is not None:
        count = len(made.front.found)
        yield Entry("trade-off", f"{count} cases in front.csv", "this one is at its knee")


def _fields(made: Outcome) -> Iterator[Entry]:
    """Values of all fields that varied, those at an end of their range said so."""
    assert made.done is not None
    found, fields = made.done.found, made.design.fields
    for path, value in found.chosen:
        choice = next(each for each in fields.choices if each.path == path)
        note = f"of {len(choice.values)} choices" if len(choice.values) > 1 else ""
        yield Entry(choice.label, value_words(value), note)
    for field, part, value in zip(fields.varied, found.x, made.tries.inner(found.x), strict=True):
        ends = f"{field.shown(field.low)} to {field.shown(field.high)}"
        side = "its lower limit" if part < _AT_END else "its upper limit"
        note = f"at {side}" if part < _AT_END or part > 1 - _AT_END else f"from {ends}"
        yield Entry(field.label, field.shown(value), note)


def best(made: Outcome) -> str:
    """What may be said of goals after "least" or "greatest"."""
    whole = made.done is not None and made.done.found.met
    if made.status != MET or made.front is not None or not whole:
        # of a target that is all but met the miss alone was made small
        return "wanted"
    return "found" if made.doubt else "possible"


def _note(made: Outcome, each: Told) -> str:
    """What is wanted, and what each model says."""
    quantity = each.quantity
    wanted = f"{each.goal} {best(made)}" if each.goal else f"wanted {quantity.wanted()}"
    if not each.met:
        wanted += f", {quantity.shown(abs(each.off))} {'over' if each.off > 0 else 'short'}"
    if len(each.by) == 1 and not quantity.states():
        return wanted
    models = ", ".join(f"{name} {quantity.shown(value)}" for name, value in each.by.items())
    return f"{wanted}; {models}"


def cost(made: Outcome) -> str:
    """What it took, the search and its confirmation each by itself."""
    counted, times = made.tries.counted, made.times
    parts = [f"{counted.solved} sections in {number(times.search + times.corrected, 1)} s"]
    checks = () if made.done is None else made.done.checks
    for name in (CELL, BODY):
        own = [check for check in checks if check.model == name and not check.absent]
        if own:
            word = {CELL: "cells", BODY: "bodies"}[name] if len(own) > 1 else name
            parts.append(f"{len(own)} {word} in {number(sum(c.cpu_s for c in own), 1)} s")
    if counted.failed:
        parts.append(f"{counted.failed} cases without an answer")
    return f"{', '.join(parts)} of processor time; seed {made.design.search.seed}"

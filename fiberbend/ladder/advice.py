"""Which rung to take: those that nothing beats in both error and time, and a sentence on them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from fiberbend.ladder.errors import Judged, Judgement
from fiberbend.ladder.rungs import Family
from fiberbend.ladder.words import full_name, number, percent, seconds, title

GOALS = (1.0, 0.1)
"""Errors in percent for which there is advice."""


def front(points: Sequence[tuple[float, float]], least: float = 0.0) -> list[int]:
    """Indices of the points that no other one beats in both numbers, by the first number.

    Args:
        points: time and error each, both finite.
        least: errors below are alike: they cannot be told apart.
    """
    order = sorted(range(len(points)), key=lambda i: (points[i][0], points[i][1]))
    best, found = math.inf, []
    for index in order:
        error = max(points[index][1], least)
        if error < best:
            found.append(index)
            best = error
    return found


def pareto(judgement: Judgement) -> list[Judged]:
    """Rungs that no other beats in wall time and error, the quickest first."""
    whole = [each for each in judgement.rungs if not each.flaw]
    points = [(each.record.wall_s, each.worst()) for each in whole]
    return [whole[index] for index in front(points, judgement.known_to())]


def advice(judgement: Judgement, goals: Sequence[float] = GOALS) -> str:
    """One sentence: what to take for each goal, as the table calls it, and how long it takes."""
    known, found = judgement.known_to(), list(_choices(judgement, goals))
    if not found:
        return "No advice: no family of rungs has a limit to compare with."
    parts: list[str] = []
    named: list[Judged] = []
    for goal, choice, fits in found:
        known_as = "the same" if choice in named else take(choice)
        if fits:
            parts.append(f"for {number(goal)} % {'' if choice in named else 'take '}{known_as}")
        else:
            best = f"the best is sure to {percent(choice.worst() + known)}"
            name = "" if choice in named else f": {known_as}"
            parts.append(f"for {number(goal)} % {_why_none(goal, known)}, and {best}{name}")
        named.append(choice)
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}.{_reservation(judgement)}"


def chosen(judgement: Judgement, goals: Sequence[float] = GOALS) -> list[Judged]:
    """The rungs that the advice names, each once."""
    found: list[Judged] = []
    for _, choice, _ in _choices(judgement, goals):
        if choice not in found:
            found.append(choice)
    return found


def _choices(judgement: Judgement, goals: Sequence[float]) -> Iterator[tuple[float, Judged, bool]]:
    """For each goal the quickest rung that is sure to keep it, else the best; and which it is."""
    best, known = pareto(judgement), judgement.known_to()
    if not best:
        return
    able = [each for each in judgement.rungs if not each.flaw]
    for goal in goals:
        # a reference that is uncertain lends its uncertainty to every error
        fits = [each for each in able if each.worst() + known <= goal]
        if fits:
            yield goal, min(fits, key=lambda each: each.record.wall_s), True
        else:
            yield goal, min(best, key=lambda each: _badness(each, known)), False


def _badness(judged: Judged, known: float) -> tuple[float, float]:
    """Error, as far as it can be told apart, then time."""
    return max(judged.worst(), known), judged.record.wall_s


def _why_none(goal: float, known: float) -> str:
    if known > goal:
        return f"the reference itself is known to {percent(known)} only"
    if known > goal / 2:
        return f"no rung keeps within it together with the {percent(known)} of the reference"
    return "no rung of this ladder is known to be as exact"


def _reservation(judgement: Judgement) -> str:
    """Where a part of the ladder is solved: what the errors do not know of."""
    own, wanted = judgement.reference, judgement.finest
    if own is None or wanted is None or _kind(own) == _kind(wanted):
        return ""
    return (
        f" This is against the limit of {title(own)}: {title(wanted)}, the finest of this case, "
        "has none yet, and what it would change is not in these errors."
    )


def _kind(family: Family) -> tuple[str, str]:
    return family.model, family.winding


def take(judged: Judged) -> str:
    """A rung as the table calls it, and its time."""
    record = judged.record
    once = f", {seconds(record.once_s)} of them once for all runs" if record.once_s else ""
    return f'"{full_name(judged.rung)}", {seconds(record.wall_s)}{once}'

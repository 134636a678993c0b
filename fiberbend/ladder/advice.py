"""Which rung to take: those that nothing beats in both error and time, and a sentence on them."""

from __future__ import annotations

import math
from collections.abc import Sequence

from fiberbend.ladder.errors import Judged, Judgement
from fiberbend.ladder.rungs import Family
from fiberbend.ladder.words import mesh_words, number, percent, seconds, settings, title

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
    """One sentence: what to take for each goal, how long it takes, and what to type."""
    best, known = pareto(judgement), judgement.known_to()
    if not best:
        return "No advice: no family of rungs has a limit to compare with."
    parts: list[str] = []
    for goal in goals:
        # a reference that is uncertain lends its uncertainty to every error
        able = [each for each in judgement.rungs if not each.flaw]
        fits = [each for each in able if each.worst() + known <= goal]
        fit = min(fits, key=lambda each: each.record.wall_s, default=None)
        if fit is not None:
            same = any(take(fit) in part for part in parts)
            parts.append(f"for {number(goal)} % {'the same' if same else f'take {take(fit)}'}")
            continue
        near = min(best, key=lambda each: (max(each.worst(), known), each.record.wall_s))
        why = (
            f"the reference itself is known to {percent(known)} only"
            if known > goal
            else f"no rung keeps within it together with the {percent(known)} of the reference"
            if known > goal / 2
            else "no rung of this ladder is known to be as exact"
        )
        parts.append(
            f"for {number(goal)} % {why}; the best has {percent(near.worst())}: {take(near)}"
            if not any(take(near) in part for part in parts)
            else f"for {number(goal)} % {why}, and the best has {percent(near.worst())}"
        )
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}.{_reservation(judgement)}"


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
    """A rung in words, its time, and the options that make it."""
    family, rung = title(judged.rung.family), judged.rung
    words = ", ".join(filter(None, (family, mesh_words(rung))))
    return f"{words}: {seconds(judged.record.wall_s)} ({settings(rung)})"

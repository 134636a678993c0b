"""Whether an answer that the section has found is the best by a finer model too."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.design.search.confirm import Confirmed
from fiberbend.design.search.minimum import linear_step
from fiberbend.design.told.sensitivity import Near

_RADIUS = 0.1
"""Part of all ranges by which the answer is moved in thought."""
_TELLS = 0.02
"""Part of the goal above which what is won so is told."""
_MOVES = 0.5
"""Part of the radius above which a field counts as moved."""


def doubt(done: Confirmed, near: Near) -> str:
    """Why an answer may not be the best; empty where nothing speaks against it.

    The search goes by the derivatives of the section. A finer model that agrees on all values may
    have others, as of strains between the turns: what it foresees nearby is told.

    Args:
        done: the answer.
        near: the same by the finest model that is quick enough.
    """
    found = done.found
    wishes = dataclasses.replace(
        found.wishes, tries=near.tries, corrections=tuple(near.corrections)
    )
    if near.tries is found.wishes.tries or not found.met or wishes.goal is None or not near.x:
        return ""
    x = np.array(near.x)
    values, slopes = wishes.values(x), wishes.slopes(x)
    if values is None or slopes is None:
        return ""
    step = linear_step(x, values, slopes, _RADIUS)
    won = -float(slopes.goal @ step)
    if won < _TELLS * max(abs(values.goal), _TELLS):
        return ""
    fields = wishes.design.fields.varied
    ways = [
        f"{'more' if part > 0 else 'less'} {field.label}"
        for field, part in zip(fields, step, strict=True)
        if abs(part) > _MOVES * _RADIUS
    ]
    goal = wishes.design.goals[wishes.goal]
    side, more = ("least", "less") if goal.sign > 0 else ("greatest", "more")
    amount = goal.quantity.shown(won * wishes.scales[wishes.goal])
    return (
        f"{goal.quantity.words()} is perhaps not the {side}: the section has found it, and the "
        f"cell foresees {amount} {more} with {' and '.join(ways)}, a tenth of their ranges away"
    )

"""The branches of a test that goes back and forth."""

from __future__ import annotations

import itertools

import numpy as np

from materials.stretches import Floats

TOLERANCE = 0.02
"""Part of the range of strains that a test has to turn back by to count as turned."""
_SHARE = 0.45
"""Turns per point from which on rows are in no order of time."""


def loading(stretch: Floats, cycle: int) -> slice:
    """Rows of a loading.

    Args:
        stretch: stretches in the order of time, (n,).
        cycle: which loading, from 1 on.

    Returns:
        All rows where the stretch only grows or only falls, but for noise.

    Raises:
        ValueError: there is no such cycle, or rows are in no order.
    """
    if len(turns(stretch)) == 2:
        if cycle != 1:
            raise ValueError(f"one loading and no cycles, expected --cycle 1, found {cycle}")
        return slice(0, len(stretch))
    away = np.abs(np.log(stretch))
    ends = turns(away)
    if len(ends) - 2 > _SHARE * len(stretch):
        raise ValueError(
            "rows are in no order of time, so that there is no first loading, expected "
            "--cycle 0 for all rows"
        )
    branches = [
        (first, last) for first, last in itertools.pairwise(ends) if away[last] > away[first]
    ]
    if not 1 <= cycle <= len(branches):
        raise ValueError(f"{len(branches)} loadings, expected --cycle up to that, found {cycle}")
    first, last = branches[cycle - 1]
    return slice(first, last + 1)


def turns(values: Floats) -> list[int]:
    """Places where a series turns, with its first and its last."""
    span = float(values.max() - values.min()) * TOLERANCE
    found, direction, extreme = [0], 0, 0
    for i in range(1, len(values)):
        step = values[i] - values[extreme]
        if direction == 0:
            low, high = int(np.argmin(values[: i + 1])), int(np.argmax(values[: i + 1]))
            if values[high] - values[low] > span:
                direction, extreme = (1, high) if high > low else (-1, low)
                begin = low if high > low else high
                # what lies before is noise around the beginning
                found = [0] if begin == 0 or abs(values[begin] - values[0]) <= span else [0, begin]
        elif direction * step > 0:
            extreme = i
        elif direction * step < -span:
            found.append(extreme)
            direction, extreme = -direction, i
    return [*found, len(values) - 1]

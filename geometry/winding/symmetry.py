"""How families of threads repeat, and which motions map them onto themselves; no numpy."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence

from geometry.winding.families import Family

FEW = 6
"""A slice may hold so many repeats of the family that repeats last."""
_SAME = 1e-9
"""Relative difference of what is the same but for rounding."""

Kind = tuple[float, ...]
"""What two families are alike in, but for hand and place."""
Lines = list[tuple[float, float]]
"""Where lines lie, and after what they repeat."""


def common_period(families: Iterable[Family]) -> float | None:
    """The least length along the axis after which all repeat, mm.

    Returns:
        inf where everything is alike along the axis; None where there is none within `FEW` repeats
        of the family that repeats last.
    """
    periods = [family.period for family in families if math.isfinite(family.period)]
    if not periods:
        return math.inf
    longest = max(periods)
    for times in range(1, FEW + 1):
        if all(_whole(times * longest / period) for period in periods):
            return times * longest
    return None


def nearest_periods(families: Sequence[Family], number: int) -> list[float]:
    """Periods of one family, nearest to its own, with which it repeats with the longest other one.

    First that of the shortest slice, then the nearest of all, where it is another.

    Args:
        families: all of them.
        number: of the one that is to fit.
    """
    own = families[number].period
    others = [f.period for i, f in enumerate(families) if i != number and math.isfinite(f.period)]
    if not others or not math.isfinite(own):
        return []
    other, counts = max(others), range(1, FEW + 1)
    # m repeats of the other one are k of its own
    pairs = {(max(1, round(k * own / other)), k) for k in counts}
    pairs |= {(m, max(1, round(m * other / own))) for m in counts}
    fits = [(m * other, m * other / k) for m, k in pairs if min(m, k) <= FEW]
    first = min(fits, key=lambda fit: (fit[0], abs(fit[1] - own)))[1]
    best = min((fit for _, fit in fits), key=lambda fit: abs(fit - own))
    return [first] if math.isclose(first, best, rel_tol=_SAME) else [first, best]


def least_distance(one: Family, other: Family) -> float:
    """Least distance of the middles of two families' threads that run one way, mm.

    Lines c1 + k d1 and c2 + m d2 lie apart by c2 − c1 modulo the greatest length of which d1 and
    d2 are multiples; where there is none of a few, they come as near as one likes.
    """
    if one.spacing < other.spacing:
        one, other = other, one
    for times in range(1, FEW + 1):
        if _whole(times * one.spacing / other.spacing):
            step = other.spacing / times
            away = (other.offset - one.offset) % step
            return min(away, step - away)
    return 0.0


def mirrored(families: Iterable[Family], smeared: bool = False) -> bool:
    """Whether x = 0 is a mirror plane of them: it changes hands, and the side of axial threads.

    Args:
        families: all of them.
        smeared: spread over the surface: of what goes around only the directions count.
    """
    return _alike(families, smeared, lambda hand: -hand, lambda f: f.offset, lambda s: -s)


def twofold(families: Sequence[Family], smeared: bool = False) -> float | None:
    """z of a line x = 0 along y half a turn about which maps all onto themselves, mm, or None.

    Half a turn keeps the hand and turns z and s round. 0 where that will do.
    """
    if smeared:
        turned = _alike(families, True, lambda hand: hand, lambda f: f.offset, lambda s: -s)
        return 0.0 if turned else None
    for origin in _origins(families):
        moved = [family.turned(origin) for family in families]
        if _alike(moved, False, lambda hand: hand, lambda f: -f.offset, lambda s: -s):
            return origin
    return None


def _origins(families: Sequence[Family]) -> Iterator[float]:
    """Where such a line may be: midway between two lines of one kind, here of the rarest one."""
    yield 0.0
    whole = common_period(families)
    if whole is None or math.isinf(whole):
        return
    groups: dict[tuple[int, Kind], list[Family]] = {}
    for family in families:
        if family.angle:
            groups.setdefault((family.hand, _kind(family)), []).append(family)
    rarest = min(groups.values(), key=len)
    for one, other in itertools.combinations_with_replacement(rarest, 2):
        middle, step = (one.offset + other.offset) / 2 / one.sine, one.period / 2
        yield from (middle + k * step for k in range(round(2 * whole / step)))


def _kind(family: Family) -> Kind:
    numbers = (family.angle, family.spacing, family.width, family.reach)
    return (*(float(f"{value:.9g}") for value in numbers), float(family.thread))


def _alike(
    families: Iterable[Family],
    smeared: bool,
    hand: Callable[[int], int],
    across: Callable[[Family], float],
    along: Callable[[float], float],
) -> bool:
    """Whether a motion maps families onto themselves.

    Args:
        families: all of them.
        smeared: what goes around counts by its directions alone.
        hand: what becomes of a hand.
        across: what becomes of the offset of what goes around.
        along: the same of threads along the axis, whose offset is s.
    """
    here: dict[tuple[int, Kind], Lines] = {}
    there: dict[tuple[int, Kind], Lines] = {}
    for family in families:
        kind, spread = _kind(family), smeared and not family.place
        own = (0.0 if spread else family.offset, family.spacing)
        moved = across(family) if family.angle else along(family.offset)
        here.setdefault((family.hand, kind), []).append(own)
        image = (hand(family.hand), kind)
        there.setdefault(image, []).append((0.0 if spread else moved, family.spacing))
    return here.keys() == there.keys() and all(_same(here[key], there[key]) for key in here)


def _same(ones: Lines, others: Lines) -> bool:
    """Whether lines lie at the same places, each modulo its spacing."""
    if len(ones) != len(others):
        return False
    left = list(others)
    for offset, spacing in ones:
        match = next((o for o in left if _whole((o[0] - offset) / spacing)), None)
        if match is None:
            return False
        left.remove(match)
    return True


def _whole(ratio: float) -> bool:
    return abs(ratio - round(ratio)) <= _SAME * max(1.0, abs(ratio))

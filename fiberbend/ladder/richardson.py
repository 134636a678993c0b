"""What a quantity tends to as the elements shrink, and how well that is known.

On meshes of sizes h the values are taken as f(h) = f₀ + C hᵖ (Richardson 1911). Three meshes give
f₀ and the observed order p. Roache, Perspective: a method for uniform reporting of grid refinement
studies, J. Fluids Eng. 116 (1994) 405–413, doi 10.1115/1.2910291, has the rule for what is left
uncertain where the order is assumed: three times what is extrapolated.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Sequence

ORDERS = (0.5, 4.0)
"""Least and greatest order that is extrapolated with: quadratic elements have no more than 4 in
quantities of energy, and beside a corner or under a thread less."""
ASSUMED_ORDER = 2.0
"""Of two meshes, whose order nothing tells."""
ASSUMED_FACTOR = 3.0
"""Roache's factor of safety where the order is assumed."""
_SAME = 1e-7
"""Relative differences up to here are the solver's: the tolerance of Newton's method."""
_LEAST_SHARE = 0.25
"""Part of what is extrapolated that stays uncertain however well four meshes agree."""


@dataclasses.dataclass(frozen=True)
class Limit:
    """What values tend to.

    Attributes:
        value: f₀.
        uncertainty: how far from it the truth may be, in the unit of the value; infinite where one
            mesh alone tells nothing.
        order: p, where it was observed and used as it was.
        remark: what is special: not monotone, too few meshes; empty where nothing.
    """

    value: float
    uncertainty: float
    order: float | None = None
    remark: str = ""


def extrapolate(
    sizes: Sequence[float], values: Sequence[float], order: float | None = None
) -> Limit:
    """The limit of values on ever smaller meshes.

    Args:
        sizes: h, falling, in any unit.
        values: of the same number, as exact as the solver's tolerance.
        order: p that other values were observed to have, for two meshes.

    Returns:
        With three meshes and more, f₀ of the finest three, uncertain by all that is extrapolated;
        with four and more by as much as f₀ of the three before differs, from a quarter of what is
        extrapolated to all of it. Where they turn round the last of them, uncertain by the last
        step, or by their spread where steps do not become smaller; where they settle slower than
        with the least of `ORDERS` the last of them, uncertain by what that order would add.

    Raises:
        ValueError: sizes that do not fall, or other numbers of sizes and values.
    """
    _check(sizes, values)
    if len(values) == 1:
        return Limit(values[0], math.inf, remark="one mesh")
    scale = max(abs(value) for value in values)
    spread = max(values[-3:]) - min(values[-3:])
    if spread <= _SAME * scale:
        return Limit(values[-1], spread)
    if len(values) == 2:
        return _of_two(sizes, values, order)
    last = _of_three(sizes[-3:], values[-3:])
    if len(values) == 3 or last.remark:
        return last
    before = _of_three(sizes[-4:-1], values[-4:-1])
    if before.remark:
        return last
    beyond = abs(last.value - values[-1])
    apart = abs(last.value - before.value)
    return dataclasses.replace(last, uncertainty=min(max(apart, _LEAST_SHARE * beyond), beyond))


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float | None:
    """p of three meshes with any ratios of their sizes; None where values turn round.

    Nothing where they fall no faster than a logarithm, infinite above 16.

    (f₁ − f₂)/(f₂ − f₃) = (h₁ᵖ − h₂ᵖ)/(h₂ᵖ − h₃ᵖ), whose right side rises with p.
    """
    coarse, fine = values[0] - values[1], values[1] - values[2]
    if fine == 0 or coarse / fine <= 0:
        return None
    wanted = math.log(coarse / fine)

    def excess(p: float) -> float:
        a, b = math.log(sizes[0] / sizes[1]), math.log(sizes[1] / sizes[2])
        # (h₁ᵖ − h₂ᵖ)/(h₂ᵖ − h₃ᵖ) in logarithms, which no size overflows
        return p * b + math.log(math.expm1(p * a) / math.expm1(p * b)) - wanted

    low, high = 1e-6, 16.0
    if excess(low) > 0:
        return 0.0
    if excess(high) < 0:
        return math.inf
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if excess(middle) < 0 else (low, middle)
    return (low + high) / 2


def _check(sizes: Sequence[float], values: Sequence[float]) -> None:
    if len(sizes) != len(values) or not values:
        raise ValueError(
            f"{len(sizes)} sizes and {len(values)} values, expected as many, from 1 on"
        )
    if any(b >= a for a, b in itertools.pairwise(sizes)) or sizes[-1] <= 0:
        raise ValueError("expected sizes that fall and are above zero")


def _of_two(sizes: Sequence[float], values: Sequence[float], order: float | None) -> Limit:
    p = ASSUMED_ORDER if order is None else min(max(order, ORDERS[0]), ORDERS[1])
    beyond = _beyond(sizes[-2:], values[-2:], p)
    if order is None:
        remark = f"two meshes, order {ASSUMED_ORDER:g} assumed"
        return Limit(values[-1] + beyond, ASSUMED_FACTOR * abs(beyond), remark=remark)
    remark = f"two meshes, order {p:.1f} of other families"
    return Limit(values[-1] + beyond, abs(beyond), remark=remark)


def _of_three(sizes: Sequence[float], values: Sequence[float]) -> Limit:
    coarse, fine = values[0] - values[1], values[1] - values[2]
    spread = max(values) - min(values)
    settling = abs(fine) < abs(coarse)
    p = observed_order(sizes, values)
    if p is None:
        # steps that turn round and become smaller have the limit between them
        return Limit(values[-1], abs(fine) if settling else spread, remark="not monotone")
    if p < ORDERS[0]:
        slow = abs(_beyond(sizes[1:], values[1:], ORDERS[0]))
        uncertain = slow if settling else max(slow, ASSUMED_FACTOR * spread)
        return Limit(values[-1], uncertain, remark="does not settle")
    used = min(p, ORDERS[1])
    beyond = _beyond(sizes[1:], values[1:], used)
    if used < p:
        # faster than the elements can be: the last step tells as much as the rule
        return Limit(values[-1] + beyond, abs(fine), remark=f"order above {used:g}")
    return Limit(values[-1] + beyond, abs(beyond), p)


def _beyond(sizes: Sequence[float], values: Sequence[float], order: float) -> float:
    """f₀ − f of the finer of two meshes."""
    return (values[1] - values[0]) / ((sizes[0] / sizes[1]) ** order - 1)

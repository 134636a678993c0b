"""What the caps of a body do that a section or a cell has not."""

from __future__ import annotations

from fiberbend.accuracy.numbers import numbers, radius
from fiberbend.accuracy.table import Curve, at, down_to, knowledge
from fiberbend.case.case import Case

USUAL = 20.0
"""Length over the radius of the bodies from which the ends are known; from here on it is all one:
of a baseline of 30 radii they are 1 % of themselves more."""
SHORTEST = 10.0
"""The same of the shortest that is known."""


def ends_error(case: Case, state: float) -> float:
    """Percent of P by which a body with caps bends further than its middle.

    By so many radii it seems longer than it is: the ends are a matter of the section and its
    curvature, and hardly of the length, unless they come near to each other. A thin floor bends
    more across itself: only actuators count whose floor is no thinner than the next one below the
    case's.

    Args:
        case: a case.
        state: radius times curvature.
    """
    table = knowledge()
    known = [k for k in table.of_section(case.actuator.section) if k.ends[0]]
    near = down_to(known, "floor", numbers(case)["floor"])
    longer = max(_longer(k.ends, state) for k in near) + table.ends_of_turns
    if case.actuator.length < USUAL * radius(case) * (1 - 1e-6):
        longer += table.ends_of_short
    return 100 * longer * radius(case) / case.actuator.length


def too_short(case: Case) -> list[tuple[str, float]]:
    """In words, and how many times, a body is shorter than any whose ends are known."""
    radii = case.actuator.length / radius(case)
    if case.straight or radii >= SHORTEST * (1 - 1e-6):
        return []
    return [(f"length over radius {radii:.3g} (known: from {SHORTEST:g})", SHORTEST / radii)]


def _longer(ends: tuple[Curve, Curve], state: float) -> float:
    """By how many radii a body seems longer; the greatest of all where it was not bent as far."""
    if state > ends[0][-1]:
        return max(map(abs, ends[1]))
    return abs(at(*ends, state))

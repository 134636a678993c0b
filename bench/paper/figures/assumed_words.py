"""What is said of what the paper leaves open, from the numbers of the record."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bench.paper.assumed.flat import SLACK
from bench.paper.assumed.grid import Grid
from bench.paper.assumed.record import Record
from bench.paper.assumed.solving import PRESSURE
from bench.paper.assumptions import (
    CHOICES,
    DEFAULT,
    RANGES,
    THICKNESS,
    Combination,
    changed,
    ranges,
)
from bench.paper.combination import (
    SERIES,
    Best,
    Predicted,
    Statement,
    alone,
    closed_form,
    kappa,
    misfit,
    predict,
    statements,
)
from bench.paper.facts import BASELINE, STATED
from bench.paper.lines import kpa, printed
from bench.paper.verdict import percent

SAME = 1e-3
"""Of misfit²: what is as good as the best."""
KEPT = 1.0
"""Greatest misfit with which a statement is explained: what our own number may be off by."""


def words(record: Record) -> list[str]:
    """What is open, how it is priced, what follows from what is stated, and what is left."""
    return [
        "The paper does not say everything that its simulations assume. The first table has what "
        "is open, our value, bounds and the reason for each; the second what each costs, one at a "
        "time. Pressures are those of sections with the cell's correction, the winding calibrated. "
        "They are solved on a grid of pitch and thickness; in between they are polynomials, off by "
        f"{100 * max(abs(part) for part in record.held_out):.1f} % at most at "
        f"{len(record.held_out)} places that were solved beside the grid. A wall of 1 or 3 mm and "
        "a shorter chamber have the correction of 2 and 160 mm.",
        _forces(record),
        _pressures(),
        *_outcome(record),
    ]


def _forces(record: Record) -> str:
    """What follows from the stated errors of the force, and what does not."""
    force = kappa(BASELINE[0]) * PRESSURE / 1e3 / DEFAULT.lever
    low, high = _band("force_solid")
    straight = float(alone(record.grid, DEFAULT).ratio(BASELINE[0]))
    held = float(alone(record.grid, changed(DEFAULT, "guided", True)).ratio(BASELINE[0]))
    return (
        f"Forces. The paper states none. Eq. (20) has {force:.2f} N at 200 kPa with L_f = 15 mm. "
        "Errors of 10.3 and 4.3 % against one measured force leave the simulation "
        f"{low:.3f} to {high:.3f} times that. Kept straight, a section has {straight:.2f} times "
        "that, whatever L_f is, since both have the same: no L_f explains the force, and the force "
        "does not determine L_f. A body whose crown a strip holds down, as the plate of Fig. 11, "
        f"has {held:.2f} times that with L_f = 15 mm: {_inside(held, low, high)}. Where a strip "
        "holds it the force bounds L_f: below at 200 kPa, with Fig. 11 at all its pressures. That "
        "the length does not matter follows from nothing that is open: a section does not know its "
        "length, and bodies do not show it (Fig. 11)."
    )


def _inside(value: float, low: float, high: float) -> str:
    return "within the band" if low <= value <= high else "outside the band"


def _pressures() -> str:
    """What follows from the stated error of the pressure."""
    low, high = _band("pressure")
    off = STATED["full_circle"].value / closed_form()
    times = float(kpa(printed(), 360.0)) / closed_form()
    return (
        "Pressures. Errors of 10.9 % of both models against one measured pressure leave the "
        f"simulation {low:.3f} to {high:.3f} times eq. (19). As printed that equation is "
        f"{times:.0f} times too high. Without its extra L it has {closed_form():.1f} kPa with the "
        f"stated 0.314 MPa; 196 kPa are {percent(off - 1)} from it, {_inside(off, low, high)}. So "
        "the two numbers can both be, and the band says nothing of the simulation that 196 kPa "
        "does not."
    )


def _band(key: str) -> tuple[float, float]:
    (one, *_) = (each for each in statements() if each.key == key)
    return one.low, one.high


def _outcome(record: Record) -> list[str]:
    """The best combination in words: how well it does, what stays unexplained, what is flat."""
    best = record.best[0]
    given = alone(record.grid, best.given)
    stated = statements()
    left = [one for one in stated if float(one.misfit(given)) > KEPT]
    unkept = "; ".join(f"{one.what}: {number(one, given)}, stated {interval(one)}" for one in left)
    unexplained = (
        f"Not explained: {unkept}; within the bounds nothing explains all at once."
        if left
        else "Nothing is left."
    )
    radii = _listed([float(given.pressures[key]) for key in SERIES["radius"]])
    at_end = [
        each.what
        for each in ranges(best.given.readings)
        if min(abs(getattr(best.given, each.key) - end) for end in each.bounds)
        < 1e-3 * (each.high - each.low)
    ]
    loose = [
        choice.what
        for choice in CHOICES
        if other(record, choice.key).misfit ** 2 <= best.misfit**2 + SLACK
    ]
    by_cell = {one.key: one.cell for one in record.cells}
    around = _listed([by_cell[key] for key in SERIES["radius"]])
    cells = max(abs(one.grid / one.cell - 1) for one in record.cells)
    bodies = max(abs(one.grid / one.body - 1) for one in record.bodies)
    return [
        "The best combination within the bounds is in the third table. Its misfit is "
        f"{best.misfit:.2f}, that of ours elsewhere on this page {misfit_of(record, DEFAULT):.2f}. "
        f"It explains {len(stated) - len(left)} of {len(stated)} statements. {unexplained} P is "
        f"{radii} kPa for radii of 6, 8, 10 and 12 mm. A wide floor gives way more than a narrow "
        "one; a floor stiff enough against that makes the baseline too stiff.",
        f"At the end of its bounds: {_or_none(at_end)}. Not determined, since the other reading "
        f"adds less than 1 to misfit²: {_or_none(loose)}.",
        _weaker(record),
        "The best combination solved anew: cells with every turn are within "
        f"{100 * cells:.1f} % of the pressures with which it was found, bodies within "
        f"{100 * bodies:.1f} % of the forces; both have the sheath all around. Over the radius the "
        f"cells have {around} kPa.",
    ]


def _weaker(record: Record) -> str:
    """What explains the statements if the steps of the radius do not count."""
    ends = record.ends
    found = alone(record.grid, ends.given)
    spans = []
    for profile, each in zip(record.ends_profiles, RANGES, strict=True):
        allowed = profile.allowed(ends.misfit, SAME)
        if allowed is not None and each.key in ("pitch", ends.given.base):
            spans.append(f"{each.what} {allowed[0]:.2f} to {allowed[1]:.2f} mm")
    all_but = " So all is explained but that last step." if ends.misfit**2 < SAME else ""
    floors = floors_at(record.grid, DEFAULT.pitch)
    return (
        "Table II has a sign and no steps; that each step counts is asked here, as the paper has "
        "four simulations over the radius. If only 6 and 12 mm are compared, the misfit is "
        f"{ends.misfit:.2f}, for instance with the last column of that table, where P changes by "
        f"{percent(float(found.fall()))} from 6 to 12 mm and by "
        f"{percent(float(found.steps('radius')[-1]))} from 10 to 12 mm. As good are, with all "
        f"others free: {'; '.join(spans)}; with a pitch of {DEFAULT.pitch:g} mm and all else as "
        f"ours but the strip, floors of {floors[0]:.2f} to {floors[1]:.2f} mm. A wider pitch makes "
        f"up for a thinner floor.{all_but}"
    )


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.1f}" for value in values)


def _or_none(names: Sequence[str]) -> str:
    return "; ".join(names) or "none"


def other(record: Record, key: str) -> Best:
    """The best combination with one reading turned around."""
    value = bool(getattr(record.best[0].given, key))
    return min(
        (one for one in record.best if bool(getattr(one.given, key)) is not value),
        key=lambda one: one.misfit,
    )


def floors_at(grid: Grid, pitch: float) -> tuple[float, float]:
    """Floors in mm that explain everything but the steps of the radius, held by a strip.

    Args:
        grid: sections that were solved.
        pitch: of the winding, mm; all else is ours.
    """
    given = changed(DEFAULT, "guided", True)
    floors, levers = np.linspace(*THICKNESS.bounds, 601), np.linspace(10.0, 15.0, 26)[:, None]
    found = predict(grid, given.readings, (np.asarray(pitch), floors, levers))
    left = np.broadcast_to(misfit(found, statements(ends=True)), (26, 601)).min(axis=0)
    inside = floors[left**2 <= left.min() ** 2 + SAME]
    return float(inside[0]), float(inside[-1])


def misfit_of(record: Record, given: Combination) -> float:
    """Of a combination with every statement."""
    at = alone(record.grid, given)
    return math.sqrt(sum(float(one.misfit(at)) ** 2 for one in statements()))


def values(given: Combination) -> list[str]:
    """Of everything that is open, in the order of `RANGES` and `CHOICES`."""
    numbers = [
        "–"
        if each.key in ("floor", "layer") and each.key != given.base
        else each.words(float(getattr(given, each.key)))
        for each in RANGES
    ]
    return numbers + [choice.words(bool(getattr(given, choice.key))) for choice in CHOICES]


def number(one: Statement, at: Predicted) -> str:
    """What a combination gives of a statement."""
    return shown(one, float(one.of(at)))


def shown(one: Statement, value: float) -> str:
    """A value of its number: of steps their percent, of ratios three digits."""
    if one.unit:
        return f"{value:.1f} {one.unit}"
    # steps are changes, ratios are not
    return percent(value) if "step" in one.what else f"{value:.3f}"


def interval(one: Statement) -> str:
    """What keeps it."""
    if math.isinf(one.low):
        return f"≤ {shown(one, one.high)}"
    if math.isinf(one.high):
        return f"≥ {shown(one, one.low)}"
    return f"{shown(one, one.low)} to {shown(one, one.high)}"

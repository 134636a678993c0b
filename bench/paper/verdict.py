"""Verdicts on what the paper states: computed from a number and a bound, never written by hand."""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
from collections.abc import Sequence

import numpy as np

from bench.paper.facts import FALLS, RISES, STATED, STAYS, Stated
from geometry.mesh.data import Floats

FLAT = 0.01
"""Part by which a quantity may change and is still insignificant in the sense of Table II."""

UNREACHED = "the run ends before"
_GLUE = "\u00a0"
"""Between a number and its unit, which stay in one line."""


@dataclasses.dataclass(frozen=True)
class Verdict:
    """What has come of a stated number in one of our models.

    Attributes:
        stated: what the paper states.
        model: which of ours is beside it.
        ours: what it gives.
        kept: whether it is within the bound; None where nothing can be compared.
        why: the bound and how far off, or why nothing can be compared.
        taken: it is an input that our models take as it is stated.
    """

    stated: Stated
    model: str
    ours: str
    kept: bool | None
    why: str
    taken: bool = False

    @property
    def word(self) -> str:
        """The verdict itself."""
        return {True: "kept", False: "not kept", None: "cannot be compared"}[self.kept]


def percent(part: float, digits: int = 1) -> str:
    """A part with its sign in percent."""
    return f"{100 * part:+.{digits}f}{_GLUE}%".replace("-", "−")


def number(value: float, unit: str = "", digits: int = 4) -> str:
    """A number and its unit."""
    return f"{value:.{digits}g}{_GLUE}{unit}".strip().replace("-", "−")


def near(key: str, model: str, ours: float, bound: float, source: str) -> Verdict:
    """Within a part of the stated number.

    Args:
        key: of the stated number.
        model: of ours.
        ours: our number, in its unit.
        bound: greatest part by which it may differ.
        source: where the bound is from.
    """
    stated = STATED[key]
    if not math.isfinite(ours):
        return Verdict(stated, model, "", None, UNREACHED)
    off = ours / stated.value - 1
    kept = bool(abs(off) <= bound)
    why = f"{percent(off)}, bound ±{100 * bound:.3g} %, {source}"
    return Verdict(stated, model, number(ours, stated.unit), kept, why)


def rounded(key: str, model: str, ours: float) -> Verdict:
    """The stated number is ours, rounded to the digits in which it is printed."""
    stated = STATED[key]
    match = re.search(r"\d+(?:\.(\d+))?", stated.printed)
    places = len(match[1] or "") if match else 0
    kept = bool(abs(ours - stated.value) <= 0.5 * 10.0**-places * (1 + 1e-9))
    decimals = "1 decimal" if places == 1 else f"{places} decimals"
    why = f"{percent(ours / stated.value - 1)}, printed with {decimals}"
    return Verdict(stated, model, number(ours, stated.unit, 5), kept, why)


def within(key: str, model: str, ours: float, bound: float, source: str) -> Verdict:
    """Within a distance of the stated number, in its unit."""
    stated = STATED[key]
    off = ours - stated.value
    kept = bool(abs(off) <= bound)
    sign = f"{off:+.3g}".replace("-", "−")
    why = f"{sign} {stated.unit}, bound ±{bound:g} {stated.unit}, {source}"
    return Verdict(stated, model, number(ours, stated.unit, 3), kept, why)


def used(key: str, ours: float, where: str) -> Verdict:
    """A number that our models take as it is stated."""
    stated = STATED[key]
    kept = math.isclose(ours, stated.value, rel_tol=1e-12)
    why = "taken as stated" if kept else "taken otherwise"
    return Verdict(stated, where, number(ours, stated.unit, 6), kept, why, taken=kept)


def holds(key: str, model: str, ours: str, kept: bool, why: str) -> Verdict:
    """A statement that is true or not of our numbers."""
    return Verdict(STATED[key], model, ours, bool(kept), why)


def unknown(key: str, model: str, ours: str, why: str) -> Verdict:
    """Nothing to hold it to."""
    return Verdict(STATED[key], model, ours, None, why)


def sign_of(values: Sequence[float]) -> str:
    """How a quantity changes over rising values of a dimension.

    One of the signs of Table II; where it both rises and falls by more than `FLAT`, ∪ or ∩.
    """
    least, most = min(values), max(values)
    if most <= (1 + FLAT) * least:
        return STAYS
    steps = [b - a for a, b in itertools.pairwise(values)]
    if all(step > 0 for step in steps):
        return RISES
    if all(step < 0 for step in steps):
        return FALLS
    return "∪" if min(values[0], values[-1]) > least else "∩"


def trend(key: str, model: str, values: Sequence[float], over: str) -> Verdict:
    """A sign of Table II.

    Args:
        key: of the sign.
        model: of ours.
        values: our quantity over rising values of the dimension.
        over: the values of the dimension in words.
    """
    stated = STATED[key]
    if not all(math.isfinite(value) for value in values):
        return Verdict(stated, model, "", None, UNREACHED)
    found = sign_of(values)
    change = percent(values[-1] / values[0] - 1)
    shown = ", ".join(f"{value:.4g}" for value in values)
    return Verdict(
        stated, model, f"{found} ({change})", found == stated.printed, f"{shown} over {over}"
    )


def shared(values: Sequence[float], errors: Sequence[float]) -> tuple[float, float]:
    """The measured values from which every model is off by no more than its stated error.

    |v − m| ≤ e m for all v, e. Such an m is there if the first number is not above the second.

    Args:
        values: of the models, above zero.
        errors: greatest error of each, a part of what is measured.

    Returns:
        Least and greatest m.
    """
    low = max(v / (1 + e) for v, e in zip(values, errors, strict=True))
    high = min(v / (1 - e) for v, e in zip(values, errors, strict=True))
    return low, high


def possible(
    key: str,
    models: Sequence[str],
    values: Sequence[float],
    errors: Sequence[float],
    where: str,
    unit: str = "kPa",
) -> Verdict:
    """An error against experiments whose points are not published: what can be said without them.

    Two models cannot both be within their errors of one measured value if they are too far apart.

    Args:
        key: of the stated error.
        models: of ours, one word each.
        values: theirs, in one unit.
        errors: stated for each.
        where: at which state.
        unit: of the values.
    """
    stated = STATED[key]
    low, high = shared(values, errors)
    if not all(math.isfinite(value) for value in values):
        return Verdict(stated, " and ".join(models), "", None, UNREACHED)
    ours = " and ".join(number(value, unit) for value in values)
    if low <= high:
        why = (
            f"the measured points are not published; {where} a measurement from {low:.4g} to "
            f"{high:.4g} {unit} would keep both errors"
        )
        return Verdict(stated, " and ".join(models), ours, None, why)
    why = f"{where} no measurement is within the stated errors of both: {low:.4g} > {high:.4g}"
    return Verdict(stated, " and ".join(models), ours, False, why)


def possible_place(
    key: str,
    models: Sequence[str],
    first: Floats,
    second: Floats,
    rest: Floats,
    error: float,
    angles: Floats,
) -> Verdict:
    """The same of places: could one measured path be within the error of two models?

    The error is taken as a part of the measured way from rest, |x − m| ≤ e |m − x0|: m then is in
    a ball about x0 + (x − x0)/(1 − e²) of radius e |x − x0|/(1 − e²) (Apollonius). Two balls that
    do not meet leave no m.

    Args:
        key: of the stated error.
        models: of ours.
        first: places of the one, (n, 2), mm.
        second: places of the other, (n, 2), mm.
        rest: x0, (2,), mm.
        error: e.
        angles: at which they are, (n,), °.
    """
    ways = [places - rest for places in (first, second)]
    lengths = [np.linalg.norm(way, axis=1) for way in ways]
    apart = np.linalg.norm(ways[0] - ways[1], axis=1)
    reach = error * (lengths[0] + lengths[1])
    worst = int(np.argmax(apart / reach))
    part = float((apart / ((lengths[0] + lengths[1]) / 2))[worst])
    ours = f"{apart[worst]:.2g} mm apart at {angles[worst]:.0f}°, {100 * part:.1f} % of the way"
    shown = " and ".join(models)
    if np.all(apart <= reach):
        why = (
            "the measured points are not published; one path could be within the error of both, "
            "if it is a part of the way from rest"
        )
        return Verdict(STATED[key], shown, ours, None, why)
    return Verdict(STATED[key], shown, ours, False, "no measured place is within it of both")

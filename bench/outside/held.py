"""Tubes whose ends are held: axial force and torque against pressure, as measured at Michigan.

The source's signs: F pushes on what holds the ends, and a family of an angle above zero turns them
by M > 0. So it is left-handed here. Both are what the tube does, as the section's columns are, and
the opposite of what holds the exact tube, N and T.
"""

from __future__ import annotations

import math

from analytic.tube import Family, Held
from bench.outside.table import Row, percent
from bench.outside.tubes import Rubber, Threads, section

RADIUS, LENGTH, WALL = 5.0, 100.0, 1.0
MU = 0.388
"""MPa; neither it nor the wall enters where fibers keep their length and nothing moves."""
SUBJECT = "Tube, one family, ends held"
NAMES, UNITS = ("F/P", "M/P"), ("mm²", "mm³")
EXTENSIONS = (0.0, 5.0)
"""mm."""
PRESSURES = (0.01, 0.1)
STIFF = 1e6
"""EA of a thread of the section in N that hardly stretches: 3e-4 of F/P, 3e-3 at 1e5."""
NEAR = 1e-3
"""How near the section is to be to the exact tube, whose fibers cannot be stretched."""
STIFFNESS = 100.0
"""Of a family that gives, N/mm: so stiff that it strains by 0.5 % at 100 kPa."""
MEASURED = {48.0: (-44.5, 835.0), -48.0: (-41.8, -714.0), -85.0: (60.6, -156.0)}
"""F/P in mm² and M/P in mm³ at 0 mm and 0°."""
LONGER = {48.0: -57.0, -48.0: -56.3, -85.0: 62.7}
"""F/P at 5 mm and 0°."""
ASKED = {48.0: (0.2, 0.2), -48.0: (0.2, 0.2), -85.0: (0.25, None)}
UNKNOWN = {
    48.0: "wall, thread count, end fittings",
    -48.0: "wall, thread count, end fittings",
    -85.0: "the wound angle as made (−79° would have the measured M/P and an F/P of +72 mm²), "
    "wall, thread count, end fittings",
}


def slopes(
    degrees: float, stretch: float = 1.0, stiffness: float = math.inf
) -> tuple[float, float]:
    """F/P in mm² and M/P in mm³ of the exact tube between two pressures.

    Args:
        degrees: lean of the fibers.
        stretch: that is held.
        stiffness: of the family, N/mm.
    """
    family = Family(-math.radians(degrees), stiffness)
    tube = Rubber(MU, RADIUS - WALL, RADIUS, LENGTH).wound(family)
    low = tube.solve(Held(pressure=PRESSURES[0], stretch=1.0, twist=0.0))
    low = tube.solve(Held(pressure=PRESSURES[0], stretch=stretch, twist=0.0), low)
    high = tube.solve(Held(pressure=PRESSURES[1], stretch=stretch, twist=0.0), low)
    step = PRESSURES[1] - PRESSURES[0]
    return (low.force - high.force) / step, (low.torque - high.torque) / step


def computed(degrees: float, stretch: float = 1.0) -> tuple[float, float]:
    """The same of the section model, its ends held.

    Args:
        degrees: lean of the fibers.
        stretch: that is held.
    """
    tube = Rubber(MU, RADIUS - WALL, RADIUS, LENGTH)
    hold = {"stretch": stretch, "twist": "0 deg"}
    low, high = section(tube, [Threads(-degrees, STIFF)], PRESSURES, hold=hold)
    step = (high["pressure_kPa"] - low["pressure_kPa"]) / 1e3
    # these columns are what the tube does to what holds it, as the source's F and M
    force, torque = (high[name] - low[name] for name in ("axial_force_N", "torque_Nmm"))
    return force / step, torque / step


def beside_theory(degrees: float) -> Row:
    """The section's slope that is farthest from the exact tube's."""
    pairs = [
        (f"{name} at {mm:g} mm", unit, ours, theirs)
        for mm in EXTENSIONS
        for name, unit, ours, theirs in zip(
            NAMES,
            UNITS,
            computed(degrees, 1 + mm / LENGTH),
            slopes(degrees, 1 + mm / LENGTH),
            strict=True,
        )
    ]
    name, unit, ours, theirs = max(pairs, key=lambda pair: abs(pair[2] / pair[3] - 1))
    return Row(
        SUBJECT,
        f"{degrees:+g}°: section against the exact tube, worst ({name}) of F/P and M/P at "
        f"{EXTENSIONS[0]:g} and {EXTENSIONS[1]:g} mm of extension",
        f"{ours:+.3f} {unit}",
        f"{theirs:+.3f} {unit}",
        ours / theirs - 1,
        NEAR,
        "theory",
    )


def both_measures(ours: float, theirs: float, asked: float | None) -> str:
    """What a row that misses its bound says of the other measure; empty for others."""
    if asked is None or abs(ours / theirs - 1) <= asked:
        return ""
    return (
        f"; off: of the measured figure, {percent(1 - theirs / ours, sign=False)} of the computed"
    )


def rows() -> list[Row]:
    """Section beside theory, then beside force and torque of the three tubes."""
    made = []
    for degrees, measured in MEASURED.items():
        made.append(beside_theory(degrees))
        for name, unit, digits, ours, theirs, asked, other in zip(
            NAMES,
            UNITS,
            (1, 0),
            computed(degrees),
            measured,
            ASKED[degrees],
            slopes(degrees, stiffness=STIFFNESS),
            strict=True,
        ):
            made.append(
                Row(
                    SUBJECT,
                    f"{degrees:+g}°: {name}{both_measures(ours, theirs, asked)}",
                    f"{ours:+.{digits}f} {unit}",
                    f"{theirs:+.{digits}f} {unit}",
                    ours / theirs - 1,
                    asked,
                    "Bruder 2018",
                    f"{UNKNOWN[degrees]}; a wall of 1 mm and a family of 100 N/mm give "
                    f"{other:+.{digits}f}",
                )
            )
        longer = computed(degrees, 1 + EXTENSIONS[1] / LENGTH)[0]
        made.append(
            Row(
                SUBJECT,
                f"{degrees:+g}°: F/P at {EXTENSIONS[1]:g} mm of extension",
                f"{longer:+.1f} mm²",
                f"{LONGER[degrees]:+.1f} mm²",
                longer / LONGER[degrees] - 1,
                None,
                "Bruder 2018",
                UNKNOWN[degrees],
            )
        )
    return made

"""Tubes whose ends are held: axial force and torque against pressure, as measured at Michigan.

The source's signs: F pushes on what holds the ends, and a family of an angle above zero turns them
by M > 0. So it is left-handed here, and both are the opposite of what holds the ends, N and T.
"""

from __future__ import annotations

import math

from analytic.tube import Family, Held
from bench.outside.table import Row
from bench.outside.tubes import Rubber

RADIUS, LENGTH, WALL = 5.0, 100.0, 1.0
MU = 0.388
"""MPa; neither it nor the wall enters where fibers keep their length and nothing moves."""
SUBJECT = "Tube, one family, ends held"
PRESSURES = (0.01, 0.1)
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
    -85.0: "the wound angle as made (−79° would have the measured M/P), wall, thread count, end "
    "fittings",
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


def rows() -> list[Row]:
    """Force and torque of the three tubes."""
    made = []
    for degrees, (force, torque) in MEASURED.items():
        found = slopes(degrees)
        giving = slopes(degrees, stiffness=STIFFNESS)
        for name, unit, ours, theirs, asked, other in zip(
            ("F/P", "M/P"),
            ("mm²", "mm³"),
            found,
            (force, torque),
            ASKED[degrees],
            giving,
            strict=True,
        ):
            digits = 1 if name == "F/P" else 0
            made.append(
                Row(
                    SUBJECT,
                    f"{degrees:+g}°: {name}",
                    f"{ours:+.{digits}f} {unit}",
                    f"{theirs:+.{digits}f} {unit}",
                    ours / theirs - 1,
                    asked,
                    "Bruder 2018",
                    f"{UNKNOWN[degrees]}; a wall of 1 mm and a family of 100 N/mm give "
                    f"{other:+.{digits}f}",
                )
            )
        ours = slopes(degrees, 1 + 5 / LENGTH)[0]
        made.append(
            Row(
                SUBJECT,
                f"{degrees:+g}°: F/P at 5 mm of extension",
                f"{ours:+.1f} mm²",
                f"{LONGER[degrees]:+.1f} mm²",
                ours / LONGER[degrees] - 1,
                None,
                "Bruder 2018",
                UNKNOWN[degrees],
            )
        )
    return made

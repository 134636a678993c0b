"""The section model beside the exact tube over a grid of angles, and a braid's angle of rest."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

from scipy.optimize import brentq

from analytic.tube import Family, Held, Tube
from bench.outside.table import Row
from bench.outside.tubes import exact, per_width, section

MU, INNER, OUTER, LENGTH = 0.24, 6.35, 8.35, 100.0
EA = 771.0
"""Of a thread, N: Kevlar of 0.18 mm."""
PRESSURE = 0.02
ANGLES = (10.0, 20.0, 30.0, 40.0, 50.0, 54.7356, 60.0, 70.0, 80.0, 85.0)
PATTERNS = {"single-helix-right": (1,), "double-helix": (1, -1)}
NAMES = {"single-helix-right": "one family", "double-helix": "two families"}
LOCKING = math.degrees(math.atan(math.sqrt(2)))
SMALL = 1e-5
"""MPa, where a tube answers in proportion."""
ASKED = 1e-4
SUBJECT = "Tube of any angle, free"


def grid() -> list[Row]:
    """Stretch and twist of the worst angle, for one family and for two."""
    made = []
    for pattern, hands in PATTERNS.items():
        worst: dict[str, tuple[float, float, float, float]] = {}
        for degrees in ANGLES:
            width = per_width(EA, OUTER, degrees)
            families = (Family(hand * math.radians(degrees), width) for hand in hands)
            known = exact(MU, INNER, OUTER, *families).solve(Held(pressure=PRESSURE))
            found = section((MU, INNER, OUTER, LENGTH), (pattern, degrees, EA), [PRESSURE])[0]
            pairs = {"stretch": (found["axis_stretch"], known.stretch)}
            if len(hands) == 1:
                twist = math.radians(found["twist_deg"])
                pairs["twist, rad"] = (twist, known.twist * LENGTH)
            for name, (ours, theirs) in pairs.items():
                error = ours / theirs - 1
                if name not in worst or abs(error) > abs(worst[name][0]):
                    worst[name] = (error, ours, theirs, degrees)
        for name, (error, ours, theirs, degrees) in worst.items():
            made.append(
                Row(
                    SUBJECT,
                    f"{NAMES[pattern]} of elastic fibers at {PRESSURE * 1e3:g} kPa: section "
                    f"against the exact tube, {name}, worst ({degrees:g}°) of {len(ANGLES)} angles "
                    f"from {ANGLES[0]:g} to {ANGLES[-1]:g}°",
                    f"{ours:.7f}",
                    f"{theirs:.7f}",
                    error,
                    ASKED,
                    "theory",
                    "",
                )
            )
    return made


def growth(degrees: float, wall: float) -> float:
    """Strain along a balanced braid of fixed lengths under a small pressure."""
    families = (Family(hand * math.radians(degrees)) for hand in (1, -1))
    return exact(MU, OUTER - wall, OUTER, *families).solve(Held(pressure=SMALL)).stretch - 1


def locking() -> list[Row]:
    """Where a balanced braid neither grows nor shrinks, and that it does on either side."""
    made = []
    for wall, name in ((0.05, "thin"), (2.0, "thick")):
        found = float(brentq(functools.partial(growth, wall=wall), 50.0, 60.0, xtol=1e-6))
        below, above = growth(LOCKING - 1, wall), growth(LOCKING + 1, wall)
        if not below < 0 < above:
            raise RuntimeError(f"{name} braid: {below:.1e} below and {above:.1e} above")
        made.append(
            Row(
                "Balanced braid of fixed lengths",
                f"{name} wall: angle without a change of length; a degree less it shrinks, a "
                "degree more it grows",
                f"{found:.4f}°",
                f"{LOCKING:.4f}°",
                found / LOCKING - 1,
                1e-4,
                "braid",
                "",
            )
        )
    return made


def torsion() -> list[Row]:
    """Rivlin's torsion of a tube that keeps its radii and its length."""
    twist, outer, inner = 0.05, 10.0, 8.0
    tube: Tube = exact(MU, inner, outer)
    # dσr/dr = (σφ − σr)/r = μ ψ² r, and σr(B) = 0
    pressure = MU * twist**2 * (outer**2 - inner**2) / 2
    found = tube.solve(Held(pressure=pressure, stretch=1.0, twist=twist))
    known = math.pi * MU * twist * (outer**4 - inner**4) / 2
    return [
        Row(
            "Tube twisted at constant length",
            "torque at 0.05 rad/mm, exact tube",
            f"{found.torque:.6f} N mm",
            f"{known:.6f} N mm",
            found.torque / known - 1,
            1e-8,
            "torsion",
            "",
        )
    ]


PARTS: tuple[Callable[[], list[Row]], ...] = (grid, locking, torsion)


def rows() -> list[Row]:
    """All of them."""
    return [row for part in PARTS for row in part()]

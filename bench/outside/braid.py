"""The section model beside the exact tube over a grid of angles, and a braid's angle of rest."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable

from scipy.optimize import brentq

from analytic.tube import Family, Held
from bench.outside.table import Row
from bench.outside.tubes import Rubber, Threads, section

TUBE = Rubber(0.24, 6.35, 8.35, 100.0)
EA = 771.0
"""Of a thread, N: Kevlar of 0.18 mm."""
STARTS = 4
PRESSURE = 0.02
ANGLES = (10.0, 20.0, 30.0, 40.0, 50.0, 54.7356, 60.0, 70.0, 80.0, 85.0)
WOUND: dict[str, Callable[[float], list[Threads]]] = {
    "one family": lambda degrees: [Threads(degrees, EA, STARTS)],
    "two of both hands": lambda degrees: [Threads(hand * degrees, EA, STARTS) for hand in (1, -1)],
    "one, and half as much at −70°": lambda degrees: [
        *(Threads(degrees, EA, STARTS), Threads(-70.0, EA, STARTS // 2))
    ],
}
LOCKING = math.degrees(math.atan(math.sqrt(2)))
NO_TWIST = 1e-9
"""rad/mm; less is round-off of a braid that is its own mirror image."""
SMALL = 1e-5
"""MPa, where a tube answers in proportion."""
ASKED = 1e-4
SUBJECT = "Tube of any angle, free"


def grid() -> list[Row]:
    """Stretch and twist of the worst angle, for one family and for two."""
    made = []
    for name, threads in WOUND.items():
        worst: dict[str, tuple[float, float, float, float]] = {}
        for degrees in ANGLES:
            around = threads(degrees)
            families = (each.family(TUBE.outer) for each in around)
            known = TUBE.wound(*families).solve(Held(pressure=PRESSURE))
            found = section(TUBE, around, [PRESSURE])[0]
            pairs = {"stretch": (found["axis_stretch"], known.stretch)}
            if abs(known.twist) > NO_TWIST:
                twist = math.radians(found["twist_deg"])
                pairs["twist, rad"] = (twist, known.twist * TUBE.length)
            for figure, (ours, theirs) in pairs.items():
                error = ours / theirs - 1
                if figure not in worst or abs(error) > abs(worst[figure][0]):
                    worst[figure] = (error, ours, theirs, degrees)
        for figure, (error, ours, theirs, degrees) in worst.items():
            made.append(
                Row(
                    SUBJECT,
                    f"{name}, elastic, {PRESSURE * 1e3:g} kPa: section against the exact tube, "
                    f"{figure}, worst ({degrees:g}°) of {len(ANGLES)} angles from {ANGLES[0]:g} to "
                    f"{ANGLES[-1]:g}°",
                    f"{ours:.7f}",
                    f"{theirs:.7f}",
                    error,
                    ASKED,
                    "theory",
                )
            )
    return made


def growth(degrees: float, wall: float) -> float:
    """Strain along a balanced braid of fixed lengths under a small pressure."""
    families = (Family(hand * math.radians(degrees)) for hand in (1, -1))
    tube = dataclasses.replace(TUBE, inner=TUBE.outer - wall).wound(*families)
    return tube.solve(Held(pressure=SMALL)).stretch - 1


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
    tube = dataclasses.replace(TUBE, inner=inner, outer=outer).wound()
    # dσr/dr = (σφ − σr)/r = μ ψ² r, and σr(B) = 0
    pressure = TUBE.mu * twist**2 * (outer**2 - inner**2) / 2
    found = tube.solve(Held(pressure=pressure, stretch=1.0, twist=twist))
    known = math.pi * TUBE.mu * twist * (outer**4 - inner**4) / 2
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

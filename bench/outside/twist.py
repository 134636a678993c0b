"""Latex tubes with one family of fibers: twist and extension as measured at Michigan."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from analytic.tube import Family, Held, TubeState
from bench.outside.table import Row
from bench.outside.tubes import Rubber, Threads, section

INNER, OUTER, LENGTH = 4.7625, 6.35, 86.36
PSI, INCH = 6.894757e-3, 25.4
STIFF = 1e6
"""EA of a thread in N that hardly stretches: 3e-4 of the twist at 1e5."""
SUBJECT = "Latex tube, one family, free"
UNKNOWN = "wound angle as made, thread count, friction; latex is no neo-Hooke rubber"


@dataclasses.dataclass(frozen=True)
class Sample:
    """A tube, on its first loading.

    Attributes:
        degrees: lean of its fibers from the axis.
        psi: pressures.
        twist: measured, rad.
        extension: measured, inches; empty where it was not.
        asked: greatest rms error over the greatest twist; None: printed as it is.
        loop: how much more it twists at 5 psi on the way down; None where that was not read.
    """

    degrees: float
    psi: tuple[float, ...]
    twist: tuple[float, ...]
    extension: tuple[float, ...] = ()
    asked: float | None = None
    loop: float | None = None


FITTED = "40°"
SAMPLES = {
    FITTED: Sample(
        *(40.0, (2.5, 5.0, 8.5, 10.0, 13.0), (0.325, 0.681, 1.323, 1.673, 2.561)),
        (0.0, 0.0, 0.004, 0.020, 0.060),
        loop=0.13,
    ),
    "40°, second sample": Sample(
        *(40.0, (3.0, 5.4, 8.8, 10.1, 13.7), (0.358, 0.736, 1.395, 1.752, 2.788)),
        (0.0, 0.008, 0.036, 0.052, 0.112),
        asked=0.03,
    ),
    "50°": Sample(
        *(50.0, (2.5, 5.0, 8.5, 10.0, 13.0), (0.351, 0.784, 1.559, 1.901, 3.204)),
        (0.0, 0.004, 0.048, 0.060, 0.148),
        asked=0.05,
        loop=0.42,
    ),
    "20°": Sample(20.0, (2.5, 5.0, 8.5, 10.0), (0.142, 0.344, 0.788, 1.030), loop=0.14),
    "60°": Sample(
        *(60.0, (2.5, 5.0, 8.5, 10.0, 13.0), (0.315, 0.800, 1.505, 1.851, 2.865)),
        (0.0, 0.012, 0.064, 0.084, 0.164),
        loop=0.28,
    ),
}
"""Measured, of the source's own lists."""


def states(mu: float, sample: Sample) -> list[TubeState]:
    """The exact tube, its fibers of fixed length; left-handed, so that the twist is above zero."""
    tube = Rubber(mu, INNER, OUTER, LENGTH).wound(Family(-math.radians(sample.degrees)))
    found: list[TubeState] = []
    for psi in sample.psi:
        found.append(tube.solve(Held(pressure=psi * PSI), found[-1] if found else None))
    return found


def _twists(found: list[TubeState]) -> NDArray[np.float64]:
    return np.array([state.twist * LENGTH for state in found])


def fitted() -> float:
    """μ in MPa by least squares of the twist of the first sample at 40° alone."""
    sample = SAMPLES[FITTED]

    def gap(mu: float) -> float:
        return float(np.sum((_twists(states(mu, sample)) - sample.twist) ** 2))

    return float(minimize_scalar(gap, bounds=(0.3, 0.5), method="bounded").x)


def leaning(mu: float, sample: Sample) -> tuple[float, float]:
    """The lean in degrees with which the tube twists most like a sample, and its rms error then."""

    def gap(degrees: float) -> float:
        leant = dataclasses.replace(sample, degrees=degrees)
        return float(np.mean((_twists(states(mu, leant)) - sample.twist) ** 2))

    bounds = (sample.degrees - 15, sample.degrees + 15)
    found = minimize_scalar(gap, bounds=bounds, method="bounded", options={"xatol": 0.01})
    return float(found.x), math.sqrt(found.fun) / max(sample.twist)


def rows() -> list[Row]:
    """Section beside theory, then theory beside measurement."""
    mu = fitted()
    made = []
    for name, sample in SAMPLES.items():
        ideal = states(mu, sample)
        theory = _twists(ideal)
        pressures = [psi * PSI for psi in sample.psi]
        ran = section(
            Rubber(mu, INNER, OUTER, LENGTH), [Threads(-sample.degrees, STIFF)], pressures
        )
        ours = np.radians([row["twist_deg"] for row in ran])
        worst = int(np.argmax(np.abs(ours / theory - 1)))
        made.append(
            Row(
                SUBJECT,
                f"{name}: section against the thick-tube theory, twist, worst pressure",
                f"{ours[worst]:.4f} rad",
                f"{theory[worst]:.4f} rad",
                float(ours[worst] / theory[worst] - 1),
                0.005,
                "theory",
                "",
            )
        )
        measured = np.array(sample.twist)
        how = f"μ = {1e3 * mu:.1f} kPa fitted to it" if name == FITTED else "untuned"
        loop = "" if sample.loop is None else f"; its own loop: {100 * sample.loop:.0f} % at 5 psi"
        if name != FITTED and sample.asked is None:
            lean, rest = leaning(mu, sample)
            loop += f"; a lean of {lean:.0f}° would fit to {100 * rest:.1f} %"
        made.append(
            Row(
                SUBJECT,
                f"{name}: twist, {how}; off: rms over the greatest",
                ", ".join(f"{value:.3f}" for value in ours) + " rad",
                ", ".join(f"{value:.3f}" for value in measured)
                + f" rad at {', '.join(f'{psi:g}' for psi in sample.psi)} psi",
                float(np.sqrt(np.mean((ours - measured) ** 2)) / measured.max()),
                sample.asked,
                "Bruder 2017",
                UNKNOWN + loop,
            )
        )
        if sample.extension:
            longer = (ran[-1]["axis_stretch"] - 1) * LENGTH
            seen = sample.extension[-1] * INCH
            made.append(
                Row(
                    SUBJECT,
                    f"{name}: extension at {sample.psi[-1]:g} psi, untuned",
                    f"{longer:.2f} mm",
                    f"{seen:.2f} mm",
                    longer / seen - 1,
                    None,
                    "Bruder 2017",
                    "read to 0.1 mm; at low pressure theory shortens by 0.5 mm, which nobody saw",
                )
            )
    return made

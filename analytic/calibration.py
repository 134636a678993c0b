"""Effective shear modulus from a measured curve of pressure against angle. MPa, rad.

Section IV-B of Polygerinos et al. 2015 (doi 10.1109/TRO.2015.2428504) fits the μ̄ of eq. (19) by
one-step least squares: P is linear in μ̄, P = μ̄ g(θ).
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from analytic.bending import Hemicircle
from analytic.inverse import FORWARD
from analytic.stress import Floats, effective

FEWEST = 3
"""Points that bend: one fixes μ̄, and a scatter needs two others at least."""
GREATEST_SCATTER = 0.25
"""Of the pressures about the fit, relative to their size; the paper's stay within 0.109."""


@dataclasses.dataclass(frozen=True)
class Calibration:
    """A fitted μ̄.

    Attributes:
        modulus: effective shear modulus μ̄, MPa.
        error: its standard error, MPa, for independent errors of equal size in the pressures.
        scatter: standard deviation of the pressures about the fit, MPa.
        points: number of points used.
    """

    modulus: float
    error: float
    scatter: float
    points: int


def calibrate(pressure: Floats, angle: Floats, actuator: Hemicircle) -> Calibration:
    """Least squares for μ̄ in the pressures.

    Args:
        pressure: measured pressures, (n,), MPa.
        angle: measured bending angles, (n,), rad; several trials may follow one another.
        actuator: dimensions, acting area and `paper` switch; all its rubber gets the one μ̄.

    Raises:
        ValueError: arrays of different shapes, values that are not finite, angles beyond 720°, a
            sheath, fewer than three points away from θ = 0, all at one angle, or pressures that
            do not follow the model's curve at any positive μ̄.
    """
    pressure, angle = np.asarray(pressure, dtype=float), np.asarray(angle, dtype=float)
    if pressure.ndim != 1 or pressure.shape != angle.shape:
        raise ValueError(
            f"pressures and angles must be two lists of one length, not of shapes "
            f"{pressure.shape} and {angle.shape}"
        )
    for name, values in (("pressure", pressure), ("angle", angle)):
        if not np.isfinite(values).all():
            raise ValueError(f"{name} {int(np.argmin(np.isfinite(values))) + 1} is not finite")
    if np.any(np.abs(angle) > FORWARD):
        raise ValueError("inconsistent data: angles beyond 720°; radians expected")
    if actuator.sheath:
        raise ValueError("one effective modulus stands for all rubber: leave the sheath out")
    bent = angle != 0
    if bent.sum() < FEWEST:
        raise ValueError(f"too few data: {bent.sum()} points with an angle, {FEWEST} needed")
    if np.ptp(angle[bent]) == 0:
        raise ValueError("too few data: all points have the same angle")
    unit = dataclasses.replace(actuator, stress=effective(1.0), floor_stress=None)
    curve = unit.pressure(angle)
    square = float(curve @ curve)
    modulus = float(curve @ pressure) / square
    if modulus <= 0:
        raise ValueError("inconsistent data: the pressures do not rise with the angle")
    rest = pressure - modulus * curve
    scatter = math.sqrt(float(rest @ rest) / (len(rest) - 1))
    size = math.sqrt(float(pressure @ pressure) / len(rest))
    if scatter > GREATEST_SCATTER * size:
        raise ValueError(
            f"inconsistent data: the pressures scatter by {scatter / size:.0%} about the best fit, "
            f"more than {GREATEST_SCATTER:.0%}; check units, signs and dimensions"
        )
    return Calibration(modulus, scatter / math.sqrt(square), scatter, len(rest))

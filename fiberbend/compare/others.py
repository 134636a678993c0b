"""The models beside a run, as functions of what they are compared by."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analytic.bending import Hemicircle
from analytic.stress import Floats
from fiberbend.case.case import Case
from fiberbend.models import lines
from fiberbend.models.closed_form import analytic_curves, lever_arm
from fiberbend.models.result import Curve

_TOLERANCE = 1e-6


@dataclasses.dataclass(frozen=True, eq=False)
class StraightSection:
    """A section that is kept straight, its axial stretch free.

    Attributes:
        pressure: rising pressures from zero on, (n,), MPa.
        moment: moments about the floor's lower face that keep it straight, (n,), N mm.
    """

    pressure: Floats
    moment: Floats


@dataclasses.dataclass(frozen=True)
class OtherModel:
    """A model beside the run.

    Attributes:
        name: as columns and run.json call it.
        label: as plots and messages call it.
        value: pressures in kPa of angles in degrees, or tip forces in N of pressures in kPa,
            elementwise; nan where the model does not reach.
        line: name among the analytical models; empty for the section model.
    """

    name: str
    label: str
    value: Callable[[Floats], Floats]
    line: str = ""


def bending_models(case: Case, model: str, section: Curve | None) -> list[OtherModel]:
    """P(θ) of the other models of a case that bends freely.

    Args:
        case: the case.
        model: name of the run's own model, which is none of the others.
        section: P(θ) of the section model, where there is one.

    The paper's own line is beside a case that asks for it.
    """
    others = []
    if section is not None:
        others.append(OtherModel("section", "section model", _through_curve(section)))
    for line, closed in analytic_curves(case).items():
        if line == lines.PAPER and line not in case.compare:
            continue
        others.append(OtherModel(lines.NAMES[line], lines.LABELS[line], _closed(closed), line))
    return [other for other in others if other.name != model]


def force_models(case: Case, model: str, straight: StraightSection | None) -> list[OtherModel]:
    """F(P) of the other models of a case whose tip is blocked; see `bending_models`."""
    lever, others = lever_arm(case), []
    if straight is not None:
        others.append(
            OtherModel("section", "section model (M/L_f)", _straight_force(straight, lever))
        )
    curves = analytic_curves(case)
    if curves:
        others += [
            OtherModel(
                lines.NAMES[lines.ZERO_FIT],
                "eq. (20) of the paper, κP/L_f" if lines.PAPER in case.compare else "κP/L_f",
                _force(curves[lines.ZERO_FIT], lever),
                lines.ZERO_FIT,
            ),
            OtherModel(
                lines.NAMES[lines.WINDING],
                "κP/L_f (area to winding)",
                _force(curves[lines.WINDING], lever),
                lines.WINDING,
            ),
        ]
    return [other for other in others if other.name != model]


def through_rows(
    rows: Sequence[dict[str, Any]], key: str, value: str
) -> Callable[[Floats], Floats]:
    """A smooth curve of a column over another one; nan outside, and where there are no two rows.

    Args:
        rows: rows of history.csv.
        key: the column of the arguments.
        value: the column of the values.
    """
    from scipy.interpolate import PchipInterpolator

    pairs = {row[key]: row[value] for row in rows if row.get(value) is not None}
    at = np.array(sorted(pairs))
    if len(at) < 2:
        return lambda x: np.full(np.shape(x), np.nan)
    through = PchipInterpolator(at, np.array([pairs[x] for x in at]), extrapolate=False)
    return lambda x: np.asarray(through(x))


def _through_curve(curve: Curve) -> Callable[[Floats], Floats]:
    from scipy.interpolate import CubicSpline

    order = np.argsort(curve.angle)
    low, high = np.degrees(curve.angle[order[[0, -1]]])
    spline = CubicSpline(curve.angle[order], 1e3 * curve.pressure[order])

    def pressure(degrees: Floats) -> Floats:
        inside = (degrees >= low - _TOLERANCE) & (degrees <= high + _TOLERANCE)
        return np.where(inside, spline(np.radians(np.clip(degrees, low, high))), np.nan)

    return pressure


def _closed(closed: Hemicircle) -> Callable[[Floats], Floats]:
    return lambda degrees: 1e3 * closed.pressure(np.radians(degrees))


def _straight_force(straight: StraightSection, lever: float) -> Callable[[Floats], Floats]:
    from scipy.interpolate import PchipInterpolator

    moment = PchipInterpolator(straight.pressure, straight.moment, extrapolate=False)
    return lambda kpa: np.asarray(moment(1e-3 * kpa) / lever)


def _force(closed: Hemicircle, lever: float) -> Callable[[Floats], Floats]:
    return lambda kpa: closed.force(1e-3 * kpa, lever)

"""Every run beside the other models of the same case, and beside what a user has measured.

Free bending is compared by the pressure for the angle of each row: it is single-valued, every
model gives it without an inverse, and it goes on where the pressure has its greatest value. A
blocked tip is compared by its force at the pressure of each row.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.bending import Hemicircle
from analytic.calibration import calibrate
from analytic.stress import Floats
from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.case.measured import Measured
from fiberbend.compare.causes import find_causes
from fiberbend.compare.comparison import Comparison
from fiberbend.compare.others import (
    OtherModel,
    StraightSection,
    bending_models,
    force_models,
    through_rows,
)
from fiberbend.compare.unit_check import unit_remark
from fiberbend.drawing.overlay import Line, Overlay, Points
from fiberbend.models import lines
from fiberbend.models.closed_form import dimensions, no_analytic
from fiberbend.models.model import ModelKind
from fiberbend.models.resolution import (
    BULGING_PITCH,
    FARTHEST_PITCH,
    beyond_section,
    bulging,
)
from fiberbend.models.result import Curve

PAPER_PRESSURE = 11.0
PAPER_FORCE = 10.5
"""Percent by which the paper's own models differ from its experiments at most: 10.9 in pressure,
10.3 in force."""
_SMEARED = 0.5
_BULGING = 5.5
_LEAST_ANGLE = 1.0
_LEAST_LOSS = 0.5
_LEAST_FORCE = -60.0
"""Percent by which the tip force of a body, guided and under a soft sheath, is below that of the
section kept straight at most; measured: 45 to 50 (docs/evidence/blocked.md)."""
_FULL = 0.4
"""Part of the greatest pressure from which a body lies firmly on roof and post."""


@dataclasses.dataclass(frozen=True)
class Check:
    """A run beside everything else that is known of its case.

    Attributes:
        columns: what is added at the end of each row of the history.
        comparisons: with each other model, and with measured points.
        angles: what is drawn beside the angle over the pressure, or None.
        forces: what is drawn beside the tip force over the pressure, or None.
        missing: models that are not beside it, and why.
        remarks: what limits the comparison.
        doubtful: what of them casts doubt on the run.
        calibration: effective modulus fitted to measured angles, or why there is none.
    """

    columns: tuple[dict[str, Any], ...]
    comparisons: tuple[Comparison, ...] = ()
    angles: Overlay | None = None
    forces: Overlay | None = None
    missing: Mapping[str, str] = dataclasses.field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    doubtful: tuple[str, ...] = ()
    calibration: Mapping[str, Any] | None = None

    def beside(self, rows: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
        """The rows with the columns of the other models at their ends."""
        return [row | more for row, more in zip(rows, self.columns, strict=True)]

    def entry(self) -> dict[str, Any]:
        """The entry 'crosscheck' of run.json."""
        entry: dict[str, Any] = {c.name: c.entry() for c in self.comparisons}
        extra = {
            "missing": self.missing,
            "remarks": self.remarks,
            "calibration": self.calibration,
            "lines": self.lines(),
        }
        return entry | {key: value for key, value in extra.items() if value}

    @property
    def _shown(self) -> list[Comparison]:
        """The comparisons that a user reads of."""
        return [c for c in self.comparisons if c.name != "analytic_winding"]

    def doubts(self) -> list[str]:
        """What casts doubt on the run, not on the other model.

        A closed form is further off than its band on most cases, for reasons that are known, and a
        section kept straight has about twice the force of a body; a difference from the section
        model or from measured points, or one without a reason, is not expected.
        """
        return [*(c.line() for c in self._shown if c.unexpected), *self.doubtful]

    def lines(self) -> list[str]:
        """A few lines for the user."""
        shown = self._shown
        lines = [c.line() for c in shown]
        lines += [
            f"no {model} model to compare with: {text}" for model, text in self.missing.items()
        ]
        lines += self.remarks
        fit = self.calibration
        if fit is not None and "reason" in fit:
            lines.append(f"no μ̄ fitted to the measured angles: {fit['reason']}")
        elif fit is not None:
            lines.append(
                f"measured angles fit μ̄ = {fit['modulus_MPa']:.4g} ± "
                f"{fit['standard_error_MPa']:.1g} MPa in eq. (19)"
            )
        return lines


def crosscheck(
    case: Case,
    model: ModelKind,
    rows: Sequence[dict[str, Any]],
    section: Curve | None = None,
    measured: Measured | None = None,
    straight: StraightSection | None = None,
    no_section: str = "",
) -> Check:
    """Put a run beside the other models of its case, and beside measured points.

    Args:
        case: the case.
        model: the run's own model.
        rows: its history, from rest on.
        section: P(θ) of the section model, for free bending.
        measured: measured points.
        straight: the section kept straight, for a blocked tip.
        no_section: why the section model is not given, for the user.
    """
    nothing = Check(tuple({} for _ in rows))
    if case.inflation is None:
        return nothing
    blocked = case.straight
    alone = _alone(case)
    columns = (col.PRESSURE, col.TIP_FORCE) if blocked else (col.ANGLE, col.PRESSURE)
    others = (
        force_models(case, model.name, straight)
        if blocked
        else bending_models(case, model.name, section)
    )
    at, run = (_column(rows, name) for name in columns)
    least = 0.0 if blocked else _LEAST_ANGLE
    if blocked and any(effect.touches() for effect in case.effects):
        least = _FULL * np.abs(at).max()
    counts = np.abs(at) > least
    added: list[dict[str, Any]] = [{} for _ in rows]
    drawn, comparisons = [], []
    for other in others:
        values = other.value(at)
        name = f"{other.name}_{'tip_force_N' if blocked else 'kPa'}"
        for row, value in zip(added, values, strict=True):
            row[name] = None if np.isnan(value) else float(value)
        drawn += _drawn(other, at, blocked)
        worst = _worst(run, values, counts)
        if worst is not None:
            index, percent = worst
            where = f"{at[index]:.1f}{' kPa' if blocked else '°'}"
            limit, causes = None, []
            if not alone and not (other.line and model.line):
                limit = _limit(case, model, other, blocked)
                causes = find_causes(case, model, rows[index], other, float(values[index]))
            comparisons.append(
                Comparison(
                    other.name,
                    other.label,
                    percent,
                    where,
                    limit,
                    tuple(causes),
                    _limits(model, other, blocked, percent),
                    "force" if blocked else "pressure",
                )
            )
    points: tuple[Points, ...] = ()
    remarks = [] if blocked else _unresolved(case, model, rows, [o.name for o in others])
    doubtful = [*remarks]
    if alone:
        remarks.append(f"{alone} in this run alone: its differences are shown without a band")
    if measured is not None:
        points = (Points(f"measured ({measured.source})", *measured.shown()),)
        comparison, outside = _beside_measured(rows, columns, points[0], blocked)
        comparisons += [comparison] if comparison is not None else []
        odd = unit_remark(rows, points[0], blocked, measured.units)
        found = [text for text in (outside, odd) if text]
        remarks += found
        doubtful += found
    doubtful += _no_paper(case)
    overlay = Overlay(tuple(drawn), points)
    reasons = {"section": no_section, "analytic": no_analytic(case) or ""}
    return Check(
        tuple(added),
        tuple(comparisons),
        angles=None if blocked else overlay,
        forces=overlay if blocked else None,
        missing={name: text for name, text in reasons.items() if text},
        remarks=tuple(remarks),
        doubtful=tuple(doubtful),
        calibration=None if measured is None or blocked else _calibration(case, measured),
    )


def _alone(case: Case) -> str:
    """What acts on the run and on no model beside it; empty for nothing."""
    return " and ".join(text for effect in case.effects if (text := effect.alone()))


def band(case: Case, model: ModelKind) -> float:
    """Percent of pressure within which a run's model agrees with the section model.

    The ends of a body cost up to 1.1 %, a winding of 3 mm pitch up to 5.1 %, both on the baseline;
    other pitches in proportion to `bulging`.
    """
    turns = case.turns
    if turns is None or turns.pitch is None or beyond_section(case, model) == 0:
        return model.agreement
    scale = bulging(turns.pitch, 360.0) / bulging(BULGING_PITCH, 360.0)
    return round(max(model.agreement, _SMEARED + _BULGING * scale), 2)


def _limit(case: Case, model: ModelKind, other: OtherModel, blocked: bool) -> float | None:
    turns = case.turns
    far = turns is not None and (turns.pitch is None or turns.pitch > FARTHEST_PITCH)
    if far and (beyond_section(case, model) > 0 or other.name != "section"):
        return None
    if other.name == "section" and not (blocked and model.ends):
        return band(case, model)
    return PAPER_FORCE if blocked else PAPER_PRESSURE


def _limits(model: ModelKind, other: OtherModel, blocked: bool, percent: float) -> str:
    """Of what it is known that the run differs beyond its band; empty where that is a doubt."""
    if other.line:
        return "the closed form"
    loses = blocked and model.ends and _LEAST_FORCE < percent < 0
    return "a section kept straight" if loses else ""


def _unresolved(
    case: Case, model: ModelKind, rows: Sequence[dict[str, Any]], others: Sequence[str]
) -> list[str]:
    """Agreement with a smeared winding proves nothing where a discrete one is not resolved."""
    turns = case.turns
    if turns is None or turns.pitch is None or not turns.discrete or not model.ends:
        return []
    greatest = max(abs(row[col.ANGLE]) for row in rows)
    lost = (1 - model.resolved_bulging(case)) * bulging(turns.pitch, greatest)
    if "section" not in others or lost < _LEAST_LOSS:
        return []
    return [
        f"elements of {case.mesh.axial:g} mm do not resolve a pitch of {turns.pitch:g} mm: "
        f"agreement with the section model proves nothing, resolved fibers need about {lost:.1f} % "
        "more pressure"
    ]


def _no_paper(case: Case) -> list[str]:
    """Why the paper's figures are not beside a run that asks for them."""
    reason = no_analytic(case) if lines.PAPER in case.compare else None
    return [f"compare: nothing of the paper is beside the run: {reason}"] if reason else []


def _beside_measured(
    rows: Sequence[dict[str, Any]], columns: tuple[str, str], points: Points, blocked: bool
) -> tuple[Comparison | None, str]:
    """The run at the measured points, and how many of them lie beyond it."""
    at, target = (points.across, points.up) if blocked else (points.up, points.across)
    values = through_rows(rows, *columns)(at)
    outside = int(np.isnan(values).sum())
    remark = f"{outside} of {len(at)} measured points lie beyond the run" if outside else ""
    worst = _worst(values, target, np.abs(at) > (0.0 if blocked else _LEAST_ANGLE))
    if worst is None:
        return None, remark
    index, percent = worst
    where = f"{at[index]:.1f}{' kPa' if blocked else '°'}"
    limit = PAPER_FORCE if blocked else PAPER_PRESSURE
    quantity = "force" if blocked else "pressure"
    found = Comparison(
        "measured", points.label, percent, where, limit, quantity=quantity, reference=True
    )
    return found, remark


def _calibration(case: Case, measured: Measured) -> dict[str, Any]:
    reason = no_analytic(case)
    if reason is not None:
        return {"reason": reason}
    try:
        fit = calibrate(measured.pressure, measured.value, Hemicircle(*dimensions(case)))
    except ValueError as error:
        return {"reason": str(error)}
    return {
        "modulus_MPa": fit.modulus,
        "standard_error_MPa": fit.error,
        "scatter_kPa": 1e3 * fit.scatter,
        "points": fit.points,
    }


def _column(rows: Sequence[dict[str, Any]], name: str) -> Floats:
    values = [row.get(name) for row in rows]
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _drawn(other: OtherModel, at: Floats, blocked: bool) -> list[Line]:
    """The other model's curve over the range of the run."""
    points = np.linspace(at.min(), at.max(), 121)
    values = other.value(points)
    known = ~np.isnan(values)
    if np.ptp(points) == 0 or known.sum() < 2:
        return []
    across, up = (points, values) if blocked else (values, points)
    return [Line(other.name, other.label, across[known], up[known])]


def _worst(run: Floats, other: Floats, counts: NDArray[np.bool_]) -> tuple[int, float] | None:
    """Where the run differs most from the other one, and by how many per cent of it."""
    valid = counts & np.isfinite(run) & np.isfinite(other) & (run != 0) & (other != 0)
    if not valid.any():
        return None
    where = np.flatnonzero(valid)
    percent = 100 * (run[where] / other[where] - 1)
    most = int(np.argmax(np.abs(percent)))
    return int(where[most]), float(percent[most])

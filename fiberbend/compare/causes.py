"""Why a run may differ from another model of the same case: estimates in per cent of its value.

Every estimate follows from the case and the run's own row; docs/crosscheck.md has the measured
numbers behind the rules.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping

import numpy as np

from analytic.bending import Hemicircle
from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.compare.others import OtherModel
from fiberbend.effects.records import tip_strips
from fiberbend.models import lines
from fiberbend.models.closed_form import (
    analytic_curves,
    floor_limits,
    lever_arm,
)
from fiberbend.models.model import ModelKind
from fiberbend.models.resolution import beyond_section, bulging

_SHARE = 0.25
"""Part of a difference that a cause has to account for to be named."""
_BULGED = 0.05
_ROTATED = 1.0
_SIDEWAYS = 0.1
"""Degrees of side angle that are worth a word."""
_SOFT = 1 / 3
_SOFT_SHEATH = -16.0


@dataclasses.dataclass(frozen=True)
class Cause:
    """A possible cause of a difference.

    Attributes:
        name: a few words.
        percent: estimated part of the difference, signed, in per cent of the other model's value;
            None where there is no estimate.
        text: a sentence with the numbers behind it.
        direction: sign of its effect where there is no estimate; None where it may be either.
        brief: what differences are expected for, where it is not its name.
    """

    name: str
    percent: float | None
    text: str
    direction: int | None = 0
    brief: str = ""

    def explains(self, difference: float) -> bool:
        """Whether it accounts for a good part of a difference in per cent."""
        if self.percent is None:
            return self.direction is None or self.direction * difference > 0
        return self.percent * difference > 0 and abs(self.percent) >= _SHARE * abs(difference)

    def reversed(self) -> Cause:
        """The same seen from the other model."""
        percent = None if self.percent is None else 100 * (1 / (1 + self.percent / 100) - 1)
        direction = None if self.direction is None else -self.direction
        return dataclasses.replace(self, percent=percent, direction=direction)


def find_causes(
    case: Case, model: ModelKind, row: col.Row, other: OtherModel, value: float
) -> list[Cause]:
    """What sets a run apart from another model.

    Args:
        case: the case.
        model: the run's model.
        row: the row of the history at which they are compared.
        other: the other model.
        value: its value there, kPa or N.
    """
    if case.straight:
        return _of_force(case, row, value)
    curves = analytic_curves(case)
    if other.name != "section":
        found = _of_closed_form(case, model, row, curves[other.line], curves)
        return [*_ends(model, row, other), *found]
    if model.line:
        seen = {col.ANGLE: row[col.ANGLE], col.PRESSURE: value}
        found = _of_closed_form(case, model, seen, curves[lines.ZERO_FIT], curves)
        return [cause.reversed() for cause in found]
    return [*_ends(model, row, other), *_fibers(case, beyond_section(case, model), row)]


def _ends(model: ModelKind, row: col.Row, other: OtherModel) -> list[Cause]:
    middle, whole = row.get(col.UNIFORM_ANGLE), row[col.ANGLE]
    if not model.ends or not middle:
        return []
    percent = 100 * float(other.value(np.array(middle)) / other.value(np.array(whole)) - 1)
    if not math.isfinite(percent):
        return []
    turns = [f"{100 * (whole / middle - 1):+.1f} % in angle"]
    twist, inside = row.get(col.TWIST), row.get(col.UNIFORM_TWIST)
    if twist is not None and inside:
        turns.append(f"{100 * (twist / inside - 1):+.1f} % in twist")
    side, within = row.get(col.SIDE_ANGLE), row.get(col.UNIFORM_SIDE)
    if side is not None and within is not None and abs(side - within) > _SIDEWAYS:
        turns.append(f"{side - within:+.1f}° in side angle")
    text = f"whole body {', '.join(turns)} beside its middle half"
    return [Cause("end caps", percent, f"{text}: {percent:+.1f} %", brief="the end caps")]


def _fibers(case: Case, part: float, row: col.Row) -> list[Cause]:
    """What a part of the bulging between the turns costs, which the other model has not."""
    turns = case.turns
    if turns is None or turns.pitch is None or part == 0:
        return []
    percent = part * bulging(turns.pitch, row[col.ANGLE])
    text = (
        f"rubber bulges between the turns of a pitch of {turns.pitch:g} mm, and no smeared "
        f"winding sees it: about {percent:+.1f} %"
    )
    brief = f"a pitch of {turns.pitch:g} mm"
    return [Cause("discrete winding", percent, text, brief=brief)]


def _of_closed_form(
    case: Case, model: ModelKind, row: col.Row, closed: Hemicircle, curves: Mapping[str, Hemicircle]
) -> list[Cause]:
    """What sets a finite-element model apart from a section that keeps its shape."""
    own, wide = curves[lines.ZERO_FIT], curves[lines.WINDING]
    angle = math.radians(row[col.ANGLE])
    needs = float(closed.pressure(angle))
    found = []
    if closed is curves[lines.PAPER]:
        percent = 100 * (float(own.pressure(angle)) / needs - 1)
        text = f"the paper's μ̄ was calibrated; wall and sheath by their own laws: {percent:+.0f} %"
        found.append(Cause("effective modulus", percent, text))
    reach = float(own.moment(angle)) / (1e-3 * row[col.PRESSURE])
    if closed is not wide and own.kappa < reach <= 1.1 * wide.kappa:
        text = (
            f"M_θ/P is {reach:.0f} mm³, between {own.kappa:.0f} mm³ of the chamber and "
            f"{wide.kappa:.0f} mm³ of all inside the winding"
        )
        found.append(Cause("acting area", 100 * (own.kappa / wide.kappa - 1), text))
    if floor_limits(case):
        found.append(_floor_stiffness(case, closed, angle))
    found += _floor_bulging(row, wide, angle)
    return [*found, *_fibers(case, model.resolved_bulging(case), row)]


def _floor_stiffness(case: Case, closed: Hemicircle, angle: float) -> Cause:
    """Bending of the stiff floor about its own middle, which the inextensible line leaves out."""
    floor = case.materials.floor
    assert floor is not None
    modulus = 4 * convert.material(floor).initial_shear_modulus
    inertia = 2 * (closed.radius + closed.wall) * closed.floor**3 / 12
    own = modulus * inertia * angle / closed.length
    percent = 100 * own / float(closed.moment(angle))
    text = f"the closed form leaves out the floor's own bending, {own:.3g} N mm: {percent:+.0f} %"
    return Cause("floor stiffness", percent, text)


def _floor_bulging(row: col.Row, wide: Hemicircle, angle: float) -> list[Cause]:
    """A flat floor rounds the outline, which the closed form keeps as it is.

    Rubber keeps its volume, so that in an outline of unchanged shape the chamber grows with the
    outline, by κ_w θ.
    """
    volume = row.get(col.VOLUME)
    if volume is None:
        return []
    straight = math.pi * wide.radius**2 / 2 * wide.length
    excess = volume / (straight + wide.kappa * angle) - 1
    if excess < _BULGED:
        return []
    text = (
        f"the chamber's volume is {100 * excess:.0f} % more than in an outline that keeps its shape"
    )
    return [Cause("floor bulging", None, text, direction=None)]


def _of_force(case: Case, row: col.Row, force: float) -> list[Cause]:
    """What sets F of a blocked tip apart from M/L_f of a section kept straight."""
    lever, pressure = lever_arm(case), 1e-3 * row[col.PRESSURE]
    kappa, reach = force * lever / pressure, row[col.TIP_FORCE] * lever / pressure
    curves, found = analytic_curves(case), []
    wide = curves[lines.WINDING].kappa if curves else kappa
    if kappa < reach <= 1.1 * wide:
        text = (
            f"F L_f/P is {reach:.0f} mm³, beyond {kappa:.0f} mm³: the pressure acts on more than "
            f"the chamber, at most on {wide:.0f} mm³"
        )
        found.append(Cause("acting area", 100 * (wide / kappa - 1), text))
    rotation = row.get(col.ANGLE) or 0.0
    if abs(rotation) > _ROTATED:
        text = f"the tip is guided, not clamped: the section z = L turns by {rotation:.1f}°"
        found.append(Cause("guided tip", None, text, -1))
    sheath, wall = case.materials.sheath, convert.material(case.materials.wall)
    if sheath is not None and tip_strips(case.effects) is not None:
        ratio = convert.material(sheath).initial_shear_modulus / wall.initial_shear_modulus
        text = f"the sheath under roof and post, {ratio:.2f} times as stiff as the wall, yields"
        if ratio < _SOFT:
            found.append(Cause("soft sheath", _SOFT_SHEATH, text))
    return found

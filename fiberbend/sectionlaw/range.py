"""What a table is to reach: the free states of a case, and the loads that a rod bears beside."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import sheared
from fiberbend.models.choice import meshed
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.law import Free
from fiberbend.trial import loads as trial
from fiberbend.trial.calibrations import Calibrations
from fiberbend.trial.reading import Reader
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Answer, Wanted
from fiberbend.uniform.small import Small

STATES = 4
"""Free states from rest to the greatest load, to which a table is compared too."""
FILLED = 16
"""The same by a volume: its greatest pressure may be on the way, and is met within a percent."""
FORCE, MOMENT = 0.2, 50.0
"""Loads at the tip that a table reaches, N and N mm, beside the weight of the whole."""
_THIN = 0.5
"""Strain by the usual moment at rest of an actuator that is not made for it."""
_GRAVITY = 9810.0
_RUBBER = 1.1e-9
"""Density of what has none in the case, t/mm³."""


class Loads(NamedTuple):
    """What a rod bears beside its pressure.

    Attributes:
        force: of weight and tip load, N.
        moment: of weight and of either tip load at the root of the straight actuator, N mm.
        held: what it touches, or is held by, may keep it from bending under its pressure.
        idle: nothing acts on it but its pressure.
    """

    force: float
    moment: float
    held: bool = True
    idle: bool = False


@dataclasses.dataclass(frozen=True)
class Reach:
    """What a case takes, and what it bears beside.

    Attributes:
        free: pressures in MPa, all above zero or all below, with the free states at them, from the
            one nearest to rest on.
        height: of the section without sheath, mm.
        force: of weight and tip load, N.
        moment: of weight and of either tip load at the root of the straight actuator, N mm.
        held: something may keep it straight under its pressure.
        idle: nothing acts on it but its pressure.
        remarks: what casts doubt on the calibration of its winding.
    """

    free: tuple[tuple[float, Free], ...]
    height: float
    force: float
    moment: float
    held: bool = True
    idle: bool = False
    remarks: tuple[str, ...] = ()


def reach_of(case: Case, loads: Loads) -> Reach:
    """Free states of a case up to its own pressure, volume or angle, and its loads.

    Args:
        case: a checked case of model section or cell.
        loads: of the actuator whose section it is.

    Raises:
        CaseError: it has none of them, or does not come there.
    """
    answer = _found(case)
    if not answer.converged:
        raise CaseError([Problem("effects.pressure", f"no such free state: {answer.reason}")])
    length = case.actuator.length
    if len({np.sign(point.pressure) for point in answer.free}) > 1:
        text = "a table is of pressures above zero or of those below, and the way leads from one"
        raise CaseError([Problem("effects.pressure", f"{text} to the other")])
    if not any(point.pressure for point in answer.free):
        raise CaseError([Problem("effects.pressure", "it stays as at rest, expected a load")])
    return Reach(
        tuple(
            (p.pressure, Free(p.stretch, p.angle / length, p.side_angle / length, p.twist / length))
            for p in answer.free
        ),
        float(np.ptp(meshed(case).mesh(case).nodes[:, 1])),
        *loads,
        answer.remarks,
    )


def _found(case: Case) -> Answer:
    """Free states on the way to what is given."""
    load = case.inflation
    if load is not None and load.volume is not None:
        return _filled(case, load.volume)
    goal = None if load is None else (load.angle or load.to)
    if load is None or not goal:
        text = "a table reaches from rest to a pressure, a volume or an angle, expected effect"
        raise CaseError([Problem("effects", f"{text} pressure with one that is not zero")])
    goals = tuple(goal * (number + 1) / STATES for number in range(STATES))
    return solve(case, Wanted(angles=goals) if load.angle else Wanted(pressures=goals))


def _filled(case: Case, volume: float) -> Answer:
    """Free states on the way from the volume at rest to another one, mm³."""
    ready = Calibrations().ready(trial.filled(case, volume))
    small = Small(ready.case)
    rest = Reader(small).point(small.rest).volume
    goals = np.linspace(rest, volume, FILLED + 1)[1:].tolist()
    found, report, _ = small.reach(goals)
    reader = Reader(small)
    points = tuple(reader.point(found[goal]) for goal in goals if goal in found)
    reason = report.reason or "it ends before" if len(points) < len(goals) else ""
    return Answer(points, converged=not reason, reason=reason, remarks=ready.remarks)


def loads_of(case: Case) -> Loads:
    """Of a whole actuator: its weight to the side, and a force or a moment at its tip."""
    actuator, materials = convert.dimensions(case.actuator), convert.site(case).materials
    densities = {name: each.mass_density or _RUBBER for name, each in materials.items()}
    volumes = actuator.region_volumes()
    weight = _GRAVITY * sum(volume * densities[name] for name, volume in volumes.items())
    length = actuator.total_length
    return Loads(weight + FORCE, weight * length / 2 + max(MOMENT, FORCE * length))


def loads_on(case: Case) -> Loads:
    """What an actuator bears as a rod: the usual loads, or, where it is thin, its own alone.

    50 N mm bend a tube of 8 mm by many turns: a table that reached so far would be coarse where the
    tube is.
    """
    usual = loads_of(case)
    pulls = [effect.at_rods_tip(convert.site(case).weight) for effect in case.effects]
    told = all(pull is not None for pull in pulls) and not any(e.touches() for e in case.effects)
    if case.time is not None or not told or _outside_strain(case) < _THIN:
        return usual
    force = sum(pull[0] for pull in pulls if pull is not None)
    moment = sum(pull[1] for pull in pulls if pull is not None)
    length = convert.dimensions(case.actuator).total_length
    bent = usual.moment - max(MOMENT, FORCE * length) + moment + force * length
    return Loads(usual.force - FORCE + force, bent, held=False, idle=not sheared(case))


def _outside_strain(case: Case) -> float:
    """By the usual moment on a ring as wide as the wall, whatever else stiffens it."""
    actuator, wall = convert.dimensions(case.actuator), convert.site(case).materials["wall"]
    outer = actuator.outline_half_width
    inner = outer - actuator.wall
    second = math.pi / 4 * (outer**4 - inner**4)
    return MOMENT * outer / (3 * wall.initial_shear_modulus * second)

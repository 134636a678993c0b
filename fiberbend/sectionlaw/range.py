"""What a table is to reach: the free states of a case, and the loads that a rod bears beside."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.law import Free
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted

STATES = 4
"""Free states from rest to the greatest load, to which a table is compared too."""
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
    """

    force: float
    moment: float
    held: bool = True


@dataclasses.dataclass(frozen=True)
class Reach:
    """What a case takes, and what it bears beside.

    Attributes:
        free: pressures in MPa with the free states at them, from a small pressure on.
        height: of the section without sheath, mm.
        force: of weight and tip load, N.
        moment: of weight and of either tip load at the root of the straight actuator, N mm.
        held: something may keep it straight under its pressure.
        remarks: what casts doubt on the calibration of its winding.
    """

    free: tuple[tuple[float, Free], ...]
    height: float
    force: float
    moment: float
    held: bool = True
    remarks: tuple[str, ...] = ()


def reach_of(case: Case, loads: Loads) -> Reach:
    """Free states of a case up to its own pressure or angle, and its loads.

    Args:
        case: a checked case of model section or cell.
        loads: of the actuator whose section it is.

    Raises:
        CaseError: it has neither, or does not come there.
    """
    load = case.inflation
    goal = None if load is None else (load.angle or load.to)
    if load is None or goal is None:
        text = "a table reaches from rest to a pressure or an angle, expected effect pressure"
        raise CaseError([Problem("effects", f"{text} with to or angle")])
    if load.to is not None and load.to < 0:
        raise CaseError([Problem("effects", "a table is of pressures above zero")])
    goals = tuple(goal * (number + 1) / STATES for number in range(STATES))
    answer = solve(case, Wanted(angles=goals) if load.angle else Wanted(pressures=goals))
    if not answer.converged:
        raise CaseError([Problem("effects.pressure", f"no such free state: {answer.reason}")])
    length = case.actuator.length
    if min(point.pressure for point in answer.free) <= 0:
        raise CaseError([Problem("effects", "a table is of pressures above zero")])
    return Reach(
        tuple(
            (p.pressure, Free(p.stretch, p.angle / length, p.side_angle / length, p.twist / length))
            for p in answer.free
        ),
        float(np.ptp(meshed(case).mesh(case).nodes[:, 1])),
        *loads,
        answer.remarks,
    )


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
    return Loads(usual.force - FORCE + force, bent, held=False)


def _outside_strain(case: Case) -> float:
    """By the usual moment on a ring as wide as the wall, whatever else stiffens it."""
    actuator, wall = convert.dimensions(case.actuator), convert.site(case).materials["wall"]
    outer = actuator.outline_half_width
    inner = outer - actuator.wall
    second = math.pi / 4 * (outer**4 - inner**4)
    return MOMENT * outer / (3 * wall.initial_shear_modulus * second)

"""What a table is to reach: the free states of a case, and the loads that a rod bears beside."""

from __future__ import annotations

import dataclasses

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
_GRAVITY = 9810.0
_RUBBER = 1.1e-9
"""Density of what has none in the case, t/mm³."""


@dataclasses.dataclass(frozen=True)
class Reach:
    """What a case takes, and what it bears beside.

    Attributes:
        free: pressures in MPa with the free states at them, from a small pressure on.
        height: of the section without sheath, mm.
        force: of weight and tip load, N.
        moment: of weight and of either tip load at the root of the straight actuator, N mm.
        remarks: what casts doubt on the calibration of its winding.
    """

    free: tuple[tuple[float, Free], ...]
    height: float
    force: float
    moment: float
    remarks: tuple[str, ...] = ()


def reach_of(case: Case) -> Reach:
    """Free states of a case up to its own pressure or angle, and its loads.

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
    weight, moment = _loads(case)
    return Reach(
        tuple(
            (p.pressure, Free(p.stretch, p.angle / length, p.side_angle / length, p.twist / length))
            for p in answer.free
        ),
        float(np.ptp(meshed(case).mesh(case).nodes[:, 1])),
        weight + FORCE,
        moment,
        answer.remarks,
    )


def _loads(case: Case) -> tuple[float, float]:
    """Weight of the whole, N, and moment of it and of a tip load at the root, N mm."""
    actuator, materials = convert.dimensions(case.actuator), convert.site(case).materials
    densities = {name: each.mass_density or _RUBBER for name, each in materials.items()}
    volumes = actuator.region_volumes()
    weight = _GRAVITY * sum(volume * densities[name] for name, volume in volumes.items())
    length = actuator.total_length
    return weight, weight * length / 2 + max(MOMENT, FORCE * length)

"""The range of a table: what free bending and a straight section take, and a margin for loads."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.law import Free
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from rod.functions import Floats

STATES = 4
"""Free states from rest to the greatest load, to which a table is compared too."""
MARGIN = 0.25
"""Beyond the curvatures and stretches of those states, in parts of them."""
LEAST_STRETCH = 0.02
"""Least margin of the stretch."""
BENT = 0.05
"""Strain by bending on the outside of what does not bend by itself."""
PRESSURE_MARGIN = 0.05
LEAST_PRESSURE = 0.15
"""Part of the greatest pressure from which a table is, unless it is said: below, threads go slack
and tight again, and the law has kinks that no smooth table meets."""


@dataclasses.dataclass(frozen=True)
class Reach:
    """What the case itself takes.

    Attributes:
        free: pressures in MPa with the free states at them, from a small pressure on.
        straight: stretches of the section kept straight at the same pressures, where it has such.
        height: of the section without sheath, mm.
        remarks: what casts doubt on the calibration of its winding.
    """

    free: tuple[tuple[float, Free], ...]
    straight: tuple[float, ...]
    height: float
    remarks: tuple[str, ...] = ()


@dataclasses.dataclass(frozen=True)
class Box:
    """The range of a table.

    Attributes:
        ranges: of e, of u and of P in MPa.
        chart: what e and u are.
    """

    ranges: tuple[tuple[float, float], ...]
    chart: Chart

    def words(self, point: Floats) -> str:
        """A point in words."""
        stretch, k = self.chart.strains(point[None, :])[0].tolist()
        pressure = 1e3 * float(point[2])
        return f"stretch {stretch:.5g}, curvature {1e3 * k:.5g} 1/m, {pressure:.5g} kPa"


def reach_of(case: Case) -> Reach:
    """Free and straight states of a case up to its own pressure or angle.

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
    pressures = tuple(point.pressure for point in answer.free)
    if min(pressures) <= 0:
        raise CaseError([Problem("effects", "a table is of pressures above zero")])
    straight = solve(case, Wanted(straight=pressures))
    return Reach(
        tuple((p.pressure, Free(p.stretch, p.angle / length)) for p in answer.free),
        tuple(point.stretch for point in straight.straight),
        _height(case),
        answer.remarks,
    )


def box_of(reach: Reach, part: float = 1.0, least: float | None = None) -> Box:
    """The range of a table.

    Args:
        reach: what the case takes.
        part: of the margins.
        least: pressure from which the table is, MPa.
    """
    stretches = np.array([1.0, *(state.stretch for _, state in reach.free)])
    curvatures = np.array([0.0, *(state.curvature for _, state in reach.free)])
    square = float(curvatures @ curvatures)
    most = float(np.abs(curvatures).max())
    bends = most * reach.height > 1e-6
    lever = float(curvatures @ (stretches - 1.0)) / square if bends else 0.0
    own = np.concatenate([stretches - lever * curvatures, reach.straight])
    beside = part * max(LEAST_STRETCH, MARGIN * float(np.ptp(own)))
    around = part * (MARGIN * most if bends else 2 * BENT / reach.height)
    pressures = [0.0, *(pressure for pressure, _ in reach.free)]
    high = (1.0 + part * PRESSURE_MARGIN) * max(pressures)
    low = LEAST_PRESSURE * max(pressures) if least is None else least
    return Box(
        ((float(own.min()) - beside, float(own.max()) + beside), (0.0, 1.0), (low, high)),
        _chart(pressures, curvatures, around, lever),
    )


def _chart(pressures: list[float], curvatures: Floats, around: float, lever: float) -> Chart:
    """Curvatures from straight to free at each pressure, and a margin to both sides."""
    least = float(curvatures.min()) - around
    growth = 0.0
    if curvatures.max() > 0:
        rates = curvatures[1:] / np.array(pressures[1:])
        growth = float(rates.max())
    widest = float(curvatures.max()) + around - least
    width = 2 * around if growth else widest
    return Chart(lever, least, width, growth)


def _height(case: Case) -> float:
    """Of the section at rest."""
    nodes = meshed(case).mesh(case).nodes
    return float(np.ptp(nodes[:, 1]))

"""Sections and cells of uniform bending, as an assumption has them; kPa, N mm and CPU seconds."""

from __future__ import annotations

import dataclasses
import math
import time
from collections.abc import Sequence

from bench.paper.assumed.under import bare
from bench.paper.assumptions import Combination
from bench.paper.facts import BASELINE
from bench.paper.runs import ROOT
from fiberbend.case.case import Case
from fiberbend.reader.reader import read_case
from fiberbend.trial import loads
from fiberbend.trial.reading import Reader
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Answer, Wanted
from fiberbend.uniform.small import Small

CASE = ROOT / "cases" / "section.yaml"
GUIDED = ROOT / "cases" / "fig11" / "radius8_length160_guided.yaml"
PRESSURE = 200.0
"""Of forces and of the moment that keeps it straight, kPa."""
FULL = 360.0
CELL_AXIAL = 8
"""Elements of a cell along a turn: four along half a pitch, P within 0.5 % of its limit."""


@dataclasses.dataclass(frozen=True)
class Solved:
    """What is solved of a section.

    Attributes:
        pressures: P in kPa at 360° of chambers of given lengths.
        moment: that keeps it straight at 200 kPa, N mm.
        seconds: of processor time.
    """

    pressures: tuple[float, ...]
    moment: float
    seconds: float


def section(
    given: Combination, radius: float, wall: float, chambers: Sequence[float], winding: str
) -> Solved:
    """A section of uniform bending.

    The pressure hangs on curvature alone: 360° of a chamber of 100 mm are 576° of one of 160 mm.

    Args:
        given: what is assumed.
        radius: a, mm.
        wall: t, mm.
        chambers: lengths in mm, the longest first.
        winding: "smeared" or "calibrated".
    """
    start = time.process_time()
    longest = max(chambers)
    key = (radius, longest, wall)
    free = dataclasses.replace(given, capped=False)
    angles = tuple(math.radians(FULL) * longest / chamber for chamber in chambers)
    changes = free.settings(key, winding) | {
        "effects.0": {"pressure": {"angle": f"{math.degrees(max(angles)):.8g} deg"}},
        "output": {},
    }
    case = read_case(CASE, changes)
    wanted = Wanted(angles=angles, straight=(PRESSURE / 1e3,))
    answer = _without(case, wanted) if given.bare else solve(case, wanted)
    if not answer.converged:
        raise RuntimeError(f"{given}, a = {radius:g}, t = {wall:g} mm: {answer.reason}")
    return Solved(
        tuple(1e3 * point.pressure for point in answer.free),
        answer.straight[0].moment,
        time.process_time() - start,
    )


def _without(case: Case, wanted: Wanted) -> Answer:
    """As `solve`, without the sheath under the floor; a winding that is spread only."""
    bent = Small(loads.bent(case, wanted.angles), mesh=bare(case))
    states, free = bent.march()
    points = tuple(Reader(bent).point(state) for state in states)
    straight = Small(loads.straight(case, wanted.straight), bent)
    kept, report = straight.march()
    reader = Reader(straight)
    whole = len(points) == len(wanted.angles) and len(kept) == len(wanted.straight)
    return Answer(
        points, tuple(reader.point(s) for s in kept), whole, f"{free.reason} {report.reason}"
    )


def cell(given: Combination, radius: float, wall: float, chambers: Sequence[float]) -> Solved:
    """The cell of a section, every turn by itself; otherwise as `section`."""
    start = time.process_time()
    longest = max(chambers)
    angles = tuple(math.radians(FULL) * longest / chamber for chamber in chambers)
    free = dataclasses.replace(given, capped=False)
    changes = free.settings((radius, longest, wall), "discrete") | {
        "model": "cell",
        "mesh": {"axial": f"{given.pitch / CELL_AXIAL:.6g} mm", "section": 2},
        "output": {},
    }
    answer = solve(read_case(CASE, changes), Wanted(angles, straight=(PRESSURE / 1e3,)))
    if not answer.converged:
        raise RuntimeError(f"{given}, cell, a = {radius:g}, t = {wall:g} mm: {answer.reason}")
    return Solved(
        tuple(1e3 * point.pressure for point in answer.free),
        answer.straight[0].moment,
        time.process_time() - start,
    )


def blocked(given: Combination, radius: float) -> tuple[float, float]:
    """Force on the post of a body that a strip along its crown holds, at 200 kPa.

    Args:
        given: what is assumed; its sheath is all around.
        radius: a, mm.

    Returns:
        The force in N and seconds of processor time.
    """
    from fiberbend import run

    start = time.process_time()
    changes = given.settings((radius, *BASELINE[1:]), "smeared") | {
        "effects.0": {"pressure": {"to": f"{PRESSURE:g} kPa"}},
        "output": {},
    }
    result = run(GUIDED, settings=changes)
    if result.status != "converged":
        raise RuntimeError(f"{given}, body, a = {radius:g} mm: {result.status}")
    return float(result.last("tip_force_N")), time.process_time() - start

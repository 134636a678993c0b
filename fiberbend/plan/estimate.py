"""What a run is expected to take: steps, seconds, memory. Estimates, good to a factor of two.

All numbers were measured on two cores of a 2 GHz Xeon (Debian 12, dolfinx 0.5, MUMPS with METIS,
one BLAS thread a rank).
"""

from __future__ import annotations

import dataclasses
import math
import os
from pathlib import Path

from fiberbend.case.case import Case
from fiberbend.effects.table import (
    BlockedTipEffect,
    ContactEffect,
    GravityEffect,
    PressureEffect,
    StraightEffect,
    hold_straight,
)
from fiberbend.models.choice import FIRST_TURN, turn_of
from fiberbend.plan.size import Size

MACHINE = "two 2 GHz Xeon cores"
"""Where the numbers below were measured."""
_START = {"analytic": 1.5, "section": 1.8, "cell": 1.8, "body": 6.0}
"""Seconds to import, to mesh, to load compiled kernels, and for the section that steers a body."""
_COMPILE = {"section": 9.0, "cell": 20.0, "body": 20.0}
"""Seconds to compile a scene that is not in the cache."""
_PICTURES = {"analytic": (1.0, 0.0), "section": (3.0, 0.4), "cell": (5.0, 1.0), "body": (5.0, 2.0)}
"""Seconds to draw: in all, and for each state that is asked for."""
_FIELDS = {"analytic": 0.0, "section": 0.3, "cell": 0.5, "body": 1.0}
"""Seconds to write the fields of a state."""
_ITERATIONS = {"section": 2.0, "cell": 3.3, "body": 3.5}
"""Newton iterations in a step of free bending."""
_BLOCKED_ITERATIONS = 6.0
"""The same with a blocked tip, whose sheath yields under the strips."""
_GROWTH = 1.5
_NEAR = 0.2
_TWO_RANKS = 0.6
_START_SHARE = 1 / 20


@dataclasses.dataclass(frozen=True)
class Cost:
    """What a run is expected to take.

    Attributes:
        steps: load steps; None where the bending angle at the end cannot be foreseen.
        step_s: seconds a step on one rank.
        start_s: seconds before the first step, kernels compiled.
        compile_s: seconds more where they are not.
        memory_mb: greatest memory on one rank, MB.
    """

    steps: int | None
    step_s: float
    start_s: float
    compile_s: float
    memory_mb: float

    def rows(self, case: Case, model: str) -> dict[str, list[str]]:
        """Steps, time and memory in words."""
        turn = math.degrees(turn_of(case, model))
        pace = f"at most {turn:.3g}° each"
        whole = self.seconds()
        if self.steps is None or whole is None:
            steps, time = pace, f"about {_rounded(self.step_s)} s a step"
        else:
            steps = f"about {self.steps}" + ("" if hold_straight(case.effects) else f", {pace}")
            time = f"about {_rounded(whole)} s"
            if model == "body":
                time += f" on one rank, {_rounded(self.seconds(2) or whole)} s on two"
        time += f"; {MACHINE}, an estimate"
        more = [f"about {self.compile_s:g} s more {_compiled()}"]
        drawing = drawing_seconds(case, model)
        if drawing:
            more.append(f"about {_rounded(drawing)} s more for pictures and fields")
        memory = f"about {_rounded(self.memory_mb / 1000)} GB"
        if model == "body":
            memory += ", and 0.2 GB for each further rank"
        return {"steps": [steps], "time": [time, *more], "memory": [memory]}

    def seconds(self, ranks: int = 1) -> float | None:
        """Seconds of the whole run with compiled kernels, where its steps can be foreseen."""
        if self.steps is None:
            return None
        return self.start_s + self.steps * self.step_s * (_TWO_RANKS if ranks > 1 else 1.0)


def cost_of(case: Case, model: str, size: Size) -> Cost:
    """What the run of a finite-element model is expected to take."""
    return Cost(
        steps=steps_of(case, model),
        step_s=_step_seconds(case, model, size),
        start_s=_START[model],
        compile_s=_COMPILE[model],
        memory_mb=_memory(model, size),
    )


def _rounded(value: float) -> str:
    """Two digits: no estimate has more."""
    if value >= 10:
        digits = 1 - math.floor(math.log10(value))
        return f"{round(value, digits):.0f}"
    return f"{value:.2g}"


def start_seconds(model: str) -> float:
    """Seconds before a model's first step."""
    return _START[model]


def drawing_seconds(case: Case, model: str) -> float:
    """Seconds for pictures and fields of the states that are asked for, at least one."""
    output = case.output
    states = max(1, len(output.at_angles) + len(output.at_pressures))
    once, each = _PICTURES[model]
    pictures = once + states * each if output.pictures else 0.0
    return pictures + (states * _FIELDS[model] if output.fields else 0.0)


def _compiled() -> str:
    return "as nothing is compiled yet" if cold() else "if no scene of this kind was compiled yet"


def cold() -> bool:
    """Whether no run has compiled anything yet for this user."""
    root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache")) / "fiberbend"
    return next(root.glob("*/*.so"), None) is None


def _step_seconds(case: Case, model: str, size: Size) -> float:
    """Seconds a step on one rank.

    Body: tangent by elements, factor by layers and by unknowns a layer as nested dissection of a
    long body has it, fitted to sections refined once and twice and to elements of 2 to 6 mm.
    """
    if model == "section":
        return 0.015 + 9e-6 * size.unknowns
    if model == "cell":
        return _ITERATIONS[model] * 0.069 * (size.unknowns / 3285) ** 1.15
    tangent = (1.1e-4 if size.kind == "tetrahedra" else 5.3e-4) * size.elements
    factor = 1.5e-7 * size.layers * (size.unknowns / size.layers) ** 1.75
    iteration = 0.65 * (tangent + factor) + 2.8e-6 * size.unknowns
    touching = case.find(BlockedTipEffect) is not None or case.find(ContactEffect) is not None
    return iteration * (_BLOCKED_ITERATIONS if touching else _ITERATIONS[model])


def _memory(model: str, size: Size) -> float:
    if model != "body":
        return 130 + 7e-3 * size.unknowns
    return 200 + 1e-3 * size.unknowns * (size.unknowns / size.layers) ** 0.3


def steps_of(case: Case, model: str) -> int | None:
    """Load steps of a run, or None where the angle at its end cannot be foreseen."""
    pressure = case.find(PressureEffect)
    steps = 1 if case.find(GravityEffect) is not None else 0
    if pressure is None:
        return steps
    output = case.output
    least = 0
    if pressure.to is not None and case.solver.max_step is not None:
        least = math.ceil(abs(pressure.to) / case.solver.max_step)
    if hold_straight(case.effects):
        # the angle is all but zero: a section starts with a twentieth, a body with everything
        if pressure.to is None:
            return None
        share = _START_SHARE if case.find(StraightEffect) is not None else 1.0
        goals = [value / pressure.to for value in output.at_pressures]
        return steps + max(least, count_steps(share, math.inf, [*goals, 1.0]))
    end = expected_angle(case)
    if end is None:
        return None
    turn = turn_of(case, model)
    goals = [angle for angle in output.at_angles if 0 < angle / end < 1]
    goals = [*map(abs, goals), abs(end)]
    counted = count_steps(min(turn, FIRST_TURN[model]), turn, goals)
    return steps + max(least, counted + len(output.at_pressures))


def count_steps(first: float, most: float, goals: list[float]) -> int:
    """Steps from zero through every goal, growing by half until they have their greatest size."""
    here, size, steps = 0.0, first, 0
    for goal in sorted(goals):
        while here < goal * (1 - 1e-9):
            size = min(size, most)
            here = goal if here + size > goal - _NEAR * size else here + size
            size *= _GROWTH
            steps += 1
    return steps


def expected_angle(case: Case) -> float | None:
    """Bending angle at the end of a run, rad; of a given pressure by the closed form, if any."""
    pressure = case.find(PressureEffect)
    if pressure is None:
        return None
    stop = case.output.stop_at_angle
    if pressure.angle is not None:
        return pressure.angle
    from fiberbend.models.closed_form import analytic_curves

    curve = analytic_curves(case).get("zero-fit")
    if curve is None or pressure.to is None:
        return stop
    import numpy as np

    sign = math.copysign(1.0, pressure.to)
    angles = sign * np.radians(np.arange(0.0, 541.0 if sign > 0 else 91.0, 5.0))
    reached = sign * curve.pressure(angles)
    rising = int(np.argmax(np.append(np.diff(reached) <= 0, True))) + 1
    angle = float(np.interp(abs(pressure.to), reached[:rising], angles[:rising]))
    return angle if stop is None or abs(stop) > abs(angle) else stop

"""What a run is expected to take: steps, seconds, memory. Estimates, good to a factor of two.

What each model costs stands with the model.
"""

from __future__ import annotations

import dataclasses
import math

from fiberbend.case.case import Case
from fiberbend.case.section_beside import section_guides
from fiberbend.case.symmetry import stays_straight
from fiberbend.models import lines
from fiberbend.models.costs.price import machine
from fiberbend.models.model import MeshedModel, ModelKind, ProblemSize, SlenderModel
from fiberbend.plan.memory import RANK_MB, Room, gigabytes, needed_mb, room
from machine.folders import MachineError, cache_root

_GROWTH = 1.5
_NEAR = 0.2
_TWO_RANKS = 0.6
_ITERATIVE = (
    "not known of the iterative solver, {} on one rank (docs/evidence/iterative.md); direct: "
)


@dataclasses.dataclass(frozen=True)
class Cost:
    """What a run is expected to take, with the direct solver.

    Attributes:
        steps: load steps; None where the bending angle at the end cannot be predicted.
        step_s: seconds a step on one rank.
        start_s: seconds beside the steps, kernels compiled.
        compile_s: seconds more where they are not.
        memory_mb: greatest memory on one rank, MB.
        free: what there is, where that is known.
        iterative: the run takes the iterative solver, whose time and memory nothing estimates.
    """

    steps: int | None
    step_s: float
    start_s: float
    compile_s: float
    memory_mb: float
    free: Room | None = None
    iterative: bool = False

    def rows(self, case: Case, model: MeshedModel) -> dict[str, list[str]]:
        """Steps, time and memory in words."""
        turn = math.degrees(model.largest_turn(case))
        each = f"at most {turn:.3g}° each"
        whole = self.seconds()
        if self.steps is None or whole is None:
            steps, time = each, f"about {_rounded(self.step_s)} s a step"
        else:
            steps = f"about {self.steps}" + (
                "" if case.straight or stays_straight(case) else f", {each}"
            )
            time = f"about {_rounded(whole)} s"
            if model.shared:
                time += f" on one rank, {_rounded(self.seconds(2) or whole)} s on two"
        time += f"; on {machine()}, an estimate"
        if self.iterative:
            time = _ITERATIVE.format("several times longer") + time
        more = [f"about {self.compile_s:g} s more {_compiled()}"]
        drawing = drawing_seconds(case, model)
        if drawing:
            more.append(f"about {_rounded(drawing)} s more for pictures and fields")
        memory = f"about {_rounded(self.memory_mb / 1000)} GB"
        if model.shared:
            memory += f", and {RANK_MB / 1000:g} GB for each further rank"
        if self.iterative:
            memory = _ITERATIVE.format("more") + memory
        if self.free is not None:
            memory += f"; {gigabytes(self.free.mb)} are free {self.free.source}"
        return {"steps": [steps], "time": [time, *more], "memory": [memory]}

    def seconds(self, ranks: int = 1) -> float | None:
        """Seconds of the whole run with compiled kernels, where its steps can be predicted."""
        if self.steps is None:
            return None
        return self.start_s + self.steps * self.step_s * (_TWO_RANKS if ranks > 1 else 1.0)


def cost_of(case: Case, model: MeshedModel, size: ProblemSize) -> Cost:
    """What the run of a finite-element model is expected to take.

    Args:
        case: the case.
        model: its model.
        size: how large its problem is.
    """
    return Cost(
        steps=steps_of(case, model),
        step_s=model.step_seconds(case, size),
        start_s=model.start_seconds(size),
        compile_s=model.compile_s,
        memory_mb=needed_mb(case),
        free=room(),
        iterative=model.shared and case.solver.linear == "iterative",
    )


def _rounded(value: float) -> str:
    """Two digits: no estimate has more."""
    if value >= 10:
        digits = 1 - math.floor(math.log10(value))
        return f"{round(value, digits):.0f}"
    return f"{value:.2g}"


def drawing_seconds(case: Case, model: ModelKind) -> float:
    """Seconds for pictures and fields of the states that are asked for, at least one."""
    output = case.output
    states = max(1, len(output.at_angles) + len(output.at_pressures))
    once, each = model.pictures_s
    pictures = once + states * each if output.pictures else 0.0
    elements = model.elements()
    if output.field_steps == "all" and elements is not None:
        states = max(states, steps_of(case, elements) or 0)
    copies = 2 if output.field_halves == "both" else 1
    return pictures + (copies * states * model.fields_s if output.fields else 0.0)


def _compiled() -> str:
    return "as nothing is compiled yet" if cold() else "if no scene of this kind was compiled yet"


def cold() -> bool:
    """Whether no run has compiled anything yet for this user."""
    try:
        root = cache_root().path
    except MachineError:
        return True
    return next(root.glob("*/*.so"), None) is None


def steps_of(case: Case, model: MeshedModel) -> int | None:
    """Load steps of a run, or None where they cannot be predicted."""
    if case.zones is not None:
        return model.steps_of_zones(case)
    others = [effect.steps() for effect in case.effects]
    if None in others:
        return None
    steps, load = sum(count for count in others if count is not None), case.inflation
    if load is None:
        return steps
    output = case.output
    least = 0
    if load.to is not None and case.solver.max_step is not None:
        least = math.ceil(abs(load.to) / case.solver.max_step)
    if case.straight or stays_straight(case):
        # the angle is all but zero: no step is bounded by its turn
        if load.to is None:
            return None
        goals = [value / load.to for value in output.at_pressures]
        return steps + max(least, count_steps(model.straight_start, math.inf, [*goals, 1.0]))
    end = expected_angle(case)
    wound = any(effect.fixes_circumference() for effect in case.effects)
    if not end or (load.angle is not None and not wound):
        # without a winding it hardly bends at first: the chamber's volume bounds the steps
        return None
    turn = model.largest_turn(case)
    goals = [angle for angle in output.at_angles if 0 < angle / end < 1]
    goals = [*map(abs, goals), abs(end)]
    first, growth = model.first_turn, _GROWTH
    if model.ends and section_guides(case):
        first, growth = case.solver.max_turn or model.guided_first, model.guided_growth
    counted = count_steps(min(turn, first), turn, goals, growth)
    return steps + max(least, counted + len(output.at_pressures))


def steps_of_rod(case: Case, model: SlenderModel) -> int | None:
    """Steps of a rod, in time or of loads; None where the angle at its end cannot be predicted."""
    if case.time is not None:
        return math.ceil(case.time.duration / case.time.step * (1 - 1e-9))
    end = expected_angle(case)
    others = [effect.steps() for effect in case.effects]
    if end is None or None in others:
        return None
    steps = sum(count for count in others if count is not None)
    output, turn = case.output, case.solver.max_turn or model.turn
    goals = [abs(angle) for angle in output.at_angles if 0 < angle / end < 1]
    counted, least = count_steps(turn, turn, [*goals, abs(end)]), 0
    load = case.inflation
    if load is not None and load.to is not None and case.solver.max_step is not None:
        least = math.ceil(abs(load.to) / case.solver.max_step)
    return steps + max(least, counted + len(output.at_pressures))


def count_steps(first: float, most: float, goals: list[float], growth: float = _GROWTH) -> int:
    """Steps from zero through every goal, growing until they have their greatest size.

    Args:
        first: size of the first step, in the unit of the goals.
        most: greatest size of a step.
        goals: values that are hit exactly, the last one the end.
        growth: of a step over the one before.
    """
    here, size, steps = 0.0, first, 0
    for goal in sorted(goals):
        while here < goal * (1 - 1e-9):
            size = min(size, most)
            if size == most:
                # from here on all alike: counted, for there may be millions
                steps += max(1, math.ceil((goal - here) / size - _NEAR - 1e-9))
                here = goal
                break
            here = goal if here + size > goal - _NEAR * size else here + size
            size *= growth
            steps += 1
    return steps


def expected_angle(case: Case) -> float | None:
    """Bending angle at the end of a run, rad; of a given pressure by the closed form, if any."""
    load = case.inflation
    if load is None:
        return None
    stop = case.output.stop_at_angle
    if load.angle is not None:
        return load.angle
    from fiberbend.models.closed_form import analytic_curves

    curve = analytic_curves(case).get(lines.ZERO_FIT)
    if curve is None or load.to is None:
        return stop
    from analytic.inverse import first_angle

    low, high = curve.angles
    angle = first_angle(curve.pressure, load.to, high if load.to > 0 else low).angle
    return stop if stop is not None and stop * angle > 0 and abs(stop) < abs(angle) else angle

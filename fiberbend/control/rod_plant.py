"""An actuator with inertia between two valves: a plant whose angle is that of a rod in motion."""

from __future__ import annotations

import dataclasses
import math
import time

import numpy as np

from analytic.control.controller import Valves
from analytic.control.plant import ActuatorCurve, ArcCurve, PlantParameters
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects.pressure import inflate
from fiberbend.effects.records import Requests
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.slender.actuator import Slender, slender
from fiberbend.slender.air import ValveAir
from fiberbend.slender.laws import twists_by_itself
from fiberbend.slender.path import PRESSURE, Course, Limits
from fiberbend.slender.timed import equilibrium
from rod.motion import Motion, Moving
from rod.motion.motion import retarded
from rod.rod import Level
from rod.statics import NoEquilibriumError

STEP = 0.005
"""Longest step in time, s."""
_TURN = math.radians(10)
_CUTBACKS = 8
_BEYOND = 4 / 3
"""Of the greatest angle that is asked for: so far the law of the section reaches."""


def rod_of(case: Case, highest: float) -> Slender:
    """The rod of a case whose section is known beyond an angle.

    Args:
        case: any case that model rod takes; its pressure is not used.
        highest: angle in rad.

    Raises:
        CaseError: the rod cannot have an effect of the case, or a material has no density.
    """
    from fiberbend.models.rod import MODEL, MOVED

    loads = [effect for effect in case.effects if effect.inflation() is None]
    given = {"model": MODEL.name, "time": None, "accuracy": None}
    bent = case.model_copy(update=given | {"effects": (*loads, inflate(angle=_BEYOND * highest))})
    problems = [Problem(path, f"plant rod: {text}") for path, text in MODEL.refuses(bent)]
    if twists_by_itself(bent):
        problems.append(Problem("effects", f"plant rod: {MOVED}"))
    problems += [
        Problem(f"materials.{name}.density", "missing, expected one: what moves has mass")
        for name, material in convert.site(case).materials.items()
        if material.mass_density is None
    ]
    if problems:
        raise CaseError(problems)
    return slender(bent)


def rod_curve(rod: Slender) -> tuple[ActuatorCurve, str]:
    """P, θ and V of a rod at rest under its loads; why it ends before its angle, or nothing."""
    course = Course(rod, Requests(None, None, (), (), None), Limits(_TURN, _CUTBACKS), 0)
    report = course.run()
    inflated = [point for point in course.points if PRESSURE in point.values]
    found = [equilibrium(rod, 0.0), *inflated]
    values = np.array(
        [
            (
                p.values.get(PRESSURE, 0.0),
                p.angle,
                rod.rod.volume(p.state.strains, p.values.get(PRESSURE, 0.0)),
            )
            for p in found
        ]
    )
    rising = np.concatenate([[True], np.diff(values[:, 0]) > 0])
    return ArcCurve(*values[rising].T), report.reason


@dataclasses.dataclass(frozen=True)
class Damping:
    """What damps the rod.

    Attributes:
        retardation: τ of Kelvin and Voigt, s.
        drag: Rayleigh's part of the mass, 1/s.
    """

    retardation: float = 0.0
    drag: float = 0.0


class RodPlant:
    """Chamber and moving actuator between two valves; an `analytic.control.loop.Controlled`.

    Args:
        rod: the actuator.
        parameters: pneumatics; a lag of the angle has no place here: inertia is it.
        damping: of the rod.

    Attributes:
        parameters: as given.
        pressure: gauge pressure in the chamber now, MPa.
        angle: bending angle now, rad.
        steps: that were made.
        seconds: processor time that they took.

    Raises:
        ValueError: valves too large for the chamber, or a lag.
    """

    def __init__(self, rod: Slender, parameters: PlantParameters, damping: Damping) -> None:
        if parameters.lag:
            raise ValueError("lag: no effect beside the rod's inertia, expected 0 ms")
        self.parameters, self._rod = parameters, rod
        rest = rod.rod.layout.at_rest()
        self._air = ValveAir(parameters, rod.rod.volume(rest, 0.0))
        whole = {ramp.load: ramp.target for ramp in rod.ramps if ramp.load != PRESSURE}
        level = Level(0.0, rod.level(whole).amounts)
        viscosity = retarded(rod.rod, damping.retardation)
        self._motion = Motion(rod.rod, lambda time: level, viscosity, damping.drag, self._air)
        self._weights = rod.weights()
        self.steps, self.seconds = 0, 0.0
        self.restart(0.0)

    def restart(self, pressure: float) -> None:
        """Come to rest under a gauge pressure in MPa.

        Raises:
            ValueError: there is no such equilibrium.
        """
        try:
            point = equilibrium(self._rod, pressure)
        except CaseError as error:
            raise ValueError(f"curve: {error.problems[0].text}") from None
        self._moving = self._motion.at(point.state.strains, pressure=pressure)
        self._told(self._moving)

    def _told(self, moving: Moving) -> None:
        self._moving, self.pressure = moving, moving.pressure
        self.angle = float(np.vdot(self._weights, moving.strains))

    def advance(self, valves: Valves, duration: float) -> None:
        """Let time pass with the valves as they are.

        Raises:
            ValueError: the rod leaves the range in which its section is known.
        """
        count = math.ceil(duration / STEP * (1 - 1e-9))
        began = time.process_time()
        for _ in range(count):
            self._air.move(self._moving.time, valves)
            try:
                self._told(self._motion.step(self._moving, duration / count))
            except NoEquilibriumError as error:
                raise ValueError(f"curve: {error}") from None
        self.seconds += time.process_time() - began
        self.steps += count

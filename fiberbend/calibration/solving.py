"""Small scenes of uniform bending, marched to the states that a calibration compares."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.kinematics.uniform import CURVATURE, STRETCH
from fem.march.hooks import AfterStep
from fem.march.march import March
from fem.march.records import Report, Rules, State
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from fem.solver.side_conditions import Functional, GivenFunctional, Stationary
from fiberbend.case.case import Case
from fiberbend.effects.effect import Effect
from fiberbend.models.choice import meshed
from fiberbend.models.parts import build

PRESSURE = "pressure"
_SAME = 1e-9
_FIRST, _GROW = math.radians(45), 3.0
"""Steps of uniform bending without contact: the first, and how fast they grow."""


@dataclasses.dataclass(frozen=True)
class Reading:
    """What is compared of a state.

    Attributes:
        pressure: MPa.
        moment: that keeps it straight, N mm; zero where it is bent.
        stretch: along the pin.
        area: of the chamber, its volume per length at rest, mm².
        angle: rad.
    """

    pressure: float
    moment: float
    stretch: float
    area: float
    angle: float


class Small:
    """A case of uniform bending on this rank alone, compiled and at rest.

    Args:
        case: model section or cell.
    """

    def __init__(self, case: Case) -> None:
        model = meshed(case)
        self._case, mesh = case, model.mesh(case)
        parts = build(case, mesh, model)
        self.scene = Scene(Domain(mesh, MPI.COMM_SELF), parts.effects, model.kinematics(case))
        self._ramps = parts.ramps(self.scene.body.symmetry_factor)
        self._control: Functional = model.observables(case, self.scene).control
        self._newton = Newton(self.scene, MPI.COMM_SELF, Settings(tolerance=case.solver.tolerance))
        turn = model.largest_turn(case)
        rules = Rules(turn=turn, first_turn=min(turn, _FIRST), memory=model.memory, grow=_GROW)
        self._march = March(self.scene, self._newton, rules, control=self._control)

    def march(self) -> tuple[list[State], Report]:
        """States that the case asks for by angle or pressure, in their order, and how it ended."""
        found: list[State] = []
        asked = (*self._case.output.at_angles, *self._case.output.at_pressures)

        def keep(state: State, _outcome: Outcome) -> None:
            key = "value pressure" if self._case.straight else "control"
            if any(math.isclose(state.measures[key], goal, rel_tol=_SAME) for goal in asked):
                found.append(state)

        report = self._march.run(self._ramps, [AfterStep(keep)])
        return found, report

    def read(self, state: State) -> Reading:
        """What is compared of a state."""
        share = self.scene.body.symmetry_factor / self._case.actuator.length
        return Reading(
            pressure=state.scalars[PRESSURE],
            moment=share * state.measures.get(f"conjugate {CURVATURE}", 0.0),
            stretch=state.scalars[STRETCH],
            area=share * state.measures[f"conjugate {PRESSURE}"],
            angle=state.measures["control"],
        )

    def wind(self, winding: Effect) -> None:
        """Give the winding of the scene other numbers; mesh and kernels stay.

        Args:
            winding: of the same thread.
        """
        from fiberbend.case import convert

        site, requests = convert.site(self._case), convert.requests(self._case)
        built = winding.build(site, self.scene.domain.data, requests)
        for term in built.terms:
            potential = term.discrete(self.scene.body)
            assert potential is not None
            self.scene.discrete[term.key] = potential
        # away from the present state, which the scene would take as evaluated
        self.scene.set(np.zeros_like(self.scene.w))

    def again(self, state: State) -> State | None:
        """The state at the same angle, or kept straight at the same pressure; None: none found."""
        scene, natural = self.scene, list(self.scene.natural)
        self._march.equilibrium.restore(state)
        scene.predict(None)
        conditions: list = [Stationary(scene, name) for name in natural]
        if self._case.straight:
            outcome = self._newton.solve(state.w, natural, conditions)
        else:
            conditions.append(GivenFunctional(self._control, state.measures["control"]))
            outcome = self._newton.solve(state.w, [*natural, PRESSURE], conditions)
        return self._march.equilibrium.capture() if outcome.converged else None

"""A small scene of uniform bending on one rank, marched to the states that are asked for."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from analytic.path import CentreLine
from fem.effects.effect import Discrete
from fem.effects.sums.hold import HOLD, Held
from fem.kinematics.domain import Domain
from fem.kinematics.uniform import CURVATURE, STRETCH, Uniform
from fem.march.hooks import AfterStep
from fem.march.march import March
from fem.march.records import Report, Rules, State, measure
from fem.results.diagnosis import Diagnosis
from fem.scene import Scene
from fem.solver.bordered import BorderedSystem, SideCondition
from fem.solver.newton import Newton, Outcome, Settings
from fem.solver.side_conditions import Functional, GivenFunctional, Stationary
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.effects.effect import Effect
from fiberbend.models.choice import meshed
from fiberbend.models.parts import build
from geometry.mesh.data import MeshData

PRESSURE = "pressure"
_SAME = 1e-9
_FAR = 0.5
"""Part of a neighbour's displacement by which a state may differ from it."""
_FIRST, _GROW = math.radians(45), 3.0
"""Steps of uniform bending without contact: the first, and how fast they grow."""


@dataclasses.dataclass(frozen=True)
class Reading:
    """What a section and a cell have in common.

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


class Reached(NamedTuple):
    """Where a march has come.

    Attributes:
        found: states by what was asked for.
        report: how it ended.
        furthest: the state with the greatest angle, or pressure, of all on the way.
    """

    found: dict[float, State]
    report: Report
    furthest: State


@dataclasses.dataclass
class _Stage:
    """A compiled scene with its solver.

    Attributes:
        scene: the scene.
        newton: its solver.
        numbers: of the case that it stands for at present.
    """

    scene: Scene
    newton: Newton
    numbers: tuple[object, ...]


class Small:
    """A case of uniform bending on this rank alone, compiled and at rest.

    Args:
        case: model section or cell.
        likes: others: it takes over the scene of the first from which it differs by numbers and
            loads alone. What shares a scene is used one after another, the last one made.
        mesh: in place of the model's own, for the first of those that share a scene.

    Attributes:
        scene: the compiled scene.
        observables: what is read off its states.
    """

    _stage: _Stage
    _system: BorderedSystem

    def __init__(self, case: Case, *likes: Small, mesh: MeshData | None = None) -> None:
        model = meshed(case)
        self._case, self._model = case, model
        numbers, settings = _numbers(case), Settings(tolerance=case.solver.tolerance)
        for effect in case.acting:
            settings = effect.settings(settings)
        alike = [like._stage for like in likes if like._serves(case, settings)]
        stage = next((one for one in alike if one.numbers == numbers), None)
        if stage is not None:
            mesh = stage.scene.domain.data
        elif mesh is None:
            mesh = model.mesh(case)
        parts = build(case, mesh, model)
        self._held = {k: v for term in parts.effects for k, v in term.fixed_scalars().items()}
        if stage is None:
            stage = next((one for one in alike if one.scene.refit(parts.effects, mesh)), None)
        else:
            stage.scene.begin()
        if stage is None:
            scene = Scene(Domain(mesh, MPI.COMM_SELF), parts.effects, model.kinematics(case))
            stage = _Stage(scene, Newton(scene, MPI.COMM_SELF, settings), numbers)
        else:
            stage.numbers = numbers
            _bent(stage.scene).resize(case.actuator.length)
            stage.newton.begin()
        self._stage, self.scene, self._newton = stage, stage.scene, stage.newton
        self.scene.hold(self._held)
        self._ramps = parts.ramps(self.scene.body.symmetry_factor)
        self.observables = model.observables(case, self.scene)
        self._control: Functional = self.observables.control
        turn = model.largest_turn(case)
        rules = Rules(
            cutbacks=case.solver.max_cutbacks,
            turn=turn,
            first_turn=min(turn, _FIRST),
            memory=model.memory,
            grow=_GROW,
        )
        for effect in case.acting:
            rules = effect.rules(rules, case.straight)
        causes = Diagnosis(self.scene)
        self._march = March(self.scene, self._newton, rules, control=self._control, causes=causes)

    def _serves(self, case: Case, settings: Settings) -> bool:
        """Whether its unknowns and its solver are those of another case."""
        mine, theirs = (Symmetry.of(given.acting) for given in (self._case, case))
        alike = mine.scalars() == theirs.scalars() and mine.halved == theirs.halved
        return alike and self._model is meshed(case) and self._newton.settings == settings

    @property
    def rest(self) -> State:
        """The state at rest."""
        return self._march.rest

    def march(self) -> tuple[list[State], Report]:
        """States that the case asks for by angle or pressure, in their order, and how it ended.

        It begins where it was made, at rest: before another that shares its scene is made.
        """
        found, report, _ = self.reach()
        asked = (*self._case.output.at_angles, *self._case.output.at_pressures)
        return [found[value] for value in asked if value in found], report

    def reach(self, volumes: Sequence[float] = ()) -> Reached:
        """The same by what was asked for: angles, pressures or, of a case with a volume, volumes.

        Args:
            volumes: of the whole chamber, mm³; one of the three is asked for.
        """
        found: dict[float, State] = {}
        furthest, value = self.rest, measure("value", PRESSURE)
        volume, whole = measure("conjugate", PRESSURE), self.scene.body.symmetry_factor
        output, slack = self._case.output, 2 * self._case.solver.tolerance
        asked = [("control", goal, goal) for goal in output.at_angles]
        asked += [(value, goal, goal) for goal in output.at_pressures]
        asked += [(volume, goal / whole, goal) for goal in volumes]
        driven = value if output.at_pressures else "control"
        ramps = [
            dataclasses.replace(ramp, stops=tuple(goal / whole for goal in volumes))
            if ramp.drive == "conjugate"
            else ramp
            for ramp in self._ramps
        ]

        def keep(state: State, _outcome: Outcome) -> None:
            nonlocal furthest
            if abs(state.measures[driven]) > abs(furthest.measures[driven]):
                furthest = state
            for key, goal, name in asked:
                near = slack if key == "control" else 0.0
                if math.isclose(state.measures[key], goal, rel_tol=_SAME, abs_tol=near):
                    found.setdefault(name, state)

        report = self._march.run(ramps, [AfterStep(keep)])
        return Reached(found, report, furthest)

    def put(self, state: State) -> None:
        """Put the scene to a state that was found."""
        self.scene.hold(self._held)
        self._march.equilibrium.restore(state)

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

    def windings(self, winding: Effect) -> dict[str, Discrete]:
        """Potentials of the winding with other numbers; mesh and kernels stay.

        Args:
            winding: of the same thread.
        """
        site, requests = convert.site(self._case), convert.requests(self._case)
        built = winding.build(site, self.scene.domain.data, requests)
        found = {term.key: term.discrete(self.scene.body) for term in built.terms}
        return {key: potential for key, potential in found.items() if potential is not None}

    @property
    def length(self) -> float:
        """Of the chamber, mm."""
        return self._case.actuator.length

    def line(self) -> CentreLine:
        """The centre-line at the present state."""
        return _bent(self.scene).centre_line()

    def again(self, state: State, kind: str = "") -> State | None:
        """The state once more; None: none found.

        Args:
            state: found before.
            kind: what is given: 'control' or 'value'; by default the angle, or the pressure of
                what is kept straight.
        """
        unknown, conditions = self.conditions(state, kind) if kind else self._back(state)
        outcome = self._newton.solve(state.w, unknown, conditions)
        return self._march.equilibrium.capture() if outcome.converged else None

    def conditions(
        self, state: State, kind: str, goal: float | None = None
    ) -> tuple[list[str], list[SideCondition]]:
        """Put the scene to a state, and say which scalars are found there, by which conditions.

        Args:
            state: of this case, or of a like one that had this scene before.
            kind: what is given: 'control' or 'value'.
            goal: the angle in rad, or the pressure in MPa; that of the state by default.
        """
        scene = self.scene
        self.put(state)
        scene.predict(None)
        unknown = list(scene.natural)
        conditions: list[SideCondition] = [Stationary(scene, name) for name in unknown]
        if kind == "control":
            unknown.append(PRESSURE)
            goal = state.measures["control"] if goal is None else goal
            conditions.append(GivenFunctional(self._control, goal))
        elif goal is not None:
            scene.set_scalar(PRESSURE, goal)
        return unknown, conditions

    def capture(self) -> State:
        """The present state of the scene."""
        return self._march.equilibrium.capture()

    def from_neighbour(self, state: State, kind: str, goal: float) -> State | None:
        """A state found from that of a like case, with its stability; None: not by this way.

        What is found so is the state to which a march leads where both are stable and lie near each
        other, and no path to either has lost its stability.

        Args:
            state: of a case that had this scene before.
            kind: what is given: 'control' or 'value'.
            goal: the angle in rad, or the pressure in MPa.
        """
        equilibrium = self._march.equilibrium
        unknown, conditions = self.conditions(state, kind, goal)
        outcome = self._newton.solve(state.w, unknown, conditions)
        if not outcome.converged or not equilibrium.tells_stability:
            return None
        new = equilibrium.capture()
        moved = equilibrium.displacements
        way, size = (np.linalg.norm(w[moved]) for w in (new.w - state.w, state.w))
        if way > _FAR * size:
            return None
        if not outcome.factorisations:
            self._newton.assemble()
            self._newton.factorise(unknown, conditions)
        return new if equilibrium.modes() == 0 else None

    def held(self, state: State, targets: Mapping[str, float], pressure: float) -> State | None:
        """A stable state near another one, whose strains are held; None: none found.

        The tangent at the state itself is left factorised, for `responses`.

        Args:
            state: of this case, which holds the same motions.
            targets: by name, as `Hold` has them.
            pressure: MPa.
        """
        scene, equilibrium = self.scene, self._march.equilibrium
        holding = {key: item for key, item in scene.discrete.items() if isinstance(item, Held)}
        for item in holding.values():
            item.aim(targets)
        scene.exchange(holding)
        unknown, conditions = self.conditions(state, "value", pressure)
        scene.set_scalar(HOLD, 1.0)
        outcome = self._newton.solve(state.w, unknown, conditions)
        if not outcome.converged or not equilibrium.tells_stability:
            return None
        new = equilibrium.capture()
        scene.predict(None)
        scene.residual()  # whose forces scale the conditions
        self._newton.assemble()
        self._system = self._newton.factorise(unknown, conditions)
        return new if equilibrium.modes() == 0 else None

    def responses(
        self, held: Sequence[str], scalar: str
    ) -> list[tuple[npt.NDArray[np.float64], dict[str, float]]]:
        """Rates of the fields and of all scalars that are found, at the state of `held`.

        Args:
            held: names of what is held: the rates are with its value, over the whole length.
            scalar: a load, with whose value the last rates are.
        """
        scene, names = self.scene, list(self.scene.natural)
        conditions = [Stationary(scene, name) for name in names]
        part, found = 1 / scene.body.symmetry_factor, []
        for name in held:
            sides = np.zeros(len(names))
            sides[names.index(name)] = part / scene.equation_scale(name)
            found.append(self._system.eliminate(np.zeros(len(scene.w)), sides))
        column = self._newton.solve_linear(scene.load(scalar))
        sides = np.array([condition.slope(scalar) for condition in conditions])
        found.append(self._system.eliminate(column, sides))
        return [(-w, dict(zip(names, (-q).tolist(), strict=True))) for w, q in found]

    def keeps_symmetry(self, state: State) -> bool:
        """Whether half of what is modelled does not buckle out of its symmetry at a state."""
        self.put(state)
        return not self._march.equilibrium.opposite_modes(state, self.rest)

    def near(self, state: State, others: Sequence[Mapping[str, Discrete]]) -> Iterator[State]:
        """A state with windings of slightly other numbers, by a step with one tangent.

        Args:
            state: found with the present winding.
            others: potentials of the windings; the last ones stay.
        """
        unknown, conditions = self._back(state)
        scene, newton = self.scene, self._newton
        scene.residual()  # whose forces scale the conditions
        newton.assemble()
        system = newton.factorise(unknown, conditions)
        for potentials in others:
            scene.exchange(potentials)
            self._back(state)
            forces, _ = scene.residual()
            left = np.array([condition.value() for condition in conditions])
            step = newton.solve_linear(np.where(scene.free[: len(forces)], forces, 0.0))
            step, change = system.eliminate(step, left)
            for name, value in zip(unknown, change, strict=True):
                scene.set_scalar(name, scene.scalar(name) - float(value))
            scene.set(state.w - step)
            yield self._march.equilibrium.capture()

    def _back(self, state: State) -> tuple[list[str], list[SideCondition]]:
        """Put the scene to a state; the scalars that are found there, by which conditions."""
        return self.conditions(state, "value" if self._case.straight else "control")


def _bent(scene: Scene) -> Uniform:
    body = scene.body
    assert isinstance(body, Uniform), "model section or cell"
    return body


def _numbers(case: Case) -> tuple[object, ...]:
    """All of a case that a scene is compiled from but its loads, which are scalars."""
    effects = tuple(
        effect
        for effect in case.effects
        if effect.inflation() is None and not effect.keeps_straight()
    )
    return case.model, case.actuator, case.materials, case.mesh, effects

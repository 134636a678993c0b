"""Sections and cells assembled by hand, driven by any global scalar."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry, TwofoldAxis
from fem.kinematics.domain import Domain
from fem.kinematics.section import Section
from fem.kinematics.uniform import CURVATURE, STRETCH, TWIST
from fem.march.hooks import AfterStep
from fem.march.march import March
from fem.march.records import Ramp, Rules, State
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.bodies.extrude import section_quadrilaterals
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize

Floats = npt.NDArray[np.float64]
Law = dict[str, float]
RATES = (CURVATURE, STRETCH, TWIST)


class Value:
    """A global scalar as a functional that a march can follow.

    Args:
        scene: where it lives.
        name: its name.
    """

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name

    def value(self) -> float:
        """At the present state."""
        return self._scene.scalar(self._name)

    def row(self) -> Floats:
        """No field enters."""
        return np.zeros(self._scene.body.owned)

    def slope(self, scalar: str) -> float:
        """One for itself."""
        return float(scalar == self._name)


class Held(Effect):
    """Natural unknowns held at values.

    Args:
        values: by name.
    """

    def __init__(self, values: dict[str, float]) -> None:
        self.values = values

    def fixed_scalars(self) -> dict[str, float]:
        """As given."""
        return self.values


def domain(actuator: ShapedActuator, refinement: int) -> Domain:
    """Half a section."""
    return Domain(
        section_quadrilaterals(actuator, MeshSize(section=refinement, half=True)), MPI.COMM_SELF
    )


def rubber(laws: dict[str, Law], bulk: float | None = None) -> list[Effect]:
    """Yeoh's law in every region; incompressible, or with a bulk modulus in MPa."""
    return [Elastic("yeoh", laws), Incompressible(dict.fromkeys(laws, bulk) if bulk else None)]


def section(
    where: Domain, actuator: ShapedActuator, effects: Sequence[Effect], twisted: bool = False
) -> Scene:
    """A scene of uniform bending on half a section, with its mirror plane or axis."""
    support: Effect = TwofoldAxis() if twisted else Symmetry()
    make = functools.partial(Section, length=actuator.length, twisted=twisted)
    return Scene(where, [*effects, support], make)


def march(scene: Scene, ramp: Ramp, control: str = STRETCH, turn: float = 0.05) -> list[State]:
    """All states of a ramp from rest.

    Args:
        scene: at rest.
        ramp: the load; "control" drives the scalar `control`.
        control: a global scalar.
        turn: greatest change of `control` in a step.
    """
    states: list[State] = []
    runner = March(
        scene,
        Newton(scene, MPI.COMM_SELF, Settings()),
        Rules(turn=turn, first_turn=turn),
        control=Value(scene, control),
        hooks=[AfterStep(lambda state, _: states.append(state))],
    )
    report = runner.run([ramp])
    assert report.status == "converged", report.reason
    return states


def resultants(scene: Scene) -> dict[str, float]:
    """∂Π/∂q of k, λ0 (and τ) per mm of length of the whole section: N mm, N, N mm."""
    factor = -scene.body.symmetry_factor / scene.body.length  # type: ignore[attr-defined]
    return {name: factor * scene.conjugate(name) for name in RATES if name in scene.body.natural}


class _Balance:
    """Closing equation: no moment, force or torque that is conjugate to a natural unknown."""

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name

    def value(self) -> float:
        return -self._scene.conjugate(self._name)

    def noise(self) -> float:
        return 0.0

    def lag(self) -> float:
        return self._scene.lag_along(self._name)

    def row(self) -> Floats:
        return self._scene.load(self._name)

    def slope(self, scalar: str) -> float:
        return self._scene.second_derivative(self._name, scalar)


@dataclasses.dataclass(frozen=True)
class Linear:
    """Derivatives at rest by one global scalar.

    Attributes:
        natural: of the natural unknowns that are free.
        resultants: of ∂Π/∂q per mm of length of the whole section.
    """

    natural: dict[str, float]
    resultants: dict[str, float]


def linear(scene: Scene, load: str, step: float) -> Linear:
    """The linear response at rest to a scalar.

    Args:
        scene: a scene.
        load: name of the scalar.
        step: size of the central difference that finds the resultants.
    """
    scene.set(np.zeros(scene.body.owned))
    rest = {name: scene.scalar(name) for name in (load, *scene.natural)}
    newton = Newton(scene, MPI.COMM_SELF, Settings())
    field, natural = newton.response(
        load, scene.natural, [_Balance(scene, name) for name in scene.natural]
    )
    sides = []
    for size in (step, -step):
        for name, rate in {load: 1.0, **natural}.items():
            scene.set_scalar(name, rest[name] + size * rate)
        scene.set(size * field)
        sides.append(resultants(scene))
    up, down = sides
    return Linear(natural, {name: (up[name] - down[name]) / (2 * step) for name in up})

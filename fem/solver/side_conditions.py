"""Side conditions of an equilibrium: one scalar is found so that each of them is met."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from fem.scene import Scene

Floats = npt.NDArray[np.float64]


class Functional(Protocol):
    """A scalar measure with its gradient, such as the bending angle."""

    def value(self) -> float:
        """At the present state."""

    def row(self) -> Floats:
        """∂/∂w on the owned dofs."""

    def slope(self, scalar: str) -> float:
        """∂/∂q of a global scalar."""


class GivenConjugate:
    """(c − c̄)/|c̄| = 0: the work-conjugate c = −∂Π/∂q of a scalar takes a value.

    Args:
        scene: the scene.
        name: of the scalar q.
        target: c̄, such as a chamber volume in mm³.
    """

    def __init__(self, scene: Scene, name: str, target: float) -> None:
        self._scene, self._name, self._target = scene, name, target
        self._scale = max(abs(target), 1e-30)

    def value(self) -> float:
        """What is left of the equation, scaled."""
        return (self._scene.conjugate(self._name) - self._target) / self._scale

    def noise(self) -> float:
        """None that is known."""
        return 0.0

    def lag(self) -> float:
        """What a step with the last tangent lacks of that."""
        return -self._scene.lag_along(self._name) / self._scale

    def row(self) -> Floats:
        """Its gradient on the owned dofs."""
        return -self._scene.load(self._name) / self._scale

    def slope(self, scalar: str) -> float:
        """Its derivative with respect to a global scalar."""
        return -self._scene.second_derivative(self._name, scalar) / self._scale


class Stationary:
    """∂Π/∂q / s = 0: the potential is stationary in a natural scalar.

    The scale s makes the condition as fine as those on the forces.

    Args:
        scene: the scene.
        name: of the scalar q.
    """

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name

    @property
    def _scale(self) -> float:
        return self._scene.equation_scale(self._name)

    def value(self) -> float:
        """What is left of the equation, scaled."""
        return -self._scene.conjugate(self._name) / self._scale

    def noise(self) -> float:
        """That of the potentials with code of their own."""
        return self._scene.noise_along[self._name] / self._scale

    def lag(self) -> float:
        """What a step with the last tangent lacks of that."""
        return self._scene.lag_along(self._name) / self._scale

    def row(self) -> Floats:
        """Its gradient on the owned dofs."""
        return self._scene.load(self._name) / self._scale

    def slope(self, scalar: str) -> float:
        """Its derivative with respect to a global scalar."""
        return self._scene.second_derivative(self._name, scalar) / self._scale


class GivenFunctional:
    """g − ḡ = 0: a functional takes a value.

    Args:
        functional: g, of the order of one (an angle in rad).
        target: ḡ.
    """

    def __init__(self, functional: Functional, target: float) -> None:
        self._functional, self._target = functional, target

    def value(self) -> float:
        """What is left of the equation, scaled."""
        return self._functional.value() - self._target

    def noise(self) -> float:
        """None that is known."""
        return 0.0

    def lag(self) -> float:
        """Nothing: no fiber force is in it."""
        return 0.0

    def row(self) -> Floats:
        """Its gradient on the owned dofs."""
        return self._functional.row()

    def slope(self, scalar: str) -> float:
        """Its derivative with respect to a global scalar."""
        return self._functional.slope(scalar)

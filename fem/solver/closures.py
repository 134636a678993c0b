"""Equations that close a bordered system: a scalar is found so that each of them holds."""

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


class Conjugate:
    """Closing equation: the conjugate of a scalar takes a value."""

    def __init__(self, scene: Scene, name: str, target: float) -> None:
        self._scene, self._name, self._target = scene, name, target
        self._scale = max(abs(target), 1e-30)

    def value(self) -> float:
        """What is left of the equation, scaled."""
        return (self._scene.conjugate(self._name) - self._target) / self._scale

    def row(self) -> Floats:
        """Its gradient on the owned dofs."""
        return -self._scene.load(self._name) / self._scale

    def slope(self, scalar: str) -> float:
        """Its derivative with respect to a global scalar."""
        return -self._scene.corner(self._name, scalar) / self._scale


class Stationary:
    """Closing equation: the potential is stationary in a natural scalar."""

    def __init__(self, scene: Scene, name: str) -> None:
        self._scene, self._name = scene, name
        self._lever = scene.body.span / scene.body.size_of(name)

    @property
    def _scale(self) -> float:
        return self._scene.force_scale * self._lever

    def value(self) -> float:
        """What is left of the equation, scaled."""
        return -self._scene.conjugate(self._name) / self._scale

    def row(self) -> Floats:
        """Its gradient on the owned dofs."""
        return self._scene.load(self._name) / self._scale

    def slope(self, scalar: str) -> float:
        """Its derivative with respect to a global scalar."""
        return self._scene.corner(self._name, scalar) / self._scale


class Target:
    """Closing equation: a functional takes a value."""

    def __init__(self, functional: Functional, target: float) -> None:
        self._functional, self._target = functional, target

    def value(self) -> float:
        """What is left of the equation, scaled."""
        return self._functional.value() - self._target

    def row(self) -> Floats:
        """Its gradient on the owned dofs."""
        return self._functional.row()

    def slope(self, scalar: str) -> float:
        """Its derivative with respect to a global scalar."""
        return self._functional.slope(scalar)

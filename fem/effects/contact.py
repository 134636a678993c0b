"""Contact of the outer surface with rigid, frictionless obstacles."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar, Protocol

import ufl

from fem.effects.effect import Effect
from fem.kinematics.kinematics import Kinematics

ROUND_OFF = 1e-12
"""Obstacles are so much nearer, as a part of the body: where one lies against the body at rest, all
of its points are in the first tangent, not those whose gap of ±1e-16 round-off makes negative."""


class Obstacle(Protocol):
    """A rigid body that keeps its place."""

    def numbers(self) -> list[float]:
        """What places it, mm."""

    def gap(self, x: Any, numbers: Any) -> Any:
        """Signed distance of a point to its surface in mm; negative inside.

        Args:
            x: y and z of the point at least, by component: a UFL vector, or arrays.
            numbers: those of `numbers`, as they are or as UFL constants.
        """


@dataclasses.dataclass(frozen=True)
class Plane:
    """A half space behind a plane.

    Attributes:
        point: a point of the plane, mm.
        normal: out of the obstacle, of any length above zero.
    """

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def numbers(self) -> list[float]:
        """Unit normal and distance from the origin along it."""
        length = sum(n * n for n in self.normal) ** 0.5
        normal = [n / length for n in self.normal]
        return [*normal, sum(n * p for n, p in zip(normal, self.point, strict=True))]

    def gap(self, x: Any, numbers: Any) -> Any:
        """n · x − n · p."""
        return sum(numbers[i] * x[i] for i in range(3)) - numbers[3]


@dataclasses.dataclass(frozen=True)
class Cylinder:
    """A round bar along x.

    Attributes:
        center: y and z of its axis, mm.
        radius: mm.
    """

    center: tuple[float, float]
    radius: float

    def numbers(self) -> list[float]:
        """Center and radius."""
        return [*self.center, self.radius]

    def gap(self, x: Any, numbers: Any) -> Any:
        """Distance from the axis less the radius."""
        return ((x[1] - numbers[0]) ** 2 + (x[2] - numbers[1]) ** 2) ** 0.5 - numbers[2]


class Contact(Effect):
    """Π = ∫ ½ k d² dS, d the depth of a surface's deformed point in the obstacle: unilateral.

    A penalty: the obstacle yields by p/k under a pressure p. Π is once continuously
    differentiable, so that touch and lift-off bend the forces and do not break them; the tangent
    is that of the points that touch. Nothing acts at a distance.

    Args:
        name: of the obstacle.
        obstacle: what is touched.
        surfaces: named surfaces of the body that may touch it.
        stiffness: k, MPa/mm.

    Raises:
        ValueError: a stiffness that is not positive.
    """

    outside: ClassVar[bool] = True

    def __init__(
        self, name: str, obstacle: Obstacle, surfaces: tuple[str, ...], stiffness: float
    ) -> None:
        if not stiffness > 0:
            raise ValueError(f"contact stiffness {stiffness} MPa/mm, expected a positive value")
        self.name = name
        self.obstacle = obstacle
        self.surfaces = surfaces
        self.stiffness = stiffness

    @property
    def key(self) -> str:
        """Several obstacles may exist."""
        return f"Contact[{self.name}]"

    def potential(self, body: Kinematics) -> Any:
        """The penalty as a form; all numbers are constants."""
        place = body.constants(self.obstacle.numbers())
        stiffness = body.constants([self.stiffness])[0]
        nearer = body.constants([ROUND_OFF * body.span])[0]
        depth = ufl.max_value(nearer - self.obstacle.gap(body.x, place), 0.0)
        density = stiffness / 2 * depth**2
        return sum((density * body.ds(name) for name in self.surfaces), ufl.Form([]))

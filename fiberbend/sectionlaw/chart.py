"""Coordinates in which the states that a rod takes fill a box: e, u and P for λ, k and P."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats


@dataclasses.dataclass(frozen=True)
class Chart:
    """e = λ − s k, the stretch of a line that free bending hardly stretches; u = (k − k₀)/h(P).

    h = a + b P grows with the curvature of the free section: bent far without pressure, which no
    rod is, threads go slack, and a section has no smooth law.

    Attributes:
        lever: s, mm.
        least: k₀, the least curvature, rad/mm.
        width: a, rad/mm.
        growth: b, rad/mm/MPa.
    """

    lever: float
    least: float
    width: float
    growth: float

    def place(self, strains: Floats, pressure: float) -> Floats:
        """e and u, (n, 2), by λ and k."""
        stretch, curvature = strains.T
        share = (curvature - self.least) / (self.width + self.growth * pressure)
        return np.column_stack([stretch - self.lever * curvature, share])

    def strains(self, points: Floats) -> Floats:
        """λ and k, (n, 2), by e, u and P."""
        e, u, pressure = points.T
        curvature = self.least + u * (self.width + self.growth * pressure)
        return np.column_stack([e + self.lever * curvature, curvature])

    def first(self, place: Floats, pressure: float) -> Floats:
        """∂(e, u, P)/∂(λ, k, P), (n, 3, 3)."""
        h = self.width + self.growth * pressure
        out = np.zeros((len(place), 3, 3))
        out[:, 0, 0] = out[:, 2, 2] = 1.0
        out[:, 0, 1], out[:, 1, 1] = -self.lever, 1.0 / h
        out[:, 1, 2] = -place[:, 1] * self.growth / h
        return out

    def second(self, place: Floats, pressure: float) -> Floats:
        """∂²u/∂(λ, k, P)², (n, 3, 3); e and P have none."""
        h = self.width + self.growth * pressure
        out = np.zeros((len(place), 3, 3))
        out[:, 1, 2] = out[:, 2, 1] = -self.growth / h**2
        out[:, 2, 2] = 2 * place[:, 1] * (self.growth / h) ** 2
        return out

    def slopes(self, points: Floats, forces: Floats) -> Floats:
        """∂Φ by e, u and P, (n, 3), by N, M and the area of the chamber, (n, 3)."""
        _, u, pressure = points.T
        force, moment, area = forces.T
        own = moment + self.lever * force
        h = self.width + self.growth * pressure
        return np.column_stack([force, own * h, own * u * self.growth - area])

    def forces(self, points: Floats, slopes: Floats) -> Floats:
        """N, M and the area of the chamber, (n, 3), by ∂Φ by e, u and P: `slopes` undone."""
        _, u, pressure = points.T
        own = slopes[:, 1] / (self.width + self.growth * pressure)
        force = slopes[:, 0]
        area = own * u * self.growth - slopes[:, 2]
        return np.column_stack([force, own - self.lever * force, area])

"""Weight of the body."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

from fiberbend.effects.effect import Built, Effect, Requests, Site
from fiberbend.effects.records import LINE, OnRod, RodRamp, RodSite
from fiberbend.schema.quantities import Acceleration

if TYPE_CHECKING:
    from geometry.mesh.data import MeshData

_EARTH = 9840.0
"""mm/s², at the poles, rounded up."""


class GravityEffect(Effect):
    """Weight of the body; every material needs a density."""

    name = "gravity"
    load = True
    needs_density = True

    direction: Literal["-y", "+y", "+x", "-x", "+z", "-z"]
    """Where the weight points; -y is from the crown to the floor, +z from the root to the tip."""
    acceleration: Acceleration = 9810.0
    """Standard gravity by default."""

    def needs(self) -> dict[str, str]:
        """A line in space."""
        return {LINE: "weight bends no uniform arc"}

    def mirror_breaker(self) -> str:
        """A pull along x."""
        return "gravity along x pulls to one side" if self.direction.endswith("x") else ""

    def bends(self) -> bool:
        """Weight across the floor."""
        return self.direction.endswith("y")

    def follows_section(self) -> bool:
        """It bends a body little beside the pressure."""
        return True

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: the model's own errors were measured with it."""
        yield from ()

    def weight(self) -> tuple[float, float, float]:
        """Along its direction."""
        sign = 1.0 if self.direction[0] == "+" else -1.0
        x, y, z = (self.acceleration * sign * (axis == self.direction[1]) for axis in "xyz")
        return x, y, z

    def alone(self) -> str:
        """No section has weight."""
        return "gravity acts"

    def steps(self) -> int:
        """It is put on in one."""
        return 1

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """Weight of every region, put on in one step."""
        from fem.effects.gravity import Gravity
        from fem.march.records import Ramp

        density = {
            region: material.mass_density
            for region, material in site.materials.items()
            if region in mesh.regions and material.mass_density is not None
        }
        return Built((Gravity(density, self.weight()),), (Ramp(Gravity.scalar, 1.0, first=1.0),))

    def of_measured(self) -> float:
        """Nothing of its own up to that of the Earth, with which rods were measured."""
        return 0.0 if self.acceleration <= _EARTH else math.inf

    def on_rod(self, site: RodSite) -> OnRod:
        """Weight of all sections and caps, put on in one step."""
        from rod.loads import Weight

        return OnRod((("gravity", Weight(site.inertia, self.weight())),), (RodRamp("gravity"),))

"""A mass that hangs at the tip."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from fiberbend.effects.effect import Built, Draft, Effect, Requests, Site
from fiberbend.effects.records import LINE, OnRod, RodSite
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Mass
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from geometry.mesh.data import MeshData


class TipMassEffect(Effect):
    """A mass at the centroid of the tip cap's outer face; gravity makes it heavy, time inert."""

    name = "tip-mass"
    load = True

    mass: Mass
    """Its weight acts along the direction of gravity and grows with it."""

    def needs(self) -> dict[str, str]:
        """A tip."""
        return {LINE: "only a whole body has a tip"}

    def mirror_breaker(self) -> str:
        """None of its own: gravity's direction is gravity's."""
        return ""

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Without gravity it does nothing, unless it moves."""
        if not draft.moves and all(effect.weight() is None for effect in draft.effects.values()):
            text = "weighs nothing without effect gravity, expected that beside it, or time"
            yield Problem(path, f"{path} {text}")

    def alone(self) -> str:
        """No section has a tip."""
        return "a mass hangs at the tip"

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None of its own."""
        yield from ()

    def steps(self) -> int:
        """It is put on with gravity."""
        return 0

    def at_tip(self, row: Mapping[str, Any]) -> dict[str, tuple[float, float, float] | None]:
        """It hangs there."""
        return {f"tip mass {show(self.mass, 'mass')}": None}

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """Its weight, scaled as gravity is."""
        from fem.effects.sums.tip_load import TipWeight

        assert site.weight is not None, "checked when the case was read"
        x, y, z = (self.mass * acceleration for acceleration in site.weight)
        return Built((TipWeight((x, y, z)),))

    def at_rods_tip(self, weight: tuple[float, float, float] | None) -> tuple[float, float]:
        """What it weighs."""
        return self.mass * math.hypot(*(weight or (0.0,))), 0.0

    def of_measured(self) -> float:
        """Of 20 g."""
        return self.mass / 20e-6

    def on_rod(self, site: RodSite) -> OnRod:
        """A point at the centroid of the tip's outer face; heavy as gravity is on, else inert."""
        import numpy as np

        from rod.inertia import lump
        from rod.loads import Weight

        inertia = np.zeros_like(site.inertia)
        inertia[-1] = lump(self.mass, site.tip)
        heavy = () if site.weight is None else (("gravity", Weight(inertia, site.weight)),)
        return OnRod(heavy, inertia=inertia)

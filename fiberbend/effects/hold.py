"""Stretch, bend and twist of a uniform bend held at given values."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from pydantic import Field

from fiberbend.columns import ANGLE, AXIS_STRETCH, SIDE_ANGLE, TWIST
from fiberbend.effects.effect import HELD, Built, Draft, Effect, Requests, Site
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import AngleOrZero

if TYPE_CHECKING:
    from geometry.mesh.data import MeshData


class HoldEffect(Effect):
    """Stretch, bend or twist of the centre-line held, any of them; what is not given is free."""

    name = "hold"
    load = True

    stretch: float | None = Field(default=None, ge=0.2, le=5.0)
    """Stretch of the centre-line; 1 keeps its length."""
    bend: AngleOrZero | None = None
    """Bending angle between z = 0 and z = L, toward -y; "0 deg" keeps it from bending."""
    side_bend: AngleOrZero | None = None
    """The same about the section's own y, toward x."""
    twist: AngleOrZero | None = None
    """Turn of the sections about the centre-line between z = 0 and z = L, from x to y."""

    def needs(self) -> dict[str, str]:
        """A uniform bend whose centre-line is known."""
        return {HELD: "only section and cell hold a uniform bend (body: tip-load, blocked-tip)"}

    def mirror_breaker(self) -> str:
        """A twist, a bend to the side."""
        return self.end_breaker() or self.turn_breaker()

    def end_breaker(self) -> str:
        """A twist."""
        return "a twist that is held turns it out of its mirror planes" if self.twist else ""

    def turn_breaker(self) -> str:
        """A bend to the side."""
        return "a side bend that is held takes it to one side" if self.side_bend else ""

    def bends(self) -> bool:
        """Where that is asked of it."""
        return bool(self.bend)

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Nothing held, held twice, or driven too."""
        values = (self.stretch, self.bend, self.side_bend, self.twist)
        if all(value is None for value in values):
            yield Problem(path, "nothing is held, expected stretch, bend, side_bend or twist")
        for other, effect in draft.effects.items():
            if effect is self:
                continue
            if effect.fixed_scalars():
                yield Problem(path, f"{other} holds it already, expected one of the two")
            load = effect.inflation()
            if load is not None and load.angle is not None and self.bend is not None:
                text = f"the angle is held (effects.{self.name}), expected a pressure or a volume"
                yield Problem(f"{other}.angle", text)
        if not self._moves() and all(e.inflation() is None for e in draft.effects.values()):
            yield Problem(path, "nothing moves, expected other values or effect pressure beside it")

    def fixes_angle(self) -> bool:
        """Where the bend is held."""
        return self.bend is not None

    def held(self) -> dict[str, str]:
        """Those that are given."""
        turns = {ANGLE: ("bend", self.bend), SIDE_ANGLE: ("side bend", self.side_bend)}
        turns[TWIST] = ("twist", self.twist)
        given = {AXIS_STRETCH: f"its stretch at {self.stretch:g}"} if self.stretch else {}
        return given | {
            key: f"its {name} at {math.degrees(value):.4g}°"
            for key, (name, value) in turns.items()
            if value is not None
        }

    def _moves(self) -> bool:
        """Whether it is held elsewhere than at rest."""
        return bool(self.bend or self.side_bend or self.twist or (self.stretch or 1.0) != 1.0)

    def alone(self) -> str:
        """No model beside it is held."""
        return "it is held"

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: nothing of it is meshed."""
        yield from ()

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """From rest to the values."""
        from fem.effects.sums.hold import BEND, HOLD, LENGTHENED, SIDE_BEND, TWISTED, Hold
        from fem.march.records import Ramp

        given = {
            LENGTHENED: self.stretch,
            BEND: self.bend,
            SIDE_BEND: self.side_bend,
            TWISTED: self.twist,
        }
        targets = {name: value for name, value in given.items() if value is not None}
        ramps = (Ramp(HOLD, 1.0, conjugated=False),) if self._moves() else ()
        return Built((Hold(targets),), ramps)


def hold(stretch: float, bend: float) -> HoldEffect:
    """Stretch and bending angle held, of the whole length, rad."""
    return HoldEffect.model_construct(stretch=stretch, bend=bend)

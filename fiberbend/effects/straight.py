"""The body kept straight: the blocked state of uniform bending."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, Literal

from fiberbend.effects.effect import ARC, Built, Draft, Effect, Requests, Site
from fiberbend.schema.problems import Problem

if TYPE_CHECKING:
    from geometry.mesh.data import MeshData


class StraightEffect(Effect):
    """The body kept straight, zero curvature: the blocked state of uniform bending."""

    name = "straight"

    stretch: Literal["free", "held"] = "free"
    """Whether the axis may stretch, or is fixed in length as well (held)."""

    def needs(self) -> dict[str, str]:
        """A uniform bend."""
        return {ARC: "only a uniform bend is kept straight all along (effect blocked-tip)"}

    def mirror_breaker(self) -> str:
        """None: straight is symmetric."""
        return ""

    def end_breaker(self) -> str:
        """None: straight is symmetric."""
        return ""

    def turn_breaker(self) -> str:
        """None: straight is symmetric."""
        return ""

    def bends(self) -> bool:
        """It keeps it from bending."""
        return False

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Once is enough."""
        for other, effect in draft.effects.items():
            if effect is not self and effect.keeps_straight():
                yield Problem(path, f"{other} keeps it straight already, expected one of them")

    def keeps_straight(self) -> bool:
        """That is all it does."""
        return True

    def fixed_scalars(self) -> tuple[str, ...]:
        """Both curvatures, and stretch where that is fixed."""
        bends = ("curvature", "side_curvature")
        return bends if self.stretch == "free" else (*bends, "stretch")

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: the model's own errors were measured with it."""
        yield from ()

    def alone(self) -> str:
        """The section beside a case that is kept straight is kept straight too."""
        return ""

    def steps(self) -> int:
        """It is no load."""
        return 0

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """No curvature, and no stretch where that is fixed."""
        from fem.effects.supports import StraightAxis

        return Built((StraightAxis(self.stretch == "held"),))


def straight_of(effects: Iterable[Effect]) -> Effect:
    """The effect that keeps a section straight beside a case: the case's own, if it has one."""
    own = (effect for effect in effects if isinstance(effect, StraightEffect))
    return next(own, StraightEffect())


def kept_straight(data: dict[str, Any], pressure: str) -> dict[str, Any]:
    """A case as plain values, kept straight up to a pressure.

    Args:
        data: the case as a mapping, with a pressure.
        pressure: with its unit.
    """
    from fiberbend.effects.pressure import PressureEffect

    name = PressureEffect.name
    effects = [{name: {"to": pressure}} if name in entry else entry for entry in data["effects"]]
    return data | {"effects": [*effects, {StraightEffect.name: {}}]}

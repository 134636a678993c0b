"""A force and a moment on the tip."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field

from fiberbend.effects.effect import Built, Draft, Effect, Requests, Site
from fiberbend.effects.records import LINE, OnRod, RodRamp, RodSite
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import SignedForce, SignedMoment

if TYPE_CHECKING:
    from fem.effects.effect import Effect as Term
    from geometry.mesh.data import MeshData
    from rod.term import Term as RodTerm

_NONE = (0.0, 0.0, 0.0)
_LOAD = "load_tip_load"
"""The column of its part that is on."""


class TipLoadEffect(Effect):
    """A force and a moment on the tip cap's outer face, whose centroid is their point."""

    name = "tip-load"
    load = True

    force: tuple[SignedForce, SignedForce, SignedForce] = Field(default=_NONE, strict=False)
    """Along x, y and z; spread evenly over the face, it acts at its centroid."""
    moment: tuple[SignedMoment, SignedMoment, SignedMoment] = Field(default=_NONE, strict=False)
    """About x, y and z; about x it bends toward -y where it is positive."""
    follows: bool = False
    """Force and moment turn with the face; else they keep their directions."""

    def needs(self) -> dict[str, str]:
        """A tip."""
        return {LINE: "only a whole body has a tip (section and cell: effect hold)"}

    def mirror_breaker(self) -> str:
        """What pulls out of the plane x = 0."""
        if self.force[0]:
            return "a tip load along x pulls to one side"
        if any(self.moment[1:]):
            return "a tip moment about y or z turns to one side"
        return ""

    def bends(self) -> bool:
        """Where it has a lever."""
        return True

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Something has to pull, and what follows has to have a direction that changes."""
        if not any((*self.force, *self.moment)):
            yield Problem(path, "nothing pulls, expected a force or a moment other than zero")
        elif self.follows and not any((*self.force, *self.moment[1:])):
            text = "a moment about x alone keeps its direction in the plane, expected no value"
            yield Problem(f"{path}.follows", text)

    def alone(self) -> str:
        """No section has a tip."""
        return "a tip load acts"

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """Its own are those of the mesh."""
        yield "tip load: the mesh moves deflections as it moves P (docs/evidence/free.md)"

    def _free(self, mirrored: bool) -> bool:
        """Whether it has no potential: it follows, or is a moment on a tip that turns in space."""
        return self.follows or (any(self.moment) and not mirrored)

    def doubts(self, site: Site, rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
        """Nobody looks whether a state under a load without a potential is stable."""
        if self._free(site.mirrored):
            kind = (
                "a load that follows" if self.follows else "a moment on a tip that turns in space"
            )
            yield (
                f"tip-load: {kind} has no potential: no unstable modes are counted, and a body "
                "that would buckle or flutter is passed unseen"
            )

    def at_tip(self, row: Mapping[str, Any]) -> dict[str, tuple[float, float, float] | None]:
        """As much of it as is on; one that follows has turned with the face."""
        if not any(self.force):
            return {"tip moment": None}
        part = float(row.get(_LOAD) or 0.0)
        x, y, z = (part * each for each in self.force)
        return {"tip load": None if self.follows else (x, y, z)}

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """It grows from zero to the whole; with a potential where it has one."""
        from fem.effects.sums.tip_load import FollowingTipLoad, TipForce, TipMoment
        from fem.march.records import Ramp

        free = self._free(site.mirrored)
        ramp = Ramp(TipForce.scalar, 1.0, conjugated=not free)
        if free:
            term = FollowingTipLoad(self.force, self.moment, self.follows)
            return Built((term,), (ramp,))
        terms: list[Term] = []
        if any(self.force):
            terms.append(TipForce(self.force))
        if self.moment[0]:
            terms.append(TipMoment(self.moment[0]))
        return Built(tuple(terms), (ramp,))

    def at_rods_tip(self, _weight: tuple[float, float, float] | None) -> tuple[float, float]:
        """Both."""
        return math.hypot(*self.force), math.hypot(*self.moment)

    def of_measured(self) -> float:
        """Of 0.2 N and 50 N mm that keep their directions."""
        if self.follows:
            return math.inf
        return math.hypot(*self.force) / 0.2 + math.hypot(*self.moment) / 50.0

    def on_rod(self, site: RodSite) -> OnRod:
        """Force and moment at the centroid of the tip's outer face."""
        from rod.loads import PlaneMoment, TipForce, TipMoment

        terms: list[RodTerm] = []
        if any(self.force):
            terms.append(TipForce(self.force, self.follows, site.tip))
        if any(self.moment[1:]) or (any(self.moment) and not site.layout.plane):
            terms.append(TipMoment(self.moment, self.follows))
        elif any(self.moment):
            terms.append(PlaneMoment(self.moment[0]))
        potential = all(term.conservative for term in terms)
        named = tuple(("tip-load", term) for term in terms)
        return OnRod(named, (RodRamp("tip-load", potential=potential),))


def turned(moment: float) -> TipLoadEffect:
    """A moment about x alone, N mm, that bends toward -y."""
    return TipLoadEffect.model_construct(force=_NONE, moment=(moment, 0.0, 0.0), follows=False)

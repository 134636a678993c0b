"""What section and cell share: uniform bending between the caps."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.case.zones import shared_pressures
from fiberbend.columns import UNIFORM, ZONES
from fiberbend.effects.effect import SPACE
from fiberbend.effects.records import LINE
from fiberbend.models.ends import AT_ENDS, left_out
from fiberbend.models.model import (
    MeshedModel,
    Objection,
    Observables,
    found_pressure,
)

if TYPE_CHECKING:
    from fem.scene import Scene


_HELD_HELIX = (
    "no curvature keeps the line y = 0 straight, about which a winding with a hand would turn the "
    "body: expected a winding that is its own mirror image, or no effect straight"
)


class UniformModel(MeshedModel):
    """Curvature and stretch are global unknowns, and by symmetry side curvature and twist."""

    fills = MeshedModel.fills | {UNIFORM, ZONES}
    gives_blocked_force = True
    agreement = 0.5
    straight_start = 1 / 20

    def limits(self, case: Case) -> Iterator[Objection]:
        """No uniform bend."""
        yield from super().limits(case)
        yield from not_uniform(case, Symmetry.of(case.acting).twists)

    def limits_of_zones(self, case: Case) -> Iterator[Objection]:
        """Zones that do not share one given pressure, and no more."""
        load = case.inflation
        for index, effect in enumerate(case.effects):
            path, own = f"effects.{index}.{effect.name}", effect.inflation()
            if own is not None and own.to is None:
                yield path, "zones share one pressure, which has to be given: expected to"
            elif own is None and effect.load:
                yield path, "zones share a pressure and no other load"
            if effect.keeps_straight():
                yield path, "each zone kept straight has a moment of its own (effect blocked-tip)"
        if load is None:
            yield "effects", "zones are chained at one pressure, expected one"

    def observables(self, case: Case, scene: Scene) -> Observables:
        """Angle, stretch and twist are scalars."""
        from fem.kinematics.uniform import CurvatureAngle, Uniform
        from fem.march.selfcontact import UniformRod
        from fiberbend.models.gauges import UniformGauge

        body, actuator = scene.body, convert.dimensions(case.actuator)
        assert isinstance(body, Uniform)
        return Observables(
            None,
            CurvatureAngle(body),
            lambda: UniformGauge(body, scene.natural, actuator),
            lambda: UniformRod(body, case.actuator.cap),
        )

    def scalars(self, case: Case) -> tuple[str, ...]:
        """Global unknowns: those of uniform bending that no effect fixes, and a pressure found."""
        fixed = {name for effect in case.effects for name in effect.fixed_scalars()}
        names = Symmetry.of(case.acting).scalars()
        return (*(name for name in names if name not in fixed), *found_pressure(case))

    def force_named(self) -> str:
        """The moment over the cap."""
        return f"{self.name} kept straight, no caps"

    def force_remark(self) -> str:
        """A real tip turns, and passes half of the moment on."""
        return (
            f"the force of a {self.name} kept straight is about twice that of a body whose tip "
            "presses on a post: 94 beside 49 N mm on the baseline (docs/evidence/causes.md)"
        )

    @abstractmethod
    def mesh_error(self, case: Case) -> float:
        """Percent of the pressure for an angle up to 360° by which the mesh is off."""

    def errors(self, case: Case) -> Iterator[str]:
        """Mesh and ends."""
        if case.inflation is None:
            return
        if case.straight:
            yield f"mesh: moves the moment by up to {self.mesh_error(case)} %"
            yield (
                "tip: a real one turns, its sheath yields: about half the force "
                "(docs/evidence/causes.md)"
            )
            return
        yield f"mesh: moves P by up to {self.mesh_error(case)} % (docs/evidence/uniform.md)"
        yield left_out(case)

    def steps_of_zones(self, case: Case) -> int:
        """Pressures at which all zones are chained, and angles."""
        return len(shared_pressures(case)) + len(case.output.at_angles)

    def errors_of_zones(self) -> Iterator[str]:
        """As measured beside bodies."""
        yield (
            f"{AT_ENDS}caps and borders of zones are left out: zones five to ten times as long as "
            "the tube is wide bend up to 3 % and twist 3 % further than in a body, zones three "
            "times as long 13 % (docs/models.md)"
        )


def not_uniform(case: Case, twists: bool) -> Iterator[Objection]:
    """Why a case does not bend uniformly, beside its effects.

    Args:
        case: the case.
        twists: something may twist the body.
    """
    uniform = (e.load and not {SPACE, LINE} & set(e.needs()) for e in case.effects)
    if not any(uniform):
        yield "effects", "nothing bends it uniformly but a pressure or effect hold"
    elif case.straight and case.inflation is not None and case.inflation.angle is not None:
        yield "effects", "kept straight, it reaches no angle: expected a pressure by its value"
    if twists:
        for index, effect in enumerate(case.effects):
            if effect.keeps_straight():
                yield f"effects.{index}.{effect.name}", _HELD_HELIX
    if case.mesh.element == "tetrahedron":
        yield "mesh.element", "tetrahedra are for a body"

"""What section and cell share: uniform bending between the caps."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.columns import UNIFORM
from fiberbend.models.model import (
    ENDS_BEND,
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


_SKEW = (
    "no half turn about a line through top and bottom maps its threads onto themselves, so that it "
    "bends sideways: expected other phases, or as: smeared, or model body"
)


class UniformModel(MeshedModel):
    """Curvature and stretch, and twist where the winding has a hand, are global unknowns."""

    fills = MeshedModel.fills | {UNIFORM}
    gives_blocked_force = True
    agreement = 0.5
    straight_start = 1 / 20

    def limits(self, case: Case) -> Iterator[Objection]:
        """No uniform bend."""
        yield from super().limits(case)
        yield from not_uniform(case)
        turns = case.turns
        if turns is None or turns.origin is not None:
            return
        for index, effect in enumerate(case.effects):
            if effect.winds():
                sideways = effect.not_beside() or _SKEW
                yield f"effects.{index}.{effect.name}", sideways

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
        names = ["curvature", "stretch", *(["twist"] if twists(case) else [])]
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
        yield f"ends: left out; {ENDS_BEND}"


def not_uniform(case: Case) -> Iterator[Objection]:
    """Why a case does not bend uniformly, beside its effects."""
    if case.inflation is None:
        yield "effects", "nothing bends it uniformly but a pressure"
    elif case.straight and case.inflation.angle is not None:
        yield "effects", "kept straight, it reaches no angle: expected a pressure by its value"
    if twists(case):
        for index, effect in enumerate(case.effects):
            if effect.keeps_straight():
                yield f"effects.{index}.{effect.name}", _HELD_HELIX
    if case.mesh.element == "tetrahedron":
        yield "mesh.element", "tetrahedra are for a body"


def twists(case: Case) -> bool:
    """Whether a winding may twist the body."""
    turns = case.turns
    return turns is not None and turns.twists

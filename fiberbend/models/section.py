"""`model: section`: uniform bending of the cross-section, its winding spread over its surface."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry, twists
from fiberbend.case.zones import zone_cases
from fiberbend.effects.effect import (
    ARC,
    CHAMBER,
    HELD,
    SIDE,
    THREAD,
    TWIST,
    VOLUME,
    WOUND,
    ZONES,
)
from fiberbend.effects.records import OUTLINE
from fiberbend.models.costs.size import summed
from fiberbend.models.mesh_error import section_error
from fiberbend.models.model import ProblemSize, Rung, completed_mesh, count
from fiberbend.models.uniform import UniformModel

if TYPE_CHECKING:
    from fem.effects.effect import Effect as Term
    from fiberbend.models.model import KinematicsFactory
    from geometry.mesh.data import MeshData
    from geometry.sections.size import MeshSize

_FLAT = 1e-9
"""Its elements have no length along the axis."""
_PICTURE_LAYER = 0.4
"""Length of the elements of a picture over the section's half width."""
_PICTURE_LAYERS = 400
"""The most that a picture has: beyond, no eye sees more."""


class Section(UniformModel):
    """Nothing depends on z in the frame that turns with the section."""

    name = "section"
    offers = frozenset({CHAMBER, WOUND, ARC, HELD, VOLUME, TWIST, SIDE, THREAD, OUTLINE, ZONES})
    turn = math.radians(10)
    first_turn = math.radians(10)
    memory = 5
    priced = "section"
    compile_s = 9.0
    pictures_s = (3.0, 0.4)
    fields_s = 0.3

    def completed(self, case: Case) -> Case:
        """A finer mesh: it is cheap."""
        return case.model_copy(update={"mesh": completed_mesh(case.mesh, section=2)})

    def half(self, case: Case) -> tuple[bool, str]:
        """Where it has both mirror planes, or half a turn about y maps the section onto itself."""
        symmetry = Symmetry.of(case.acting)
        return symmetry.halved, symmetry.words()

    def unused(self, case: Case) -> dict[str, set[str]]:
        """What concerns the axis and the other half."""
        return {"mesh": case.mesh.model_fields_set & {"axial", "symmetry"}}

    def mesh_size(self, case: Case, half: bool) -> MeshSize:
        """As the case gives it across the section."""
        return dataclasses.replace(convert.mesh_size(case.mesh, half), axial=_FLAT)

    def mesh(self, case: Case, msh: Path | None = None) -> MeshData:
        """Quadrilaterals from the block layout."""
        from geometry.bodies.extrude import section_quadrilaterals

        size = self.mesh_size(case, self.half(case)[0])
        return section_quadrilaterals(convert.dimensions(case.actuator), size)

    def kinematics(self, case: Case) -> KinematicsFactory:
        """Two components of the displacement, three where it may twist."""
        from fem.kinematics.section import Section as Bending

        symmetry = Symmetry.of(case.acting)
        return functools.partial(
            Bending,
            length=case.actuator.length,
            twisted=symmetry.twists,
            sideways=symmetry.sideways,
        )

    def supports(self, case: Case, mesh: MeshData) -> list[Term]:
        """A mirror plane, or the axis of half a turn; a whole section has neither."""
        from fem.effects.supports import Symmetry as Mirror
        from fem.effects.supports import TwofoldAxis

        if not mesh.half:
            return []
        return [TwofoldAxis() if twists(case) else Mirror(halves=True)]

    def size(self, case: Case) -> ProblemSize:
        """Of its mesh, or of those of all zones."""
        if case.zones is not None:
            return summed(self.size(zone) for zone in zone_cases(case, self.name))
        from geometry.bodies.counts import section_counts

        size = self.mesh_size(case, self.half(case)[0])
        counts = section_counts(convert.dimensions(case.actuator), size)
        components = 3 if twists(case) else 2
        unknowns = count(counts, components, 3)
        scalars = self.scalars(case)
        # the thread of a section has a piece for each point of the outline: next to none
        return ProblemSize(counts.cells, "quadrilaterals", unknowns, scalars, 1.0, 0.0)

    def ladder(self, case: Case) -> Iterator[dict[str, Any]]:
        """Finer across: nothing else is meshed."""
        yield from ({"section": number} for number in (1, 2, 3, 4))

    def rung(self, case: Case) -> Rung:
        """Across only."""
        return Rung(case.mesh.section)

    def drawn(self, case: Case, size: ProblemSize) -> float:
        """The section along the whole length."""
        if case.zones is not None:
            zones = zone_cases(case, self.name)
            return sum(self.drawn(zone, self.size(zone)) for zone in zones)
        return float(size.elements * picture_layers(case))

    def mesh_error(self, case: Case) -> float:
        """By refinement."""
        return section_error(case)


def picture_layers(case: Case) -> int:
    """Layers of elements in which a picture in space has the length between the caps."""
    width = convert.dimensions(case.actuator).outline_half_width
    return min(math.ceil(case.actuator.length / (_PICTURE_LAYER * width)), _PICTURE_LAYERS)


MODEL = Section()

"""`model: cell`: uniform bending of a slice that repeats, with every turn of the winding in it."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.case.zones import zone_cases
from fiberbend.effects.effect import (
    ARC,
    CHAMBER,
    HELD,
    SIDE,
    THREAD,
    TURNS,
    TWIST,
    VOLUME,
    WOUND,
    ZONES,
)
from fiberbend.models.costs.size import pieces, summed
from fiberbend.models.mesh_error import cell_section_error, section_error
from fiberbend.models.model import Objection, ProblemSize, Rung, completed_mesh, count
from fiberbend.models.uniform import UniformModel
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from fem.effects.effect import Effect as Term
    from fiberbend.models.model import KinematicsFactory
    from geometry.mesh.data import MeshData
    from geometry.sections.size import MeshSize

_ERRORS = ((8, 0.3), (4, 0.5), (0, 1.9))
"""Layers a half pitch, and percent of the pressure for an angle from 5 to 360°
(docs/evidence/uniform.md)."""


class Cell(UniformModel):
    """Half a pitch between mirror planes, or a whole pitch with tied ends."""

    name = "cell"
    offers = frozenset({CHAMBER, WOUND, ARC, HELD, VOLUME, TWIST, SIDE, THREAD, TURNS, ZONES})
    layers_a_pitch = 8.0
    turn = math.radians(45)
    first_turn = math.radians(10)
    memory = 4
    priced = "cell"
    compile_s = 20.0
    pictures_s = (5.0, 1.0)
    fields_s = 0.5

    def completed(self, case: Case) -> Case:
        """Four layers in half a pitch: layers count most."""
        found = (zone.turns for zone in zone_cases(case))
        spacings = [turns.spacing for turns in found if turns is not None]
        finite = [spacing for spacing in spacings if not math.isinf(spacing)]
        if not finite:
            return case
        axial = min(finite) / self.layers_a_pitch
        return case.model_copy(update={"mesh": completed_mesh(case.mesh, axial=axial)})

    def limits(self, case: Case) -> Iterator[Objection]:
        """No uniform bend, half a slice without mirror planes, and one that has no room."""
        yield from super().limits(case)
        symmetry = Symmetry.of(case.acting)
        if case.mesh.symmetry == "half" and symmetry.along:
            yield "mesh.symmetry", f"its ends are no mirror planes: {'; '.join(symmetry.along)}"
        turns, length = case.turns, case.actuator.length
        if turns is None or not turns.discrete:
            return
        extent = self.slice(case, self.half(case)[0])[0]
        for index, effect in enumerate(case.effects):
            if not effect.winds():
                continue
            if turns.misfit:
                yield f"effects.{index}.{effect.name}", turns.misfit
            elif extent > length * (1 + 1e-9):
                yield (
                    f"effects.{index}.{effect.name}",
                    f"the slice that repeats is {show(extent, 'length')} long, longer than the "
                    f"chamber, {show(length, 'length')} (as: smeared, or model body)",
                )

    def half(self, case: Case) -> tuple[bool, str]:
        """Half a section between mirror planes, where it has both; else a whole period."""
        if case.mesh.symmetry != "auto":
            return super().half(case)
        symmetry = Symmetry.of(case.acting)
        return symmetry.plane, symmetry.words()

    def origin(self, case: Case) -> float:
        """Where half a turn about a line along y maps the threads onto themselves."""
        turns = case.turns
        return 0.0 if turns is None or not turns.discrete else turns.origin or 0.0

    def slice(self, case: Case, half: bool) -> tuple[float, int]:
        """Length in mm of the slice that repeats, and its number of layers.

        Half a period between mirror planes, a whole one without; of a pattern a period is its
        pitch, of n equal starts a pitch over n. Without turns any length does.
        """
        from geometry.sections.size import divisions

        turns = case.turns
        period = None if turns is None else turns.period if turns.discrete else turns.spacing
        if period is None or math.isinf(period):
            period = 2 * case.mesh.axial
        extent = period / 2 if half else period
        return extent, divisions(extent, case.mesh.axial)

    def mesh_size(self, case: Case, half: bool) -> MeshSize:
        """Elements along the axis are never longer than the slice."""
        extent, layers = self.slice(case, half)
        return dataclasses.replace(convert.mesh_size(case.mesh, half), axial=extent / layers)

    def mesh(self, case: Case, msh: Path | None = None) -> MeshData:
        """Hexahedra from the block layout."""
        from geometry.bodies.extrude import hexahedral_slice

        half, _ = self.half(case)
        actuator, size = convert.dimensions(case.actuator), self.mesh_size(case, half)
        return hexahedral_slice(actuator, size, *self.slice(case, half))

    def kinematics(self, case: Case) -> KinematicsFactory:
        """Three components of the displacement."""
        from fem.kinematics.cell import Cell as Bending

        symmetry = Symmetry.of(case.acting)
        return functools.partial(
            Bending,
            length=case.actuator.length,
            twisted=symmetry.twists,
            sideways=symmetry.sideways,
        )

    def supports(self, case: Case, mesh: MeshData) -> list[Term]:
        """Three mirror planes; a whole pitch has none."""
        from fem.effects.supports import Symmetry as Mirror

        if not mesh.half:
            return []
        return [Mirror(halves=True), Mirror("section_root", 2), Mirror("section_tip", 2)]

    def resolved_bulging(self, case: Case) -> float:
        """All of it, where every turn lies by itself."""
        turns = case.turns
        return 1.0 if turns is not None and turns.discrete else super().resolved_bulging(case)

    def size(self, case: Case) -> ProblemSize:
        """Of its mesh, or of those of all zones."""
        if case.zones is not None:
            return summed(self.size(zone) for zone in zone_cases(case, self.name))
        from geometry.bodies.counts import slice_counts, winding_sides

        half, _ = self.half(case)
        length, layers = self.slice(case, half)
        size = self.mesh_size(case, half)
        actuator = convert.dimensions(case.actuator)
        counts = slice_counts(actuator, size, length, layers)
        segments = pieces(case, half, winding_sides(actuator, size), length, layers)
        scalars = self.scalars(case)
        return ProblemSize(
            counts.cells, "hexahedra", count(counts, 3, 4), scalars, layers, segments
        )

    def ladder(self, case: Case) -> Iterator[dict[str, Any]]:
        """Layers in half a turn first: they count most."""
        turns = case.turns
        if turns is None or not turns.discrete:
            yield from ({"section": number} for number in (1, 2, 3, 4))
            return
        for number, layers in itertools.product((1, 2), (1, 2, 4, 8)):
            yield {"section": number, "axial": turns.spacing / 2 / layers}

    def rung(self, case: Case) -> Rung:
        """Along it nothing counts where no turn lies by itself."""
        turns = case.turns
        if turns is None or not turns.discrete:
            return Rung(case.mesh.section)
        extent, layers = self.slice(case, self.half(case)[0])
        return Rung(case.mesh.section, layers * turns.spacing / 2 / extent)

    def drawn(self, case: Case, size: ProblemSize) -> float:
        """All slices of the length."""
        if case.zones is not None:
            zones = zone_cases(case, self.name)
            return sum(self.drawn(zone, self.size(zone)) for zone in zones)
        extent = self.slice(case, self.half(case)[0])[0]
        return size.elements * max(1.0, case.actuator.length / extent)

    def mesh_error(self, case: Case) -> float:
        """By layers a half pitch, and by the section."""
        across, turns = cell_section_error(case), case.turns
        if turns is None or not turns.discrete:
            # alike along the axis: no layers count
            return section_error(case)
        extent, number = self.slice(case, self.half(case)[0])
        layers = number * (turns.spacing / 2 / extent)
        return max(across, next(error for least, error in _ERRORS if layers >= least))


MODEL = Cell()

"""`model: body`: the whole actuator in three dimensions, caps included."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.section_beside import section_guides
from fiberbend.case.zones import borders, differing, effects_of, own_regions, zone_cases
from fiberbend.columns import BODY, MIDDLE
from fiberbend.columns import ZONES as ZONE_COLUMNS
from fiberbend.effects.effect import (
    CHAMBER,
    ENDS,
    SIDE,
    SPACE,
    STRIPS,
    THREAD,
    TURNS,
    TWIST,
    VOLUME,
    WOUND,
    ZONES,
    Effect,
)
from fiberbend.effects.records import LINE, tip_strips
from fiberbend.models.costs.size import pieces
from fiberbend.models.ends import AT_ENDS, at_ends
from fiberbend.models.mesh_error import section_error
from fiberbend.models.model import (
    MeshedModel,
    Objection,
    Observables,
    ProblemSize,
    Rung,
    count,
    found_pressure,
)

if TYPE_CHECKING:
    from fem.effects.effect import Effect as Term
    from fem.scene import Scene
    from fiberbend.models.model import KinematicsFactory
    from geometry.mesh.data import MeshData
    from geometry.sections.size import MeshSize

_TOUCHING_ITERATIONS = 6.0
"""Newton iterations in a step with roof and post, under which the sheath yields, and along
obstacles: between 4 with a spread winding (docs/accuracy.md) and 9 with turns
(docs/evidence/times.md)."""
_RESOLVED = ((0.5, 1.0), (2 / 3, 0.85), (4 / 3, 0.2))
"""Length of the elements over the pitch, and the part of the bulging between turns they give."""
_END = 1 + 1e-9
"""The last of them counts, whatever a quotient rounds to."""


class Body(MeshedModel):
    """Everything that can act on an actuator acts on it here."""

    name = "body"
    offers = frozenset(
        {CHAMBER, WOUND, SPACE, LINE, ENDS, STRIPS, VOLUME, TWIST, SIDE, THREAD, TURNS, ZONES}
    )
    fills = MeshedModel.fills | {MIDDLE, BODY, ZONE_COLUMNS}
    shared = True
    resumes = True
    takes_mesh_as_given = True
    ends = True
    layers_a_pitch = 2.0
    agreement = 2.0
    turn = math.radians(60)
    first_turn = math.radians(20)
    guided_turn = math.radians(90)
    guided_first = math.radians(20)
    guided_growth = 3.0
    memory = 3
    straight_start = 1.0
    priced = "body"
    compile_s = 20.0
    pictures_s = (5.0, 2.0)
    fields_s = 1.0

    def mesh_size(self, case: Case, half: bool) -> MeshSize:
        """As the case gives it; no element crosses from a zone to the next."""
        return dataclasses.replace(convert.mesh_size(case.mesh, half), borders=borders(case))

    def mesh(self, case: Case, msh: Path | None = None) -> MeshData:
        """Meshed by gmsh, with the fibers' curves."""
        from geometry.bodies.gmsh_body import build_body
        from geometry.bodies.zones import with_regions

        actuator = convert.dimensions(case.actuator)
        size = self.mesh_size(case, self.half(case)[0])
        curves = convert.curves(case) or None
        mesh = build_body(actuator, size, tip_strips(case.effects), curves, msh)
        return with_regions(mesh, size.borders, own_regions(case)) if case.zones else mesh

    def kinematics(self, case: Case) -> KinematicsFactory:
        """x = X + u."""
        from fem.kinematics.body import Body as InSpace

        return InSpace

    def supports(self, case: Case, mesh: MeshData) -> list[Term]:
        """The support that the case names, and the mirror plane of half a body."""
        from fem.effects.supports import Clamp, Symmetry

        named = {"clamped-root": Clamp}
        return [named[case.support](), *([Symmetry(halves=True)] if mesh.half else [])]

    def observables(self, case: Case, scene: Scene) -> Observables:
        """Angles by the line of the centroids."""
        from fem.march.frames import Frames
        from fem.march.selfcontact import BodyRod
        from fem.results.centre_line import BendingAngle, CentreLine
        from fiberbend.models.gauges import BodyGauge

        against = case.zones is not None
        frames, line = Frames(scene.body, against), CentreLine(scene.body)
        return Observables(
            frames,
            BendingAngle(line),
            lambda: BodyGauge(scene, line, borders(case)),
            lambda: BodyRod(scene.body, frames),
        )

    def limits_of_zones(self, case: Case) -> Iterator[Objection]:
        """Effects of zones that one mesh cannot have side by side."""
        first: dict[str, Effect] = {}
        for number in range(len(case.zones or ())):
            for path, effect in effects_of(case, number).items():
                if effect.name in differing(case):
                    other = first.setdefault(effect.name, effect)
                    if other is not effect and (reason := effect.unlike(other)):
                        yield path, reason

    def force_named(self) -> str:
        """Of its tip on what blocks it."""
        return "body, its tip blocked"

    def resolved_bulging(self, case: Case) -> float:
        """By the length of its elements."""
        import numpy as np

        turns = case.turns
        if turns is None or not turns.discrete:
            return super().resolved_bulging(case)
        sizes, parts = zip(*_RESOLVED, strict=True)
        ratio = case.mesh.axial / turns.spacing
        return 0.0 if ratio > _END * sizes[-1] else float(np.interp(ratio, sizes, parts))

    def size(self, case: Case) -> ProblemSize:
        """From the block layout: as many hexahedra as gmsh makes, about as many tetrahedra."""
        from geometry.bodies.counts import body_counts, winding_sides

        actuator = convert.dimensions(case.actuator)
        half, _ = self.half(case)
        size = self.mesh_size(case, half)
        counts = body_counts(actuator, size, tip_strips(case.effects))
        kind, pressures, edge, exact = "hexahedra", 4, size.axial, True
        if case.mesh.element == "tetrahedron":
            kind, pressures, edge, exact = "tetrahedra", 0, size.of_edges().axial, False
        layers = actuator.total_length / edge
        unknowns = count(counts, 3, pressures)
        around, length = winding_sides(actuator, size), actuator.length
        segments = pieces(case, half, around, length, length / size.axial)
        if differing(case):
            segments = sum(
                pieces(zone, half, around, zone.actuator.length, zone.actuator.length / size.axial)
                for zone in zone_cases(case, self.name)
            )
        scalars = found_pressure(case)
        return ProblemSize(counts.cells, kind, unknowns, scalars, layers, segments, exact)

    def step_seconds(self, case: Case, size: ProblemSize) -> float:
        """More iterations where it touches."""
        touching = any(e.touches() or e.strips() is not None for e in case.effects)
        iterations = _TOUCHING_ITERATIONS if touching else None
        counts = size.elements, size.unknowns, size.layers
        return self.price(size).step_seconds(*counts, iterations)

    def ladder(self, case: Case) -> Iterator[dict[str, Any]]:
        """Long elements under a winding that is spread, parts of half a turn under turns."""
        turns = case.turns
        if turns is not None and turns.discrete:
            lengths = [turns.spacing / 2 / layers for layers in (1, 2, 4)]
        else:
            width = convert.dimensions(case.actuator).profile.half_width
            lengths = [width, width / 2]
        for number, axial in itertools.product((1, 2), lengths):
            yield {"section": number, "axial": axial}

    def largest_turn(self, case: Case) -> float:
        """Longer steps where the section guides."""
        usual = self.guided_turn if section_guides(case) else self.turn
        return self.bounded_turn(case, case.solver.max_turn or usual)

    def rung(self, case: Case) -> Rung | None:
        """Nothing is known of tetrahedra."""
        if case.mesh.element == "tetrahedron":
            return None
        turns, axial = case.turns, case.mesh.axial
        layers = turns.spacing / 2 / axial if turns is not None and turns.discrete else 0.0
        return Rung(case.mesh.section, layers, axial)

    def errors(self, case: Case) -> Iterator[str]:
        """Mesh, effects, ends."""
        if case.inflation is None:
            return
        if case.straight:
            yield "mesh: moves the tip force by 1 to 3 % (docs/evidence/blocked.md)"
        else:
            yield (
                "mesh: shorter elements move P by 0.1 to 0.3 % (docs/evidence/free.md), a finer "
                f"section by up to {section_error(case)} % (docs/evidence/uniform.md)"
            )
        for effect in case.effects:
            yield from effect.uncertainties(case.straight)
        if not case.straight and not any(effect.alone() for effect in case.effects):
            yield f"{AT_ENDS}{at_ends(case)}: see the columns uniform_…"

    def errors_of_zones(self) -> Iterator[str]:
        """It has the borders."""
        yield f"{AT_ENDS}caps and borders of zones are those of the mesh, as long as its elements"


MODEL = Body()

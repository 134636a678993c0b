"""Parts of a case as the objects that geometry and materials take.

Both bring numpy: imported where they are used, so that a case that is wrong fails without it.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from fiberbend.case import case, zones
from fiberbend.effects.effect import Requests, Site
from fiberbend.effects.records import mirror_breakers

if TYPE_CHECKING:
    from fiberbend.states.obstacles import Shape
    from fiberbend.states.snapshot import FamilyLook
    from geometry.mesh.data import Floats
    from geometry.sections.shape import ShapedActuator
    from geometry.sections.size import MeshSize
    from materials.material import Material

_KG_PER_M3 = 1e12
"""kg/m³ in one t/mm³."""


def dimensions(actuator: case.ActuatorSpec) -> ShapedActuator:
    """The dimensions as the geometry takes them."""
    from geometry.sections.table import make_actuator

    return make_actuator(dict(actuator))


def mesh_size(mesh: case.Mesh, half: bool) -> MeshSize:
    """The fineness as the geometry takes it."""
    from geometry.sections.size import MeshSize

    return MeshSize(axial=mesh.axial, section=mesh.section, element=mesh.element, half=half)


def material(spec: case.MaterialSpec) -> Material:
    """The material that a case names or describes.

    Raises:
        ValueError: an unknown name, or coefficients that the law does not allow.
    """
    from materials.material import Material
    from materials.named.table import named_material

    if spec.name is not None:
        base = named_material(spec.name)
    elif spec.young is not None:
        shear, bulk = spec.moduli
        base = Material("neo-hooke", {"mu": shear}, bulk=bulk)
    else:
        base = Material(spec.law or "", spec.coefficients)
    density = base.density if spec.density is None else spec.density * _KG_PER_M3
    bulk = base.bulk if spec.bulk is None else spec.bulk
    tested = base.tested if spec.tested is None else spec.tested
    source = base.source or spec.source or "the case"
    return dataclasses.replace(base, density=density, bulk=bulk, tested=tested, source=source)


def site(given: case.Case) -> Site:
    """The actuator of a case as its effects see it, with the regions of its zones."""
    specs = {part: spec for part, spec in dict(given.materials).items() if spec is not None}
    for zone, names in zip(given.zones or (), zones.own_regions(given), strict=True):
        specs |= {names[part]: spec for part, spec in zone.materials.items()}
    return Site(
        actuator=dimensions(given.actuator),
        materials={part: material(spec) for part, spec in specs.items()},
        straight=given.straight,
        mirrored=not any(mirror_breakers(given.acting)),
        weight=next((w for e in given.effects if (w := e.weight()) is not None), None),
    )


def curves(given: case.Case) -> list[Floats]:
    """Polylines of all threads of a case in space, (n, 3), mm, in every zone its own."""
    if not zones.differing(given):
        actuator = dimensions(given.actuator)
        return [curve for effect in given.effects for curve in effect.curves(actuator)]
    import numpy as np

    found = []
    for start, zone in zip(zones.bounds(given), zones.zone_cases(given), strict=False):
        found += [curve + np.array([0.0, 0.0, start]) for curve in curves(zone)]
    return found


def obstacle_shapes(given: case.Case) -> dict[str, Shape]:
    """Rigid obstacles of a case by their names, as pictures show them; no name is there twice."""
    actuator = dimensions(given.actuator)
    found: dict[str, Shape] = {}
    for effect in given.effects:
        found |= effect.obstacle_shapes(actuator)
    return found


def looks(given: case.Case) -> tuple[FamilyLook, ...]:
    """Families of threads of a case's winding, as pictures tell them apart."""
    actuator = dimensions(given.actuator)
    return tuple(look for effect in given.effects for look in effect.looks(actuator))


def requests(given: case.Case) -> Requests:
    """What a case asks of its loads."""
    output, solver = given.output, given.solver
    return Requests(
        first=solver.first_step,
        largest=solver.max_step,
        at_pressures=tuple(output.at_pressures),
        at_angles=tuple(output.at_angles),
        stop_at_angle=output.stop_at_angle,
    )

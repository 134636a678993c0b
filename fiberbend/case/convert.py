"""Parts of a case as the objects that geometry and materials take.

Both bring numpy: imported where they are used, so that a case that is wrong fails without it.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from fiberbend.case import case
from fiberbend.effects import table

if TYPE_CHECKING:
    from geometry.actuator import Actuator
    from geometry.sections.size import MeshSize, Strips
    from materials.fiber import Fiber
    from materials.material import Material

_KG_PER_M3 = 1e12
"""kg/m³ in one t/mm³."""


def dimensions(actuator: case.Actuator) -> Actuator:
    """The dimensions as the geometry takes them."""
    from geometry.actuator import Actuator

    return Actuator(**dict(actuator))


def mesh_size(mesh: case.Mesh, half: bool) -> MeshSize:
    """The fineness as the geometry takes it."""
    from geometry.sections.size import MeshSize

    return MeshSize(axial=mesh.axial, section=mesh.section, element=mesh.element, half=half)


def strips(tip: table.BlockedTipEffect | table.ContactEffect | None) -> Strips | None:
    """The strips of roof and post as the geometry takes them; None where neither exists."""
    from geometry.sections.size import Strips

    if isinstance(tip, table.ContactEffect):
        if tip.roof is None and tip.post is None:
            return None
        roof, post = tip.roof or table.Roof(), tip.post or table.Post()
        return Strips(roof_half_width=roof.width / 2, post_length=post.length)
    if tip is None:
        return None
    return Strips(roof_half_width=tip.roof_width / 2, post_length=tip.post_length)


def tip_support(
    given: case.Case,
) -> table.BlockedTipEffect | table.ContactEffect | None:
    """The effect of a case that may have a roof and a post."""
    return given.find(table.BlockedTipEffect) or given.find(table.ContactEffect)


def material(spec: case.Material) -> Material:
    """The material that a case names or describes.

    Raises:
        ValueError: an unknown name, or coefficients that the law does not allow.
    """
    from materials.material import Material
    from materials.named import named_material

    if spec.name is not None:
        base = named_material(spec.name)
    else:
        base = Material(spec.law or "", spec.coefficients, source="the case")
    density = base.density if spec.density is None else spec.density * _KG_PER_M3
    bulk = base.bulk if spec.bulk is None else spec.bulk
    return dataclasses.replace(base, density=density, bulk=bulk)


def fiber(spec: table.Fiber) -> Fiber:
    """The fiber that a case names or describes; a described one carries with all of its radius.

    Raises:
        ValueError: an unknown name, or one without modulus and diameter.
    """
    from materials.fiber import FIBERS, Fiber

    if spec.name is not None:
        if spec.name not in FIBERS:
            raise ValueError(f"fiber {spec.name!r} is unknown: expected one of {', '.join(FIBERS)}")
        return FIBERS[spec.name]
    if spec.modulus is None or spec.diameter is None:
        raise ValueError("a fiber without a name needs modulus and diameter")
    factor = 1.0 if spec.radius_factor is None else spec.radius_factor
    return Fiber(spec.modulus, spec.diameter, factor, source="the case")

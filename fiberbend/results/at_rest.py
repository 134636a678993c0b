"""An actuator at rest in space, from its case alone: nothing is solved and no model is asked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.zones import borders, own_regions, zone_cases
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.states.snapshot import ModelMesh

if TYPE_CHECKING:
    from geometry.mesh.data import Floats

_LAYER = 0.7
"""Length of an element over the section's half width: it only has to be drawn."""
_ROUND = 2
"""Elements through a thickness, with which arcs look round."""


def body_at_rest(case: Case, half: bool = True) -> ModelMesh:
    """The whole body with its caps, or half of it; a winding in turns is left to `threads`.

    Args:
        case: the case.
        half: x ≥ 0 stands for all.

    Raises:
        CaseError: dimensions of which no mesh can be made.
    """
    from geometry.bodies.extrude import hexahedral_body
    from geometry.bodies.zones import with_regions
    from geometry.sections.size import MeshSize

    actuator, site = convert.dimensions(case.actuator), convert.site(case)
    between = borders(case)
    axial = _LAYER * actuator.outer_half_width
    size = MeshSize(axial=axial, section=_ROUND, half=half, borders=between)
    try:
        mesh = with_regions(hexahedral_body(actuator, size), between, own_regions(case))
    except ValueError as error:
        raise CaseError([Problem("actuator", str(error))]) from None
    found = [zone.turns for zone in zone_cases(case)]
    return ModelMesh(
        mesh=mesh,
        materials={name: site.materials[name] for name in mesh.regions},
        fibers=None,
        smeared=any(turns is not None and not turns.discrete for turns in found),
        title=case.title,
    )


def threads(case: Case) -> list[Floats]:
    """The thread of a winding in turns as polylines in space, (n, 3), mm; none where it is spread.

    A thread as wide as a ribbon has several lines beside each other.

    Args:
        case: the case.
    """
    alone = [zone for zone in zone_cases(case) if zone.turns is not None]
    if not any(zone.turns is not None and zone.turns.discrete for zone in alone):
        return []
    return convert.curves(case)

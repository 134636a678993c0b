"""How large a run's problem is, from the block layout: neither gmsh nor a solver starts."""

from __future__ import annotations

import dataclasses

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects.table import PressureEffect, StraightEffect
from fiberbend.models.choice import UNIFORM, mirror_breakers
from fiberbend.models.mesh_size import cell_slice, mesh_size


@dataclasses.dataclass(frozen=True)
class Size:
    """How large a problem is.

    Attributes:
        elements: number of elements.
        kind: what they are.
        unknowns: displacements and pressures, before any are held.
        scalars: global unknowns beside them.
        layers: elements along the axis.
    """

    elements: int
    kind: str
    unknowns: int
    scalars: tuple[str, ...]
    layers: float


def size_of(case: Case, model: str, half: bool) -> Size:
    """Size of a finite-element model.

    Quadratic displacement everywhere; linear pressure, discontinuous on quadrilaterals and
    hexahedra, at the vertices of tetrahedra.

    Args:
        case: the case.
        model: "section", "cell" or "body".
        half: half the section stands for the whole.
    """
    import numpy as np

    from geometry.bodies.extrude import swept_body, swept_section, swept_slice
    from geometry.mesh.data import vertex_positions
    from geometry.mesh.tets import to_tetrahedra

    actuator, fineness = convert.dimensions(case.actuator), mesh_size(case, model, half)
    twisted, kind, pressures = any(mirror_breakers(case.effects)), "hexahedra", 4
    if model == "section":
        mesh, kind, pressures, layers = swept_section(actuator, fineness), "quadrilaterals", 3, 1.0
        components = 3 if twisted else 2
    elif model == "cell":
        extent, number = cell_slice(case, half)
        mesh, layers, components = swept_slice(actuator, fineness, extent, number), number, 3
    else:
        mesh = swept_body(actuator, fineness, convert.strips(convert.tip_support(case)))
        layers, components = actuator.total_length / case.mesh.axial, 3
    constraints = pressures * len(mesh.cells)
    if case.mesh.element == "tetrahedron":
        mesh, kind = to_tetrahedra(mesh), "tetrahedra"
        constraints = len(np.unique(mesh.cells[:, vertex_positions(mesh.cell_type)]))
    return Size(
        elements=len(mesh.cells),
        kind=kind,
        unknowns=components * len(mesh.nodes) + constraints,
        scalars=_scalars(case, model, twisted),
        layers=layers,
    )


def _scalars(case: Case, model: str, twisted: bool) -> tuple[str, ...]:
    """Global unknowns: those of uniform bending, and a pressure that is found."""
    pressure, straight = case.find(PressureEffect), case.find(StraightEffect)
    names: list[str] = []
    if model in UNIFORM:
        names += ["curvature"] if straight is None else []
        names += ["stretch"] if straight is None or straight.stretch == "free" else []
        names += ["twist"] if twisted else []
    if pressure is not None and pressure.to is None:
        names.append("pressure")
    return tuple(names)

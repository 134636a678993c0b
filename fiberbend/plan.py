"""What a run would do, told without doing it."""

from __future__ import annotations

import dataclasses

from fiberbend import bridge
from fiberbend.case import Case
from fiberbend.case_effects import BlockedTipEffect, WindingEffect
from fiberbend.choice import choose_half, choose_model
from fiberbend.units import show


@dataclasses.dataclass(frozen=True)
class Plan:
    """What a run would do.

    Attributes:
        effects: names of the effects, in the order of the case.
        model: the model and why.
        body: half or full and why.
        elements: number of elements.
        unknowns: displacements and pressures, before any are held; volume control adds one.
        winding: whether the elements resolve the winding, or None where there is nothing to say.
    """

    effects: tuple[str, ...]
    model: str
    body: str
    elements: int
    unknowns: int
    winding: str | None

    def lines(self) -> list[str]:
        """The plan as lines of text."""
        rows = {
            "effects": ", ".join(self.effects),
            "model": self.model,
            "body": self.body,
            "elements": str(self.elements),
            "unknowns": str(self.unknowns),
            "winding": self.winding,
        }
        return [f"{key + ':':10}{value}" for key, value in rows.items() if value is not None]


def make_plan(case: Case) -> Plan:
    """Say what a run of a case would do; takes the mesh from the block layout, without gmsh."""
    model, why_model = choose_model(case)
    half, why_half = choose_half(case)
    elements, unknowns = count(case, half)
    return Plan(
        effects=tuple(effect.name for effect in case.effects),
        model=f"{model} ({why_model})",
        body=f"{'half' if half else 'full'} ({why_half})",
        elements=elements,
        unknowns=unknowns,
        winding=winding_remark(case),
    )


def count(case: Case, half: bool) -> tuple[int, int]:
    """Elements and unknowns of the body.

    Quadratic displacement everywhere; on hexahedra four pressures each (linear, discontinuous),
    on tetrahedra one at each vertex.
    """
    import numpy as np

    from geometry.mesh import vertex_positions
    from geometry.sweep import swept_body
    from geometry.tets import to_tetrahedra

    tip = case.find(BlockedTipEffect)
    mesh = swept_body(
        bridge.dimensions(case.actuator),
        bridge.mesh_size(case.mesh, half),
        bridge.strips(tip) if tip else None,
    )
    if case.mesh.element == "tetrahedron":
        mesh = to_tetrahedra(mesh)
        pressures = len(np.unique(mesh.cells[:, vertex_positions(mesh.cell_type)]))
    else:
        pressures = 4 * len(mesh.cells)
    return len(mesh.cells), 3 * len(mesh.nodes) + pressures


def winding_remark(case: Case) -> str | None:
    """Whether elements of the case's axial length resolve its winding.

    Returns:
        A sentence, or None without a discrete winding.
    """
    winding = case.find(WindingEffect)
    if winding is None or winding.representation == "smeared":
        return None
    axial, most = case.mesh.axial, winding.pitch / 2
    turn = f"a pitch of {show(winding.pitch, 'length')}"
    if axial <= most * (1 + 1e-9):
        return f"resolved (elements of {show(axial, 'length')}, {turn})"
    return (
        f"NOT resolved (elements of {show(axial, 'length')} under {turn}, needs "
        f"{show(most, 'length')}): rubber between the turns bulges too little, the pressure for "
        "an angle comes out too low"
    )

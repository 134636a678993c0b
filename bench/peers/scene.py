"""The actuator that all programs solve, as fiberbend reads it and as arrays for the others.

Hoops in place of the double helix: a thread of a fifth of the pitch and a fifth of the stiffness
is the same per length, and lies almost square to the axis. Every rubber has a bulk modulus of
`BULK` times its shear modulus, because CalculiX has no element without one.
"""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.peers.arrays import Body, Floats, Ints

if TYPE_CHECKING:
    from fiberbend.case.case import Case
    from geometry.mesh.data import MeshData

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "cases" / "free_bending_smeared.yaml"

BULK = 200.0
"""Bulk over shear modulus."""
PITCH, THREAD = 3.0, 0.38
"""Of the case, mm."""
FINER = 5
"""Times finer than the case's is the winding that stands for hoops."""
REGIONS = ("wall", "floor", "sheath")
YEOH = {"wall": (0.11, 0.02), "floor": (7.9, 0.0), "sheath": (0.012662, 0.0)}
"""C1 and C2 of the case's rubbers, MPa."""
_LEVELS = np.array([1.0, 4.0, 1.0]) / 6
"""Share of an element's length that the hoops at its ends and at its middle stand for."""


def settings(section: int, axial: float) -> list[str]:
    """Changes to the case.

    Args:
        section: elements through each thickness.
        axial: length of the elements, mm.
    """
    thread = THREAD / math.sqrt(FINER)
    rubbers = ", ".join(
        f'"{name}": {{"law": "yeoh", "c1": "{c1} MPa", "c2": "{c2} MPa", '
        f'"bulk": "{2 * c1 * BULK} MPa"}}'
        for name, (c1, c2) in YEOH.items()
    )
    return [
        f"materials={{{rubbers}}}",
        'effects.1.winding={"pattern": "double-helix", "as": "smeared", '
        f'"pitch": "{PITCH / FINER} mm", "fiber": {{"modulus": "31076 MPa", '
        f'"diameter": "{thread:.10f} mm", "radius_factor": 0.5}}}}',
        f"mesh.section={section}",
        f'mesh.axial="{axial} mm"',
        "compare=[]",
        "output.pictures=false",
        "output.fields=false",
        "output.report=false",
    ]


def the_case(section: int, axial: float) -> Case:
    """The case on a mesh; see `settings`."""
    from fiberbend.reader.reader import read_case

    return read_case(CASE, settings(section, axial))


@functools.cache
def hoop_stiffness() -> float:
    """EA of the hoops in a length of 1 mm of the axis, N/mm."""
    from fiberbend.case import convert

    case = the_case(1, 8.0)
    (winding,) = (effect for effect in case.effects if effect.name == "winding")
    actuator = convert.dimensions(case.actuator)
    density = winding.helix().density(actuator)  # type: ignore[attr-defined]
    hands = len(winding.helix().hands)  # type: ignore[attr-defined]
    return float(winding.fiber.thread().stiffness * density * hands)  # type: ignore[attr-defined]


def meshed(section: int, axial: float) -> MeshData:
    """fiberbend's mesh of the body; see `settings`."""
    from fiberbend.models.choice import meshed as model_of

    case = the_case(section, axial)
    return model_of(case).mesh(case)


def body_of(mesh: MeshData) -> Body:
    """A mesh of fiberbend as arrays, and the hoops along its nodes."""
    from fiberbend.states.mesh_file import facet_order
    from fiberbend.states.paraview import vtk_order

    places = facet_order("hexahedron")
    surfaces = {
        name: mesh.cells[pairs[:, :1], places[pairs[:, 1]]] for name, pairs in mesh.facets.items()
    }
    cells = mesh.cells[:, vtk_order("hexahedron")]
    region = np.zeros(len(cells), dtype=np.int64)
    for number, name in enumerate(REGIONS):
        region[mesh.cell_region == mesh.regions[name]] = number
    hoops, stiffness = hoop_pieces(mesh.nodes, surfaces["winding"], False)
    plain_hoops, plain_stiffness = hoop_pieces(mesh.nodes, surfaces["winding"], True)
    return Body(
        points=mesh.nodes,
        cells=cells,
        region=region,
        chamber=surfaces["chamber"],
        root=surfaces["section_root"],
        tip=surfaces["section_tip"],
        clamp=np.unique(surfaces["clamp"]),
        symmetry=np.unique(surfaces["symmetry"]),
        hoops=hoops,
        hoop_stiffness=stiffness,
        plain_hoops=plain_hoops,
        plain_stiffness=plain_stiffness,
    )


def hoop_pieces(points: Floats, facets: Ints, plain: bool) -> tuple[Ints, Floats]:
    """Straight pieces of hoop between the nodes of the winding's surface, each listed once.

    A hoop lies along every row of nodes around the section and carries what its share of the
    element's length does, by Simpson's rule.

    Args:
        points: of the nodes, (n, 3).
        facets: (f, 9), in VTK's order.
        plain: the facets have no node in their middle.

    Returns:
        Nodes (k, 2), and EA in N, (k,).
    """
    pairs: list[tuple[int, int]] = []
    carried: list[float] = []
    for facet in facets:
        z = points[facet, 2]
        levels = np.unique(np.round(z, 6))
        length = levels[-1] - levels[0]
        for level, share in zip(levels, _LEVELS, strict=True):
            row = facet[np.abs(z - level) < 1e-5]  # corner, corner, middle: VTK's order
            first, last, middle = row
            step = [(first, middle), (middle, last)]
            if plain and middle == facet[8]:
                step = [(first, last)]
            pairs += step
            carried += [share * length * hoop_stiffness()] * len(step)
    unique, which = np.unique(np.sort(np.array(pairs), axis=1), axis=0, return_inverse=True)
    total = np.bincount(which.ravel(), weights=carried).astype(np.float64)
    return unique.astype(np.int64), total

"""A mesh as an input file of Abaqus and CalculiX.

meshio's own writer has no surfaces, and writes other elements than these: a line of three nodes as
a cubic beam, a tetrahedron as a modified one.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import numpy as np

from fiberbend.states.paraview import vtk_order
from geometry.mesh.data import Floats, Ints, MeshData, reference_nodes

if TYPE_CHECKING:
    from fiberbend.states.mesh_file import Named

TYPES = {"hexahedron27": ("C3D20", 20), "tetra10": ("C3D10", 10), "quad9": ("CPE8", 8)}
"""Element and number of its nodes, which are the first of VTK's."""
TRUSS = "T3D2"
_REDUCED = {"C3D20": "C3D20R", "CPE8": "CPE8R"}
"""Elements of reduced integration, which do not lock where the volume hardly changes."""

_FACES = {
    "C3D20": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)),
    "C3D10": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "CPE8": ((0, 1), (1, 2), (2, 3), (3, 0)),
}
"""Corners of the faces S1, S2, …"""
_A_LINE = 8
_SAME_SHAPE = 1e-6
"""Distance in mm that no digit of a file shows."""


def write_inp(parts: Named, mesh: MeshData, path: Path, title: str) -> list[str]:
    """Write nodes, elements by region, fibers as trusses, surfaces by faces, and node sets.

    Args:
        parts: of the mesh.
        mesh: the mesh.
        path: the file.
        title: of the case.

    Returns:
        What the file has otherwise than the mesh, a sentence each.
    """
    element, count = TYPES[parts.solid]
    regions = {name: cells[:, :count] for name, cells in parts.regions.items()}
    used = np.unique(np.concatenate([cells.ravel() for cells in regions.values()]))
    used = np.r_[used, np.unique(parts.fibers)].astype(np.int64)
    label = np.zeros(len(parts.points), dtype=np.int64)
    label[used] = np.arange(1, len(used) + 1)
    numbers = _numbers(mesh, regions)
    with path.open("w", encoding="utf-8") as file:
        file.write("*HEADING\n")
        file.write(f"{' '.join(title.split()) or 'fiberbend'}\n")
        file.write("** lengths in mm\n*NODE\n")
        _rows(file, label[used], parts.points[used, : parts.dimension])
        last = 0
        for name, cells in regions.items():
            file.write(f"*ELEMENT, TYPE={element}, ELSET={name}\n")
            last = _elements(file, last, label[cells])
        if len(parts.fibers):
            trusses = np.stack([parts.fibers[:, [0, 2]], parts.fibers[:, [2, 1]]], axis=1)
            file.write(f"*ELEMENT, TYPE={TRUSS}, ELSET=fibers\n")
            begin, last = last, _elements(file, last, label[trusses.reshape(-1, 2)])
            curve = np.repeat(parts.curve, 2)
            for number in np.unique(curve):
                _set(
                    file,
                    f"*ELSET, ELSET=fiber_{number}",
                    begin + 1 + np.flatnonzero(curve == number),
                )
        for name, facets in parts.surfaces.items():
            file.write(f"*SURFACE, NAME={name}, TYPE=ELEMENT\n")
            for cell, face in zip(*_faces(mesh, parts, name, element), strict=True):
                file.write(f"{numbers[cell]}, S{face + 1}\n")
            nodes = label[np.unique(facets)]
            _set(file, f"*NSET, NSET={name}", nodes[nodes > 0])
        for name, node in parts.nodes.items():
            _set(file, f"*NSET, NSET={name}", label[[node]])
    return list(_remarks(parts, mesh, element, count))


def _remarks(parts: Named, mesh: MeshData, element: str, count: int) -> Iterator[str]:
    kept = len(parts.regions[next(iter(parts.regions))][0])
    if kept != count:
        moved = _moved(parts, mesh, count)
        text = f"elements are {element}: the middles of faces and cells are left out"
        # of straight extruded elements they lie where the others put them
        shape = f", which moves surfaces by up to {moved:.2g} mm" if moved > _SAME_SHAPE else ""
        yield text + shape
    if len(parts.fibers):
        yield (
            f"fibers are straight trusses {TRUSS}, two for a piece within an element: "
            "*EMBEDDED ELEMENT ties them to the body"
        )
    yield (
        f"incompressible rubber wants hybrid elements in Abaqus, {element}H in place of {element}; "
        f"CalculiX has none: a bulk modulus, and {_REDUCED.get(element, element)}"
    )


def _moved(parts: Named, mesh: MeshData, count: int) -> float:
    """Greatest distance in mm of a node that is left out from where the others put it."""
    d = parts.dimension
    cells = np.concatenate(list(parts.regions.values()))
    corners = 2**d
    nodes = parts.points[cells]
    reference = _reference(mesh.cell_type)
    weights = _serendipity(reference[:count], reference[count:], corners)
    gap = np.linalg.norm(weights @ nodes[:, :count] - nodes[:, count:], axis=2)
    return float(gap.max())


def _reference(cell_type: str) -> Floats:
    """Reference coordinates in [−1, 1] of the nodes in VTK's order."""
    return 2 * reference_nodes(cell_type)[vtk_order(cell_type)] - 1


def _serendipity(nodes: Floats, points: Floats, corners: int) -> Floats:
    """Shape functions of an element whose nodes are corners and middles of edges, (points, n)."""
    d = nodes.shape[1]
    values = np.empty((len(points), len(nodes)))
    for number, node in enumerate(nodes):
        shares = 1 + points * node
        if number < corners:
            values[:, number] = shares.prod(axis=1) * ((points * node).sum(axis=1) - d + 1) / 2**d
        else:
            along = node == 0
            values[:, number] = np.where(along, 1 - points**2, shares).prod(axis=1) / 2 ** (d - 1)
    return values


def _numbers(mesh: MeshData, regions: dict[str, Ints]) -> Ints:
    """Number in the file of every cell: by region, from 1 on."""
    order = np.concatenate(
        [np.flatnonzero(mesh.cell_region == mesh.regions[name]) for name in regions]
    )
    numbers = np.zeros(len(mesh.cells), dtype=np.int64)
    numbers[order] = np.arange(1, len(order) + 1)
    return numbers


def _faces(mesh: MeshData, parts: Named, name: str, element: str) -> tuple[Ints, Ints]:
    """Cell and face, from zero on, of every facet of a surface."""
    corners = np.array(_FACES[element])
    cells = mesh.facets[name][:, 0]
    nodes = np.sort(mesh.cells[cells][:, vtk_order(mesh.cell_type)][:, corners], axis=2)
    facets = np.sort(parts.surfaces[name][:, : corners.shape[1]], axis=1)
    same = (nodes == facets[:, None]).all(axis=2)
    return cells, same.argmax(axis=1)


def _rows(file: TextIO, labels: Ints, points: Floats) -> None:
    for label, point in zip(labels.tolist(), points.tolist(), strict=True):
        file.write(f"{label}, {', '.join(f'{value:.12g}' for value in point)}\n")


def _elements(file: TextIO, last: int, rows: Ints) -> int:
    """Write elements from a number on; no line has more than sixteen entries."""
    for number, row in enumerate(rows.tolist(), start=last + 1):
        entries = [number, *row]
        lines = [entries[i : i + 2 * _A_LINE] for i in range(0, len(entries), 2 * _A_LINE)]
        file.write(",\n".join(", ".join(map(str, line)) for line in lines) + "\n")
    return last + len(rows)


def _set(file: TextIO, head: str, members: Ints) -> None:
    rows = members.tolist()
    file.write(head + "\n")
    for begin in range(0, len(rows), _A_LINE):
        file.write(", ".join(map(str, rows[begin : begin + _A_LINE])) + "\n")

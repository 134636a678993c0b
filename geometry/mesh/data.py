"""Mesh arrays with named regions and facets, independent of any finite-element code."""

from __future__ import annotations

import dataclasses
import functools
import json
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_TET_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))

FACET_VERTICES: dict[str, tuple[tuple[int, ...], ...]] = {
    "quadrilateral": ((0, 1), (0, 2), (1, 3), (2, 3)),
    "hexahedron": (
        (0, 1, 2, 3),
        (0, 1, 4, 5),
        (0, 2, 4, 6),
        (1, 3, 5, 7),
        (2, 3, 6, 7),
        (4, 5, 6, 7),
    ),
    "tetrahedron": ((1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)),
}
"""Vertices of each local facet, in the numbering of the UFC reference cells (UFC manual, ch. 4)."""


def reference_nodes(cell_type: str) -> Floats:
    """Reference coordinates of the nodes of an order-2 cell, in the node order of `MeshData`.

    Quadrilateral and hexahedron: tensor order on [0, 1]^d, the first coordinate fastest (9 or 27
    nodes). Tetrahedron: four vertices, then the middles of edges 01, 12, 02, 03, 13, 23.

    Args:
        cell_type: "quadrilateral", "hexahedron" or "tetrahedron".

    Returns:
        Array (nodes, d) of coordinates in the unit reference cell.

    Raises:
        ValueError: another cell type.
    """
    line = np.array([0.0, 0.5, 1.0])
    if cell_type == "quadrilateral":
        y, x = np.meshgrid(line, line, indexing="ij")
        return np.column_stack([x.ravel(), y.ravel()])
    if cell_type == "hexahedron":
        z, y, x = np.meshgrid(line, line, line, indexing="ij")
        return np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    if cell_type == "tetrahedron":
        vertices = np.vstack([np.zeros(3), np.eye(3)])
        middles = [(vertices[i] + vertices[j]) / 2 for i, j in _TET_EDGES]
        return np.vstack([vertices, *middles])
    raise ValueError(f"no reference cell for {cell_type!r}")


def vertex_positions(cell_type: str) -> Ints:
    """Positions of the vertices within the node list of a cell, in UFC vertex order."""
    if cell_type == "tetrahedron":
        return np.arange(4)
    d = 2 if cell_type == "quadrilateral" else 3
    corner = np.arange(2**d)
    return sum(2 * 3**i * ((corner >> i) & 1) for i in range(d))  # type: ignore[return-value]


def facet_positions(cell_type: str) -> Ints:
    """Positions, within the node list of a cell, of the nodes on each local facet.

    Returns:
        Array (facets, nodes per facet): 3, 9 or 6 nodes, in increasing position.
    """
    nodes = reference_nodes(cell_type)
    vertices = nodes[vertex_positions(cell_type)]
    rows = []
    for corners in FACET_VERTICES[cell_type]:
        base, span = vertices[corners[0]], vertices[list(corners[1:])] - vertices[corners[0]]
        normal = np.linalg.svd(span)[2][-1]
        rows.append(np.flatnonzero(np.abs((nodes - base) @ normal) < 1e-9))
    return np.array(rows)


@dataclasses.dataclass(frozen=True)
class MeshData:
    """An order-2 mesh as arrays.

    Attributes:
        cell_type: "quadrilateral", "hexahedron" or "tetrahedron".
        nodes: coordinates in mm, (n, 3); (n, 2) for a section of quadrilaterals.
        cells: node numbers, (m, 9 | 27 | 10), in the order of `reference_nodes`.
        regions: number of each named region.
        cell_region: region number of each cell, (m,).
        facets: for each named surface the pairs (cell, local facet), (k, 2). A surface inside the
            body lists every facet once, from the cell with the lower number.
        half: True when only x ≥ 0 is meshed and x = 0 is a mirror plane.
        points: number of each named node; "pin" lies on x = 0, on the floor's lower face, at z = 0.
    """

    cell_type: str
    nodes: Floats
    cells: Ints
    regions: dict[str, int]
    cell_region: Ints
    facets: dict[str, Ints]
    half: bool = False
    points: dict[str, int] = dataclasses.field(default_factory=dict)

    @functools.cached_property
    def extent(self) -> Floats:
        """Of the nodes along each axis, mm."""
        extent: Floats = np.ptp(self.nodes, axis=0)
        return extent

    def facet_nodes(self, name: str) -> Ints:
        """Node numbers of every facet of a named surface, (k, nodes per facet)."""
        pairs = self.facets[name]
        local = facet_positions(self.cell_type)[pairs[:, 1]]
        return self.cells[pairs[:, :1], local]

    def save(self, target: Path | IO[bytes]) -> None:
        """Write the mesh to an .npz file.

        Args:
            target: its path, or a file open for writing bytes.
        """
        header = {
            "cell_type": self.cell_type,
            "regions": self.regions,
            "half": self.half,
            "points": self.points,
        }
        arrays = {f"facets/{name}": pairs for name, pairs in self.facets.items()}
        np.savez(
            target,
            header=np.array(json.dumps(header)),
            nodes=self.nodes,
            cells=self.cells,
            cell_region=self.cell_region,
            **arrays,
        )

    @classmethod
    def load(cls, path: Path) -> MeshData:
        """Read a mesh written by `save`.

        Raises:
            FileNotFoundError: no such file.
        """
        with np.load(path) as file:
            header = json.loads(str(file["header"]))
            facets = {
                name.removeprefix("facets/"): file[name]
                for name in file.files
                if name.startswith("facets/")
            }
            return cls(
                cell_type=header["cell_type"],
                nodes=file["nodes"],
                cells=file["cells"],
                regions=header["regions"],
                cell_region=file["cell_region"],
                facets=facets,
                half=header["half"],
                points=header.get("points", {}),
            )

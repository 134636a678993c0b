"""A distributed mesh with the names of its regions and surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import ufl
from mpi4py import MPI

from fem import compat
from geometry.mesh.data import MeshData
from geometry.mesh.reference import surface_weights

QUADRATURE_DEGREE = {"quadrilateral": 5, "hexahedron": 5, "tetrahedron": 4}
"""Three Gauss points a direction on bricks: exact for the volume of the quadratic chamber wall."""


class Domain:
    """A `MeshData` spread over the ranks of a communicator.

    Every rank holds the whole `MeshData` and finds its part by input numbers, so that nothing is
    ever located by coordinates.

    Attributes:
        data: the mesh as arrays.
        comm: communicator.
        mesh: the dolfinx mesh.
        cells: input number of every local cell.
        owned: number of cells this rank owns (they come first).
        local_cell: local number of every input cell, -1 where it is not owned here.
    """

    def __init__(self, data: MeshData, comm: MPI.Comm = MPI.COMM_WORLD) -> None:
        self.data = data
        self.comm = comm
        self.mesh = compat.create_mesh(comm, data.cell_type, data.nodes, data.cells)
        self.cells = compat.input_cells(self.mesh)
        self.owned = compat.owned_cells(self.mesh)
        self.local_cell = np.full(len(data.cells), -1, dtype=np.int64)
        self.local_cell[self.cells[: self.owned]] = np.arange(self.owned)
        self._facet_tags, self._facet_ids = self._tag_facets()

    def like(self, data: MeshData) -> bool:
        """Whether another mesh differs from this one by the places of its nodes alone."""
        mine = self.data
        return (
            mine.cell_type == data.cell_type
            and mine.half == data.half
            and mine.regions == data.regions
            and mine.points == data.points
            and mine.nodes.shape == data.nodes.shape
            and np.array_equal(mine.cells, data.cells)
            and np.array_equal(mine.cell_region, data.cell_region)
            and mine.facets.keys() == data.facets.keys()
            and all(np.array_equal(mine.facets[name], data.facets[name]) for name in mine.facets)
        )

    def move(self, data: MeshData) -> None:
        """Put the nodes where another mesh has them; on one rank.

        Args:
            data: a mesh that is `like` this one.
        """
        self.data = data
        points, corners = compat.coordinates(self.mesh)
        order = compat.node_permutation(data.cell_type)
        points[corners, : data.nodes.shape[1]] = data.nodes[data.cells[self.cells][:, order]]

    def _tag_facets(self) -> tuple[Any, dict[str, tuple[int, ...]]]:
        """Tag every boundary facet with its combination of names; a facet may have several."""
        data = self.data
        names: dict[tuple[int, int], tuple[str, ...]] = {}
        for name in sorted(data.facets):
            for cell, facet in data.facets[name].tolist():
                names[cell, facet] = (*names.get((cell, facet), ()), name)
        combinations = sorted(set(names.values()))
        number = {combination: i + 1 for i, combination in enumerate(combinations)}
        facets = compat.cell_facets(self.mesh)
        tagged: dict[int, int] = {}
        for (cell, facet), combination in names.items():
            local = self.local_cell[cell]
            if local >= 0:
                tagged[int(facets[local, facet])] = number[combination]
        tags = compat.meshtags(
            self.mesh, self.mesh.topology.dim - 1, list(tagged), list(tagged.values())
        )
        ids = {
            name: tuple(i for combination, i in number.items() if name in combination)
            for name in data.facets
        }
        return tags, ids

    @property
    def degree(self) -> int:
        """Quadrature degree of the measures."""
        return QUADRATURE_DEGREE[self.data.cell_type]

    def dx(self) -> Any:
        """Measure of the whole body."""
        return ufl.Measure("dx", domain=self.mesh, metadata={"quadrature_degree": self.degree})

    def ds(self, name: str) -> Any:
        """Measure of a named surface on the boundary.

        Raises:
            KeyError: the mesh has no surface of this name.
        """
        ids = self._facet_ids[name]
        return ufl.Measure(
            "ds",
            domain=self.mesh,
            subdomain_data=self._facet_tags,
            subdomain_id=ids if len(ids) > 1 else ids[0],
            metadata={"quadrature_degree": self.degree},
        )

    def cell_values(self, by_region: dict[str, float]) -> npt.NDArray[np.float64]:
        """One value per local cell from a value per region; zero in regions not named.

        Raises:
            KeyError: the mesh has no such region.
        """
        table = np.zeros(max(self.data.regions.values()) + 1)
        for region, value in by_region.items():
            table[self.data.regions[region]] = value
        return table[self.data.cell_region[self.cells]]

    def surface_nodes(self, name: str) -> npt.NDArray[np.int64]:
        """Input numbers of the nodes on a named surface, sorted."""
        return np.unique(self.data.facet_nodes(name))

    def surface_weights(self, name: str) -> npt.NDArray[np.float64]:
        """Area weight of every input node, ∫ φ_a dA over a named surface, in mm²; (n,)."""
        return surface_weights(self.data, name)

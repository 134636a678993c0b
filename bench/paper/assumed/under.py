"""A section without the sheath under its floor: the elements there are left out."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from geometry.mesh.data import MeshData


def bare(case: Case) -> MeshData:
    """The mesh of a section without the sheath below the lowest line of floor and layer."""
    return without_under(meshed(case).mesh(case), convert.dimensions(case.actuator).outline_bottom)


def without_under(mesh: MeshData, bottom: float) -> MeshData:
    """A mesh without its sheath below a line.

    Args:
        mesh: has a region "sheath".
        bottom: y of the line, mm.
    """
    below = mesh.nodes[mesh.cells][:, :, 1].mean(axis=1) < bottom
    keep = np.flatnonzero(~(below & (mesh.cell_region == mesh.regions["sheath"])))
    cell = np.full(len(mesh.cells), -1)
    cell[keep] = np.arange(len(keep))
    used = np.unique(mesh.cells[keep])
    node = np.full(len(mesh.nodes), -1)
    node[used] = np.arange(len(used))
    facets = {
        name: np.column_stack([cell[pairs[:, 0]], pairs[:, 1]])[cell[pairs[:, 0]] >= 0]
        for name, pairs in mesh.facets.items()
    }
    return dataclasses.replace(
        mesh,
        nodes=mesh.nodes[used],
        cells=node[mesh.cells[keep]],
        cell_region=mesh.cell_region[keep],
        facets=facets,
        points={name: int(node[number]) for name, number in mesh.points.items()},
    )

"""Zones along a body: regions of their own, and the winding of one of them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from geometry.mesh.data import Floats, Ints, MeshData
from geometry.winding.segments import EmbeddedFibers


def with_regions(
    mesh: MeshData, borders: Sequence[float], names: Sequence[Mapping[str, str]]
) -> MeshData:
    """The mesh with regions that bear other names in some zones.

    A cap belongs to the zone beside it.

    Args:
        mesh: of a body, no cell of which crosses a border.
        borders: z of the planes between zones, mm, in order.
        names: for each zone, from root to tip, the new names of regions by their old ones.
    """
    regions, cell_region = dict(mesh.regions), mesh.cell_region.copy()
    zone = _zone(mesh, mesh.cells, borders)
    for number, by_part in enumerate(names):
        for part, name in by_part.items():
            if part in mesh.regions:
                regions[name] = len(regions)
                here = (zone == number) & (mesh.cell_region == mesh.regions[part])
                cell_region[here] = regions[name]
    # a region without cells would have a law and a kernel that nothing needs
    used = [name for name, number in regions.items() if np.any(cell_region == number)]
    place = np.zeros(len(regions), dtype=np.int64)
    place[[regions[name] for name in used]] = np.arange(len(used))
    return dataclasses.replace(
        mesh,
        regions={name: number for number, name in enumerate(used)},
        cell_region=place[cell_region],
    )


def wound_part(
    mesh: MeshData, borders: Sequence[float], number: int, surfaces: Sequence[str]
) -> MeshData:
    """The mesh with some surfaces in one zone only, z = 0 at the zone's end at the root.

    Args:
        mesh: of a body, no facet of these surfaces crosses a border.
        borders: z of the planes between zones, mm, in order.
        number: of the zone, from 0.
        surfaces: names of surfaces; those that the mesh does not have are left out.
    """
    facets = dict(mesh.facets)
    for name in surfaces:
        if name in facets:
            here = _zone(mesh, mesh.facet_nodes(name), borders) == number
            facets[name] = facets[name][here]
    start = (0.0, *borders)[number]
    return dataclasses.replace(mesh, nodes=mesh.nodes - [0.0, 0.0, start], facets=facets)


def _zone(mesh: MeshData, nodes: Ints, borders: Sequence[float]) -> Ints:
    """The zone in which the middle of some nodes lies, (n, k) to (n,)."""
    middle = mesh.nodes[nodes, 2].mean(axis=1)
    return np.searchsorted(np.asarray(borders, dtype=float), middle)


def joined(
    pieces: Sequence[tuple[EmbeddedFibers, float, float | Floats]],
) -> tuple[EmbeddedFibers, Floats]:
    """Fibers of several zones on one mesh, sorted by curve and z.

    Curves of the same number go on from zone to zone, with a gap where they do not meet.

    Args:
        pieces: of every zone its fibers, of one class, with z from its end at the root; z of that
            end, mm; and a value of all of them or of every segment, such as the thread's stiffness.

    Returns:
        The fibers, and the value of every segment, (segments,).
    """
    parts, starts, values = zip(*pieces, strict=True)
    (kind,) = {type(part) for part in parts}
    names = [field.name for field in dataclasses.fields(kind)]
    rows = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    counts = [len(part.cell) for part in parts]
    rows["z"] = rows["z"] + np.repeat(np.array(starts), counts)
    each = [np.broadcast_to(value, count) for value, count in zip(values, counts, strict=True)]
    order = np.lexsort((rows["z"], rows["curve"]))
    own = np.concatenate(each).astype(float)[order]
    return kind(**{name: value[order] for name, value in rows.items()}), own

"""Zones as one body in space: their sections or slices put together and joined at the borders.

Nodes at a border are there twice: the sections of two zones deform each in its own way.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.case.zones import bounds, own_regions
from fiberbend.results.space import Space
from fiberbend.running.zones.chain import Link
from fiberbend.running.zones.march import ZoneMarch
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Ints, MeshData
from geometry.winding.segments import EmbeddedFibers

_ROOT, _TIP = "section_root", "section_tip"


class Joined:
    """The length between the caps in space.

    Args:
        case: of the whole.
        zones: from root to tip.
        model: name of the model that solves them.

    Attributes:
        model_mesh: mesh, materials and fibers of all zones.
    """

    def __init__(self, case: Case, zones: Sequence[ZoneMarch], model: str) -> None:
        own = [zone.model_mesh(case.title) for zone in zones]
        spaces = [Space(z.case, mesh) for z, mesh in zip(zones, own, strict=True)]
        if not all(space.model_mesh.mesh.half for space in spaces):
            spaces = [Space(z.case, mesh, both=True) for z, mesh in zip(zones, own, strict=True)]
        self._spaces, self._starts = spaces, bounds(case)[:-1]
        self._heights = [zone.rest.bend.height for zone in zones]
        meshes = [space.model_mesh for space in spaces]
        names = [
            {part: new.get(part, part) for part in each.mesh.regions}
            for each, new in zip(meshes, own_regions(case), strict=True)
        ]
        self._segments, fibers = _fibers(meshes, self._starts)
        self.model_mesh = ModelMesh(
            mesh=_mesh([each.mesh for each in meshes], names, self._starts),
            materials={
                new[part]: each.materials[part]
                for each, new in zip(meshes, names, strict=True)
                for part in each.mesh.regions
            },
            fibers=fibers,
            smeared=fibers is None and any(each.smeared for each in own),
            title=f"{case.title}: {model} model, caps not modelled",
        )

    def snapshot(self, link: Link, label: str, row: dict[str, Any], remark: str) -> Snapshot:
        """A state of the whole in space.

        Args:
            link: the state.
            label: its name.
            row: of the history.
            remark: what every picture of it has to say.
        """
        moved, forces = [], []
        multipliers = []
        for number, (space, kept) in enumerate(zip(self._spaces, link.parts, strict=True)):
            shot, mesh = space.snapshot(kept.shot), space.model_mesh
            rotation, place = link.frames[number]
            root = np.array([0.0, self._heights[number], 0.0])
            nodes = mesh.mesh.nodes
            there = root + place + (nodes + shot.displacement - root) @ rotation.T
            moved.append(there - nodes - [0.0, 0.0, self._starts[number]])
            multipliers.append(shot.multiplier)
            if mesh.lines is not None and shot.fiber_force is not None:
                forces.append(shot.fiber_force)
        return Snapshot(
            label=label,
            step=row[col.STEP],
            pressure_kpa=row[col.PRESSURE],
            angle_deg=row[col.ANGLE],
            remark=remark,
            displacement=np.concatenate(moved),
            multiplier=np.concatenate(multipliers),
            fiber_force=np.concatenate(forces)[self._segments] if forces else None,
        )


def _mesh(
    meshes: Sequence[MeshData], names: Sequence[dict[str, str]], starts: Sequence[float]
) -> MeshData:
    """Meshes of zones as one, regions by their new names."""
    regions: dict[str, int] = {}
    facets: dict[str, list[Ints]] = {}
    nodes, cells, cell_region = [], [], []
    count = total = 0
    for number, (mesh, new) in enumerate(zip(meshes, names, strict=True)):
        place = np.zeros(max(mesh.regions.values()) + 1, dtype=np.int64)
        for part, region in mesh.regions.items():
            place[region] = regions.setdefault(new[part], len(regions))
        nodes.append(mesh.nodes + np.array([0.0, 0.0, starts[number]]))
        cells.append(mesh.cells + count)
        cell_region.append(place[mesh.cell_region])
        left_out = {_TIP} if number < len(meshes) - 1 else set()
        left_out |= {_ROOT} if number > 0 else set()
        for name, pairs in mesh.facets.items():
            if name not in left_out:
                facets.setdefault(name, []).append(pairs + np.array([total, 0]))
        count, total = count + len(mesh.nodes), total + len(mesh.cells)
    return MeshData(
        cell_type="hexahedron",
        nodes=np.concatenate(nodes),
        cells=np.concatenate(cells),
        regions=regions,
        cell_region=np.concatenate(cell_region),
        facets={name: np.concatenate(pairs) for name, pairs in facets.items()},
        half=meshes[0].half,
        points=meshes[0].points,
    )


def _fibers(
    meshes: Sequence[ModelMesh], starts: Sequence[float]
) -> tuple[Ints, EmbeddedFibers | None]:
    """Lines of all zones sorted by curve and z, and the place of each among them one by one."""
    first = np.cumsum([0, *(len(each.mesh.cells) for each in meshes)])
    found = [
        dataclasses.replace(each.lines, cell=each.lines.cell + cells, z=each.lines.z + start)
        for each, cells, start in zip(meshes, first, starts, strict=False)
        if each.lines is not None
    ]
    if not found:
        return np.zeros(0, dtype=np.int64), None
    names = [field.name for field in dataclasses.fields(EmbeddedFibers)]
    rows = {name: np.concatenate([getattr(each, name) for each in found]) for name in names}
    order = np.lexsort((rows["z"], rows["curve"]))
    return order, EmbeddedFibers(**{name: values[order] for name, values in rows.items()})

"""What the pictures show of a run: surfaces of regions and fibers, at rest or in a state.

pyvista is imported where it is used: a run without pictures does without it.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.page import COLORS
from fiberbend.drawing.renderer import Drawable
from fiberbend.drawing.tessellation import Tessellation, boundary_facets, on_mirror
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats, Ints
from geometry.winding.segments import EmbeddedFibers

_FIBER_RADIUS = 0.2

Mask = NDArray[np.bool_]


class BodySurfaces:
    """Drawable parts of a run; a half body is completed by its mirror image.

    Args:
        model_mesh: mesh and fibers.

    Attributes:
        mesh: the mesh.
        fibers: the middle line of every fiber, or None without lines.
        middle: centre of every cell, (m, 3), mm.
        bare: True for the cells that do not hide the fibers: all but the sheath, (m,).
        names: the regions, and "fiber" where there are lines.
    """

    def __init__(self, model_mesh: ModelMesh) -> None:
        self.mesh = model_mesh.mesh
        self.fibers = None if model_mesh.lines is None else _one_line_each(model_mesh.lines)
        self.middle: Floats = self.mesh.nodes[self.mesh.cells].mean(axis=1)
        everything = np.ones(len(self.mesh.cells), dtype=bool)
        self.bare: Mask = everything if self.fibers is None else ~self._region("sheath")
        self.names = [*self.mesh.regions, *([] if self.fibers is None else ["fiber"])]

    def outside(self, cells: Mask) -> Ints:
        """Facets (cell, local facet) around some cells, without the mirror plane of a half."""
        pairs = boundary_facets(self.mesh, cells)
        return pairs[~on_mirror(self.mesh, pairs)] if self.mesh.half else pairs

    def parts(
        self,
        cells: Mask,
        state: Snapshot | None = None,
        open_at_mirror: bool = False,
        level: int = 3,
    ) -> list[Drawable]:
        """The surface of some cells, one drawable per region.

        Args:
            cells: True for those to draw, (m,).
            state: the state; None: undeformed.
            open_at_mirror: draw the half with its facets in the mirror plane, not the whole.
            level: pieces along an edge.
        """
        mesh, layers = self.mesh, []
        for name in mesh.regions:
            chosen = cells & self._region(name)
            pairs = boundary_facets(mesh, chosen) if open_at_mirror else self.outside(chosen)
            if len(pairs):
                skin = Tessellation(mesh, pairs, level)
                data = self.surface(skin, state, mesh.half and not open_at_mirror)
                layers.append(Drawable(data, color=COLORS.get(name, "#999999")))
        return layers

    def surface(self, skin: Tessellation, state: Snapshot | None, mirror: bool) -> Any:
        """A tessellation as pyvista.PolyData.

        Args:
            skin: the tessellation.
            state: the state; None: undeformed.
            mirror: append the mirror image in x = 0.
        """
        import pyvista as pv

        mesh = self.mesh
        nodes = mesh.nodes if state is None else mesh.nodes + state.displacement
        at_cells = nodes[mesh.cells]
        points, normals = skin.interpolate(at_cells), skin.normals(at_cells)
        pieces = skin.pieces
        if mirror:
            flip = np.array([-1.0, 1.0, 1.0])
            pieces = np.concatenate([pieces, pieces[:, ::-1] + len(points)])
            points = np.concatenate([points, points * flip])
            normals = np.concatenate([normals, normals * flip])
        data = pv.PolyData.from_regular_faces(points, pieces)
        data.point_data.active_normals = normals
        return data

    def fiber_tubes(
        self,
        state: Snapshot | None = None,
        low: float = -np.inf,
        high: float = np.inf,
    ) -> list[Drawable]:
        """The fibers as tubes, all around the body.

        Args:
            state: the state; None: undeformed.
            low: least z at rest, mm.
            high: greatest z at rest, mm.
        """
        mesh, fibers = self.mesh, self.fibers
        if fibers is None:
            return []
        kept = (fibers.z > low) & (fibers.z < high)
        if not kept.any():
            return []
        moved = None if state is None else state.displacement
        lines = [fiber_lines(mesh, _select(fibers, kept), moved)]
        if mesh.half:
            lines.append(lines[0].reflect((1, 0, 0)))
        return [Drawable(data, color=COLORS["fiber"], radius=_FIBER_RADIUS) for data in lines]

    def _region(self, name: str) -> Mask:
        number = self.mesh.regions.get(name, -1)
        found: Mask = self.mesh.cell_region == number
        return found


def _select(fibers: EmbeddedFibers, kept: Mask) -> EmbeddedFibers:
    fields = dataclasses.fields(fibers)
    return EmbeddedFibers(**{field.name: getattr(fibers, field.name)[kept] for field in fields})


def _one_line_each(fibers: EmbeddedFibers) -> EmbeddedFibers:
    """The middle line of every ribbon."""
    lines = round(1 / float(fibers.share[0]))
    return _select(fibers, fibers.curve % lines == lines // 2)

"""A section in its own plane, at rest or in a state, in pieces fine enough to draw."""

from __future__ import annotations

import numpy as np

from fiberbend.states.bend import in_frame
from fiberbend.states.recovery import SplitNodes
from fiberbend.states.snapshot import ModelMesh, Snapshot
from fiberbend.states.stack import root_section
from geometry.actuator import Actuator
from geometry.mesh.data import Floats, Ints, facet_positions
from geometry.mesh.reference import shape_functions
from geometry.winding.strip import Window, covered

_MIRROR = np.array([-1.0, 1.0])


class Crosscut:
    """The section of a section model, or the end z = 0 of a cell; a half with its mirror image.

    Args:
        model_mesh: mesh of quadrilaterals or of a slice.
        level: pieces along an edge.

    Attributes:
        mesh: the quadrilaterals.
        triangles: point numbers of the pieces, (t, 3).
        region: region number of each drawn point, (p,).
    """

    def __init__(self, model_mesh: ModelMesh, level: int = 8) -> None:
        mesh = model_mesh.mesh
        self.mesh = mesh if mesh.cell_type == "quadrilateral" else root_section(mesh)
        line = np.linspace(0.0, 1.0, level + 1)
        v, u = np.meshgrid(line, line, indexing="ij")
        grid = np.column_stack([u.ravel(), v.ravel()])
        self._weights = shape_functions("quadrilateral", grid)[0]
        ends = np.column_stack([line, np.zeros_like(line)])
        # the nodes of an edge, in increasing position, run along it
        self._along = shape_functions("quadrilateral", ends)[0][:, :3]
        corner = (np.arange(level)[:, None] * (level + 1) + np.arange(level)).reshape(-1, 1)
        halves = np.array([[0, 1, level + 2], [0, level + 2, level + 1]])
        split = np.concatenate([corner + half for half in halves])
        cells = len(self.mesh.cells)
        pieces = (len(grid) * np.arange(cells)[:, None, None] + split).reshape(-1, 3)
        region = np.repeat(self.mesh.cell_region, len(grid))
        if self.mesh.half:
            pieces = np.concatenate([pieces, pieces + cells * len(grid)])
            region = np.tile(region, 2)
        self.triangles: Ints = pieces
        self.region: Ints = region

    def nodes(self, state: Snapshot | None) -> Floats:
        """Positions of the nodes in the section's own plane, (n, 2), mm."""
        rest = self.mesh.nodes
        if state is None:
            return rest
        moved: Floats = in_frame(rest, state.displacement[: len(rest)])[:, :2]
        return moved

    def points(self, state: Snapshot | None) -> Floats:
        """Positions of the drawn points, (p, 2), mm."""
        points = (self._weights @ self.nodes(state)[self.mesh.cells]).reshape(-1, 2)
        return np.concatenate([points, points * _MIRROR]) if self.mesh.half else points

    def values(self, nodes: SplitNodes, field: Floats) -> Floats:
        """A field at the drawn points, (p,).

        Args:
            nodes: `split_alike` of the mesh.
            field: at their copies, (copies,).
        """
        at_cells = field[nodes.cells[: len(self.mesh.cells), :9]]
        values: Floats = (at_cells @ self._weights.T).ravel()
        return np.tile(values, 2) if self.mesh.half else values

    def outlines(self, state: Snapshot | None) -> Floats:
        """Borders of the regions as polylines, (k, level + 1, 2), mm."""
        mesh = self.mesh
        every = mesh.cells[:, facet_positions("quadrilateral")]
        # an edge is known by its middle node; a border of two regions is drawn once
        border = np.zeros(len(mesh.nodes), dtype=bool)
        for number in mesh.regions.values():
            middle, count = np.unique(every[mesh.cell_region == number, :, 1], return_counts=True)
            border[middle[count == 1]] = True
        if mesh.half:
            border[mesh.facet_nodes("symmetry")[:, 1]] = False
        middle, first = np.unique(every[:, :, 1], return_index=True)
        edges = every.reshape(-1, 3)[first[border[middle]]]
        lines = self._along @ self.nodes(state)[edges]
        return np.concatenate([lines, lines * _MIRROR]) if mesh.half else lines

    def winding(self, state: Snapshot | None) -> Floats:
        """The line on which the winding lies, as polylines, (k, level + 1, 2), mm."""
        lines: Floats = self._along @ self.nodes(state)[self.mesh.facet_nodes("winding")]
        return np.concatenate([lines, lines * _MIRROR]) if self.mesh.half else lines

    def fabric(self, state: Snapshot | None, actuator: Actuator, window: Window) -> Floats:
        """The part of that line within a window, as polylines, (k, level + 1, 2), mm.

        Args:
            state: the state; None: undeformed.
            actuator: dimensions.
            window: on its outline.
        """
        level = self._along.shape[0] - 1
        cells, points = covered(self.mesh, actuator, window, level)
        values = shape_functions("quadrilateral", points)[0]
        lines = values @ self.nodes(state)[self.mesh.cells[cells]]
        return np.concatenate([lines, lines * _MIRROR]) if self.mesh.half else lines

    def bulge(self, state: Snapshot) -> float | None:
        """How far the middle of a flat floor's lower face lies below its edges, mm.

        Returns:
            None where the floor is round.
        """
        edge, middle = self.chord(None)
        if abs(edge[1] - middle[1]) > 1e-9:
            return None
        edge, middle = self.chord(state)
        return float(edge[1] - middle[1])

    def chord(self, state: Snapshot | None) -> tuple[Floats, Floats]:
        """The edge x > 0 and the middle of the winding's lowest face, (2,) each, mm."""
        winding = np.unique(self.mesh.facet_nodes("winding"))
        x, y = self.mesh.nodes[winding].T
        edge, middle = winding[np.argmax(x - y)], winding[np.argmax(-np.abs(x) - y)]
        nodes = self.nodes(state)
        return nodes[edge], nodes[middle]

    def size(self, state: Snapshot | None) -> tuple[float, float]:
        """Width and height of the winding's outline, mm."""
        own = self.nodes(state)[np.unique(self.mesh.facet_nodes("winding"))]
        own = np.concatenate([own, own * _MIRROR]) if self.mesh.half else own
        width, height = np.ptp(own, axis=0)
        return float(width), float(height)

"""What lies on the body in the page of a run: its threads, and its strips of fabric."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import COLORS, name_of
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.report.packing import packed
from fiberbend.report.places import Places
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.snapshot import Snapshot
from geometry.mesh.data import Floats, Ints
from geometry.winding.segments import EmbeddedFibers


def strips(surfaces: BodySurfaces, states: Sequence[Floats]) -> tuple[dict[str, Any], Floats]:
    """Strips of fabric in every state.

    Args:
        surfaces: of the body in space, with what lies on it.
        states: positions of all its nodes in each, (n, 3), mm.

    Returns:
        What does not move, for the script of the page, and the points, (states, m, 3), mm.
    """
    triangles, places = surfaces.fabric_in(states)
    content = {
        "points": len(places[0]),
        "triangles": packed(triangles.astype("<u4")),
        "color": COLORS["fabric"],
        "name": name_of("fabric"),
    }
    return content, np.stack(places)


class Threads:
    """The fibers, one line for each ribbon.

    Args:
        surfaces: of the body in space.
        places: of its nodes.

    Attributes:
        content: what does not move, for the script of the page.
    """

    def __init__(self, surfaces: BodySurfaces, places: Places) -> None:
        self._places = places
        fibers, mesh = surfaces.fibers, places.mesh
        self._fibers: EmbeddedFibers | None = None
        self.content: dict[str, Any] = {
            "points": 0,
            "segments": "",
            "radius": 0.0,
            "family": "",
            "families": [],
        }
        if fibers is None:
            return
        cells, self._cell = np.unique(fibers.cell, return_inverse=True)
        self._node, numbers = np.unique(mesh.cells[cells], return_inverse=True)
        self._fibers = dataclasses.replace(fibers, cell=self._cell)
        self._mesh = dataclasses.replace(
            mesh,
            nodes=mesh.nodes[self._node],
            cells=numbers.reshape(len(cells), -1),
            cell_region=mesh.cell_region[cells],
            facets={},
            points={},
        )
        lines = self._lines()
        # the cells of a PolyData of lines: their sizes, each before its points
        sizes, flat = [], np.asarray(lines.lines)
        start = 0
        while start < len(flat):
            sizes.append(int(flat[start]))
            start += sizes[-1] + 1
        first = np.ones(lines.n_points, dtype=bool)
        first[np.cumsum(sizes) - 1] = False
        starts = np.flatnonzero(first)
        self.content = {
            "points": int(lines.n_points),
            "segments": packed(np.column_stack([starts, starts + 1]).astype("<u4")),
            "family": packed(_family(sizes, lines, surfaces).astype("u1")),
            "families": [
                {"name": name, "color": color, "image": surfaces.image_colors[number]}
                for number, (name, color) in enumerate(surfaces.family_colors.items())
            ],
        }

    def at(self, state: Snapshot) -> Floats:
        """Points of the lines in a state, (n, 3), mm; none without fibers."""
        if self._fibers is None:
            return np.zeros((0, 3))
        return np.asarray(self._lines(state).points, dtype=float)

    def _lines(self, state: Snapshot | None = None) -> Any:
        assert self._fibers is not None
        moved = None
        if state is not None:
            moved = self._places.at(state, self._node) - self._mesh.nodes
        return fiber_lines(self._mesh, self._fibers, moved)


def _family(sizes: list[int], lines: Any, surfaces: BodySurfaces) -> Ints:
    """The place of the family of every piece of polylines among those that are told apart."""
    names = list(surfaces.family_colors.values())
    place = np.array([names.index(color) for color in surfaces.line_colors] or [0])
    family = np.asarray(lines.cell_data["family"]) if surfaces.line_colors else np.zeros(len(sizes))
    found: Ints = np.repeat(place[family.astype(np.int64)], np.array(sizes) - 1)
    return found

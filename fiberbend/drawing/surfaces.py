"""What the pictures show of a run: surfaces of regions and fibers, at rest or in a state.

pyvista is imported where it is used: a run without pictures does without it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.page import COLORS, FAMILIES, SMEARED, color_of
from fiberbend.drawing.renderer import Drawable
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.drawing.tessellation import Tessellation, boundary_facets, on_mirror
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats, Ints
from geometry.winding.outline import arc_length
from geometry.winding.segments import EmbeddedFibers

FIBER_RADIUS = 0.2
"""Of the tubes that stand for fibers, mm."""
_ON_PLANE = 1e-9
"""Part of its width by which a body may miss the plane x = 0."""
_MIRROR = np.array([-1.0, 1.0, 1.0])
_OFF = 0.1
"""By so much fabric is drawn off its surface, mm."""
_TO_VIEWER = np.array([0.1, 0.0, 0.0])
"""So far a line stands out of the cut in which it lies, mm."""

Mask = NDArray[np.bool_]


class BodySurfaces:
    """Drawable parts of a run; a half body is completed by its mirror image.

    Args:
        model_mesh: mesh and fibers.
        scenery: has the strips of fabric.

    Attributes:
        mesh: the mesh.
        fibers: the middle line of every fiber, or None without lines.
        middle: centre of every cell, (m, 3), mm.
        sheathed: True for the cells of the sheath, (m,).
        bare: True for the cells that do not hide the fibers: all but the sheath, (m,).
        peeled: the same where a winding is smeared, whose surface the sheath hides.
        smeared: the winding is smeared over its surface.
        names: the regions, and "fiber" where there are lines, or the families where they are told
            apart, "winding" where they are smeared.
        family_colors: of each family that is told apart, by its name.
        image_colors: by the place of a family among those, the place of its mirror image's.
        line_colors: the colours by the number of the family of a segment.
    """

    def __init__(self, model_mesh: ModelMesh, scenery: Scenery | None = None) -> None:
        self._scenery = scenery or Scenery()
        self.mesh = model_mesh.mesh
        self._images = model_mesh.images
        self.fibers = None if model_mesh.lines is None else _one_line_each(model_mesh.lines)
        self.middle: Floats = self.mesh.nodes[self.mesh.cells].mean(axis=1)
        everything = np.ones(len(self.mesh.cells), dtype=bool)
        self.sheathed = self._region("sheath")
        self.bare: Mask = everything if self.fibers is None else ~self.sheathed
        self.smeared = model_mesh.smeared
        self.peeled: Mask = ~self.sheathed if self.smeared else self.bare
        looks = () if self.fibers is None else model_mesh.families
        numbers = list(dict.fromkeys(look.name for look in looks))
        self.family_colors = {
            name: FAMILIES[number % len(FAMILIES)] for number, name in enumerate(numbers)
        }
        image = {look.name: numbers.index(looks[look.image].name) for look in looks}
        self.image_colors = [image[name] for name in numbers]
        self.line_colors = [self.family_colors[look.name] for look in looks]
        wound = ["winding"] if self.smeared else ["fiber"] if self.fibers is not None else []
        self.names = [*self.mesh.regions, *(self.family_colors or wound)]
        self.names += ["fabric"] if self._scenery.strips else []

    @property
    def remark(self) -> str:
        """What a colour bar has to say of winding and sheath, after a comma; may be empty."""
        said = "" if self.bare.all() else ", sheath not drawn"
        if self.smeared:
            said = f", {SMEARED}"
        if not self._scenery.strips:
            return said
        covered = self.bare.all() and self.sheathed.any()
        return f"{said}, fabric {'under the sheath' if covered else 'green'}"

    def points(self, state: Snapshot | None) -> Floats:
        """Nodes of the body, also of a half's mirror image, mm, (n, 3).

        Args:
            state: the state; None: undeformed.
        """
        nodes = self.mesh.nodes if state is None else self.mesh.nodes + state.displacement
        return np.concatenate([nodes, nodes * _MIRROR]) if self.mesh.half else nodes

    def tip(self, state: Snapshot) -> Floats:
        """The middle of the face at the far end, mm, (3,)."""
        rest = self.points(None)[:, 2]
        there = rest > rest.max() - _ON_PLANE * np.ptp(rest)
        middle: Floats = self.points(state)[there].mean(axis=0)
        return middle

    def outside(self, cells: Mask, chamber: bool = True) -> Ints:
        """Facets (cell, local facet) around some cells, without the mirror plane of a half.

        Args:
            cells: True for the cells, (m,).
            chamber: with the surface of the chamber.
        """
        pairs = boundary_facets(self.mesh, cells)
        if self.mesh.half:
            pairs = pairs[~on_mirror(self.mesh, pairs)]
        if chamber:
            return pairs
        return pairs[~self._is_in(pairs, "chamber")]

    def parts(
        self,
        cells: Mask,
        state: Snapshot | None = None,
        open_at_mirror: bool = False,
        level: int = 3,
    ) -> list[Drawable]:
        """The surface of some cells, one drawable per region, and one of a smeared winding.

        Args:
            cells: True for those to draw, (m,).
            state: the state; None: undeformed.
            open_at_mirror: draw the half with its facets in the mirror plane, not the whole.
            level: pieces along an edge.
        """
        mesh = self.mesh
        layers: dict[str, list[Ints]] = {}
        for name in mesh.regions:
            chosen = cells & self._region(name)
            pairs = boundary_facets(mesh, chosen) if open_at_mirror else self.outside(chosen)
            wound = self._is_wound(pairs)
            layers.setdefault(name, []).append(pairs[~wound])
            layers.setdefault("winding", []).append(pairs[wound])
        found = []
        for name, parts in layers.items():
            pairs = np.concatenate(parts)
            if len(pairs):
                skin = Tessellation(mesh, pairs, level)
                data = self.surface(skin, state, mesh.half and not open_at_mirror)
                found.append(Drawable(data, color=color_of(name)))
        return found

    def winding_line(self, state: Snapshot | None = None) -> list[Drawable]:
        """The line in which a smeared winding meets the plane x = 0.

        Args:
            state: the state; None: undeformed.
        """
        import pyvista as pv

        if not self.smeared:
            return []
        mesh = self.mesh
        nodes = mesh.facet_nodes("winding")
        flat = np.abs(mesh.nodes[nodes, 0]) < _ON_PLANE * np.ptp(mesh.nodes[:, 0])
        # an edge has three nodes in the plane, sorted here along the axis
        edges = [
            row[on][np.argsort(mesh.nodes[row[on], 2])]
            for row, on in zip(nodes, flat, strict=True)
            if on.sum() == 3
        ]
        if not edges:
            return []
        moved = mesh.nodes if state is None else mesh.nodes + state.displacement
        points = moved[np.array(edges)].reshape(-1, 3)
        lines = np.insert(np.arange(len(points)).reshape(-1, 3), 0, 3, axis=1)
        data = pv.PolyData(points - _TO_VIEWER, lines=lines.ravel())
        return [Drawable(data, color=COLORS["winding"], radius=FIBER_RADIUS, flat=True)]

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
            pieces = np.concatenate([pieces, pieces[:, ::-1] + len(points)])
            points = np.concatenate([points, points * _MIRROR])
            normals = np.concatenate([normals, normals * _MIRROR])
        data = pv.PolyData.from_regular_faces(points, pieces)
        data.point_data.active_normals = normals
        return data

    def fabric(
        self,
        state: Snapshot | None = None,
        low: float = -np.inf,
        high: float = np.inf,
        near: float = np.inf,
        opened: bool = False,
    ) -> list[Drawable]:
        """Strips of fabric, a little off the surface on which they lie.

        Args:
            state: the state; None: undeformed.
            low: least z at rest, mm.
            high: greatest z at rest, mm.
            near: greatest z at rest of what is at x < 0, mm.
            opened: draw x > 0 alone.
        """
        skin = self._clothed()
        if skin is None:
            return []
        data = self.surface(skin, state, self.mesh.half)
        data.points = data.points + _OFF * np.asarray(data.point_data.active_normals)
        rest = np.asarray(self.surface(skin, None, self.mesh.half).points)
        end = np.where(rest[:, 0] < 0, -np.inf if opened else near, high)
        along = np.maximum(low - rest[:, 2], rest[:, 2] - np.minimum(end, high))
        data["along"] = np.where(np.isneginf(end), -rest[:, 0], along)
        return [
            Drawable(part, color=COLORS["fabric"])
            for cloth in self._cut_out(data, rest)
            if (part := cloth.clip_scalar(scalars="along", value=0.0)).n_cells
        ]

    def fabric_in(self, states: Sequence[Floats]) -> tuple[Ints, list[Floats]]:
        """Strips of fabric on the modelled half or whole, in many states.

        Args:
            states: positions of all nodes in each, (n, 3), mm.

        Returns:
            Triangles, (k, 3), and the positions of their points in each state, (m, 3), mm.
        """
        import pyvista as pv

        none = np.zeros((0, 3), dtype=np.int64), [np.zeros((0, 3)) for _ in states]
        skin = self._clothed()
        if skin is None:
            return none
        data = self.surface(skin, None, False)
        for number, nodes in enumerate(states):
            at_cells = nodes[self.mesh.cells]
            data[f"at {number}"] = skin.interpolate(at_cells) + _OFF * skin.normals(at_cells)
        # a cut interpolates whatever is known at points
        strips = self._cut_out(data, np.asarray(data.points))
        if not strips:
            return none
        found = (
            pv.merge(strips, merge_points=False)
            .extract_surface(algorithm="dataset_surface")
            .triangulate()
        )
        triangles: Ints = np.asarray(found.regular_faces).astype(np.int64)
        return triangles, [np.asarray(found[f"at {n}"]) for n in range(len(states))]

    def _clothed(self) -> Tessellation | None:
        """The surface on which strips lie; None without any."""
        pairs = self.mesh.facets.get("winding", np.zeros((0, 2), dtype=np.int64))
        there = self._scenery.actuator is not None and self._scenery.strips and len(pairs)
        return Tessellation(self.mesh, pairs) if there else None

    def _cut_out(self, data: Any, rest: Floats) -> list[Any]:
        """The strips cut out of a surface, those that are on it.

        Args:
            data: the surface as pyvista.PolyData.
            rest: where its points are at rest, (n, 3), mm.
        """
        actuator = self._scenery.actuator
        assert actuator is not None
        perimeter, s = actuator.winding_perimeter, arc_length(actuator, rest[:, :2], rest[:, 0] < 0)
        found = []
        for window in self._scenery.strips:
            apart = (s - window.middle + perimeter / 2) % perimeter - perimeter / 2
            half, (start, end) = window.width / 2, window.ends
            narrow = half < perimeter / 4
            sides = [apart - half, -apart - half] if narrow else [np.abs(apart) - half]
            if np.isfinite(window.ends).any():
                sides.append(np.maximum(start - rest[:, 2], rest[:, 2] - end))
            names = [f"beyond {number}" for number in range(len(sides))]
            for name, side in zip(names, sides, strict=True):
                data[name] = side
            part = data
            if narrow:
                # opposite the strip it jumps, and would pass through all that lies between
                jumps = np.ptp(apart[data.regular_faces], axis=1) > perimeter / 2
                part = data.remove_cells(jumps)
            for name in names:
                part = part.clip_scalar(scalars=name, value=0.0) if part.n_cells else part
            if part.n_cells:
                found.append(part)
        return found

    def fiber_tubes(
        self,
        state: Snapshot | None = None,
        low: float = -np.inf,
        high: float = np.inf,
        near: float = np.inf,
    ) -> list[Drawable]:
        """The fibers as tubes, all around the body.

        Args:
            state: the state; None: undeformed.
            low: least z at rest, mm.
            high: greatest z at rest, mm.
            near: greatest z at rest of those at x < 0, mm.
        """
        mesh, fibers = self.mesh, self.fibers
        if fibers is None:
            return []
        kept = (fibers.z > low) & (fibers.z < high)
        if not kept.any():
            return []
        moved = None if state is None else state.displacement
        if not mesh.half:
            kept &= (fibers.z < near) | (self.middle[fibers.cell, 0] > 0)
        found = self._colored(_select(fibers, kept), fibers.family[kept], moved)
        if mesh.half and (kept & (fibers.z < near)).any():
            shown = kept & (fibers.z < near)
            images = self._images(fibers.family[shown])
            found += [
                dataclasses.replace(tube, data=tube.data.reflect((1, 0, 0)))
                for tube in self._colored(_select(fibers, shown), images, moved)
            ]
        return found

    def _colored(
        self, fibers: EmbeddedFibers, family: Ints, moved: Floats | None
    ) -> list[Drawable]:
        """Tubes of some fibers, in the colour of a family each."""
        colors = self.line_colors or [COLORS["fiber"]]
        number = family if self.line_colors else np.zeros_like(family)
        places = [(color, np.isin(number, _numbers(colors, color))) for color in {*colors}]
        return [
            Drawable(
                fiber_lines(self.mesh, _select(fibers, own), moved),
                color=color,
                radius=FIBER_RADIUS,
            )
            for color, own in sorted(places, key=lambda place: place[0])
            if own.any()
        ]

    def _is_wound(self, pairs: Ints) -> Mask:
        """True for the facets over which a winding is smeared, (k,)."""
        return self._is_in(pairs, "winding") & self.smeared

    def _is_in(self, pairs: Ints, surface: str) -> Mask:
        """True for the facets of a named surface, (k,)."""
        there = self.mesh.facets.get(surface, np.zeros((0, 2), dtype=np.int64))
        key, named = (each @ [8, 1] for each in (pairs, there))
        found: Mask = np.isin(key, named)
        return found

    def _region(self, name: str) -> Mask:
        number = self.mesh.regions.get(name, -1)
        found: Mask = self.mesh.cell_region == number
        return found


def _numbers(colors: list[str], color: str) -> list[int]:
    """Where a colour stands."""
    return [number for number, other in enumerate(colors) if other == color]


def _select(fibers: EmbeddedFibers, kept: Mask) -> EmbeddedFibers:
    fields = dataclasses.fields(fibers)
    return EmbeddedFibers(**{field.name: getattr(fibers, field.name)[kept] for field in fields})


def _one_line_each(fibers: EmbeddedFibers) -> EmbeddedFibers:
    """The middle line of every ribbon."""
    lines = round(1 / float(fibers.share[0]))
    return _select(fibers, fibers.curve % lines == lines // 2)

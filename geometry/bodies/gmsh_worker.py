"""Mesh a body in gmsh: `python -m geometry.bodies.gmsh_worker spec.json out.npz`.

Every point, curve, surface and volume is made from the block layout and the stations, so each
physical group is known by construction.
"""

from __future__ import annotations

import ctypes
import itertools
import json
import signal
import sys
from pathlib import Path
from typing import Any

import gmsh
import numpy as np

from geometry.bodies.gmsh_read import read_mesh
from geometry.bodies.stations import Stations, body_stations
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.mesh.errors import NO_MESH
from geometry.mesh.reference import determinants
from geometry.sections.blocks import SIDES, Layout, Point
from geometry.sections.size import MeshSize, Strips
from geometry.sections.table import make_actuator, section_layout

geo = gmsh.model.geo
Edge = tuple[int, int]

_DELAUNAY, _HXT = 1, 10
_MESH_ADAPT = 1
_FLAT = 1e-4
"""Volume of a tetrahedron, over the median of all, that is flat; round-off of gmsh leaves some."""
_TRIES = 3
_FOLDED = 1e-9
"""det J over the greatest of the mesh: whether less than that is positive is round-off."""
_UNFOLDING = ("HighOrderElastic", "HighOrder")
"""gmsh's ways to move the middles of edges, the quicker one first."""
_PLACED = 1e-9
"""Of the length: how far all nodes may be from where they belong, lest any is moved."""
_DEATH_SIGNAL = 1
"""PR_SET_PDEATHSIG of Linux: the signal to a process whose parent ends."""


class GmshBody:
    """The body as gmsh entities of the built-in kernel.

    Attributes:
        volumes: gmsh volume of each (block, segment).
        groups: gmsh surfaces of each named surface.
        regions: gmsh volumes of each region.
        points: gmsh point of each named point.
    """

    def __init__(self, layout: Layout, stations: Stations, size: MeshSize) -> None:
        self.layout = layout
        self.stations = stations
        self.size = size
        self.structured = size.element == "hexahedron"
        self.volumes: dict[tuple[int, int], int] = {}
        self.groups: dict[str, list[int]] = {}
        self.regions: dict[str, list[int]] = {}
        self._z = [stations.segments[0].start, *(s.end for s in stations.segments)]
        self._points: dict[tuple[Point, int], int] = {}
        self._curves: dict[tuple[Edge, int], int] = {}
        self._axial: dict[tuple[int, int], int] = {}
        self._sections: dict[tuple[int, int], int] = {}
        self._lateral: dict[tuple[Edge, int], int] = {}
        for number, block in enumerate(layout.blocks):
            for i, segment in enumerate(stations.segments):
                if segment.filled or not block.fill:
                    self._add_volume(number, i)
        self._name_surfaces()
        origin = stations.origin
        self.points = {name: self._corner(i, origin) for name, i in layout.named.items()}

    def _point(self, place: Point, plane: int) -> int:
        if (place, plane) not in self._points:
            tag = geo.addPoint(place[0], place[1], self._z[plane], self.size.axial)
            self._points[place, plane] = tag
        return self._points[place, plane]

    def _corner(self, number: int, plane: int) -> int:
        return self._point(self.layout.points[number], plane)

    def _curve(self, edge: Edge, center: Point | None, number: int, plane: int) -> int:
        if (edge, plane) not in self._curves:
            start, end = (self._corner(p, plane) for p in edge)
            if center is None:
                tag = geo.addLine(start, end)
            else:
                tag = geo.addCircleArc(start, self._point(center, plane), end)
            if self.structured:
                geo.mesh.setTransfiniteCurve(tag, number + 1)
            self._curves[edge, plane] = tag
        return self._curves[edge, plane]

    def _axial_line(self, number: int, segment: int) -> int:
        if (number, segment) not in self._axial:
            tag = geo.addLine(self._corner(number, segment), self._corner(number, segment + 1))
            if self.structured:
                divisions = self.stations.segments[segment].divisions
                geo.mesh.setTransfiniteCurve(tag, divisions + 1)
            self._axial[number, segment] = tag
        return self._axial[number, segment]

    def _surface(self, loop: list[int], corners: list[int], flat: bool) -> int:
        wire = geo.addCurveLoop(loop)
        tag = geo.addPlaneSurface([wire]) if flat else geo.addSurfaceFilling([wire])
        if self.structured:
            geo.mesh.setTransfiniteSurface(tag, cornerTags=corners)
            geo.mesh.setRecombine(2, tag)
        return int(tag)

    def _section_surface(self, number: int, plane: int) -> int:
        if (number, plane) not in self._sections:
            block = self.layout.blocks[number]
            loop = []
            for side, forward in ((0, True), (2, True), (3, False), (1, False)):
                a, b = (block.corners[i] for i in SIDES[side])
                count = block.divisions[0 if side in (0, 3) else 1]
                curve = self._curve((min(a, b), max(a, b)), block.centers[side], count, plane)
                loop.append(curve if (a < b) == forward else -curve)
            corners = [self._corner(block.corners[i], plane) for i in (0, 1, 3, 2)]
            self._sections[number, plane] = self._surface(loop, corners, flat=True)
        return self._sections[number, plane]

    def _lateral_surface(self, number: int, side: int, segment: int) -> int:
        block = self.layout.blocks[number]
        a, b = sorted(block.corners[i] for i in SIDES[side])
        if ((a, b), segment) not in self._lateral:
            low, high = self._curves[(a, b), segment], self._curves[(a, b), segment + 1]
            loop = [low, self._axial_line(b, segment), -high, -self._axial_line(a, segment)]
            corners = [
                self._corner(a, segment),
                self._corner(b, segment),
                self._corner(b, segment + 1),
                self._corner(a, segment + 1),
            ]
            flat = block.centers[side] is None
            self._lateral[(a, b), segment] = self._surface(loop, corners, flat)
        return self._lateral[(a, b), segment]

    def _add_volume(self, number: int, segment: int) -> None:
        block = self.layout.blocks[number]
        ends = [self._section_surface(number, segment + i) for i in range(2)]
        sides = [self._lateral_surface(number, side, segment) for side in range(4)]
        tag = geo.addVolume([geo.addSurfaceLoop([*ends, *sides])])
        if self.structured:
            around = [block.corners[i] for i in (0, 1, 3, 2)]
            corners = [self._corner(p, segment + i) for i in range(2) for p in around]
            geo.mesh.setTransfiniteVolume(tag, corners)
        self.volumes[number, segment] = tag
        self.regions.setdefault(block.region, []).append(tag)
        for side, names in enumerate(block.names):
            for name in names:
                if name in self.stations.segments[segment].names:
                    self.groups.setdefault(name, []).append(sides[side])

    def _name_surfaces(self) -> None:
        for (number, plane), surface in self._sections.items():
            ring, fill = self.stations.planes[plane]
            name = fill if self.layout.blocks[number].fill else ring
            if name is not None:
                self.groups.setdefault(name, []).append(surface)

    def straighten(self) -> None:
        """Put the nodes of a structured body where the sweep along z has them.

        gmsh looks for second-order nodes of curved surfaces; some releases of it end up to 1e-6 of
        the length beside. x and y are those of a node in a section's plane, z that of a layer.
        """
        steps = [
            np.linspace(part.start, part.end, 2 * part.divisions + 1)
            for part in self.stations.segments
        ]
        layers = np.unique(np.concatenate(steps))
        tags, places = _nodes()
        above = np.clip(np.searchsorted(layers, places[:, 2]), 1, len(layers) - 1)
        below = places[:, 2] - layers[above - 1] < layers[above] - places[:, 2]
        z = layers[above - below]
        close = _PLACED * np.ptp(layers)
        if np.abs(z - places[:, 2]).max() < close:
            return
        from scipy.spatial import cKDTree

        known = np.concatenate([_nodes(2, tag)[1] for tag in self._sections.values()])[:, :2]
        right = np.column_stack([known[cKDTree(known).query(places[:, :2])[1]], z])
        moved = np.abs(right - places).max(axis=1) > close / 1000
        for tag, place in zip(tags[moved].tolist(), right[moved].tolist(), strict=True):
            gmsh.model.mesh.setNode(tag, place, [])

    def add_groups(self) -> None:
        """Make the physical groups of regions and surfaces."""
        for dim, groups in ((3, self.regions), (2, self.groups)):
            for name, tags in groups.items():
                gmsh.model.setPhysicalName(dim, gmsh.model.addPhysicalGroup(dim, tags), name)


def _nodes(dim: int = -1, tag: int = -1) -> tuple[Ints, Floats]:
    """Tags and places of all nodes, (n,) and (n, 3), or of those in and around an entity."""
    tags, places, _ = gmsh.model.mesh.getNodes(dim, tag, includeBoundary=True)
    return tags, np.reshape(places, (-1, 3))


def add_winding(curves: list[list[list[float]]]) -> None:
    """Add each fiber as a discrete curve of two-node lines, in the physical group "winding"."""
    line = gmsh.model.mesh.getElementType("line", 1)
    entities = []
    first = int(gmsh.model.mesh.getNodes()[0].max()) + 1
    for curve in curves:
        tags = list(range(first, first + len(curve)))
        first += len(curve)
        entity = gmsh.model.addDiscreteEntity(1)
        gmsh.model.mesh.addNodes(1, entity, tags, list(itertools.chain.from_iterable(curve)))
        pairs = np.column_stack([tags[:-1], tags[1:]]).ravel().tolist()
        gmsh.model.mesh.addElementsByType(entity, line, [], pairs)
        entities.append(entity)
    gmsh.model.setPhysicalName(1, gmsh.model.addPhysicalGroup(1, entities), "winding")


def _generate(element: str, first: int, adapted: bool, delaunay: bool) -> None:
    """Mesh the model, tetrahedra until none is flat, from one seed on.

    Raises:
        SystemExit: gmsh finds no mesh, or Delaunay's has flat tetrahedra.
    """
    if adapted:
        gmsh.option.setNumber("Mesh.Algorithm", _MESH_ADAPT)
    # the default algorithm leaves slivers in the thin walls (Jacobians of 1e-4 mm³)
    gmsh.option.setNumber("Mesh.Algorithm3D", _DELAUNAY if delaunay else _HXT)
    _from_seed(first)
    for seed in range(first + 1, first + 1 + _TRIES):
        if element != "tetrahedron" or _flattest() > _FLAT:
            return
        gmsh.model.mesh.optimize("")
        if _flattest() > _FLAT:
            return
        gmsh.model.mesh.clear()
        _from_seed(seed)
    if delaunay and _flattest() <= _FLAT:
        print("tetrahedra are flat", flush=True)
        raise SystemExit(NO_MESH)


def _from_seed(seed: int) -> None:
    gmsh.option.setNumber("Mesh.RandomSeed", seed)
    try:
        gmsh.model.mesh.generate(3)
    except Exception as error:  # gmsh raises no other
        print(error, flush=True)
        raise SystemExit(NO_MESH) from error


def _unfolded(body: GmshBody) -> MeshData:
    """The mesh of order 2, no element of it folded.

    Where edges are long beside the radius of an arc and the thickness of a wall, their middles on
    the arc turn tetrahedra inside out: gmsh then moves the middles within the body.

    Raises:
        SystemExit: it moves them to no avail.
    """

    def read() -> tuple[MeshData, bool]:
        size = body.size
        mesh = read_mesh(size.element, body.regions, body.groups, body.points, size.half)
        sizes = determinants(mesh)
        return mesh, float(sizes.min()) > _FOLDED * float(sizes.max())

    mesh, sound = read()
    for method in _UNFOLDING:
        if sound:
            break
        gmsh.model.mesh.optimize(method)
        mesh, sound = read()
    if not sound:
        raise SystemExit("elements are folded at arcs; shorter ones may do")
    return mesh


def _flattest() -> float:
    """Least volume of a tetrahedron over the median of all."""
    tags, places, _ = gmsh.model.mesh.getNodes()
    order = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    order[tags.astype(np.int64)] = np.arange(len(tags))
    corners = gmsh.model.mesh.getElementsByType(4)[1].reshape(-1, 4).astype(np.int64)
    x = np.reshape(places, (-1, 3))[order[corners]]
    volumes = np.linalg.det(x[:, 1:] - x[:, :1])
    return float((volumes / np.median(volumes)).min())


def mesh_body(spec: dict[str, Any], out: Path) -> None:
    """Mesh the described body and write it to `out`.

    Args:
        spec: dictionaries "actuator", "size", "strips" and lists "winding", all lengths of them in
            the "unit" (mm), in which the mesh too is written; path "msh_path" of a file in mm;
            "seed" of random numbers; "adapted": whether surfaces are triangulated by MeshAdapt;
            "delaunay": whether they are filled by Delaunay's algorithm instead of HXT.
        out: .npz file for `MeshData.load`.
    """
    actuator = make_actuator(spec["actuator"])
    size = MeshSize(**spec["size"] | {"borders": tuple(spec["size"]["borders"])})
    strips = Strips(**spec["strips"]) if spec["strips"] else None
    gmsh.model.add("fiberbend")
    size = size.of_edges() if size.element == "tetrahedron" else size
    layout = section_layout(actuator, size, strips)
    stations = body_stations(actuator, size, strips)
    body = GmshBody(layout, stations, size)
    geo.synchronize()
    body.add_groups()
    _generate(size.element, spec["seed"], spec["adapted"], spec["delaunay"])
    gmsh.model.mesh.setOrder(2)
    if body.structured:
        body.straighten()
    mesh = _unfolded(body)
    mesh.save(out)
    if spec["winding"]:
        add_winding(spec["winding"])
    if spec["msh_path"]:
        gmsh.option.setNumber("Mesh.ScalingFactor", spec["unit"])
        gmsh.write(spec["msh_path"])


def main() -> None:
    """Read the description named first on the command line, write the mesh named second."""
    spec, out = Path(sys.argv[1]), Path(sys.argv[2])
    # killed, the run cannot end it
    ctypes.CDLL(None).prctl(_DEATH_SIGNAL, signal.SIGKILL)
    gmsh.initialize(["fiberbend"], False)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.option.setNumber("Geometry.AutoCoherence", 0)
    try:
        mesh_body(json.loads(spec.read_text()), out)
    finally:
        gmsh.finalize()


if __name__ == "__main__":
    main()

"""Meshes of simple solids for verification, by the same block map as the actuator."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from geometry.bodies.extrude import extrude
from geometry.bodies.quads import section_mesh
from geometry.bodies.stations import Segment, Stations
from geometry.mesh.data import MeshData
from geometry.sections.blocks import Layout, Point

_CORE = 0.55
_CORE_CORNER = 0.62


def prism(layout: Layout, length: float, number: int) -> MeshData:
    """Sweep a layout over 0 ≤ z ≤ `length` (mm) in `number` layers.

    Surfaces: the layout's named sides, "bottom" (z = 0) and "top" (z = `length`).
    """
    names = frozenset(name for b in layout.blocks for side in b.names for name in side)
    stations = Stations(
        (Segment(0.0, length, number, names, False),), (("bottom", None), ("top", None))
    )
    return extrude(section_mesh(layout), stations)


def box(size: tuple[float, float, float], divisions: tuple[int, int, int]) -> MeshData:
    """Box [0, lx] × [0, ly] × [0, lz] in mm.

    Surfaces: "left", "right" (x), "front", "back" (y), "bottom", "top" (z); region "solid".
    """
    x, y = size[0], size[1]
    layout = Layout()
    layout.add(
        "solid",
        ((0.0, 0.0), (x, 0.0), (0.0, y), (x, y)),
        (divisions[0], divisions[1]),
        {},
        {0: ("front",), 1: ("left",), 2: ("right",), 3: ("back",)},
    )
    return prism(layout, size[2], divisions[2])


def tube_sector(
    inner: float, outer: float, angle: float, length: float, divisions: tuple[int, int, int]
) -> MeshData:
    """Sector 0 ≤ φ ≤ `angle` of a tube about the z axis.

    Args:
        inner: inner radius in mm.
        outer: outer radius in mm.
        angle: angle in rad, at most π/2 (the start is the plane y = 0; at π/2 the end is x = 0).
        length: length along z in mm.
        divisions: elements along radius, angle and z.

    Returns:
        Mesh with surfaces "inner", "outer", "start", "end", "bottom", "top"; region "solid".

    Raises:
        ValueError: an angle outside (0, π/2].
    """
    if not 0 < angle <= math.pi / 2:
        raise ValueError(f"angle {angle} rad: expected more than 0 and at most π/2")
    c, s = (0.0, 1.0) if angle == math.pi / 2 else (math.cos(angle), math.sin(angle))
    layout = Layout()
    center = (0.0, 0.0)
    layout.add(
        "solid",
        ((inner, 0.0), (outer, 0.0), (inner * c, inner * s), (outer * c, outer * s)),
        (divisions[0], divisions[1]),
        {1: center, 2: center},
        {0: ("start",), 1: ("inner",), 2: ("outer",), 3: ("end",)},
    )
    return prism(layout, length, divisions[2])


def cylinder(radius: float, length: float, n: int, layers: int, quarter: bool) -> MeshData:
    """Solid round bar about the z axis without singular elements (an O-grid).

    Args:
        radius: radius in mm.
        length: length along z in mm.
        n: elements along a side of the quarter's core, and from the core to the surface.
        layers: elements along z.
        quarter: mesh x ≥ 0, y ≥ 0 only.

    Returns:
        Mesh with surfaces "outer", "bottom", "top" and, of a quarter, "start" (y = 0) and
        "end" (x = 0); region "solid".
    """
    layout = Layout()
    for k in range(1 if quarter else 4):
        _add_quarter(layout, radius, n, k, quarter)
    return prism(layout, length, layers)


def _add_quarter(layout: Layout, radius: float, n: int, k: int, named: bool) -> None:
    cosine, sine = ((1, 0), (0, 1), (-1, 0), (0, -1))[k]

    def turned(x: float, y: float) -> Point:
        return (cosine * x - sine * y, sine * x + cosine * y)

    c, d, e = _CORE * radius, _CORE_CORNER * radius * math.sqrt(0.5), radius * math.sqrt(0.5)
    origin, right, up, corner = turned(0, 0), turned(c, 0), turned(0, c), turned(d, d)
    ends = turned(radius, 0), turned(e, e), turned(0, radius)
    start: tuple[str, ...] = ("start",) if named else ()
    end: tuple[str, ...] = ("end",) if named else ()
    outer = ("outer",)
    center = (0.0, 0.0)
    layout.add("solid", (origin, right, up, corner), (n, n), {}, {0: start, 1: end})
    layout.add(
        "solid", (right, ends[0], corner, ends[1]), (n, n), {2: center}, {0: start, 2: outer}
    )
    layout.add("solid", (up, corner, ends[2], ends[1]), (n, n), {3: center}, {1: end, 3: outer})


def sphere_octant(inner: float, outer: float, divisions: tuple[int, int]) -> MeshData:
    """The octant x, y, z ≥ 0 of a hollow sphere, every node on its sphere.

    Three blocks, one for each face of a cube about the sphere that the octant meets.

    Args:
        inner: inner radius in mm.
        outer: outer radius in mm.
        divisions: elements along the radius, and along each of the two sides of a block.

    Returns:
        Mesh with surfaces "inner", "outer" and, in the planes x, y, z = 0, "left", "front" and
        "bottom"; region "solid".
    """
    across = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]])

    def seen(x: float, y: float, z: float) -> Point:
        """A point of the cube as seen along its diagonal; its three faces fill a hexagon."""
        u, v = across @ (x, y, z)
        return (float(u), float(v))

    n = (divisions[1], divisions[1])
    one = seen(1, 1, 1)
    ends = ("left", "front", "bottom")
    layout = Layout()
    for i in range(3):
        # the face of the cube that lies on axis i + 2, between the two others
        axes = np.roll(np.eye(3), i, axis=0)
        a, b, c = (seen(*row) for row in (axes[2], axes[2] + axes[0], axes[2] + axes[1]))
        names = [ends[int(np.argmax(axes[k]))] for k in range(2)]
        layout.add("solid", (a, b, c, one), n, {}, {0: (names[1],), 1: (names[0],)})
    sides = frozenset(ends)
    stations = Stations(
        (Segment(inner, outer, divisions[0], sides, False),), (("inner", None), ("outer", None))
    )
    flat = extrude(section_mesh(layout), stations)
    plane = flat.nodes[:, :2] @ across
    cube = plane + (1.0 - plane.max(axis=1, keepdims=True))
    cube = np.tan(math.pi / 4 * cube)  # nearly equal elements
    nodes = flat.nodes[:, 2:] * cube / np.linalg.norm(cube, axis=1, keepdims=True)
    return dataclasses.replace(flat, nodes=nodes)

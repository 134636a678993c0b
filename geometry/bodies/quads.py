"""Order-2 quadrilaterals of a block layout, by transfinite interpolation of the sides."""

from __future__ import annotations

import math

import numpy as np

from geometry.mesh.data import Floats, Ints, MeshData
from geometry.sections.blocks import (
    SIDES,
    Block,
    Layout,
    Point,
)


def side_points(start: Point, end: Point, center: Point | None, number: int) -> Floats:
    """Evenly spaced points on a straight or circular side.

    Args:
        start: first end in mm.
        end: last end in mm.
        center: centre of the circle (the shorter arc is taken), or None for a straight side.
        number: number of intervals.

    Returns:
        Array (number + 1, 2) of coordinates in mm; the ends are exact.
    """
    t = np.linspace(0.0, 1.0, number + 1)[:, None]
    if center is None:
        points = (1 - t) * np.array(start) + t * np.array(end)
    else:
        arms = np.array([start, end]) - np.array(center)
        first, last = np.arctan2(arms[:, 1], arms[:, 0])
        turn = (last - first + math.pi) % (2 * math.pi) - math.pi
        radius = np.hypot(arms[:, 0], arms[:, 1])
        r, angle = (1 - t) * radius[0] + t * radius[1], first + t * turn
        points = np.array(center) + np.hstack([r * np.cos(angle), r * np.sin(angle)])
    points[0], points[-1] = start, end
    return points


def _transfinite(sides: list[Floats]) -> Floats:
    """Interior and border points of a block, (nv + 1, nu + 1, 2), from its four sides."""
    bottom, left, right, top = sides
    u = np.linspace(0.0, 1.0, len(bottom))[None, :, None]
    v = np.linspace(0.0, 1.0, len(left))[:, None, None]
    corners = (
        (1 - u) * (1 - v) * bottom[0]
        + u * (1 - v) * bottom[-1]
        + (1 - u) * v * top[0]
        + u * v * top[-1]
    )
    return (
        (1 - v) * bottom[None] + v * top[None] + (1 - u) * left[:, None] + u * right[:, None]
    ) - corners


class _Nodes:
    """Nodes of a layout, numbered once per corner point and once per side."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.coordinates: list[Floats] = [np.array(layout.points)]
        self.count = len(layout.points)
        self._sides: dict[tuple[int, int], tuple[Ints, Floats]] = {}

    def _append(self, points: Floats) -> Ints:
        self.coordinates.append(points.reshape(-1, 2))
        numbers = np.arange(self.count, self.count + len(self.coordinates[-1]))
        self.count += len(numbers)
        return numbers

    def _side(self, start: int, end: int, center: Point | None, n: int) -> tuple[Ints, Floats]:
        low, high = min(start, end), max(start, end)
        if (low, high) not in self._sides:
            points = side_points(self.layout.points[low], self.layout.points[high], center, n)
            numbers = np.concatenate([[low], self._append(points[1:-1]), [high]])
            self._sides[low, high] = numbers, points
        numbers, points = self._sides[low, high]
        if len(numbers) != n + 1:
            raise ValueError(f"blocks meet at points {low}, {high} with different divisions")
        return (numbers, points) if start == low else (numbers[::-1], points[::-1])

    def grid(self, block: Block) -> Ints:
        """Node numbers of a block, (2 nv + 1, 2 nu + 1)."""
        nu, nv = 2 * block.divisions[0], 2 * block.divisions[1]
        sides = [
            self._side(block.corners[a], block.corners[b], center, n)
            for (a, b), center, n in zip(SIDES, block.centers, (nu, nv, nv, nu), strict=True)
        ]
        numbers = np.empty((nv + 1, nu + 1), dtype=np.int64)
        (numbers[0], numbers[:, 0], numbers[:, -1], numbers[-1]) = (side[0] for side in sides)
        inside = _transfinite([side[1] for side in sides])[1:-1, 1:-1]
        numbers[1:-1, 1:-1] = self._append(inside).reshape(nv - 1, nu - 1)
        return numbers


def _block_cells(grid: Ints) -> Ints:
    """Cells (nv * nu, 9) of a node grid, u fastest."""
    nv, nu = (grid.shape[0] - 1) // 2, (grid.shape[1] - 1) // 2
    parts = [
        grid[j : j + 2 * nv : 2, i : i + 2 * nu : 2].ravel() for j in range(3) for i in range(3)
    ]
    return np.stack(parts, axis=1)


def section_mesh(layout: Layout) -> MeshData:
    """Mesh a layout with 9-node quadrilaterals.

    Args:
        layout: the blocks; neighbours must have the same divisions on their common side.

    Returns:
        Two-dimensional mesh with the layout's regions, named sides and named points; nodes of
        curved sides lie on their circle.

    Raises:
        ValueError: neighbours with different divisions.
    """
    nodes = _Nodes(layout)
    regions: dict[str, int] = {}
    cells: list[Ints] = []
    cell_region: list[Ints] = []
    facets: dict[str, list[Ints]] = {}
    first = 0
    for block in layout.blocks:
        block_cells = _block_cells(nodes.grid(block))
        region = regions.setdefault(block.region, len(regions))
        numbers = first + np.arange(len(block_cells)).reshape(block.divisions[::-1])
        on_side = (numbers[0], numbers[:, 0], numbers[:, -1], numbers[-1])
        for side, names in enumerate(block.names):
            pairs = np.column_stack([on_side[side], np.full(len(on_side[side]), side)])
            for name in names:
                facets.setdefault(name, []).append(pairs)
        cells.append(block_cells)
        cell_region.append(np.full(len(block_cells), region))
        first += len(block_cells)
    used, numbering = np.unique(np.concatenate(cells), return_inverse=True)
    return MeshData(
        cell_type="quadrilateral",
        nodes=np.concatenate(nodes.coordinates)[used],
        cells=numbering.reshape(-1, 9),
        regions=regions,
        cell_region=np.concatenate(cell_region),
        facets={name: np.concatenate(pairs) for name, pairs in facets.items()},
        half=layout.half,
        points={name: int(np.searchsorted(used, i)) for name, i in layout.named.items()},
    )

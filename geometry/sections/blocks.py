"""A section as quadrilateral blocks with straight or circular sides.

Corners and sides follow the UFC quadrilateral: corners (0,0), (1,0), (0,1), (1,1); sides v = 0,
u = 0, u = 1, v = 1. Blocks meet in whole sides, so meshes conform and names follow from the
layout.
"""

from __future__ import annotations

import dataclasses

from geometry.actuator import Point

SIDES = ((0, 1), (0, 2), (1, 3), (2, 3))
"""Corners at the ends of each side."""

_MIRRORED_SIDES = (0, 2, 1, 3)

_BESIDE = (0.0, 1e-10, -1e-10)
"""More than round-off of a coordinate, and less than what rounds to another key but one."""


@dataclasses.dataclass(frozen=True)
class Block:
    """One block of a layout.

    Attributes:
        region: name of its region.
        corners: numbers of its four corner points; the block must be positively oriented.
        divisions: number of quads along u and v.
        centers: for each side the centre of its circle, or None for a straight side.
        names: for each side the surfaces it belongs to.
        fill: True for a block that closes the chamber, present in the caps only.
    """

    region: str
    corners: tuple[int, int, int, int]
    divisions: tuple[int, int]
    centers: tuple[Point | None, Point | None, Point | None, Point | None]
    names: tuple[tuple[str, ...], ...]
    fill: bool = False


def _key(point: Point) -> Point:
    """What corner this is: apart by less than 1e-9 of the unit in which a section is 3 to 30."""
    return (round(point[0], 9), round(point[1], 9))


class Layout:
    """Points and blocks of a section.

    Attributes:
        points: coordinates in mm of the corner points.
        blocks: the blocks, in the order of their cells.
        half: True when only x ≥ 0 is laid out and x = 0 is a mirror plane.
        named: number of each named corner point.
    """

    def __init__(self, half: bool = False) -> None:
        self.points: list[Point] = []
        self.blocks: list[Block] = []
        self.half = half
        self.named: dict[str, int] = {}
        self._numbers: dict[Point, int] = {}

    def add(
        self,
        region: str,
        corners: tuple[Point, Point, Point, Point],
        divisions: tuple[int, int],
        centers: dict[int, Point],
        names: dict[int, tuple[str, ...]],
        fill: bool = False,
    ) -> None:
        """Append a block given by coordinates.

        Args:
            region: name of its region.
            corners: its corner points in mm, in UFC order.
            divisions: number of quads along u and v.
            centers: centre in mm of each curved side.
            names: surfaces of each named side.
            fill: the block closes the chamber.
        """
        a, b, c, d = (self._number(p) for p in corners)
        self.blocks.append(
            Block(
                region,
                (a, b, c, d),
                divisions,
                (centers.get(0), centers.get(1), centers.get(2), centers.get(3)),
                tuple(names.get(side, ()) for side in range(4)),
                fill,
            )
        )

    def name_point(self, name: str, point: Point) -> None:
        """Name a corner point of blocks already laid out.

        Args:
            name: its name in the meshes.
            point: its coordinates in mm.

        Raises:
            KeyError: no block has a corner there.
        """
        self.named[name] = self._known(point)

    def _known(self, point: Point) -> int:
        """The corner at a point: two sums of one length may be rounded to two keys."""
        for across in _BESIDE:
            for up in _BESIDE:
                number = self._numbers.get(_key((point[0] + across, point[1] + up)))
                if number is not None:
                    return number
        raise KeyError(point)

    def _number(self, point: Point) -> int:
        try:
            return self._known(point)
        except KeyError:
            self._numbers[_key(point)] = len(self.points)
            self.points.append(point)
            return len(self.points) - 1

    def mirrored(self) -> Layout:
        """The full section of a half one: its blocks, then their images in x = 0."""
        full = Layout()
        for block in self.blocks:
            names = {i: tuple(n for n in s if n != "symmetry") for i, s in enumerate(block.names)}
            centers = {i: c for i, c in enumerate(block.centers) if c is not None}
            a, b, c, d = (self.points[i] for i in block.corners)
            full.add(block.region, (a, b, c, d), block.divisions, centers, names, block.fill)
        for block in full.blocks[:]:
            a, b, c, d = ((-full.points[i][0], full.points[i][1]) for i in block.corners)
            sides = [_MIRRORED_SIDES[i] for i in range(4)]
            names = {i: block.names[side] for i, side in enumerate(sides)}
            centers = {
                i: (-center[0], center[1])
                for i, side in enumerate(sides)
                if (center := block.centers[side]) is not None
            }
            full.add(block.region, (b, a, d, c), block.divisions, centers, names, block.fill)
        for name, number in self.named.items():
            full.name_point(name, self.points[number])
        return full

    def scaled(self, unit: float) -> Layout:
        """The same layout in mm, of one in another unit (mm); no corner can be added to it."""
        if unit == 1.0:  # exact: a power of ten, and mm themselves
            return self
        scaled = Layout(self.half)
        scaled.points = [(unit * x, unit * y) for x, y in self.points]
        scaled.named = self.named

        def in_mm(center: Point | None) -> Point | None:
            return None if center is None else (unit * center[0], unit * center[1])

        for block in self.blocks:
            a, b, c, d = block.centers
            centers = in_mm(a), in_mm(b), in_mm(c), in_mm(d)
            scaled.blocks.append(dataclasses.replace(block, centers=centers))
        return scaled

    def without_fill(self) -> Layout:
        """The same layout with an open chamber."""
        ring = Layout(self.half)
        ring.points = self.points
        ring.named = self.named
        ring.blocks = [block for block in self.blocks if not block.fill]
        return ring

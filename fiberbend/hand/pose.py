"""Where a finger stands in the world: a turn and a place. No numpy: a file is checked with it."""

from __future__ import annotations

import dataclasses
import math

Triple = tuple[float, float, float]
Turn = tuple[Triple, Triple, Triple]
"""Rows of a rotation."""

NO_TURN: Turn = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
_SAME = 1e-6


@dataclasses.dataclass(frozen=True)
class Pose:
    """The axes and the origin of a finger's case in the world.

    Attributes:
        turn: its axes as columns.
        place: of its origin, mm.
    """

    turn: Turn = NO_TURN
    place: Triple = (0.0, 0.0, 0.0)

    def at(self, point: Triple) -> Triple:
        """A point of the case in the world, mm."""
        return plus(turned(self.turn, point), self.place)

    def axis(self, number: int) -> Triple:
        """x, y or z of the case in the world."""
        x, y, z = (row[number] for row in self.turn)
        return x, y, z

    def local(self, vector: Triple) -> Triple:
        """A direction of the world in the case's axes."""
        x, y, z = (dot(self.axis(number), vector) for number in range(3))
        return x, y, z


def dot(a: Triple, b: Triple) -> float:
    """a·b."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def plus(a: Triple, b: Triple, times: float = 1.0) -> Triple:
    """a + t b."""
    x, y, z = (p + times * q for p, q in zip(a, b, strict=True))
    return x, y, z


def turned(turn: Turn, vector: Triple) -> Triple:
    """R v."""
    x, y, z = (dot(row, vector) for row in turn)
    return x, y, z


def after(second: Turn, first: Turn) -> Turn:
    """One rotation after another."""
    columns = tuple(zip(*first, strict=True))
    x, y, z = (turned(second, column) for column in columns)
    a, b, c = zip(x, y, z, strict=True)
    return a, b, c


def about(axis: Triple, angle: float) -> Turn:
    """The rotation about an axis of any length, angle in rad, by Rodrigues' formula."""
    size = math.hypot(*axis)
    x, y, z = (value / size for value in axis)
    c, s = math.cos(angle), math.sin(angle)
    rest = 1 - c
    return (
        (c + rest * x * x, rest * x * y - s * z, rest * x * z + s * y),
        (rest * x * y + s * z, c + rest * y * y, rest * y * z - s * x),
        (rest * x * z - s * y, rest * y * z + s * x, c + rest * z * z),
    )


@dataclasses.dataclass(frozen=True)
class Mirror:
    """The plane in which a finger bends: x = 0 of its case.

    Attributes:
        normal: x of its case in the world.
        point: its origin, mm.
    """

    normal: Triple
    point: Triple

    @classmethod
    def of(cls, pose: Pose) -> Mirror:
        """That of a finger."""
        return cls(pose.axis(0), pose.place)

    def direction(self, vector: Triple) -> Triple:
        """A direction as the mirror shows it."""
        return plus(vector, self.normal, -2 * dot(self.normal, vector))

    def image(self, point: Triple) -> Triple:
        """A point as the mirror shows it, mm."""
        away = dot(self.normal, plus(point, self.point, -1.0))
        return plus(point, self.normal, -2 * away)

    def shows(self, pose: Pose, other: Pose, size: float) -> bool:
        """Whether a finger, which is like itself in its own mirror, is another one in this.

        Args:
            pose: of the finger.
            other: of the other one.
            size: length in mm of which a millionth is no difference.
        """
        near = same(self.image(pose.place), other.place, size)
        x = plus((0.0, 0.0, 0.0), self.direction(pose.axis(0)), -1.0)
        axes = (x, self.direction(pose.axis(1)), self.direction(pose.axis(2)))
        return near and all(same(axis, other.axis(n), 1.0) for n, axis in enumerate(axes))

    def keeps(self, vector: Triple) -> bool:
        """Whether a direction of length one lies in it."""
        return abs(dot(self.normal, vector)) < _SAME

    def holds(self, point: Triple, size: float) -> bool:
        """Whether a point lies in it, to a millionth of a size in mm."""
        return abs(dot(self.normal, plus(point, self.point, -1.0))) < _SAME * size


def same(a: Triple, b: Triple, size: float) -> bool:
    """Whether two places or directions are one, to a millionth of a size."""
    return math.dist(a, b) < _SAME * size


def unit(vector: Triple) -> Triple:
    """A direction with the length one."""
    return plus((0.0, 0.0, 0.0), vector, 1 / math.hypot(*vector))

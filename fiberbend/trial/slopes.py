"""Derivatives of points with respect to numbers of a case, by the tangent at each of them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

from fiberbend.case.case import Case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.reading import Reader
from fiberbend.trial.wanted import Point
from fiberbend.trial.ways import MAKE, Goal, Way
from fiberbend.uniform.small import Small
from fiberbend.uniform.tangent import Tangent

STEP = 1e-4
"""Change of a number, as a part of it: its square is what is missed, round-off 1e-14 over it."""
_SIDES = (
    ((1.0, 0.5), (-1.0, -0.5)),
    ((1.0, 2.0), (2.0, -0.5)),
    ((-1.0, -2.0), (-2.0, 0.5)),
)
"""Steps and weights, the point itself having what is left: to both sides, or where the elements of
the mesh change in number on one of them, to the other."""


@dataclasses.dataclass(frozen=True)
class _States:
    """States of one way with their tangents.

    Attributes:
        case: under their load.
        small: their scene.
        tangents: by goal.
        points: what is told of each.
    """

    case: Case
    small: Small
    tangents: Mapping[Goal, Tangent]
    points: Mapping[Goal, Point]


class Touched:
    """Tangents at the states of several ways on one scene, and what they say of other numbers."""

    def __init__(self) -> None:
        self._touched: list[_States] = []

    def touch(self, way: Way, points: Mapping[Goal, Point]) -> None:
        """Take the tangents at the states of a way, on whose scene no other has been since.

        Args:
            way: the states.
            points: what is told of them.
        """
        if way.small is not None:
            small = way.small
            tangents = {
                goal: Tangent(small, state, MAKE[goal.kind][1])
                for goal, state in way.states.items()
            }
            self._touched.append(_States(way.ready.case, small, tangents, points))

    def along(self, field: str) -> dict[Goal, Point]:
        """By state, the derivative of everything that is told of it.

        Args:
            field: dotted path of a number of the case.

        Raises:
            CaseError: a path leads to no number, or to one with which the mesh jumps on both sides.
        """
        if not self._touched:
            return {}
        value = number(self._touched[0].case, field)
        size = STEP * abs(value) or STEP
        for sides in _SIDES:
            parts = [(0.0 - sum(weight for _, weight in sides), self._points())]
            for step, weight in sides:
                near = self._near(field, value + step * size)
                if near is None:
                    break
                parts.append((weight, near))
            if len(parts) > len(sides):
                return {
                    goal: combined([(weight / size, part[goal]) for weight, part in parts])
                    for goal in parts[0][1]
                }
        text = f"{value:g}, at which mesh or law are others to both sides: no derivative"
        raise CaseError([Problem(field, text)])

    def _points(self) -> dict[Goal, Point]:
        return {goal: point for one in self._touched for goal, point in one.points.items()}

    def _near(self, field: str, value: float) -> dict[Goal, Point] | None:
        """What is told of the states under another number; None: the mesh is another one."""
        found: dict[Goal, Point] = {}
        for one in self._touched:
            near = Small(with_number(one.case, field, value), one.small)
            if near.scene is not one.small.scene:
                return None
            reader = Reader(near)
            for goal, tangent in one.tangents.items():
                found[goal] = reader.point(tangent.step(near, goal.value))
        return found


def combined(parts: Sequence[tuple[float, Point]]) -> Point:
    """A weighted sum of points, number by number."""
    names = [item.name for item in dataclasses.fields(Point)]
    sums = (sum(weight * getattr(point, name) for weight, point in parts) for name in names)
    return Point(*sums)

"""Derivatives of points with respect to numbers of a case, by the tangent at each of them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

from fiberbend.case.case import Case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.calibrations import Ready, enters, recalibrated
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.reading import Reader
from fiberbend.trial.wanted import Point
from fiberbend.trial.ways import MAKE, Goal, Way
from fiberbend.uniform.small import Small
from fiberbend.uniform.tangent import Tangent

STEP = 1e-4
"""Change of a number, as a part of it: its square is what is missed, round-off 1e-14 over it."""
FAR = 0.05
"""The same for calibrations, whose numbers carry what the fit leaves, 0.01 to 0.1 %."""
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
        ready: the case under their load.
        small: their scene.
        tangents: by goal.
        points: what is told of each.
    """

    ready: Ready
    small: Small
    tangents: Mapping[Goal, Tangent]
    points: Mapping[Goal, Point]

    def along(self, field: str) -> dict[Goal, Point]:
        """Derivatives with the calibration as it is."""
        case = self.ready.case
        value = number(case, field)
        size = STEP * abs(value) or STEP
        for sides in _SIDES:
            parts = [(0.0 - sum(weight for _, weight in sides), self.points)]
            for step, weight in sides:
                near = self._near(with_number(case, field, value + step * size))
                if near is None:
                    break
                parts.append((weight, near))
            if len(parts) > len(sides):
                return self._sum([(weight / size, part) for weight, part in parts])
        text = f"{value:g}, at which mesh or law are others to both sides: no derivative"
        raise CaseError([Problem(field, text)])

    def through_calibration(self, field: str) -> dict[Goal, Point]:
        """What the change of the calibration adds; empty where it has none."""
        waited = self.ready.waited
        if waited is None:
            return {}
        value = number(waited, field)
        size = FAR * abs(value) or FAR
        parts = []
        for step in (size, -size):
            other = with_number(waited, field, value + step)
            if not enters(waited, other):
                return {}
            near = self._near(recalibrated(waited, other))
            assert near is not None, "the same mesh"
            parts.append((0.5 / step, near))
        return self._sum(parts)

    def _near(self, case: Case) -> Mapping[Goal, Point] | None:
        """What is told of the states of a case nearby; None: its mesh or its law is another one."""
        near = Small(case, self.small)
        if near.scene is not self.small.scene:
            return None
        reader = Reader(near)
        return {
            goal: reader.point(tangent.step(near, goal.value))
            for goal, tangent in self.tangents.items()
        }

    def _sum(self, parts: Sequence[tuple[float, Mapping[Goal, Point]]]) -> dict[Goal, Point]:
        return {
            goal: combined([(weight, part[goal]) for weight, part in parts])
            for goal in self.tangents
        }


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
            self._touched.append(_States(way.ready, small, tangents, points))

    def along(self, field: str) -> dict[Goal, Point]:
        """By state, the derivative of everything that is told of it.

        That of a winding that waited for its calibration has the change of the calibration in it:
        the case is calibrated with a larger and a smaller number.

        Args:
            field: dotted path of a number of the case.

        Raises:
            CaseError: a path leads to no number, or to one with which the mesh jumps on both sides;
                a case beside it cannot be calibrated.
        """
        found: dict[Goal, Point] = {}
        for one in self._touched:
            rates = one.along(field)
            through = one.through_calibration(field)
            for goal, rate in rates.items():
                parts = [(1.0, rate), (1.0, through[goal])] if through else [(1.0, rate)]
                found[goal] = combined(parts)
        return found


def combined(parts: Sequence[tuple[float, Point]]) -> Point:
    """A weighted sum of points, number by number."""
    names = [item.name for item in dataclasses.fields(Point)]
    sums = (sum(weight * getattr(point, name) for weight, point in parts) for name in names)
    return Point(*sums)

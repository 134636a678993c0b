"""Steps of a rod along one load: requests, limit points, touches, stability."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from fem.march.records import Critical
from fiberbend.effects.records import RodRamp
from fiberbend.slender.points import PRESSURE, SAME, EndedError, Point
from rod.functions import Floats
from rod.statics import (
    TOUCH,
    Held,
    NoEquilibriumError,
    Volume,
    closing,
    solve,
    until_touch,
    way,
)

if TYPE_CHECKING:
    from fiberbend.slender.path import Course

BEYOND = 4.0
"""How far beyond a limit point the falling branch is followed, as a factor of the volume there; of
a vacuum as a part."""
_CUT = 0.25
_GROW = 1.5
_NEAR = 0.2
"""Part of a step by which one may be longer where that ends at a goal."""
_LEAST = 1e-4
"""Of a load: steps shorter than this part of it are those before its greatest value."""
_AWAY = 0.5
"""Greatest way from what is foreseen to a state, rad or stretch: beyond it another may be met."""
_HALVINGS = 24


class Drive:
    """Steps along one load, by its own value or by what is given in its place."""

    def __init__(
        self, course: Course, ramp: RodRamp, held: Held | None, until: float | None, begin: float
    ) -> None:
        self._course, self._ramp, self._held, self._until = course, ramp, held, until
        self._rod, self._begin = course._rod, begin
        self._base = dict(course.points[-1].values)
        self._path = course._path(self._base, ramp.load)
        self._size = math.inf
        self._s = begin
        self._before: tuple[float, Floats] | None = None
        self._largest = math.inf
        if held is None and ramp.load == PRESSURE:
            largest, first = course._requests.largest, course._requests.first
            self._largest = math.inf if largest is None else largest
            self._size = math.inf if first is None else first

    def to(self, goal: float) -> bool:
        """Go to a value of what is driven; whether it came there."""
        cutbacks, limits = 0, self._course._limits
        total = abs(self._ramp.target - self._begin) or 1.0
        beyond = math.inf
        while self._s != goal:
            point = self._course.points[-1]
            try:
                ahead, share = self._ahead(point)
            except NoEquilibriumError as error:
                return self._fail(str(error))
            most = limits.turn / max(way(self._rod, ahead), 1e-12 / total)
            size = min(most, self._size, self._largest)
            if most < _LEAST * total and self._held is None:
                return self._limit_before(point)
            left = abs(goal - self._s)
            size = left if left <= (1 + _NEAR) * size else size
            whole, size = size, self._until_touch(point, ahead, share, size, goal, beyond)
            step = math.copysign(size, goal - self._s)
            s = goal if size == left else self._s + step
            try:
                new = self._solve(s, self._foreseen(point, ahead, step), share, step)
            except NoEquilibriumError as error:
                cutbacks += 1
                self._course.report.cutbacks += 1
                self._size = _CUT * size
                if cutbacks > limits.cutbacks or self._size < 1e-9 * total:
                    return self._fail(str(error))
                continue
            touches = bool(closing(self._rod, point.state, new.state.shape, new.state.level))
            if touches and size > TOUCH * whole:
                beyond = size
                continue
            beyond = math.inf
            # a touch is a kink: what the slope did before tells nothing of what it does beyond
            self._before = None if touches else (self._s, ahead)
            cut = size == left or size < whole
            cutbacks, self._size = 0, max(_GROW * size, self._size if cut else 0.0)
            self._accept(point, new, s)
        return True

    # --- a step --------------------------------------------------------------------------------

    def _ahead(self, point: Point) -> tuple[Floats, tuple[float, float]]:
        """dε/ds, (n, m), and the load with its slope dq/ds."""
        rod, level = self._rod, point.state.level
        q, change = point.values.get(self._ramp.load, 0.0), self._path.end.less(self._path.start)
        shape = point.state.shape
        try:
            by_load = -np.linalg.solve(
                point.state.tangent, rod.growth(shape, level, change).ravel()
            ).reshape(rod.layout.shape)
        except np.linalg.LinAlgError:
            raise NoEquilibriumError("the tangent is singular") from None
        if self._held is None:
            return by_load, (q, 1.0)
        row, own = self._held.slopes(rod, point.state.strains, level, change)
        rate = float(np.sum(row * by_load)) + own
        if abs(rate) * max(abs(self._ramp.target), 1.0) < 1e-12:
            text = f"the {self._ramp.load} does not change what is given: {self._words()}"
            raise NoEquilibriumError(text)
        return by_load / rate, (q, 1.0 / rate)

    def _foreseen(self, point: Point, ahead: Floats, step: float) -> Floats:
        """Strains a step further, by the slope and how that has changed in the last step."""
        strains: Floats = point.state.strains + step * ahead
        if self._before is not None and self._s != self._before[0]:
            last, slope = self._before
            strains = strains + step**2 / 2 * (ahead - slope) / (self._s - last)
        return strains

    def _until_touch(
        self,
        point: Point,
        ahead: Floats,
        share: tuple[float, float],
        size: float,
        goal: float,
        beyond: float,
    ) -> float:
        """A step that ends where something is touched for the first time.

        Args:
            point: where it begins.
            ahead: slope of the strains.
            share: the load with its slope.
            size: of the step without a touch.
            goal: to which it leads.
            beyond: size of a step that is known to end too far beyond a touch.
        """
        step = math.copysign(size, goal - self._s)
        shape = self._rod.shape(self._foreseen(point, ahead, step))
        foreseen = self._path.at(share[0] + share[1] * step)
        meets = closing(self._rod, point.state, shape, foreseen)
        if not meets and beyond == math.inf:
            return size
        return size * min(1.0, until_touch(meets, 1.0, beyond / size))

    def _words(self) -> str:
        return {"conjugate": "the volume", "control": "the angle"}.get(self._ramp.drive, "")

    def _solve(self, s: float, guess: Floats, share: tuple[float, float], step: float) -> Point:
        q, slope = share
        last = self._course.points[-1].state
        state = solve(self._rod, guess, self._path, s, self._held, q + slope * step, last)
        if way(self._rod, state.strains - guess) > _AWAY:
            raise NoEquilibriumError("a state far from the last one was found")
        return self._course._point(state, {**self._base, self._ramp.load: state.share})

    def _accept(self, old: Point, new: Point, s: float) -> None:
        """Keep a state, those before it that are asked for, and where stability is lost."""
        self._critical(old, new)
        for goal in self._crossed(old, new):
            found = self._at_angle(old, new, goal)
            if found is None:
                continue
            if abs(new.angle - found.angle) > SAME * max(1.0, abs(goal)):
                self._course._add(found, self._part(found))
            else:
                new = dataclasses.replace(new, angle=goal)
            if goal == self._until:
                if abs(new.angle - goal) <= SAME:
                    self._course._add(new, self._part(new))
                self._course.report.ended_at = goal
                raise EndedError
        self._s = s
        self._course._add(new, self._part(new))

    def _part(self, point: Point) -> float:
        level = self._course._slender.level(point.values)
        driven = point.values[self._ramp.load]
        if self._held is not None:
            driven = self._held.value(self._rod, point.state.strains, level)
        return (driven - self._begin) / ((self._ramp.target - self._begin) or 1.0)

    def _crossed(self, old: Point, new: Point) -> Iterator[float]:
        """Angles that are asked for, between two states or at the second, in their order."""
        asked = set(self._course._requests.at_angles)
        if self._ramp.drive == "control":
            asked = set()
        asked |= set() if self._until is None else {self._until}
        low, high = sorted((old.angle, new.angle))
        slack = SAME * max(1.0, abs(high), abs(low))
        found = {a for a in asked if low - slack <= a <= high + slack}
        found -= {a for a in found if abs(a - old.angle) <= slack}
        yield from sorted(found, reverse=new.angle < old.angle)

    def _at_angle(self, old: Point, new: Point, goal: float) -> Point | None:
        """The state at an angle between two."""
        part = (goal - old.angle) / (new.angle - old.angle)
        strains = (1 - part) * old.state.strains + part * new.state.strains
        q = (1 - part) * old.values.get(self._ramp.load, 0.0)
        q += part * new.values[self._ramp.load]
        try:
            state = solve(self._rod, strains, self._path, goal, self._course._bend, q, old.state)
        except NoEquilibriumError:
            return None
        values = {**self._base, self._ramp.load: state.share}
        return dataclasses.replace(self._course._point(state, values), angle=goal)

    # --- limits and stability --------------------------------------------------------------------

    def _critical(self, old: Point, new: Point) -> None:
        """Where between two states the number of unstable modes changes, and what it is there."""
        before, after = old.state.unstable, new.state.unstable
        if before == after or not self._course.tells:
            return
        low, high = old, new
        for _ in range(_HALVINGS):
            middle = self._between(low, high)
            if middle is None:
                break
            low, high = (middle, high) if middle.state.unstable == before else (low, middle)
        slopes = [self._ahead_or_none(each) for each in (old, new)]
        turned = None not in slopes and slopes[0] * slopes[1] < 0  # type: ignore[operator]
        limit = turned and self._held is not None
        self._course.report.critical.append(
            Critical(
                kind="limit" if limit else "bifurcation",
                scalar=self._ramp.load,
                value=high.values[self._ramp.load],
                conjugate=self._rod.volume(high.state.strains, high.values.get(PRESSURE, 0.0)),
                control=high.angle,
                before=before,
                after=after,
                side="" if limit or after < before else "not looked for",
            )
        )

    def _ahead_or_none(self, point: Point) -> float | None:
        try:
            return self._ahead(point)[1][1]
        except NoEquilibriumError:
            return None

    def _between(self, low: Point, high: Point) -> Point | None:
        """The state halfway between two that are near each other."""
        s = (self._value(low) + self._value(high)) / 2
        strains = (low.state.strains + high.state.strains) / 2
        q = (low.values.get(self._ramp.load, 0.0) + high.values[self._ramp.load]) / 2
        try:
            return self._solve(s, strains, (q, 0.0), 0.0)
        except NoEquilibriumError:
            return None

    def _value(self, point: Point) -> float:
        if self._held is None:
            return point.values.get(self._ramp.load, 0.0)
        level = self._course._slender.level(point.values)
        return self._held.value(self._rod, point.state.strains, level)

    def _limit_before(self, point: Point) -> bool:
        """A load has its greatest value here: the falling branch by the volume, and no goal."""
        report = self._course.report
        report.status = "stopped"
        if self._ramp.load != PRESSURE or not self._course.tells:
            report.status = "failed"
            report.reason = f"the {self._ramp.load} has its greatest value"
            return False
        volume = self._rod.volume(point.state.strains, point.values.get(PRESSURE, 0.0))
        vacuum = point.values.get(PRESSURE, 0.0) < 0
        target = volume / BEYOND if vacuum else volume * BEYOND
        ramp = dataclasses.replace(self._ramp, target=target, drive="conjugate")
        beyond = Drive(self._course, ramp, Volume(), self._until, volume)
        report.status = "converged"
        beyond.to(ramp.target)
        found, report.status = report.status, "stopped"
        if not any(each.after > each.before for each in report.critical):
            # no limit that the branch beyond shows: what stopped it is no greatest value
            report.status = "failed"
            report.reason = report.reason or "steps become too short"
        elif found == "converged":
            report.reason = ""
        return False

    def _fail(self, why: str) -> bool:
        report = self._course.report
        report.status, report.reason = "failed", why
        return False

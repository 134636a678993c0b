"""The path of a rod through the loads of a case: steps, requests, limit points, stability."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping

import numpy as np

from fem.march.records import Critical, Report
from fiberbend.effects.records import Requests, RodRamp
from fiberbend.slender.actuator import Slender
from rod.functions import Floats
from rod.statics import (
    Angle,
    Held,
    NoEquilibriumError,
    Path,
    State,
    Volume,
    solve,
    way,
)

PRESSURE = "pressure"
BEYOND = 4.0
"""How far beyond a limit point the falling branch is followed, as a factor of the volume there."""
_CUT = 0.25
_GROW = 1.5
_NEAR = 0.2
"""Part of a step by which one may be longer where that ends at a goal."""
_LEAST = 1e-4
"""Of a load: steps shorter than this part of it are those before its greatest value."""
_AWAY = 0.5
"""Greatest way from what is foreseen to a state, rad or stretch: beyond it another may be met."""
_SAME = 1e-9
_HALVINGS = 24


@dataclasses.dataclass(frozen=True)
class Point:
    """A state on the path.

    Attributes:
        state: of the rod.
        values: of the loads; pressure in MPa, of others the share that acts.
        angle: by which it bends, z = 0 to L, rad.
        iterations: of Newton's method.
    """

    state: State
    values: Mapping[str, float]
    angle: float
    iterations: int


Listen = Callable[[Point, float], None]
"""Takes every new state and the part of all loads that is done."""


@dataclasses.dataclass(frozen=True)
class Limits:
    """How the path is stepped.

    Attributes:
        turn: greatest turn of a step, rad.
        cutbacks: failed steps in a row after which it gives up.
    """

    turn: float
    cutbacks: int


class _EndedError(Exception):
    """The run ends where it was to end early."""


class Course:
    """The states of a rod, one load after the other.

    Args:
        slender: the rod.
        requests: of the case.
        limits: of steps.
        first: number of the first load that `stop_at_angle` ends.
        listen: hears of every state.

    Attributes:
        report: how it went.
        points: the states, the first at rest.
        tells: whether stability is looked at: no load lacks a potential.
        number: of the load that is being put on.
        begin: the angle where that began, rad.
    """

    def __init__(
        self,
        slender: Slender,
        requests: Requests,
        limits: Limits,
        first: int,
        listen: Listen = lambda _point, _part: None,
    ) -> None:
        self._slender, self._rod, self._requests = slender, slender.rod, requests
        self._limits, self._first, self._listen = limits, first, listen
        self._bend = Angle(slender.weights())
        self.tells = all(term.conservative for term in self._rod.terms)
        self.report = Report()
        self.number, self.begin = 0, 0.0
        # as it is made, whatever its law says of that to its last digits
        shape, level = self._rod.shape(self._rod.layout.at_rest()), slender.level({})
        self.points = [self._point(State.at(self._rod, shape, level, 0.0, 0), {})]

    def run(self) -> Report:
        """Go through all loads; the report says how far it came."""
        for number, ramp in enumerate(self._slender.ramps):
            self.number, self.begin = number, self.points[-1].angle
            try:
                self._ramp(ramp, self._requests.stop_at_angle if number >= self._first else None)
            except _EndedError:
                break
            if self.report.status != "converged":
                break
        return self.report

    # --- one load ------------------------------------------------------------------------------

    def _ramp(self, ramp: RodRamp, until: float | None) -> None:
        givens: dict[str, Held] = {"conjugate": Volume(), "control": self._bend}
        held = givens.get(ramp.drive)
        stops = self._requests.at_pressures if ramp.load == PRESSURE and held is None else ()
        if ramp.drive == "control":
            stops = self._requests.at_angles
        begin = self._driven(held, ramp.load)
        goals = sorted(
            {s for s in stops if (s - begin) * (ramp.target - s) > 0},
            reverse=ramp.target < begin,
        )
        drive = _Drive(self, ramp, held, until, begin)
        for goal in (*goals, ramp.target):
            if not drive.to(goal):
                return

    def _driven(self, held: Held | None, load: str) -> float:
        point = self.points[-1]
        if held is None:
            return point.values.get(load, 0.0)
        return held.value(self._rod, point.state.strains, self._slender.level(point.values))

    def _path(self, values: Mapping[str, float], load: str) -> Path:
        """By the value of a load as its share, others as they are."""
        none, one = ({**values, load: amount} for amount in (0.0, 1.0))
        return Path(self._slender.level(none), self._slender.level(one))

    def _point(self, state: State, values: Mapping[str, float]) -> Point:
        angle = self._bend.value(self._rod, state.strains, state.level)
        return Point(state, dict(values), angle, state.iterations)

    def _add(self, point: Point, part: float) -> None:
        """Keep a state, and tell of it."""
        report = self.report
        report.steps += 1
        report.iterations += point.iterations
        report.factorisations += point.iterations
        report.per_step.append(point.iterations)
        self.points.append(point)
        stop = self._requests.stop_at_angle
        for goal in dict.fromkeys((*self._requests.at_angles, *([] if stop is None else [stop]))):
            if abs(point.angle - goal) <= _SAME * max(1.0, abs(goal)):
                report.hits.append((report.steps, goal))
        count = len(self._slender.ramps)
        self._listen(point, (self.number + min(max(part, 0.0), 1.0)) / count)


class _Drive:
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
            self._before = self._s, ahead
            cutbacks, self._size = 0, max(_GROW * size, self._size if size == left else 0.0)
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

    def _words(self) -> str:
        return {"conjugate": "the volume", "control": "the angle"}.get(self._ramp.drive, "")

    def _solve(self, s: float, guess: Floats, share: tuple[float, float], step: float) -> Point:
        q, slope = share
        state = solve(self._rod, guess, self._path, s, self._held, q + slope * step)
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
            if abs(new.angle - found.angle) > _SAME * max(1.0, abs(goal)):
                self._course._add(found, self._part(found))
            else:
                new = dataclasses.replace(new, angle=goal)
            if goal == self._until:
                if abs(new.angle - goal) <= _SAME:
                    self._course._add(new, self._part(new))
                self._course.report.ended_at = goal
                raise _EndedError
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
        slack = _SAME * max(1.0, abs(high), abs(low))
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
            state = solve(self._rod, strains, self._path, goal, self._course._bend, q)
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
        ramp = dataclasses.replace(self._ramp, target=BEYOND * volume, drive="conjugate")
        beyond = _Drive(self._course, ramp, Volume(), self._until, volume)
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

"""The path of a rod through the loads of a case, one after the other."""

from __future__ import annotations

from collections.abc import Mapping

from fem.march.records import Report
from fiberbend.effects.records import Requests, RodRamp
from fiberbend.slender.actuator import Slender
from fiberbend.slender.drive import BEYOND as BEYOND
from fiberbend.slender.drive import Drive
from fiberbend.slender.points import PRESSURE as PRESSURE
from fiberbend.slender.points import SAME, EndedError, Limits, Listen, Point
from rod.statics import Angle, Held, Path, State, Volume


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
            except EndedError:
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
        drive = Drive(self, ramp, held, until, begin)
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
            if abs(point.angle - goal) <= SAME * max(1.0, abs(goal)):
                report.hits.append((report.steps, goal))
        count = len(self._slender.ramps)
        self._listen(point, (self.number + min(max(part, 0.0), 1.0)) / count)

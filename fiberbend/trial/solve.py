"""Cases of uniform bending solved in this process, one after another, without a run folder."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from fiberbend.case.case import Case
from fiberbend.columns import UNIFORM
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.calibrations import Calibrations
from fiberbend.trial.fields import number
from fiberbend.trial.slopes import Touched
from fiberbend.trial.wanted import Answer, BlockedForce, Point, Slopes, Wanted
from fiberbend.trial.ways import KEPT, MAKE, Goal, Way, Ways


class Trials:
    """Solves cases one after another, and keeps scenes that serve again.

    An answer is that of a case alone, to the tolerance of the solver.

    Args:
        calibration_error: percent of pressure and moment by which a winding that waits for its
            calibration may be off where it takes over that of a like case; 0: each has its own,
            which takes about two seconds unless it is kept.
    """

    def __init__(self, calibration_error: float = 0.0) -> None:
        self._ways = Ways(Calibrations(calibration_error))

    def solve(self, case: Case, wanted: Wanted) -> Answer:
        """Solve a case of model section or cell at the states that are wanted, on this rank alone.

        Its own load and what keeps it straight are replaced by those of the states; all else is the
        case's. A winding that waits for its calibration is calibrated first, from the store or
        anew. What a run warns of is not looked at: whether walls pass through each other.

        Args:
            case: a checked case.
            wanted: the states.

        Raises:
            CaseError: the case is none of uniform bending, or its winding cannot be calibrated.
        """
        found = _Found(wanted)
        for way in self._to(case, wanted):
            found.add(way, way.points())
        return found.answer(found.points)

    def sensitivities(self, case: Case, wanted: Wanted, fields: Iterable[str]) -> Slopes:
        """What a case answers, and its derivatives with respect to numbers of the case.

        By the tangent at each state: no state is solved for again. A winding that waits for its
        calibration is calibrated with 5 % more and less of each number that enters it, which takes
        two seconds each unless it is kept.

        Args:
            case: a checked case.
            wanted: the states.
            fields: dotted paths, such as `actuator.wall`, `materials.wall.c1` of a material by its
                name too, or `effects.1.winding.pitch`.

        Raises:
            CaseError: the same; or a path leads to no number.
        """
        for field in (fields := tuple(dict.fromkeys(fields))):
            number(case, field)
        found, touched = _Found(wanted), Touched()
        for way in self._to(case, wanted):
            points = way.points()
            found.add(way, points)
            touched.touch(way, points)
        by_field = {field: found.answer(touched.along(field)) for field in fields}
        return Slopes(found.answer(found.points), by_field)

    def blocked_force(self, case: Case, pressure: float) -> BlockedForce:
        """Force of the tip of an actuator that is kept straight, as a sweep reports it.

        Args:
            case: a checked case.
            pressure: MPa.

        Raises:
            CaseError: the same as of `solve`.
        """
        model, _ = choose_model(case)
        answer = self.solve(case, Wanted(straight=(pressure,)))
        force = answer.straight[0].tip_force if answer.straight else None
        return BlockedForce(force, model.force_named(), model.force_remark(), answer.reason)

    def _to(self, case: Case, wanted: Wanted) -> Iterator[Way]:
        model, _ = choose_model(case)
        if UNIFORM not in model.fills or case.zones is not None:
            where = "model" if case.zones is None else "zones"
            text = f"{model.name}, expected section or cell without zones"
            raise CaseError([Problem(where, text)])
        return self._ways.to(case, wanted)


class _Found:
    """What several ways have found of what is wanted."""

    def __init__(self, wanted: Wanted) -> None:
        self._goals = [Goal(kind, value) for kind in MAKE for value in getattr(wanted, kind)]
        self._ways: list[Way] = []
        self.points: dict[Goal, Point] = {}

    def add(self, way: Way, points: Mapping[Goal, Point]) -> None:
        """Take in a way, and what is told of its states."""
        self._ways.append(way)
        self.points |= points

    def answer(self, points: Mapping[Goal, Point]) -> Answer:
        """The answer in the order in which it was asked for.

        Args:
            points: what is to be told of the states.
        """
        reason = "; ".join(dict.fromkeys(way.reason for way in self._ways if way.reason))
        told = [(goal.kind, points[goal]) for goal in self._goals if goal in points]
        remarks = (line for way in self._ways for line in way.ready.remarks)
        return Answer(
            free=tuple(point for kind, point in told if kind != KEPT),
            straight=tuple(point for kind, point in told if kind == KEPT),
            converged=not reason,
            reason=reason,
            remarks=tuple(dict.fromkeys(remarks)),
            calibration_error=max((way.ready.error for way in self._ways), default=0.0),
        )


_TRIALS = Trials()


def solve(case: Case, wanted: Wanted) -> Answer:
    """As `Trials.solve`, with the scenes that this process keeps."""
    return _TRIALS.solve(case, wanted)


def sensitivities(case: Case, wanted: Wanted, fields: Iterable[str]) -> Slopes:
    """As `Trials.sensitivities`, with the scenes that this process keeps."""
    return _TRIALS.sensitivities(case, wanted, fields)


def blocked_force(case: Case, pressure: float) -> BlockedForce:
    """As `Trials.blocked_force`, with the scenes that this process keeps."""
    return _TRIALS.blocked_force(case, pressure)

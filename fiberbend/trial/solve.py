"""Cases of uniform bending solved in this process, one after another, without a run folder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from fiberbend.calibration.calibrate import calibrate, waits, with_bulging
from fiberbend.case.case import Case
from fiberbend.columns import UNIFORM
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial.slopes import Touched
from fiberbend.trial.wanted import Answer, Point, Slopes, Wanted
from fiberbend.trial.ways import MAKE, Goal, Ways


class Trials:
    """Solves cases one after another, and keeps scenes that serve again.

    An answer is that of a case alone, to the tolerance of the solver.
    """

    def __init__(self) -> None:
        self._ways = Ways()

    def solve(self, case: Case, wanted: Wanted) -> Answer:
        """Solve a case of model section or cell at the states that are wanted, on this rank alone.

        Its own load and what keeps it straight are replaced by those of the states; all else is the
        case's. A winding that waits for its calibration is calibrated first, from the store or
        anew.

        Args:
            case: a checked case.
            wanted: the states.

        Raises:
            CaseError: the case is none of uniform bending, or its winding cannot be calibrated.
        """
        found: dict[Goal, Point] = {}
        reasons: list[str] = []
        for way in self._ways.to(_ready(case), wanted):
            found |= way.points()
            reasons.append(way.reason)
        return _answer(wanted, found, reasons)

    def sensitivities(self, case: Case, wanted: Wanted, fields: Iterable[str]) -> Slopes:
        """What a case answers, and its derivatives with respect to numbers of the case.

        By the tangent at each state: no state is solved for again. A winding that is calibrated
        keeps the numbers of its calibration.

        Args:
            case: a checked case.
            wanted: the states.
            fields: dotted paths, such as `actuator.wall`, `materials.wall.c1` of a material by its
                name too, or `effects.1.winding.pitch`.

        Raises:
            CaseError: the same; or a path leads to no number.
        """
        found: dict[Goal, Point] = {}
        reasons: list[str] = []
        touched = Touched()
        for way in self._ways.to(_ready(case), wanted):
            points = way.points()
            touched.touch(way, points)
            found |= points
            reasons.append(way.reason)
        by_field = {
            field: _answer(wanted, touched.along(field), reasons) for field in dict.fromkeys(fields)
        }
        return Slopes(_answer(wanted, found, reasons), by_field)


def _answer(wanted: Wanted, found: Mapping[Goal, Point], reasons: Sequence[str]) -> Answer:
    told = [Goal(kind, value) for kind in MAKE for value in getattr(wanted, kind)]
    points = [(goal.kind == "straight", found[goal]) for goal in told if goal in found]
    reason = "; ".join(dict.fromkeys(text for text in reasons if text))
    return Answer(
        free=tuple(point for kept, point in points if not kept),
        straight=tuple(point for kept, point in points if kept),
        converged=not reason,
        reason=reason,
    )


def _ready(case: Case) -> Case:
    """A case of uniform bending whose winding waits for nothing."""
    model, _ = choose_model(case)
    if UNIFORM not in model.fills or case.zones is not None:
        where = "model" if case.zones is None else "zones"
        raise CaseError([Problem(where, f"{model.name}, expected section or cell without zones")])
    return with_bulging(case, calibrate(case).found.bulging()) if waits(case) else case


_TRIALS = Trials()


def solve(case: Case, wanted: Wanted) -> Answer:
    """As `Trials.solve`, with the scenes that this process keeps."""
    return _TRIALS.solve(case, wanted)


def sensitivities(case: Case, wanted: Wanted, fields: Iterable[str]) -> Slopes:
    """As `Trials.sensitivities`, with the scenes that this process keeps."""
    return _TRIALS.sensitivities(case, wanted, fields)

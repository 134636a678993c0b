"""A case of uniform bending solved in this process, without a run folder."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fiberbend.calibration.calibrate import calibrate, waits, with_bulging
from fiberbend.case.case import Case
from fiberbend.columns import UNIFORM
from fiberbend.models.choice import choose_model, problems
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.trial import loads
from fiberbend.trial.reading import Reader
from fiberbend.trial.wanted import Answer, Point, Wanted
from fiberbend.uniform.small import Small


def solve(case: Case, wanted: Wanted) -> Answer:
    """Solve a case of model section or cell at the states that are wanted, on this rank alone.

    Its own load and what keeps it straight are replaced by those of the states; all else is the
    case's. A winding that waits for its calibration is calibrated first, from the store or anew.

    Args:
        case: a checked case.
        wanted: the states.

    Raises:
        CaseError: the case is none of uniform bending, or its winding cannot be calibrated.
    """
    _uniform(case)
    if waits(case):
        case = with_bulging(case, calibrate(case).found.bulging())
    found: dict[tuple[str, float], Point] = {}
    reasons: list[str] = []
    ways = [
        *(("angles", signed) for signed in by_sign(wanted.angles)),
        *(("pressures", signed) for signed in by_sign(wanted.pressures)),
        *(("straight", signed) for signed in by_sign(wanted.straight)),
    ]
    make = {"angles": loads.bent, "pressures": loads.inflated, "straight": loads.straight}
    small: Small | None = None
    for kind, values in ways:
        loaded = make[kind](case, values)
        objections = [f"{path}: {text}" for path, text in problems(loaded)]
        if objections:
            reasons += objections[:1]
            continue
        small = Small(loaded, small)
        reader = Reader(small)
        states, report = small.march()
        asked = sorted(values, key=abs)
        found |= {
            (kind, value): reader.point(state) for value, state in zip(asked, states, strict=False)
        }
        if report.status != "converged" or len(states) < len(asked):
            reasons.append(report.reason or "not all states lie on the way")
    free = [("angles", angle) for angle in wanted.angles]
    free += [("pressures", pressure) for pressure in wanted.pressures]
    kept = [("straight", pressure) for pressure in wanted.straight]
    return Answer(
        free=tuple(found[one] for one in free if one in found),
        straight=tuple(found[one] for one in kept if one in found),
        converged=not reasons,
        reason="; ".join(dict.fromkeys(reasons)),
    )


def by_sign(values: Iterable[float]) -> list[tuple[float, ...]]:
    """The values above zero and those below, each once, without what is empty."""
    given: Sequence[float] = tuple(dict.fromkeys(values))
    parts = (tuple(v for v in given if v > 0), tuple(v for v in given if v < 0))
    return [part for part in parts if part]


def _uniform(case: Case) -> None:
    """Refuse what is no section and no cell."""
    model, _ = choose_model(case)
    if UNIFORM not in model.fills or case.zones is not None:
        where = "model" if case.zones is None else "zones"
        raise CaseError([Problem(where, f"{model.name}, expected section or cell without zones")])

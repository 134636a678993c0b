"""The law of a section that twists or bends to the side by itself, made to an error."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from fiberbend.calibration.calibrate import waits
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry, stays_straight
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.made import Checked
from fiberbend.sectionlaw.path.fit import errors, fitted, unknowns
from fiberbend.sectionlaw.path.law import SPACE, PathLaw
from fiberbend.sectionlaw.path.made import PathMade, States
from fiberbend.sectionlaw.path.states import (
    About,
    Surroundings,
    chart_of,
    free_path,
    spread,
)
from fiberbend.sectionlaw.path.store import PathStore, digest_about
from fiberbend.sectionlaw.path.terms import Kept
from fiberbend.sectionlaw.range import Loads, Reach, loads_of, reach_of
from fiberbend.sectionlaw.states.box import PRESSURE_MARGIN, NoStateError
from fiberbend.sectionlaw.states.held import Held, HeldState
from fiberbend.sectionlaw.table import no_law
from fiberbend.trial.calibrations import Calibrations
from rod.functions import Floats
from rod.table import NotReachedError

_PARTS = ((1.0, 1.0), (0.5, 1.0), (0.2, 0.5))
"""Of the usual range, at rest and at the greatest pressure, tried in turn where a section has no
state at its faces, or no law there that so many states make exact."""
_DEGREES, _INTERVALS = (3, 4, 5, 6), (2, 4, 6)
"""Of the polynomials, and of their splines by the pressure, from which one is chosen."""
_KNOWN = 21
"""Numbers that a state tells: Φ, its slopes and second derivatives."""
_MORE = 1.5
"""Numbers that are known over unknowns of a law, at least."""
_FIRST, _GROWN, _MOST = 24, 1.6, 110
"""States to begin with, how they grow, and the greatest number of those that are fitted."""
_FAR = 10.0
"""Times the error that is asked for, beyond which more states are not tried."""
_CHECKS = 16
"""States that are never fitted."""
_PRESSURES, _RANDOM = 40, 200
"""Where convexity is looked at."""


def kept_of(case: Case) -> Kept:
    """What maps the section of a case onto itself.

    Args:
        case: of model section or cell.
    """
    symmetry = Symmetry.of(case.acting)
    return Kept(
        across=not symmetry.across,
        along=not symmetry.along,
        turn=not symmetry.turn,
        alike=convert.dimensions(case.actuator).alike_around and stays_straight(case),
    )


def law_about(
    case: Case,
    error: float,
    store: PathStore | None = None,
    tell: Callable[[str], None] | None = None,
    loads: Loads | None = None,
) -> PathMade:
    """The law of a section about its free states, from the store or anew.

    Args:
        case: a checked case of model section or cell.
        error: asked for, of forces by the strains that they make in parts of their ranges.
        store: of laws; that of the user unless given.
        tell: takes lines of progress while it is made.
        loads: of the actuator that it is a zone of; its own unless given.

    Raises:
        CaseError: the law cannot have what the case has, a free state is not found, or it does not
            reach the error.
    """
    if problems := no_law(case):
        raise CaseError(problems)
    loads = loads_of(case) if loads is None else loads
    store = PathStore() if store is None else store
    digest = digest_about(case, error, loads)
    found = store.find(digest)
    if found is not None:
        return found
    with store.alone(digest):
        # another process may have been quicker
        made = store.find(digest)
        if made is None:
            made = _made(case, error, digest, loads, tell)
            store.keep(made)
    return made


def _made(
    case: Case,
    error: float,
    digest: str,
    loads: Loads,
    tell: Callable[[str], None] | None,
) -> PathMade:
    began = time.process_time()
    reach, kept = reach_of(case, loads), kept_of(case)
    ready = Calibrations().ready(case).case if waits(case) else case
    high = (1 + PRESSURE_MARGIN) * max(pressure for pressure, _ in reach.free)
    remarks, last = list(reach.remarks), ""
    try:
        held = Held(ready, SPACE)
        path = free_path(held, high, reach.height)
    except NoStateError as stop:
        raise CaseError([Problem("effects.pressure", f"{stop}, expected a smaller one")]) from None
    for part in _PARTS:
        about = Surroundings(held, chart_of(path, reach, part, kept.alike), path, tell)
        try:
            law, known = _reached(about, kept, path, reach, error, part[1])
        except (NoStateError, NotReachedError) as stop:
            last = str(stop)
            continue
        if last:
            low, full = (100 * each for each in part)
            text = f"the range about the free states is {low:g} % of the usual at rest"
            remarks.append(f"{last}: {text}, {full:g} % at the greatest pressure")
        return PathMade(
            law=law,
            checked=known,
            samples=_states(about.found, known.states),
            error=error,
            digest=digest,
            title=case.title or "",
            model=choose_model(case)[0].name,
            length=case.actuator.length,
            free=reach.free,
            solved=held.solved,
            seconds=time.process_time() - began,
            remarks=tuple(remarks),
        )
    raise CaseError([Problem("effects", f"no law of the section about its free states: {last}")])


def _reached(
    about: Surroundings,
    kept: Kept,
    path: list[HeldState],
    reach: Reach,
    error: float,
    part: float,
) -> tuple[PathLaw, Checked]:
    """A law that is as exact as asked for, checked at the first states.

    Args:
        about: the section about its free states.
        kept: symmetries.
        path: free states.
        reach: with those that trials have found.
        error: asked for, in parts of the usual ranges, however wide the law's own are.
        part: of the usual range that it has.

    Raises:
        NoStateError: a state is not found.
        NotReachedError: it takes too many.
    """
    # the checks are bent in any direction, also where one stands for all that are fitted
    about.ask(spread(0, _CHECKS, kept.alike, turned=True))
    high = float(path[-1].at[4])
    begun, wanted, least = _CHECKS, _FIRST, np.inf
    while wanted <= _MOST and (wanted == _FIRST or least <= _FAR * error):
        about.ask(spread(begun, _CHECKS + wanted - begun, kept.alike))
        begun = _CHECKS + wanted
        checks, samples = about.found[:_CHECKS], about.found[_CHECKS:]
        ranges, area = _ranges(np.abs(about.chart.sizes) / part, path, about.found)
        for degree, intervals in _tried(kept, wanted):
            law = fitted(about.chart, kept, degree, intervals, high, samples, ranges, area)
            off = errors(law, checks, ranges, area)
            least = min(least, float(off.max()))
            if off.max() <= error and (angle := _angle(law, reach)) <= error:
                return law, _checked(law, off, angle)
        wanted = round(_GROWN * wanted)
    text = f"forces of the law are off by {least:.2g} of their range, {error:.2g} asked for"
    raise NotReachedError(f"{text}, with {len(about.found)} states")


def _tried(kept: Kept, states: int) -> Iterator[tuple[int, int]]:
    """Degrees and intervals that so many states determine, those with fewer unknowns first."""
    pairs = [(unknowns(d, k, kept), d, k) for d in _DEGREES for k in _INTERVALS]
    for count, degree, intervals in sorted(pairs):
        if _MORE * count <= _KNOWN * states:
            yield degree, intervals


def _ranges(sizes: Floats, path: list[HeldState], states: Sequence[About]) -> tuple[Floats, float]:
    """Of the strains and of the area: the usual about the free states, and these from rest on."""
    along = np.ptp(np.array([state.at[:4] for state in path]), axis=0)
    areas = [each.state.slopes[4] for each in states]
    ranges: Floats = 2 * sizes + along
    return ranges, float(np.ptp(areas))


def _angle(law: PathLaw, reach: Reach) -> float:
    """Error of the free states that trials have found, as `Checked` has it."""
    turns = max(float(np.abs(state[1:]).max()) for _, state in reach.free)
    bends = turns * reach.height > 1e-6
    size = turns if bends else max(abs(state.stretch - 1.0) for _, state in reach.free)
    try:
        off = [np.abs(np.array(law.free_at(p)) - np.array(state)) for p, state in reach.free]
    except ValueError:
        # so far off that it is not within the range
        return np.inf
    return max(float((each[1:] if bends else each[:1]).max()) for each in off) / size


def _checked(law: PathLaw, off: Floats, angle: float) -> Checked:
    softest, where = _softest(law)
    return Checked(
        states=_CHECKS,
        force=float(off[0]),
        moment=float(off[1:4].max()),
        area=float(off[4]),
        angle=angle,
        softest=softest,
        where=where,
    )


def _softest(law: PathLaw) -> tuple[float, tuple[float, ...]]:
    """Least eigenvalue of ∂²Φ/∂u², N, and the strains and the pressure there."""
    found = []
    u = spread(0, _RANDOM, law.alike, turned=True)[:, :4]
    for pressure in np.linspace(*law.pressures, _PRESSURES).tolist():
        _, _, second = law.by_place(u, pressure)
        lowest = np.linalg.eigvalsh(second[:, :4, :4])[:, 0]
        place = int(np.argmin(lowest))
        found.append((float(lowest[place]), u[place], pressure))
    softest, at, pressure = min(found, key=lambda each: each[0])
    strains = law.chart.strains(np.array([[*at, pressure]]))[0]
    return softest, (*strains.tolist(), pressure)


def _states(found: Sequence[About], checks: int) -> States:
    return States(
        points=np.array([each.state.at for each in found]),
        values=np.array([each.state.energy for each in found]),
        slopes=np.array([each.state.slopes for each in found]),
        fitted=(np.arange(len(found)) >= checks).astype(float),
    )

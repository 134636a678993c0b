"""The law of the section of a case as a table, with what is known of its errors."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from fiberbend.calibration.calibrate import waits
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry, stays_straight
from fiberbend.columns import UNIFORM
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.errors import checked, sizes
from fiberbend.sectionlaw.law import PLANE, SectionLaw
from fiberbend.sectionlaw.made import Checked, Made
from fiberbend.sectionlaw.range import Loads, Reach, loads_of, reach_of
from fiberbend.sectionlaw.side import side_of
from fiberbend.sectionlaw.states.box import Box, NoStateError, box_of
from fiberbend.sectionlaw.states.held import Held
from fiberbend.sectionlaw.states.walk import Walk
from fiberbend.sectionlaw.store import Store, digest_of
from fiberbend.trial.calibrations import Calibrations
from rod.functions import Floats
from rod.spline import Samples
from rod.table import NotReachedError, tabulate

ERROR = 1e-3
"""Of forces by the strains that they make, and of the angle of a free state, see `Checked`."""
_PARTS = (1.0, 0.75, 0.5, 0.25, 0.1)
"""Of the margins, tried in turn where a section has no state at a corner of the range."""
_TIGHTER = 0.3
_LEAST = 1e-3
"""Of the error that is asked for: no free state is off by more for want of states."""
_PRESSURES: Floats = np.array([0.0, 0.08, 0.22, 0.44, 0.7, 1.0])
"""Lines of a table at first. Threads go taut and the floor arches in the first kilopascals."""
_PLANE_LINES = (np.linspace(0.0, 1.0, 3), np.linspace(0.0, 1.0, 7), _PRESSURES)
"""Of the pull, of the curvature, and of the pressure from the one nearest to rest."""


def table_of(
    case: Case,
    error: float = ERROR,
    least: float | None = None,
    store: Store | None = None,
    tell: Callable[[str], None] | None = None,
) -> Made:
    """The law of a section that bends in its plane; see `law_of`."""
    return law_of(case, PLANE, error, least, store, tell)


def law_of(
    case: Case,
    strains: tuple[str, ...],
    error: float = ERROR,
    least: float | None = None,
    store: Store | None = None,
    tell: Callable[[str], None] | None = None,
    loads: Loads | None = None,
    enough: float = 0.0,
    whose: str = "",
) -> Made:
    """The law of a section, from the store or anew.

    Stretch and curvature are tabulated; what loads alone make of side curvature and twist is
    quadratic, from exact second derivatives. The law of a section that twists or bends to the side
    by itself is `fiberbend.sectionlaw.path.make.law_about`.

    Args:
        case: a checked case of model section or cell.
        strains: names of those of the rod, as `rod.layout.STRAINS` orders them.
        error: asked for, in parts.
        least: pressure from which the table is, MPa, toward that of the case; zero unless given.
        store: of tables; that of the user unless given.
        tell: takes lines of progress while it is made.
        loads: of the actuator that it is a zone of; its own unless given.
        enough: an error that serves where the one asked for takes too many states, with a remark.
        whose: of a rod, the part in words that a message names; "": an option asks for the error.

    Raises:
        CaseError: the law cannot have what the case has, or the table does not reach the error.
    """
    refuse(case, strains)
    loads = loads_of(case) if loads is None else loads
    store = Store() if store is None else store
    digest = digest_of(case, strains, error, least, loads)
    found = store.find(digest)
    if found is not None and found.worst <= max(error, enough):
        return found
    with store.alone(digest):
        # another process may have been quicker
        made = store.find(digest)
        if made is None or made.worst > max(error, enough):
            made = _made(case, strains, error, least, digest, loads, tell, enough, whose)
            store.keep(made)
    return made


def no_law(case: Case) -> list[Problem]:
    """What no law of a section has, of whatever strains, by name.

    Args:
        case: a checked case.
    """
    problems = [
        Problem(f"effects.{index}.{effect.name}", "a table knows no load but a pressure")
        for index, effect in enumerate(case.effects)
        if effect.keeps_straight()
        or effect.weight() is not None
        or effect.touches()
        or (effect.load and effect.inflation() is None)
    ]
    if case.zones is not None:
        problems.append(Problem("zones", "a table is of one section, expected a case without"))
    model, _ = choose_model(case)
    if UNIFORM not in model.fills and not problems:
        problems.append(Problem("model", f"{model.name}, expected section or cell"))
    return problems


def refuse(case: Case, strains: tuple[str, ...] = PLANE) -> None:
    """Say by name what a table cannot have.

    Args:
        case: a checked case.
        strains: of the rod.

    Raises:
        CaseError: the case has that.
    """
    problems, symmetry = no_law(case), Symmetry.of(case.acting)
    if strains[:2] != PLANE:
        problems.append(Problem("strains", f"{', '.join(strains)}: expected stretch and curvature"))
    if not symmetry.plane and not problems:
        text = f"a table of {' and '.join(strains)} is of a section that bends in its plane"
        problems.append(Problem("effects", f"{text}; of this one: {symmetry.words()}"))
    if problems:
        raise CaseError(problems)


def _made(
    case: Case,
    strains: tuple[str, ...],
    error: float,
    least: float | None,
    digest: str,
    loads: Loads,
    tell: Callable[[str], None] | None = None,
    enough: float = 0.0,
    whose: str = "",
) -> Made:
    began = time.process_time()
    reach = reach_of(case, loads)
    ready = Calibrations().ready(case).case if waits(case) else case
    farthest = max((pressure for pressure, _ in reach.free), key=abs)
    if least is not None and not 0 <= least / farthest < 1:
        text = f"{1e3 * least:g} kPa, expected between 0 and {1e3 * farthest:.4g} kPa"
        raise CaseError([Problem("--from", text)])
    more = set(strains) - set(PLANE)
    alike = convert.dimensions(case.actuator).alike_around and stays_straight(case)
    held = Held(ready, PLANE)
    all_held = Held(ready, strains) if more else held
    remarks, last = list(reach.remarks), ""
    for part in _PARTS:
        try:
            box = box_of(reach, held, PLANE, part, least or 0.0)
            walk = Walk(held, box, tell)
            law, known = _fitted(walk, box, reach, error, enough)
            side = None
            if more:
                side = side_of(all_held, strains, law, box, reach, alike, tell)
        except NoStateError as stop:
            last = str(stop)
            continue
        except (NotReachedError, ValueError) as stop:
            problem = Problem("--error", str(stop))
            if whose:
                problem = Problem("model", f"the law of {whose}: {stop}")
            raise CaseError([problem]) from None
        if last:
            remarks.append(f"{last}: the margins of the range are {100 * part:g} % of the usual")
        if known.worst > error:
            remarks.append(
                f"the law of the section is known to {100 * known.worst:.2g} % of its range, "
                f"{100 * error:.2g} % asked for (docs/table.md)"
            )
        return Made(
            section=law,
            checked=known,
            samples=_samples(walk),
            error=error,
            digest=digest,
            title=case.title or "",
            model=choose_model(case)[0].name,
            length=case.actuator.length,
            free=reach.free,
            solved=held.solved + (all_held.solved if more else 0),
            seconds=time.process_time() - began,
            remarks=tuple(remarks),
            side=side,
        )
    last = f"{whose}: {last}" if whose else last
    raise CaseError([Problem("effects.pressure", f"{last}, expected a smaller one")])


def _fitted(
    walk: Walk, box: Box, reach: Reach, error: float, enough: float
) -> tuple[SectionLaw, Checked]:
    """A law whose forces and free angles are as exact as asked for."""
    asked = error
    pull, turns, pressures = _PLANE_LINES
    low, high = box.pressures
    begin = (pull, turns, (box.at(pressures) - low) / (high - low))
    measure = sizes(box.chart)
    while True:
        table = tabulate(
            walk.sample,
            box.ranges,
            asked,
            begin=begin,
            sizes=measure,
            enough=enough,
        )
        law = SectionLaw(table, box.chart)
        known = checked(law, _samples(walk), reach)
        coarse = float(table.errors.max()) > asked
        if known.worst <= error or coarse or asked < _LEAST * error:
            break
        asked *= _TIGHTER
    if known.worst > max(error, enough):
        text = f"free angles of the table are off by {known.worst:.2g}, {error:.2g} asked for"
        raise NotReachedError(text)
    return law, known


def _samples(walk: Walk) -> Samples:
    points = np.array(list(walk.known))
    return Samples(points, *walk.sample(points))

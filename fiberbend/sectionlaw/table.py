"""The law of the section of a case as a table, with what is known of its errors."""

from __future__ import annotations

import time

import numpy as np

from fiberbend.calibration.calibrate import waits
from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.columns import UNIFORM
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.law import SectionLaw
from fiberbend.sectionlaw.made import Checked, Made
from fiberbend.sectionlaw.range import Box, Reach, box_of, reach_of
from fiberbend.sectionlaw.store import Store, digest_of
from fiberbend.sectionlaw.walk import NoStateError, Walk
from fiberbend.trial.calibrations import Calibrations
from rod.spline import Samples
from rod.table import NotReachedError, tabulate

ERROR = 1e-3
"""Of forces in parts of their range, and of the angle of a free state in parts of the greatest."""
_PARTS = (1.0, 0.5, 0.25, 0.1)
"""Of the margins, tried in turn where a section has no state at a corner of the range."""
_TIGHTER = 0.3
_LEAST = 1e-3
"""Of the error that is asked for: no free state is off by more for want of states."""


def table_of(
    case: Case,
    error: float = ERROR,
    least: float | None = None,
    store: Store | None = None,
    wide: float = 1.0,
) -> Made:
    """The law of a section, from the store or anew.

    Args:
        case: a checked case of model section or cell that bends in its plane.
        error: asked for, in parts.
        least: pressure from which the table is, MPa; a part of the greatest unless given.
        store: of tables; that of the user unless given.
        wide: times the usual margins of the range, of a rod whose loads bend it far.

    Raises:
        CaseError: the law cannot have what the case has, or the table does not reach the error.
    """
    refuse(case)
    store = Store() if store is None else store
    digest = digest_of(case, error, least, wide)
    found = store.find(digest)
    if found is not None:
        return found
    made = _made(case, error, least, digest, wide)
    store.keep(made)
    return made


def refuse(case: Case) -> None:
    """Say by name what the law of a section cannot have.

    Raises:
        CaseError: the case has that.
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
    symmetry = Symmetry.of(case.acting)
    if not symmetry.plane and not problems:
        text = "a table is of stretch and curvature, expected a case that bends in its plane"
        problems.append(Problem("effects", f"{text}; of this one: {symmetry.words()}"))
    if problems:
        raise CaseError(problems)


def _made(case: Case, error: float, least: float | None, digest: str, wide: float) -> Made:
    began = time.process_time()
    reach = reach_of(case)
    ready = Calibrations().ready(case).case if waits(case) else case
    greatest = max(pressure for pressure, _ in reach.free)
    if least is not None and not 0 <= least < greatest:
        text = f"{1e3 * least:g} kPa, expected 0 or more, and less than {1e3 * greatest:.4g} kPa"
        raise CaseError([Problem("--from", text)])
    remarks, last = list(reach.remarks), ""
    for part in _PARTS:
        box = box_of(reach, wide * part, least)
        walk = Walk(ready, box)
        try:
            law, checked = _fitted(case, walk, box, reach, error)
        except NoStateError as stop:
            last = str(stop)
            continue
        except (NotReachedError, ValueError) as stop:
            raise CaseError([Problem("--error", str(stop))]) from None
        if last:
            remarks.append(f"{last}: the margins of the range are {100 * part:g} % of the usual")
        return Made(
            law=law,
            checked=checked,
            samples=_samples(walk),
            error=error,
            digest=digest,
            title=case.title or "",
            model=choose_model(case)[0].name,
            length=case.actuator.length,
            free=reach.free,
            solved=walk.solved,
            seconds=time.process_time() - began,
            remarks=tuple(remarks),
        )
    raise CaseError([Problem("effects.pressure", f"{last}, expected a smaller one")])


def _fitted(
    case: Case, walk: Walk, box: Box, reach: Reach, error: float
) -> tuple[SectionLaw, Checked]:
    """A law whose forces and free angles are as exact as asked for."""
    asked = error
    while True:
        law = SectionLaw(tabulate(walk.sample, box.ranges, asked), box.chart)
        checked = _checked(law, walk, reach, case.actuator.length)
        worst = max(checked.force, checked.moment, checked.area, checked.angle)
        if worst <= error or asked < _LEAST * error:
            break
        asked *= _TIGHTER
    if worst > error:
        text = f"free angles of the table are off by {worst:.2g}, {error:.2g} asked for"
        raise NotReachedError(text)
    return law, checked


def _samples(walk: Walk) -> Samples:
    points = np.array(list(walk.known))
    values = np.array([value for value, _ in walk.known.values()])
    return Samples(points, values, np.array([slopes for _, slopes in walk.known.values()]))


def _checked(law: SectionLaw, walk: Walk, reach: Reach, length: float) -> Checked:
    """Errors at states that are not fitted."""
    samples = _samples(walk)
    fitted = {tuple(point) for point in law.table.samples.points.tolist()}
    held_out = np.array([tuple(point) not in fitted for point in samples.points.tolist()])
    strains, told = law.chart.strains(samples.points), np.empty((len(samples.points), 3))
    for number, pressure in enumerate(samples.points[:, 2].tolist()):
        here = strains[number : number + 1]
        told[number] = [*law.gradient(here, pressure)[0], law.chamber(here, pressure)[0]]
    exact = law.chart.forces(samples.points, samples.slopes)
    off = np.abs(told - exact)[held_out].max(axis=0) / np.ptp(exact, axis=0)
    softest, place, pressure = min(
        ((*law.table.softest(pressure), pressure) for pressure in _fine(law)),
        key=lambda found: found[0],
    )
    return Checked(
        states=int(held_out.sum()),
        force=float(off[0]),
        moment=float(off[1]),
        area=float(off[2]),
        angle=_angle_error(law, reach),
        softest=softest,
        where=(*law.chart.strains(np.array([[*place, pressure]]))[0].tolist(), pressure),
    )


def _fine(law: SectionLaw) -> list[float]:
    """Pressures at which convexity is looked at."""
    lines = law.table.axes[-1].lines
    found: list[float] = np.linspace(lines[0], lines[-1], 4 * len(lines)).tolist()
    return found


def _angle_error(law: SectionLaw, reach: Reach) -> float:
    """Of the free states, in parts of the greatest curvature, or of the stretch without one."""
    worst = 0.0
    stretches = [abs(state.stretch - 1.0) for _, state in reach.free]
    curvatures = [abs(state.curvature) for _, state in reach.free]
    bends = max(curvatures) * reach.height > 1e-6
    low, high = law.table.axes[-1].lines[[0, -1]].tolist()
    for pressure, state in reach.free:
        if not low <= pressure <= high:
            continue
        found = law.free(pressure, state)
        if bends:
            off = abs(found.curvature - state.curvature) / max(curvatures)
        else:
            off = abs(found.stretch - state.stretch) / max(stretches)
        worst = max(worst, off)
    return worst

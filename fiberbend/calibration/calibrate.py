"""A case whose winding waits for its numbers, with them: kept from before, or from its cell."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from fiberbend.calibration import reach as classes
from fiberbend.calibration import ways
from fiberbend.calibration.digest import content, digest
from fiberbend.calibration.reach import Reach
from fiberbend.calibration.record import DOUBTFUL, DOUBTFUL_FAMILIES, Calibrated, Calibration
from fiberbend.calibration.store import Store
from fiberbend.case.case import Case
from fiberbend.schema.problems import CaseError, Problem

if TYPE_CHECKING:
    from materials.bedding import Bedding
    from materials.bulging import Bulging


def waits(case: Case) -> bool:
    """Whether a case cannot be solved before its winding is calibrated."""
    return any(effect.uncalibrated() for effect in case.effects)


def with_bulging(case: Case, bulging: Bulging | Bedding) -> Case:
    """The case with the numbers that it waits for.

    Args:
        case: a case.
        bulging: the numbers.
    """
    effects = (e.with_bulging(bulging) if e.uncalibrated() else e for e in case.effects)
    return case.model_copy(update={"effects": tuple(effects)})


def known(case: Case, store: Store | None = None) -> Calibrated | None:
    """What is kept of a case that waits for its numbers; None: nothing. Solves nothing.

    Args:
        case: the case.
        store: where to look; the user's own by default.
    """
    store = store or Store()
    for _reach, mark, last in _classes(case):
        found = store.find(mark)
        if found is None:
            return None
        if last or not found.whole or not classes.short_of(case, found):
            return _result(case, found, mark, True, ())
    return None


def calibrate(
    case: Case, store: Store | None = None, tell: Callable[[str], None] = lambda _line: None
) -> Calibrated:
    """Calibrate the winding of a case, or take what is kept; by one process alone.

    Args:
        case: a case that waits for its numbers.
        store: where calibrations are kept; the user's own by default.
        tell: takes a line before a cell is solved.

    Raises:
        CaseError: the winding cannot be calibrated.
    """
    store = store or Store()
    for reach, mark, last in _classes(case):
        found, kept = store.find(mark), True
        if found is None:
            with store.alone(mark):
                # another process may have been quicker
                found = store.find(mark)
                if found is None:
                    tell("winding: its cell is solved to calibrate it")
                    found, kept = _solve(case, reach), False
                    store.keep(mark, found, _content(case, reach))
        if last or not found.whole or not classes.short_of(case, found):
            return _result(case, found, mark, kept, tuple(store.remarks))
    raise AssertionError("the last class ends the loop")


def _classes(case: Case) -> Iterator[tuple[Reach, str, bool]]:
    """Classes of curvature from the first that holds a case's angles on, with their digests."""
    if ways.of_families(case):
        yield Reach.of(0), digest(ways.content(case)), True
        return
    for number in range(classes.first(case).number, classes.CLASSES):
        reach = Reach.of(number)
        yield reach, digest(content(case, reach)), number == classes.CLASSES - 1


def _content(case: Case, reach: Reach) -> dict[str, Any]:
    return ways.content(case) if ways.of_families(case) else content(case, reach)


def _solve(case: Case, reach: Reach) -> Calibration:
    from fiberbend.calibration.fit import CalibrationError, cell_states, fit

    began = time.perf_counter()
    try:
        if ways.of_families(case):
            from fiberbend.calibration.families import calibrated

            return calibrated(case)
        return fit(case, reach, cell_states(case, reach), began)
    except CalibrationError as error:
        index = next(n for n, effect in enumerate(case.effects) if effect.uncalibrated())
        path = f"effects.{index}.{case.effects[index].name}.as"
        wanted = "expected discrete or smeared"
        raise CaseError([Problem(path, f'"calibrated", but {error}; {wanted}')]) from None


def _result(
    case: Case, found: Calibration, mark: str, kept: bool, remarks: tuple[str, ...]
) -> Calibrated:
    result = Calibrated(found, mark, case.straight, kept)
    doubts = (*remarks, *_doubts(case, result))
    return dataclasses.replace(result, remarks=doubts)


def _doubts(case: Case, result: Calibrated) -> Iterator[str]:
    """What makes a calibration doubtful for a case."""
    most = DOUBTFUL_FAMILIES if ways.of_families(case) else DOUBTFUL
    if result.left_percent > most:
        yield (
            f"winding: its calibration leaves {result.left_percent:.1f} % between section and "
            f"cell, more than {most:g} %"
        )
    if ways.of_families(case):
        if not result.found.whole:
            up_to = 1e3 * result.found.pressure
            yield f"winding: its cell came to {up_to:.4g} kPa; beyond, nothing is known of it"
        return
    if beyond := classes.short_of(case, result.found):
        yield f"winding: {beyond} nothing is known of its calibration"
    load = case.inflation
    if load is not None and load.to is not None and load.to < 0:
        yield "winding: it is calibrated under pressure, and used under a vacuum"

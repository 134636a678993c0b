"""Calibrated windings: each case's own numbers, or in a search those of a like case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from fiberbend.calibration import reach
from fiberbend.calibration.calibrate import calibrate, known, waits, with_bulging
from fiberbend.calibration.record import Calibration
from fiberbend.case.case import Case
from fiberbend.schema.quantities import Spec

ERROR = 6.0
"""Percent of the pressure for an angle, or of the moment, by which another case's calibration is
off where the two cases differ by a factor e in one number: 2 of the wall, 4 of radius, floor and
the wall's c1, 6 of the pitch (docs/decisions.md)."""

_NOTHING = {"length", "cap", "density", "representation", "bulging"}
"""Keys on which no calibration hangs."""


class Ready(NamedTuple):
    """A case whose winding waits for nothing.

    Attributes:
        case: the case.
        error: percent by which a calibration that was taken over may be off; 0 of its own.
        remarks: what casts doubt on its calibration.
        waited: the case as it waited for its numbers; None where it has them from its file.
    """

    case: Case
    error: float = 0.0
    remarks: tuple[str, ...] = ()
    waited: Case | None = None


class Calibrations:
    """Calibrates cases, from the store or anew, or takes over the numbers of a like case.

    Args:
        percent: greatest error that a calibration taken over may bring, of the pressure for an
            angle and of the moment; 0: every case has its own.
    """

    def __init__(self, percent: float = 0.0) -> None:
        self._percent = percent
        self._made: list[tuple[dict[str, Any], Calibration]] = []

    def ready(self, case: Case) -> Ready:
        """A case with the numbers that its winding waits for.

        Args:
            case: under its load, which says how far it is bent.

        Raises:
            CaseError: the winding cannot be calibrated.
        """
        if not waits(case):
            return Ready(case)
        if not self._percent:
            own = calibrate(case)
            return Ready(with_bulging(case, own.found.bulging()), 0.0, own.remarks, case)
        numbers = dict(_enters(case))
        kept = known(case)
        if kept is None:
            near = [
                (error, found)
                for other, found in self._made
                if (error := ERROR * _apart(numbers, other)) <= self._percent
                and not reach.short_of(case, found)
            ]
            if near:
                error, found = min(near, key=lambda one: one[0])
                return Ready(with_bulging(case, found.bulging()), error, (), case)
        own = kept or calibrate(case)
        self._made.append((numbers, own.found))
        return Ready(with_bulging(case, own.found.bulging()), 0.0, own.remarks, case)


def recalibrated(waited: Case, other: Case) -> Case:
    """A case with the numbers that another one would have; both wait for them.

    Raises:
        CaseError: the winding of the other cannot be calibrated.
    """
    return with_bulging(waited, calibrate(other).found.bulging())


def enters(case: Case, other: Case) -> bool:
    """Whether what two cases differ by enters the calibration of their windings."""
    return dict(_enters(case)) != dict(_enters(other))


def _enters(case: Case) -> Iterator[tuple[str, Any]]:
    """What enters a calibration, by its path in the case."""
    yield "reach", str(reach.first(case).number)
    yield "straight", str(case.straight)
    wound = [effect for effect in case.effects if effect.winds()]
    for part in (case.actuator, case.materials, *wound):
        for path, value in _flat(part, type(part).__name__):
            if path.rpartition(".")[2] not in _NOTHING:
                yield path, value


def _apart(one: Mapping[str, Any], other: Mapping[str, Any]) -> float:
    """Σ |ln(a/b)| over the numbers of two cases; ∞ where they differ by more than those."""
    if one.keys() != other.keys():
        return math.inf
    total = 0.0
    for name, a in one.items():
        b = other[name]
        if a == b:
            continue
        if not all(isinstance(value, float) and value > 0 for value in (a, b)):
            return math.inf
        total += abs(math.log(a / b))
    return total


def _flat(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Plain values of parts of a case, by their paths; named materials and fibers by numbers."""
    if isinstance(value, Spec):
        given = value.by_numbers()
        parts = [(name, getattr(given, name)) for name in type(given).model_fields]
    elif isinstance(value, tuple):
        parts = [(str(number), part) for number, part in enumerate(value)]
    else:
        yield path, value
        return
    for name, part in parts:
        yield from _flat(part, f"{path}.{name}")

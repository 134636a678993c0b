"""Calibrated windings: each case's own numbers, or in a search those of a like case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from fiberbend.calibration import reach
from fiberbend.calibration.calibrate import calibrate, known, waits, with_bulging
from fiberbend.calibration.record import Calibrated, Calibration
from fiberbend.case.case import Case
from fiberbend.schema.quantities import Spec
from fiberbend.uniform.small import Small
from materials.bulging import Bulging

RATE = 3.5
"""Error of another case's calibration where the two cases differ by a factor e in one number, over
all that the bulge between turns makes of the pressure: 1.5 to 2.4 of the pitch, at most 1.2 of any
other number, on five sections (docs/evidence/trials.md); the rest is a margin."""
_RIGID = Bulging(1e12, 0.0, 0.0)
"""No bulge: the winding is the smeared one."""
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
        self._made: list[_Made] = []

    def ready(self, case: Case) -> Ready:
        """A case with the numbers that its winding waits for.

        Args:
            case: under its load, which says how far it is bent.

        Raises:
            CaseError: the winding cannot be calibrated.
        """
        if not waits(case):
            return Ready(case)
        turns = case.turns
        if not self._percent or turns is None or turns.pitch is None:
            own = calibrate(case)
            return Ready(with_bulging(case, own.found.bulging()), 0.0, own.remarks, case)
        numbers = dict(_enters(case))
        near = [
            (_error(made, apart), made)
            for made in self._made
            if _error(made, apart := _apart(numbers, made.numbers)) <= self._percent
            and not reach.short_of(case, made.own.found)
        ]
        error, made = min(near, key=lambda one: one[0], default=(math.inf, None))
        if made is None or error > 0:
            kept = known(case)
            if kept is None and made is not None:
                return Ready(with_bulging(case, made.own.found.bulging()), error, (), case)
            own = kept or calibrate(case)
            made = _Made(numbers, own, RATE * _effect(case, own.found))
            self._made.append(made)
        return Ready(with_bulging(case, made.own.found.bulging()), 0.0, made.own.remarks, case)


class _Made(NamedTuple):
    """A case that was calibrated.

    Attributes:
        numbers: what enters its calibration.
        own: its calibration.
        rate: percent by which it is off where a number is e times as large.
    """

    numbers: dict[str, Any]
    own: Calibrated
    rate: float


def _error(made: _Made, apart: float) -> float:
    """Percent by which a calibration may be off on a case that is so far apart."""
    return made.rate * apart if apart else 0.0


def _effect(case: Case, found: Calibration) -> float:
    """Percent of pressure or moment that the bulge makes at the states of a case; ∞: not known."""
    small = Small(with_bulging(case, found.bulging()))
    values = [_values(small)]
    values.append(_values(Small(with_bulging(case, _RIGID), small)))
    if len(values[0]) != len(values[1]) or not (values[0] and all(values[0])):
        return math.inf
    return max(100 * abs(other / one - 1) for one, other in zip(*values, strict=True))


def _values(small: Small) -> list[float]:
    readings = map(small.read, small.march()[0])
    return [reading.moment or reading.pressure for reading in readings]


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
        for path, value in flat(part, type(part).__name__):
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


def flat(value: Any, path: str) -> Iterator[tuple[str, Any]]:
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
        yield from flat(part, f"{path}.{name}")

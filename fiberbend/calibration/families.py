"""Families of threads: the numbers of the rubber under them, from the cell on a case's own way."""

from __future__ import annotations

import dataclasses
import time
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from fem.march.records import State
from fiberbend.calibration import ways
from fiberbend.calibration.fit import CalibrationError, least_squares
from fiberbend.calibration.reach import height
from fiberbend.calibration.record import OfFamilies
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.uniform.small import Small
from materials.bedding import Bedding

Floats = npt.NDArray[np.float64]

_NORMAL, _ALONG = 2.5, 20.0
"""k0 and k_s over the wall's shear modulus at the start: 1.7 to 4.2 and 13 to 60 of the windings
of docs/evidence/families.md."""
_ACROSS = 10.0
"""a for one unit of what is fitted: 1 to 27 there."""
_WEAK = 3e-3
"""Weight of the unknowns themselves beside relative differences: what a winding does not feel,
such as slip around a circle, stays where it began."""
_LEAST_TURN, _LEAST_STRAIN = 1e-3, 1e-4
"""rad and 1: turns and lengthenings that count as none."""
_FLOOR = 0.2
"""Part of its greatest value below which a turn or a lengthening is not weighted any more."""
_STEP = 1e-3
_UNKNOWN = 1.0
"""Residual of a state that a section does not find."""


class _Reading(NamedTuple):
    """What section and cell have in common: turns in rad, λ − 1, and the pressure in MPa."""

    values: Floats
    area: float


def calibrated(case: Case) -> OfFamilies:
    """Solve the cell on the case's own way, and fit the section to it.

    Args:
        case: its winding waits for its numbers; driven by a pressure or an angle.

    Raises:
        CalibrationError: it cannot be calibrated.
    """
    began = time.perf_counter()
    if reason := ways.objection(case):
        raise CalibrationError(reason)
    cell = Small(ways.small(case, "cell"))
    states, report = cell.march()
    if len(states) < 2:
        raise CalibrationError(f"its cell has {len(states)} states only: {report.reason}")
    known = [_read(cell, state) for state in states]
    sections = _Sections(case, known)
    x = least_squares(sections.residual, np.zeros(4), sections.slopes)
    numbers = _rounded(sections.bedding(x))
    left = sections.left(numbers)
    rest = convert.dimensions(case.actuator).chamber_volume / case.actuator.length
    return OfFamilies(
        normal=numbers.normal,
        along=numbers.along,
        across=numbers.across,
        by_pressure=numbers.pressure,
        bent_percent=round(100 * left, 4),
        straight_percent=0.0,
        states=len(known),
        strain=max(abs(float(r.values[0])) for r in known) / case.actuator.length * height(case),
        pressure=max(abs(float(r.values[4])) for r in known),
        growth=max(r.area for r in known) / rest,
        whole=report.status == "converged",
        seconds=round(time.perf_counter() - began, 2),
    )


def _read(small: Small, state: State) -> _Reading:
    small.put(state)
    line = small.line()
    reading = small.read(state)
    turns = line.rates * small.length
    return _Reading(np.r_[turns, line.stretch - 1, reading.pressure], reading.area)


def _rounded(numbers: Bedding) -> Bedding:
    """To six digits: the same on every machine but for the last."""
    return Bedding(*(float(f"{value:.6g}") for value in dataclasses.astuple(numbers)))


class _Sections:
    """The section of a case at the states of its cell, as a function of the four numbers."""

    def __init__(self, case: Case, known: list[_Reading]) -> None:
        self._modulus = convert.site(case).materials["wall"].initial_shear_modulus
        load = case.inflation
        assert load is not None
        self._kind = "value" if load.angle is None else "control"
        self._known = np.array([reading.values for reading in known])
        self._most = np.abs(self._known).max(axis=0)
        least = np.array([_LEAST_TURN] * 3 + [_LEAST_STRAIN, 0.0])
        # what is given does not count
        given = 4 if self._kind == "value" else 0
        self._counts = (self._most > least) & (np.arange(5) != given)
        begin = self.bedding(np.zeros(4))
        effects = (e.with_bulging(begin) if e.uncalibrated() else e for e in case.effects)
        self._windings = [effect for effect in case.effects if effect.uncalibrated()]
        wound = case.model_copy(update={"effects": tuple(effects)})
        self._small = Small(ways.small(wound, "section"))
        states, report = self._small.march()
        if len(states) < len(known):
            raise CalibrationError(
                f"its section has {len(states)} of the {len(known)} states of its cell: "
                f"{report.reason}"
            )
        self._states = states[: len(known)]

    def bedding(self, x: Floats) -> Bedding:
        """The numbers of a point; both stiffnesses are positive at every one."""
        normal, along, across, pressure = (float(value) for value in x)
        return Bedding(
            self._modulus * _NORMAL * float(np.exp(normal)),
            self._modulus * _ALONG * float(np.exp(along)),
            _ACROSS * across,
            _ACROSS * pressure,
        )

    def left(self, numbers: Bedding) -> float:
        """Greatest difference over the greatest value of what differs."""
        off = np.abs(self._values(numbers) - self._known)[:, self._counts]
        return float(np.max(off / self._most[self._counts]))

    def residual(self, x: Floats) -> Floats:
        """Relative differences from the cell, and the point itself with a small weight."""
        off = (self._values(self.bedding(x)) - self._known)[:, self._counts]
        scale = np.maximum(np.abs(self._known), _FLOOR * self._most)[:, self._counts]
        return np.r_[np.ravel(off / scale), _WEAK * x]

    def slopes(self, x: Floats) -> Floats:
        """Its derivatives at a point, (m, 4), by differences on both sides."""
        columns = [
            (self.residual(x + _STEP * e) - self.residual(x - _STEP * e)) / (2 * _STEP)
            for e in np.eye(4)
        ]
        return np.array(columns).T

    def _values(self, numbers: Bedding) -> Floats:
        """What the section has at the states of the cell; far off where it finds none."""
        small = self._small
        potentials = {
            key: potential
            for winding in self._windings
            for key, potential in small.windings(winding.with_bulging(numbers)).items()
        }
        small.scene.exchange(potentials)
        rows = []
        for index, before in enumerate(self._states):
            state = small.again(before, self._kind)
            if state is None:
                rows.append(self._known[index] + _UNKNOWN * self._most)
                continue
            self._states[index] = state
            rows.append(_read(small, state).values)
        return np.array(rows)

"""Cell states, and the three numbers with which a section gives the same."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from fem.effects.effect import Discrete
from fem.march.records import State
from fiberbend.calibration import cases
from fiberbend.calibration.reach import Reach, height
from fiberbend.calibration.record import OfPattern
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.uniform.small import Reading, Small
from materials.bulging import Bulging

Floats = npt.NDArray[np.float64]

LEAST_STATES = 3
"""As many as there are numbers."""
_START = 8.0
"""K0 times pitch over the wall's shear modulus: 6 to 10 on the geometries of
docs/evidence/calibration.md."""
_QUADRATIC = 4.0
_BEGIN = (0.0, 1.0, 0.0)
"""With a1 = 1: −0.1 to 2 there."""
_STEP = 1e-3
"""Difference by which a slope is taken; its square, which one tangent misses, is lost."""
_ITERATIONS = 12
_STILL = 2e-3
"""Change of the numbers, relative, that moves no pressure by 0.01 %."""
_NEAR = 0.1
"""Change of the numbers across which slopes serve again: they change by a few percent."""
_DAMPING = 1e-6
_OTHER = 0.1
"""Weight of states of the other kind than a case asks for. Three numbers give both kinds to 0.1 %
where turns lie 3 mm apart; 6 mm apart, states that are bent to 0.1 % leave 4 % in those kept
straight, and both alike leave 0.5 % (docs/evidence/calibration.md)."""
_UNKNOWN = 1.0
"""Residual of a state that a section does not find."""


class CalibrationError(Exception):
    """A winding that cannot be calibrated; the message says why."""


@dataclasses.dataclass(frozen=True)
class CellStates:
    """What the cell of a case gives.

    Attributes:
        bent: bent by pressure, from the least curvature on.
        straight: kept straight, from the least pressure on.
        whole: it came to the end of what was asked.
        reason: why not.
    """

    bent: tuple[Reading, ...]
    straight: tuple[Reading, ...]
    whole: bool
    reason: str = ""


def cell_states(case: Case, reach: Reach) -> CellStates:
    """Solve the cell of a case, bent and kept straight.

    Args:
        case: has a winding.
        reach: how far it is bent.

    Raises:
        CalibrationError: it has too few states.
    """
    small, bent, whole, reason = _bent(case, reach, 1.0)
    if bent and bent[0].pressure < 0:
        # it bends up, toward a soft floor
        small, bent, whole, reason = _bent(case, reach, -1.0)
    if not bent or bent[0].pressure <= 0:
        raise CalibrationError(f"no pressure bends the cell of this section far enough: {reason}")
    straight: tuple[Reading, ...] = ()
    if case.turns is not None and not case.turns.twists:
        small = Small(cases.straight_cell(case, reach, max(r.pressure for r in bent)), small)
        states, report = small.march()
        straight = tuple(small.read(state) for state in states)
        whole, reason = whole and report.status == "converged", reason or report.reason
    if len(bent) + len(straight) < LEAST_STATES:
        raise CalibrationError(f"its cell has {len(bent)} states only: {reason}")
    return CellStates(bent, straight, whole, reason)


def _bent(case: Case, reach: Reach, sign: float) -> tuple[Small, tuple[Reading, ...], bool, str]:
    small = Small(cases.bent_cell(case, reach, sign))
    states, report = small.march()
    whole = report.status == "converged"
    return small, tuple(small.read(state) for state in states), whole, report.reason


def fit(case: Case, reach: Reach, cell: CellStates, began: float) -> OfPattern:
    """The three numbers of a case, by least squares over the states of its cell.

    Args:
        case: has a winding.
        reach: how far the cell is bent.
        cell: its states.
        began: when the calibration did, by `time.perf_counter`.

    Raises:
        CalibrationError: the section comes to fewer states than the cell.
    """
    model = _Sections(case, reach, cell)
    numbers = model.rounded(least_squares(model.residual, np.array(_BEGIN), model.slopes))
    bent_left, straight_left = (
        round(float(100 * np.max(np.abs(part), initial=0.0)), 4) for part in model.parts(numbers)
    )
    rest = convert.dimensions(case.actuator).chamber_volume / case.actuator.length
    bent = cell.bent
    length = cases.bent_cell(case, reach).actuator.length
    return OfPattern(
        stiffness=numbers.stiffness,
        linear=numbers.linear,
        quadratic=numbers.quadratic,
        bent_percent=bent_left,
        straight_percent=straight_left,
        states=len(bent) + len(cell.straight),
        strain=max(abs(r.angle) for r in bent) / length * height(case),
        pressure=max(r.pressure for r in bent),
        growth=max(r.area for r in bent) / rest,
        whole=cell.whole,
        seconds=round(time.perf_counter() - began, 2),
    )


def least_squares(
    residual: Callable[[Floats], Floats], x: Floats, slopes_at: Callable[[Floats], Floats]
) -> Floats:
    """Where a sum of squares is least, by Levenberg's and Marquardt's method.

    Args:
        residual: of m numbers at n, (m,).
        x: the start, (n,).
        slopes_at: its derivatives at the point where it was taken last, (m, n).
    """
    value, damping, moved = residual(x), _DAMPING, np.inf
    for _ in range(_ITERATIONS):
        if moved > _NEAR:
            slopes = slopes_at(x)
            square = slopes.T @ slopes
        while True:
            scale = damping * np.diag(square).max() * np.eye(len(x))
            step = np.linalg.solve(square + scale, -slopes.T @ value)
            step *= min(1.0, 1.0 / max(np.abs(step).max(), 1e-300))
            trial = residual(x + step)
            if trial @ trial < value @ value or np.abs(step).max() < _STILL:
                break
            damping = max(10 * damping, 1e-4)
        if trial @ trial < value @ value:
            x, value = x + step, trial
        damping /= 3
        moved = float(np.abs(step).max())
        if moved < _STILL:
            break
    return x


class _Sections:
    """The section of a case at the states of its cell, as a function of the three numbers."""

    def __init__(self, case: Case, reach: Reach, cell: CellStates) -> None:
        turns = cases.turns_of(case)
        modulus = convert.site(case).materials["wall"].initial_shear_modulus
        self._start = _START * modulus / turns.spacing
        self._kept = case.straight
        begin = self.bulging(np.array(_BEGIN))
        wound = self._wound(case, begin)
        self._windings = [e for e in wound.effects if e.winds()]
        angles = tuple(r.angle for r in cell.bent)
        asked = [(cases.bent_section(wound, reach, angles), cell.bent)]
        if cell.straight:
            end = max(r.pressure for r in cell.bent)
            asked.append((cases.straight_section(wound, reach, end), cell.straight))
        self._parts: list[tuple[Small, list[State], Sequence[Reading]]] = []
        for small_case, readings in asked:
            small = Small(small_case, *(part[0] for part in self._parts))
            states, report = small.march()
            if len(states) < len(readings):
                raise CalibrationError(
                    f"its section has {len(states)} of the {len(readings)} states of its cell: "
                    f"{report.reason}"
                )
            self._parts.append((small, states[: len(readings)], readings))

    @staticmethod
    def _wound(case: Case, bulging: Bulging) -> Case:
        wound = (e.with_bulging(bulging) if e.winds() else e for e in case.effects)
        return case.model_copy(update={"effects": tuple(wound)})

    def bulging(self, x: Floats) -> Bulging:
        """The numbers of a point; of every point K_b is positive, as 4 a2 > a1²."""
        scale, linear, beyond = (float(value) for value in x)
        quadratic = linear**2 / 4 + _QUADRATIC * np.exp(beyond)
        return Bulging(self._start * float(np.exp(scale)), linear, float(quadratic))

    def rounded(self, x: Floats) -> Bulging:
        """To six digits: the same on every machine but for the last."""
        numbers = self.bulging(x)
        return Bulging(*(float(f"{value:.6g}") for value in dataclasses.astuple(numbers)))

    def residual(self, x: Floats) -> Floats:
        """Weighted relative differences from the cell at a point."""
        return self._weighted(self.parts(self.bulging(x)))

    def slopes(self, x: Floats) -> Floats:
        """Its derivatives at the point where it was taken last, (m, 3)."""
        others = [self._potentials(self.bulging(x + _STEP * e)) for e in np.eye(3)]
        here = self._potentials(self.bulging(x))
        found: list[Floats] = []
        for small, states, readings in self._parts:
            values = np.empty((3, len(readings)))
            for index, (state, cell) in enumerate(zip(states, readings, strict=True)):
                now = _difference(small.read(state), cell)
                small.scene.exchange(here)
                for number, other in enumerate(small.near(state, others)):
                    values[number, index] = (_difference(small.read(other), cell) - now) / _STEP
            found.append(values)
        rows = [self._weighted([part[k] for part in found]) for k in range(3)]
        return np.array(rows).T

    def _weighted(self, parts: Sequence[Floats]) -> Floats:
        """In one, weighted: of states bent, and kept straight if there are any."""
        bent, straight = parts[0], parts[1] if len(parts) > 1 else np.zeros(0)
        if self._kept and len(straight):
            return np.r_[_OTHER * bent, straight]
        return np.r_[bent, _OTHER * straight]

    def parts(self, numbers: Bulging) -> tuple[Floats, Floats]:
        """Relative differences between section and cell: of states bent, and kept straight."""
        found: list[Floats] = []
        self._parts[0][0].scene.exchange(self._potentials(numbers))
        for small, states, readings in self._parts:
            values: list[float] = []
            for index, cell in enumerate(readings):
                state = small.again(states[index])
                if state is None:
                    values.append(_UNKNOWN)
                    continue
                states[index] = state
                values.append(_difference(small.read(state), cell))
            found.append(np.array(values))
        return found[0], found[1] if len(found) > 1 else np.zeros(0)

    def _potentials(self, numbers: Bulging) -> dict[str, Discrete]:
        """Windings with these numbers, as the scene that all parts share takes them."""
        small = self._parts[0][0]
        return {
            key: potential
            for winding in self._windings
            for key, potential in small.windings(winding.with_bulging(numbers)).items()
        }


def _difference(section: Reading, cell: Reading) -> float:
    """Of the pressure of what is bent, or of the moment of what is kept straight."""
    if cell.moment:
        return section.moment / cell.moment - 1
    return section.pressure / cell.pressure - 1

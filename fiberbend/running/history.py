"""One row of history.csv a converged step: what a user reads off a state."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import numpy.typing as npt

from analytic.spline import through
from fem.march.records import MODES, State
from fem.results.measures import fiber_forces
from fem.results.volume import VolumeProbe
from fem.scene import Scene
from fem.solver.newton import Outcome
from fiberbend import columns as col
from fiberbend.models.model import Gauge

Floats = npt.NDArray[np.float64]

UNCERTAINTIES, LEAST = 2.0, 2e-5
"""Unexplained energy: more than so many uncertainties, and than this part of the greatest."""


class Recorder:
    """Makes the rows, for the whole body also where a part of it is solved.

    Args:
        scene: the scene whose states are recorded.
        gauge: what the model reads off a state.
        model: the model, by which the columns are checked.
        rest: the state before any load, at which the scene is unless there are rows.
        rows: those of a run that is resumed.

    Attributes:
        rows: the rows so far.
    """

    def __init__(
        self,
        scene: Scene,
        gauge: Gauge,
        model: col.Filler,
        rest: State,
        rows: list[dict[str, Any]] | None = None,
    ) -> None:
        self._scene, self._model = scene, model
        self._gauge = gauge
        self._factor = scene.body.symmetry_factor
        self._energies = col.energy_columns(scene.keys)
        self._loads, self._shares = _load_columns(scene)
        self._volume = VolumeProbe.of(scene)
        self.rows = rows if rows is not None else [self._row(0, rest, None)]

    def add(self, state: State, outcome: Outcome) -> dict[str, Any]:
        """Append the row of a new state, at which the scene is; collective."""
        row = self._row(len(self.rows), state, outcome)
        self.rows.append(row)
        return row

    def integrate(self) -> list[int]:
        """Fill in the work of the loads since rest, by a spline through all steps.

        Returns:
            Steps in which the stored energy changed by what no load has done. A state that is not
            on the branch of the one before, as stable and as well converged as any, shows nowhere
            else.
        """
        work, uncertainty = self._work()
        for row, value in zip(self.rows, np.cumsum(work), strict=True):
            row[col.WORK] = float(value)
        return departures(work, uncertainty, np.array([row[col.STORED] for row in self.rows]))

    def _row(self, step: int, state: State, outcome: Outcome | None) -> dict[str, Any]:
        scene = self._scene
        x, y, z = self._gauge.tip(state)
        row: dict[str, Any] = {
            col.STEP: step,
            col.PRESSURE: 1e3 * state.scalars.get("pressure", 0.0),
            col.ANGLE: float(np.rad2deg(state.measures["control"])),
            col.TIP_Y: y,
            col.TIP_Z: z,
        }
        if "pressure" in state.scalars:
            row[col.VOLUME] = self._factor * state.measures["conjugate pressure"]
        row[col.TIP_X] = x
        row |= self._gauge.columns(state)
        row[col.ITERATIONS] = outcome.iterations if outcome else 0
        row[col.DET_F] = outcome.least_det_f if outcome else 1.0
        if self._volume is not None:
            kept = self._volume.read()
            row |= {col.VOLUME_ERROR_ELEMENT: kept.element, col.VOLUME_ERROR: kept.whole}
        forces = fiber_forces(scene)
        if forces is not None:
            row[col.FIBER_MIN], row[col.FIBER_MAX] = forces
        energies = scene.energies()
        pairs = {k: v for item in scene.discrete.values() for k, v in item.pairs().items()}
        loads = {
            name: state.measures[f"conjugate {name}"] for name in self._loads if name not in pairs
        }
        stored = sum(energies.values()) + sum(state.scalars[n] * v for n, v in loads.items())
        row[col.WORK] = 0.0
        row[col.STORED] = self._factor * stored
        for key, energy in energies.items():
            row[self._energies[key]] = self._factor * energy
        for name, load in self._loads.items():
            if name in pairs:
                row[load.value], row[load.conjugate] = pairs[name]
            else:
                row[load.value] = load.shown * state.scalars[name]
                row[load.conjugate] = self._factor * loads[name]
        row |= {column: state.scalars[name] for name, column in self._shares.items()}
        if outcome is not None:
            if MODES in state.measures:
                row[col.MODES] = int(state.measures[MODES])
            row |= self._gauge.last_columns(state)
        row |= col.read(self._model, scene, state)
        col.check(row, self._model)
        return row

    def _work(self) -> tuple[Floats, Floats]:
        """Work of the loads in the step to every row, and its uncertainty, N mm; see `work_of`."""
        loads = self._loads.values()
        if len(self.rows) < 2 or not loads:
            return np.zeros(len(self.rows)), np.zeros(len(self.rows))
        values = np.array([[row[load.value] / load.shown for load in loads] for row in self.rows])
        conjugates = np.array([[row[load.conjugate] for load in loads] for row in self.rows])
        return work_of(values, conjugates)


@dataclasses.dataclass(frozen=True)
class _Load:
    """Columns of a load and of its work-conjugate.

    Attributes:
        value: column of its value.
        conjugate: column of its work-conjugate.
        shown: what the column has of a value of one.
    """

    value: str
    conjugate: str
    shown: float = 1.0


def _load_columns(scene: Scene) -> tuple[dict[str, _Load], dict[str, str]]:
    """The columns of the loads of a scene by name, and those of shares of what comes in pairs.

    The work of a load without a potential is that of its pairs, not of the share that acts.

    Raises:
        KeyError: an effect does not say the units of a load that it brings.
    """
    units = {name: pair for effect in scene.effects.values() for name, pair in effect.units.items()}
    loads: dict[str, _Load] = {}
    shares: dict[str, str] = {}
    for effect in scene.effects.values():
        shares |= {name: col.load_columns(name, "", "")[0] for name in effect.shares}
    for item in scene.discrete.values():
        loads |= {name: _Load(*col.load_columns(name, *u)) for name, u in item.pair_units.items()}
    for name in scene.body.scalars:
        if name == "pressure":
            loads[name] = _Load(col.PRESSURE, col.VOLUME, 1e3)
        elif name not in (*scene.body.natural, *scene.added, *shares):
            if name not in units:
                raise KeyError(f"load {name!r} without a unit, expected one in `Effect.units`")
            loads[name] = _Load(*col.load_columns(name, *units[name]))
    return loads, shares


def work_of(values: Floats, conjugates: Floats) -> tuple[Floats, Floats]:
    """Work Σ ∫ q dQ in the step to each of n states, and its uncertainty, N mm, (n,) both.

    Q is the work-conjugate of a load q, for a pressure the volume of the chamber.

    Args:
        values: of m loads, (n, m).
        conjugates: their work-conjugates, (n, m).
    """
    total, uncertainty = np.zeros(len(values)), np.zeros(len(values))
    # where another load begins to move the curves have a kink
    moving = np.diff(values, axis=0) != 0
    kinks = np.flatnonzero(np.any(moving[1:] != moving[:-1], axis=1)) + 1
    for rows in np.split(np.arange(1, len(values)), kinks):
        piece = np.r_[rows[0] - 1, rows]
        for value, conjugate in zip(values[piece].T, conjugates[piece].T, strict=True):
            parts = _parts(value, conjugate)
            chord = (value[1:] + value[:-1]) / 2 * np.diff(conjugate)
            total[rows] += parts
            uncertainty[rows] += np.abs(parts - chord)
        # a spline is least certain where it has states on one side only
        uncertainty[[rows[0], rows[-1]]] = np.inf
    return total, uncertainty


def departures(work: Floats, uncertainty: Floats, stored: Floats) -> list[int]:
    """Steps in which the stored energy changes by what no load has done.

    The uncertainty of the spline is its distance from a chord, and infinite at the ends of a ramp.

    Args:
        work: of the loads in the step to each of n states, N mm, (n,).
        uncertainty: of it, N mm, (n,).
        stored: energy of each state, N mm, (n,).
    """
    gap = np.abs(work - np.diff(stored, prepend=stored[0]))
    around = np.max([uncertainty, np.roll(uncertainty, 1), np.roll(uncertainty, -1)], axis=0)
    odd = (gap > UNCERTAINTIES * around) & (gap > LEAST * np.max(np.abs(stored)))
    return [int(step) for step in np.flatnonzero(odd)]


def _along(value: Floats, conjugate: Floats) -> Floats:
    """What a curve q(Q) is fitted along, growing: Q or −Q where that grows, else its length.

    Along the numbers of the states a smooth curve looks bent where their distances change: on a
    vacuum tube that collapses, in steps of 1 to 6, its integral was a hundred times further off.
    """
    steps = np.diff(conjugate)
    if np.all(steps > 0) or np.all(steps < 0):
        return np.sign(steps[0]) * conjugate
    shares = (np.diff(q) / max(np.ptp(q), 1e-300) for q in (conjugate, value))
    length = np.hypot(*shares)
    # a load that is kept does work at a constant value: no curve to fit
    found = np.r_[0.0, np.cumsum(length)]
    return found if np.all(np.diff(found) > 0) else np.arange(len(value), dtype=float)


def _parts(value: Floats, conjugate: Floats) -> Floats:
    """∫ q dQ between n states of one ramp by a spline through them, N mm, (n - 1,)."""
    parameter = _along(value, conjugate)
    points, weights = np.polynomial.legendre.leggauss(6)
    width = np.diff(parameter)
    part = (1 + points) / 2
    q, _ = through(parameter, value, part)
    _, rate = through(parameter, conjugate, part)
    found: Floats = np.sum(width[:, None] / 2 * weights * q * rate, axis=1)
    return found

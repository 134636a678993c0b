"""One row of history.csv a converged step: what a user reads off a state."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from fem.embedded import FiberPotential
from fem.frames import Frames
from fem.linear import Factor
from fem.measures import Tip, UniformAngle, balance, mirror_factor
from fem.newton import Outcome
from fem.program import State
from fem.scene import Scene


class Recorder:
    """Makes the rows, for the whole body also where half of it is solved.

    Args:
        scene: the scene whose states are recorded.
        frames: rod frames of the body.
        blocked: the tip is blocked: reactions and balances are of interest.
        rest: the state before any load.

    Attributes:
        rows: the rows so far; a run that is resumed puts the earlier ones here.
    """

    def __init__(self, scene: Scene, frames: Frames, blocked: bool, rest: State) -> None:
        self._scene = scene
        self._blocked = blocked
        self._factor = mirror_factor(scene.domain)
        self._tip = Tip(scene.body)
        self._volumetric = int(scene.domain.comm.allreduce(int(np.count_nonzero(scene.volumetric))))
        self._uniform = UniformAngle(scene.body, frames)
        self.rows = [self._row(0, rest, None, None)]

    def add(self, state: State, outcome: Outcome, factor: Factor) -> dict[str, Any]:
        """Append the row of a new state, at which the scene is; collective."""
        row = self._row(len(self.rows), state, outcome, factor)
        self.rows.append(row)
        row["work_mJ"] = self._work()
        return row

    def _row(
        self, step: int, state: State, outcome: Outcome | None, factor: Factor | None
    ) -> dict[str, Any]:
        scene = self._scene
        tip = self._tip.position()
        row: dict[str, Any] = {
            "step": step,
            "pressure_kPa": 1e3 * state.scalars.get("pressure", 0.0),
            "angle_deg": float(np.rad2deg(state.measures["followed"])),
            "tip_y_mm": float(tip[1]),
            "tip_z_mm": float(tip[2]),
        }
        if "pressure" in state.scalars:
            row["chamber_mm3"] = self._factor * state.measures["conjugate pressure"]
        row["uniform_angle_deg"] = float(np.rad2deg(self._uniform.value(state.shape)))
        row["newton_iterations"] = outcome.iterations if outcome else 0
        row["min_det_F"] = outcome.least_det_f if outcome else 1.0
        for discrete in scene.discrete.values():
            if isinstance(discrete, FiberPotential):
                row["fiber_min_N"], row["fiber_max_N"] = discrete.force_range()
        energies = scene.energies()
        loads = {name: state.measures[f"conjugate {name}"] for name in state.scalars}
        stored = sum(energies.values()) + sum(state.scalars[n] * v for n, v in loads.items())
        row["work_mJ"] = 0.0
        row["stored_mJ"] = self._factor * stored
        for key, energy in energies.items():
            row[f"energy {key} mJ"] = self._factor * energy
        for name, value in loads.items():
            row[f"load {name}"] = state.scalars[name]
            row[f"conjugate {name}"] = self._factor * value
        if factor is not None:
            row["unstable_modes"] = factor.negative_pivots - self._volumetric
        if self._blocked:
            row |= self._reactions()
        return row

    def _reactions(self) -> dict[str, float]:
        found = balance(self._scene)
        return {
            "tip_force_N": float(found.supports["post"].force[1]),
            "roof_force_N": float(-found.supports["roof"].force[1]),
            "clamp_force_y_N": float(found.supports["clamp"].force[1]),
            "clamp_moment_x_Nmm": float(found.supports["clamp"].moment[0]),
            "balance_force": found.force,
            "balance_moment": found.moment,
        }

    def _work(self) -> float:
        """Work of the loads since rest, Σ ∫ q d(conjugate of q), by a spline through all steps."""
        total = 0.0
        for name in self._scene.body.scalars:
            value = np.array([row[f"load {name}"] for row in self.rows])
            conjugate = np.array([row[f"conjugate {name}"] for row in self.rows])
            # a load that is held does work at a constant value: no curve to fit
            parameter = np.arange(len(value), dtype=float)
            if np.all(np.diff(conjugate) > 0):
                parameter = conjugate
            degree = min(3, len(value) - 1)
            q = make_interp_spline(parameter, value, degree)
            v = make_interp_spline(parameter, conjugate, degree)
            points, weights = np.polynomial.legendre.leggauss(6)
            low, high = parameter[:-1, None], parameter[1:, None]
            t = (low + high) / 2 + (high - low) / 2 * points
            total += float(np.sum((high - low) / 2 * weights * q(t) * v(t, 1)))
        return total

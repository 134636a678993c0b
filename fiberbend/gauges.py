"""What each model reads off a converged state."""

from __future__ import annotations

import numpy as np

from analytic.path import tip
from fem.frames import Frames
from fem.measures import Tip, UniformAngle, balance
from fem.program import State
from fem.scene import Scene
from fem.uniform import CURVATURE, STRETCH, TWIST
from geometry.dimensions import Actuator


class BodyGauge:
    """The three-dimensional body.

    Args:
        scene: the scene.
        frames: rod frames of the body.
        blocked: the tip is blocked: reactions and balances are of interest.
    """

    def __init__(self, scene: Scene, frames: Frames, blocked: bool) -> None:
        self._scene, self._blocked = scene, blocked
        self._tip = Tip(scene.body)
        self._uniform = UniformAngle(scene.body, frames)

    def tip(self, state: State) -> tuple[float, float]:
        """y and z of the centroid of the tip cap's outer face, mm."""
        position = self._tip.position()
        return float(position[1]), float(position[2])

    def columns(self, state: State) -> dict[str, float]:
        """The angle without end effects."""
        assert state.shape is not None
        return {"uniform_angle_deg": float(np.rad2deg(self._uniform.value(state.shape)))}

    def last_columns(self, state: State) -> dict[str, float]:
        """Reactions of a blocked tip."""
        if not self._blocked:
            return {}
        found = balance(self._scene)
        return {
            "tip_force_N": float(found.supports["post"].force[1]),
            "roof_force_N": float(-found.supports["roof"].force[1]),
            "clamp_force_y_N": float(found.supports["clamp"].force[1]),
            "clamp_moment_x_Nmm": float(found.supports["clamp"].moment[0]),
            "balance_force": found.force,
            "balance_moment": found.moment,
        }


class UniformGauge:
    """Section and cell: the tip rides on a straight cap at the end of an arc.

    Args:
        scene: the scene.
        actuator: dimensions.
        straight: the curvature is held: the moment is of interest.
    """

    def __init__(self, scene: Scene, actuator: Actuator, straight: bool) -> None:
        self._scene, self._actuator, self._straight = scene, actuator, straight
        nodes = scene.domain.data.nodes
        self._crown = int(np.argmax(nodes[:, 1]))
        self._top = int(scene.body.node_dofs[self._crown, 1])
        self._height = float(nodes[self._crown, 1])
        self._per_length = scene.body.copies / actuator.length

    def tip(self, state: State) -> tuple[float, float]:
        """y and z of the centroid of the tip cap's outer face, mm; in the plane of bending."""
        actuator = self._actuator
        arc = actuator.length * state.scalars[STRETCH]
        z, down = tip(state.measures["followed"], arc, actuator.cap, actuator.face_height)
        return -float(down), float(z)

    def columns(self, state: State) -> dict[str, float]:
        """Stretch of the axis at the pin and of the crown, and the twist of the whole length."""
        scalars = state.scalars
        height = self._height + float(state.w[self._top])
        row = {
            "axis_stretch": scalars[STRETCH],
            "crown_stretch": scalars[STRETCH] + scalars[CURVATURE] * height,
        }
        if TWIST in scalars:
            row["twist_deg"] = float(np.rad2deg(scalars[TWIST] * self._actuator.length))
        return row

    def last_columns(self, state: State) -> dict[str, float]:
        """Moment and force that hold the body straight, and the tip force they stand for."""
        if not self._straight:
            return {}
        moment = self._per_length * state.measures[f"conjugate {CURVATURE}"]
        row = {"tip_force_N": moment / self._actuator.cap, "blocked_moment_Nmm": moment}
        if STRETCH not in self._scene.natural:
            row["axial_force_N"] = self._per_length * state.measures[f"conjugate {STRETCH}"]
        return row

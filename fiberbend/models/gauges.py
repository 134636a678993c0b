"""What each model reads off a converged state."""

from __future__ import annotations

import numpy as np

from analytic.path import tip
from fem.kinematics.uniform import CURVATURE, STRETCH, TWIST
from fem.march.frames import Frames
from fem.march.records import State
from fem.results.measures import (
    Resultant,
    Tip,
    UniformAngle,
    balance,
)
from fem.results.touch import probes
from fem.scene import Scene
from fiberbend import columns as col
from geometry.actuator import Actuator


class BodyGauge:
    """The three-dimensional body.

    Args:
        scene: the scene.
        frames: rod frames of the body.
    """

    def __init__(self, scene: Scene, frames: Frames) -> None:
        self._scene = scene
        self._tip = Tip(scene.body)
        self._uniform = UniformAngle(scene.body, frames)
        self._guided = "post" in scene.supports
        self._probes = probes(scene)

    def tip(self, state: State) -> tuple[float, float]:
        """y and z of the centroid of the tip cap's outer face, mm."""
        position = self._tip.position()
        return float(position[1]), float(position[2])

    def columns(self, state: State) -> dict[str, float]:
        """The angle without end effects."""
        assert state.shape is not None
        return {col.UNIFORM_ANGLE: float(np.rad2deg(self._uniform.value(state.shape)))}

    def last_columns(self, state: State) -> dict[str, float]:
        """Forces of supports and obstacles on the body, and what it touches."""
        if not self._guided and not self._probes:
            return {}
        found = balance(self._scene)
        supports = found.supports
        row: dict[str, float] = {}
        for column, name, sign in (("tip", "post", 1.0), ("roof", "roof", -1.0)):
            probe = self._probes.get(name)
            by = supports.get(name if probe is None else probe.key)
            if by is not None:
                row[f"{column}_force_N"] = sign * float(by.force[1])
        row["clamp_force_y_N"] = float(supports["clamp"].force[1])
        row["clamp_moment_x_Nmm"] = float(supports["clamp"].moment[0])
        row |= self._contacts(supports)
        if self._guided or any(row[f"contact_{name}_area_mm2"] for name in self._probes):
            row |= {col.BALANCE_FORCE: found.force, col.BALANCE_MOMENT: found.moment}
        return row

    def _contacts(self, supports: dict[str, Resultant]) -> dict[str, float]:
        """Force of every obstacle on the body, what touches it, and how far or deep."""
        row: dict[str, float] = {}
        for name, probe in self._probes.items():
            by, touch = supports[probe.key], probe.read()
            row |= {
                f"contact_{name}_y_N": float(by.force[1]),
                f"contact_{name}_z_N": float(by.force[2]),
                f"contact_{name}_moment_x_Nmm": float(by.moment[0]),
                f"contact_{name}_area_mm2": touch.area,
                f"contact_{name}_gap_mm": touch.gap,
            }
        return row


class UniformGauge:
    """Section and cell: the tip rides on a straight cap at the end of an arc.

    Args:
        scene: the scene.
        actuator: dimensions.
    """

    def __init__(self, scene: Scene, actuator: Actuator) -> None:
        self._scene, self._actuator = scene, actuator
        # kept straight, its moment is of interest
        self._straight = CURVATURE not in scene.natural
        nodes = scene.domain.data.nodes
        self._crown = int(np.argmax(nodes[:, 1]))
        self._top = int(scene.body.node_dofs[self._crown, 1])
        self._height = float(nodes[self._crown, 1])
        self._per_length = scene.body.symmetry_factor / actuator.length

    def tip(self, state: State) -> tuple[float, float]:
        """y and z of the centroid of the tip cap's outer face, mm; in the plane of bending."""
        actuator = self._actuator
        arc = actuator.length * state.scalars[STRETCH]
        z, down = tip(state.measures["control"], arc, actuator.cap, actuator.face_height)
        return -float(down), float(z)

    def columns(self, state: State) -> dict[str, float]:
        """Stretch of the axis at the pin and of the crown, and the twist of the whole length."""
        scalars = state.scalars
        height = self._height + float(state.w[self._top])
        row = {
            col.AXIS_STRETCH: scalars[STRETCH],
            col.CROWN_STRETCH: scalars[STRETCH] + scalars[CURVATURE] * height,
        }
        if TWIST in scalars:
            row[col.TWIST] = float(np.rad2deg(scalars[TWIST] * self._actuator.length))
        return row

    def last_columns(self, state: State) -> dict[str, float]:
        """Moment and force that keep the body straight, and the tip force that the moment makes."""
        if not self._straight:
            return {}
        moment = self._per_length * state.measures[f"conjugate {CURVATURE}"]
        row = {col.TIP_FORCE: moment / self._actuator.cap, col.MOMENT: moment}
        if STRETCH not in self._scene.natural:
            row[col.AXIAL_FORCE] = self._per_length * state.measures[f"conjugate {STRETCH}"]
        return row

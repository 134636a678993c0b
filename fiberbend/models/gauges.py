"""What each model reads off a converged state."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
import numpy.typing as npt

from analytic.path import CentreLine as UniformLine
from fem.effects.sums.hold import BEND, LENGTHENED, SIDE_BEND, TWISTED
from fem.kinematics.uniform import CURVATURE, SIDE, STRETCH, Uniform
from fem.march.records import State
from fem.results.centre_line import CentreLine
from fem.results.measures import (
    Resultant,
    Tip,
    balance,
)
from fem.results.touch import probes
from fem.scene import Scene
from fiberbend import columns as col
from geometry.actuator import Actuator
from geometry.mesh.centroid import winding_weights

Floats = npt.NDArray[np.float64]

PRESSURE = "pressure"
_HELD = {
    LENGTHENED: col.AXIAL_FORCE,
    BEND: col.MOMENT_X,
    SIDE_BEND: col.MOMENT_Y,
    TWISTED: col.TORQUE,
}
"""Forces that hold a uniform bend, and their columns."""


class BodyGauge:
    """The three-dimensional body.

    Args:
        scene: the scene.
        line: the line of its sections' centroids.
        borders: z of the planes between zones, mm; without them it is alike all along.
    """

    def __init__(self, scene: Scene, line: CentreLine, borders: Sequence[float] = ()) -> None:
        self._scene, self._line, self._borders = scene, line, borders
        self._tip = Tip(scene.body)
        self._guided = "post" in scene.supports
        # a pressurised closed chamber has no resultant
        self._loads = [name for name in scene.body.scalars if name not in (PRESSURE, *scene.added)]
        centre = winding_weights(scene.domain.data)[1] if self._loads else np.zeros(2)
        self._root: Floats = np.r_[centre, 0.0]
        self._probes = probes(scene)

    def tip(self, state: State) -> tuple[float, float, float]:
        """Centroid of the tip cap's outer face, mm."""
        x, y, z = (float(value) for value in self._tip.position())
        return 0.0 if self._scene.domain.data.half else x, y, z

    def columns(self, state: State) -> dict[str, float]:
        """Side angle and twist of a whole body, all angles without end effects, and stretch.

        Of a body with zones the angles of each in place of those without end effects.
        """
        if self._borders:
            return self._zones()
        middle = self._line.middle()
        row = {col.UNIFORM_ANGLE: float(np.rad2deg(middle[0]))}
        row[col.AXIS_STRETCH] = self._line.stretch()
        row[col.UNIFORM_STRETCH] = self._line.middle_stretch()
        if self._scene.domain.data.half:
            return row
        row |= _turns(self._line.turns())
        uniform = _turns(middle)
        return row | {
            col.UNIFORM_SIDE: uniform[col.SIDE_ANGLE],
            col.UNIFORM_TWIST: uniform[col.TWIST],
        }

    def _zones(self) -> dict[str, float]:
        row, whole = {col.AXIS_STRETCH: self._line.stretch()}, self._line.turns()
        half = self._scene.domain.data.half
        if not half:
            row |= _turns(whole)
        parts = self._line.turns_to(np.asarray(self._borders))
        for number, turns in enumerate(np.diff([np.zeros(3), *parts, whole], axis=0)):
            row[col.zone(number, "angle_deg")] = float(np.rad2deg(turns[0]))
            if not half:
                row[col.zone(number, "twist_deg")] = float(np.rad2deg(turns[2]))
        return row

    def last_columns(self, state: State) -> dict[str, float]:
        """Forces of supports and obstacles on the body, and what it touches."""
        if not (self._guided or self._probes or self._loads):
            return {}
        found = balance(self._scene)
        supports = found.supports
        row: dict[str, float] = {}
        for column, name, sign in (("tip", "post", 1.0), ("roof", "roof", -1.0)):
            probe = self._probes.get(name)
            by = supports.get(name if probe is None else probe.key)
            if by is not None:
                row[f"{column}_force_N"] = sign * float(by.force[1])
        clamp = supports["clamp"]
        for number, axis in enumerate("xyz"):
            row[f"clamp_force_{axis}_N"] = float(clamp.force[number])
            row[f"clamp_moment_{axis}_Nmm"] = float(clamp.moment[number])
        if self._loads:
            # what the body does to what pulls at it, as if that were at the section z = 0
            moment = clamp.moment - np.cross(self._root, clamp.force)
            names = (col.MOMENT_X, col.MOMENT_Y, col.TORQUE)
            row[col.AXIAL_FORCE] = float(clamp.force[2])
            row |= dict(zip(names, moment.tolist(), strict=True))
        row |= self._contacts(supports)
        loaded = any(state.scalars[name] for name in self._loads)
        touched = any(row[col.contact(name, "area_mm2")] for name in self._probes)
        if self._guided or loaded or touched:
            row |= {col.BALANCE_FORCE: found.force, col.BALANCE_MOMENT: found.moment}
        return row

    def _contacts(self, supports: dict[str, Resultant]) -> dict[str, float]:
        """Force of every obstacle on the body, what touches it, and how far or deep."""
        row: dict[str, float] = {}
        for name, probe in self._probes.items():
            by, touch = supports[probe.key], probe.read()
            row |= {
                col.contact(name, "y_N"): float(by.force[1]),
                col.contact(name, "z_N"): float(by.force[2]),
                col.contact(name, "moment_x_Nmm"): float(by.moment[0]),
                col.contact(name, "area_mm2"): touch.area,
                col.contact(name, "gap_mm"): touch.gap,
            }
        return row


class UniformGauge:
    """Section and cell: a rod along the line of the centroids, its first section clamped.

    The tip rides on a straight cap across the last section.

    Args:
        body: kinematics of uniform bending.
        natural: its scalars that are found.
        actuator: dimensions.
    """

    def __init__(self, body: Uniform, natural: Collection[str], actuator: Actuator) -> None:
        self._body, self._actuator = body, actuator
        # kept straight, its moment is of interest
        self._straight, self._held = CURVATURE not in natural, STRETCH not in natural
        data = body.domain.data
        self._crown = int(np.argmax(data.nodes[:, 1]))
        self._pin = data.points["pin"]
        self._per_length = body.symmetry_factor / actuator.length
        self._read: tuple[State, UniformLine] | None = None

    def tip(self, state: State) -> tuple[float, float, float]:
        """Centroid of the tip cap's outer face, mm."""
        actuator, height = self._actuator, float(self._body.fit.rest[1])
        axes, centre = self._line(state).sections(np.array([actuator.length]))
        x, y, z = centre[0] + axes[0] @ [0.0, actuator.face_height - height, actuator.cap]
        return float(x), height + float(y), float(z)

    def columns(self, state: State) -> dict[str, float]:
        """Side angle and twist where it may leave its plane, and stretches of three lines."""
        line, length = self._line(state), self._actuator.length
        row = {}
        if self._body.twisted or self._body.sideways:
            row = _turns(length * line.rates)
        floor, crown = (
            float(np.linalg.norm(line.advance(self._place(state, node))))
            for node in (self._pin, self._crown)
        )
        return row | {
            col.AXIS_STRETCH: line.stretch,
            col.FLOOR_STRETCH: floor,
            col.CROWN_STRETCH: crown,
        }

    def _line(self, state: State) -> UniformLine:
        """The centroids' line at a state, at which the body is; read once."""
        if self._read is None or self._read[0] is not state:
            self._read = state, self._body.centre_line()
        return self._read[1]

    def _place(self, state: State, node: int) -> Floats:
        """Of a node in the turning frame, mm, (3,)."""
        place = np.zeros(3)
        place[:2] = self._body.domain.data.nodes[node, :2]
        place[: self._body.components] += state.w[self._body.node_dofs[node]]
        return place

    def last_columns(self, state: State) -> dict[str, float]:
        """Forces and moments of what holds it; kept straight, with the tip force of the moment.

        A force N along the axis and moments M_x, M_y about the lines y = 0 and x = 0, conjugate to
        stretch and curvatures, are a force N through the centroid and moments M_x − N c_y and
        M_y + N c_x about it.
        """
        if any(name in state.scalars for name in _HELD):
            # what it does to what holds it
            return {column: 0.0 - state.scalars.get(name, 0.0) for name, column in _HELD.items()}
        if not self._straight:
            return {}
        moment, side = (
            self._per_length * state.measures.get(f"conjugate {name}", 0.0)
            for name in (CURVATURE, SIDE)
        )
        row = {}
        if self._held:
            force = row[col.AXIAL_FORCE] = self._per_length * state.measures[f"conjugate {STRETCH}"]
            x, y, _ = self._line(state).centre
            moment, side = moment - force * float(y), side + force * float(x)
        if self._body.sideways:
            row[col.MOMENT_Y] = side
        row |= {col.MOMENT: moment, col.MOMENT_X: moment}
        return {col.TIP_FORCE: moment / self._actuator.cap} | row


def _turns(turns: Floats) -> dict[str, float]:
    """Side angle and twist of turns about d1, d2 and the tangent, (3,), rad."""
    return {
        col.SIDE_ANGLE: float(np.rad2deg(turns[1])),
        col.TWIST: float(np.rad2deg(turns[2])),
    }

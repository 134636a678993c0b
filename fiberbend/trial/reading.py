"""What a trial reads off a state."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.march.records import State
from fem.results.measures import fiber_forces
from fiberbend import columns as col
from fiberbend.states.recovery import SplitNodes, principal_stretches, split_nodes
from fiberbend.states.snapshot import Snapshot
from fiberbend.trial.wanted import Point
from fiberbend.uniform.small import PRESSURE, Small

VOLUME = f"conjugate {PRESSURE}"


class Reader:
    """Reads points off the states of a scene.

    Args:
        small: the scene, at rest.
    """

    def __init__(self, small: Small) -> None:
        self._small, scene = small, small.scene
        self._gauge = small.observables.gauge()
        self._factor = scene.body.symmetry_factor
        self._copies: SplitNodes = split_nodes(scene.domain.data)

    def point(self, state: State) -> Point:
        """What is told of a state; the scene is left at it."""
        small, gauge, factor = self._small, self._gauge, self._factor
        small.put(state)
        row = gauge.columns(state) | gauge.last_columns(state)
        forces = fiber_forces(small.scene) or (0.0, 0.0)
        return Point(
            pressure=state.scalars[PRESSURE],
            angle=state.measures["control"],
            side_angle=float(np.deg2rad(row.get(col.SIDE_ANGLE, 0.0))),
            twist=float(np.deg2rad(row.get(col.TWIST, 0.0))),
            stretch=row[col.AXIS_STRETCH],
            moment=row.get(col.MOMENT_X, 0.0),
            torque=row.get(col.TORQUE, 0.0),
            tip_force=row.get(col.TIP_FORCE, 0.0),
            strain=self._strain(),
            fiber_low=forces[0],
            fiber_high=forces[1],
            volume=factor * state.measures[VOLUME],
            volume_at_rest=factor * small.rest.measures[VOLUME],
            work=factor * self._stored(state),
        )

    def _strain(self) -> float:
        """As run.json has it: at the nodes, averaged within each region."""
        scene = self._small.scene
        body, mesh = scene.body, scene.domain.data
        bend: dict[str, Any] = {name: scene.scalar(name) for name in body.natural}
        shot = Snapshot(
            label="trial",
            step=0,
            pressure_kpa=0.0,
            angle_deg=0.0,
            displacement=body.w.x.array[body.node_dofs],
            multiplier=np.zeros((0, 0)),
            fiber_force=None,
            **bend,
        )
        return float(np.log(principal_stretches(mesh, shot, self._copies)[:, 0].max()))

    def _stored(self, state: State) -> float:
        """Energies and, of every load, value times work-conjugate, as history.csv adds them."""
        scene = self._small.scene
        paired = {name for item in scene.discrete.values() for name in item.pairs()}
        loads = {
            name: value
            for name, value in state.scalars.items()
            if f"conjugate {name}" in state.measures and name not in paired
        }
        given = sum(value * state.measures[f"conjugate {name}"] for name, value in loads.items())
        return sum(scene.energies().values()) + given

"""A rod in space: the sections of a body at rest, carried along by the line."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.case.case import Case
from fiberbend.results.at_rest import body_at_rest
from fiberbend.slender.actuator import Slender
from fiberbend.slender.path import PRESSURE, Point
from fiberbend.states.snapshot import ModelMesh, Snapshot
from rod.functions import Floats


class Solid:
    """The body that pictures show: its sections keep their shape.

    Args:
        case: the case.
        slender: its rod.

    Attributes:
        model_mesh: at rest.
    """

    def __init__(self, case: Case, slender: Slender) -> None:
        self._slender = slender
        plain = body_at_rest(case, half=slender.rod.layout.plane)
        title = f"{case.title}: rod, its sections drawn as at rest"
        self.model_mesh: ModelMesh = dataclasses.replace(plain, title=title, carried=True)
        nodes, root = plain.mesh.nodes, slender.rod.layout.place
        self._z, self._level = np.unique(nodes[:, 2], return_inverse=True)
        self._arms: Floats = np.column_stack([nodes[:, :2] - root[:2], np.zeros(len(nodes))])

    def snapshot(self, point: Point, label: str, step: int, remark: str = "") -> Snapshot:
        """A state in space.

        Args:
            point: the state.
            label: its name.
            step: its number.
            remark: what every picture of it has to say.
        """
        mesh = self.model_mesh.mesh
        frames = point.state.shape.along(self._z - self._slender.rod.layout.place[2])
        here = frames[self._level.ravel()]
        places = here[..., 3] + np.einsum("nij,nj->ni", here[..., :3], self._arms)
        return Snapshot(
            label=label,
            step=step,
            pressure_kpa=1e3 * point.values.get(PRESSURE, 0.0),
            angle_deg=float(np.rad2deg(point.angle)),
            displacement=places - mesh.nodes,
            multiplier=np.zeros(mesh.cells.shape),
            fiber_force=None,
            remark=remark,
        )

"""Rigid obstacles in pictures: what they look like, and what is written about a state beside them.

pyvista is imported where it is used: a run without pictures does without it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from fiberbend.drawing.renderer import Drawable, View
from fiberbend.states.labels import short_number
from fiberbend.states.obstacles import Shape
from fiberbend.states.snapshot import Snapshot
from geometry.mesh.data import Floats

COLOR = "#d9d9d9"
_THICK = 0.012
"""Thickness of a plane in a picture, as a part of its own extent."""
_LINE = 0.0012
"""Radius of the lines along its edges, likewise."""
_SEEN_THROUGH = 0.25
_TOUCHES = 0.3
"""Distance in mm from the nearest point of the body up to which others count as its touch, too."""
_STRAIGHT = 0.05
"""Bending angle in degrees up to which a body is straight for who looks at it."""

Force = tuple[float, float, float]
"""Components along x, y and z, N."""


@dataclasses.dataclass(frozen=True)
class Scenery:
    """What pictures of a run show and say beside the body.

    Attributes:
        shapes: rigid obstacles by their names.
        forces: by the number of a load step, the force of each obstacle on the body, N.
        tip_forces: by the number of a load step, the tip force in N of a body that is kept
            straight; empty for others.
    """

    shapes: Mapping[str, Shape] = dataclasses.field(default_factory=dict)
    forces: Mapping[int, Mapping[str, Force]] = dataclasses.field(default_factory=dict)
    tip_forces: Mapping[int, float] = dataclasses.field(default_factory=dict)

    def caption(self, state: Snapshot) -> str:
        """Pressure and angle of a state; where the body is kept straight its force comes first."""
        force = self.tip_forces.get(state.step)
        if force is None:
            return state.caption
        text = f"P = {short_number(state.pressure_kpa)} kPa,  F = {short_number(force)} N"
        angle = short_number(state.angle_deg)
        return text if abs(state.angle_deg) < _STRAIGHT else f"{text},  θ = {angle}°"

    def greatest(self) -> float:
        """Greatest force of an obstacle in any step, N."""
        every = [np.linalg.norm(f) for step in self.forces.values() for f in step.values()]
        return float(max(every, default=0.0))


class Obstacles:
    """The obstacles of a run as things to draw.

    Args:
        scenery: their shapes.
        around: points of the body in all states that are shown, (n, 3), mm.
    """

    def __init__(self, scenery: Scenery, around: Floats) -> None:
        self.scenery = scenery
        self.solids = {
            name: _solid(shape.surface(around)) for name, shape in scenery.shapes.items()
        }

    @property
    def points(self) -> Floats:
        """Points that a view of the whole contains, (n, 3), mm."""
        return np.concatenate(
            [np.zeros((0, 3)), *(np.asarray(solid.points) for solid in self.solids.values())]
        )

    def behind(self, view: View) -> list[Drawable]:
        """Obstacles that never hide or tint the body: moved away from the viewer, along the view."""
        away = -view.axes[2] * 4 * view.width
        return [
            Drawable(solid.translate(away), color=COLOR, flat=True)
            for solid in self.solids.values()
        ]

    def seen_through(self) -> list[Drawable]:
        """Obstacles where they are, with their edges, through which the body is seen."""
        layers = []
        for solid in self.solids.values():
            size = float(np.linalg.norm(np.ptp(solid.points, axis=0)))
            edges = solid.extract_feature_edges(
                feature_angle=30, boundary_edges=True, manifold_edges=False
            )
            layers.append(Drawable(solid, color=COLOR, opacity=_SEEN_THROUGH, flat=True))
            layers.append(Drawable(edges, color="#707070", radius=_LINE * size, flat=True))
        return layers

    def touch(self, name: str, body: Floats) -> Floats:
        """Middle of where the body is nearest to an obstacle, (3,), mm.

        Args:
            name: of the obstacle.
            body: points of the body's surface, (n, 3), mm.
        """
        import pyvista as pv

        solid = self.solids[name]
        cloud = pv.PolyData(np.asarray(body, dtype=float))
        distance = np.asarray(cloud.compute_implicit_distance(solid)["implicit_distance"])
        near = distance <= distance.min() + _TOUCHES
        middle: Floats = np.asarray(body)[near].mean(axis=0)
        return middle


def labels(scenery: Scenery, step: int | None) -> dict[str, str]:
    """What is written beside each obstacle: its name, and its force in a state.

    Args:
        scenery: names and forces.
        step: number of the load step; None: the name only.
    """
    forces = {} if step is None else scenery.forces.get(step, {})
    texts = {}
    for name in scenery.shapes:
        texts[name] = name
        if name in forces:
            texts[name] += f" {short_number(float(np.linalg.norm(forces[name])))} N"
    return texts


def _solid(surface: Any) -> Any:
    """A surface; of a flat sheet a thin plate below it, so that it is seen from its edge, too."""
    points = np.asarray(surface.points, dtype=float)
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[2] > 1e-9 * spread[0]:
        return surface.triangulate()
    normal = np.asarray(surface.face_normals)[0]
    down = -normal * _THICK * float(np.linalg.norm(np.ptp(points, axis=0)))
    del axes
    return surface.extrude(down, capping=True).triangulate()

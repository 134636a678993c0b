"""Rigid obstacles in pictures: what they look like, and what is written about a state beside them.

pyvista is imported where it is used: a run without pictures does without it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from fiberbend.drawing.renderer import Drawable, View, frame
from fiberbend.drawing.space.panel import Panel
from fiberbend.states.labels import short_number
from fiberbend.states.obstacles import Shape
from fiberbend.states.snapshot import Snapshot
from geometry.actuator import Actuator
from geometry.mesh.data import Floats
from geometry.winding.strip import Window

COLOR = "#d9d9d9"
_THICK = 0.012
"""Thickness of a plane in a picture, as a part of its own extent."""
_LINE = 0.001
"""Radius of the lines along edges, as a part of the body's extent."""
_SEEN_THROUGH = 0.25
_TOUCHES = 0.3
"""Distance in mm from the nearest point of the body up to which others count as its touch, too."""
_MOST = 4000
"""Points of the body that are asked for their distance from an obstacle."""
_ROOM, _BESIDE = 0.085, 0.03
"""Room for what is written beside obstacles, as parts of a picture's width."""
_BEYOND = 0.6
"""How far beyond the body an obstacle makes a view wider, as a part of the body's extent."""
_NO_FORCE = 1e-6
"""Part of the greatest force in a run that is round-off."""
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
        lengths: dimensions in mm that a picture at rest states: "chamber", "whole", "height" and
            "width", and the thickness of each region; what is missing is measured on the mesh or
            left out.
        actuator: on whose outline the strips lie; None without any.
        strips: of fabric, as parts of the outline.
        at_tip: by the number of a load step, what acts at the tip's outer face, its force in N, or
            None where it has no direction that is known.
        turned: by the number of a load step, how far it is turned beside its bending angle over the
            whole length, in degrees by what captions call it.
        times: by the number of a step of a motion, when that is, s.
    """

    shapes: Mapping[str, Shape] = dataclasses.field(default_factory=dict)
    forces: Mapping[int, Mapping[str, Force]] = dataclasses.field(default_factory=dict)
    tip_forces: Mapping[int, float] = dataclasses.field(default_factory=dict)
    lengths: Mapping[str, float] = dataclasses.field(default_factory=dict)
    actuator: Actuator | None = None
    strips: tuple[Window, ...] = ()
    at_tip: Mapping[int, Mapping[str, Force | None]] = dataclasses.field(default_factory=dict)
    turned: Mapping[int, Mapping[str, float]] = dataclasses.field(default_factory=dict)
    times: Mapping[int, float] = dataclasses.field(default_factory=dict)

    def caption(self, state: Snapshot) -> str:
        """Pressure and turns of a state; where the body is kept straight its force comes first."""
        force = self.tip_forces.get(state.step)
        if force is None:
            turned = self.turned.get(state.step, {}).items()
            time = self.times.get(state.step)
            when = "" if time is None else f"t = {time:.2f} s,  "
            return when + state.caption + "".join(f",  {n} {short_number(v)}°" for n, v in turned)
        text = f"P = {short_number(state.pressure_kpa)} kPa,  F = {short_number(force)} N"
        angle = short_number(state.angle_deg)
        return text if abs(state.angle_deg) < _STRAIGHT else f"{text},  θ = {angle}°"

    def greatest(self) -> float:
        """Greatest force of an obstacle in any step, N."""
        known = [*self.forces.values(), *self.at_tip.values()]
        every = [np.linalg.norm(f) for step in known for f in step.values() if f is not None]
        return float(max(every, default=0.0))


class Obstacles:
    """The obstacles of a run as things to draw.

    Args:
        scenery: their shapes.
        around: points of the body in all states that are shown, (n, 3), mm.
    """

    def __init__(self, scenery: Scenery, around: Floats) -> None:
        self.scenery = scenery
        low, high = around.min(axis=0), around.max(axis=0)
        beyond = _BEYOND * float((high - low).max())
        self._reach = (low - beyond, high + beyond)
        self._line = _LINE * float(np.linalg.norm(np.ptp(around, axis=0)))
        self.solids = {
            name: _solid(shape.surface(around)) for name, shape in scenery.shapes.items()
        }

    @property
    def points(self) -> Floats:
        """Points that a view of the whole contains, (n, 3), mm; of a large obstacle a part."""
        every = [np.zeros((0, 3)), *(np.asarray(solid.points) for solid in self.solids.values())]
        return np.concatenate(every).clip(*self._reach)

    def frame(self, body: Floats, toward: tuple[float, float, float], aspect: float) -> View:
        """The least view of the body and all obstacles, with room for what is written beside them.

        Args:
            body: its points in the states that are shown, (n, 3), mm.
            toward: direction to the viewer.
            aspect: width over height of the picture.
        """
        if not self.solids:
            return frame(body, toward, aspect)
        return frame(np.concatenate([body, self.points]), toward, aspect, _ROOM)

    def margins(self, width: int) -> tuple[int, int]:
        """Pixels above and below, and beside all that is drawn, in which something may be written.

        Args:
            width: of the picture, pixels.
        """
        if not self.solids:
            return 6, 6
        return round(_ROOM * width), round(_BESIDE * width)

    def behind(self, view: View) -> list[Drawable]:
        """Obstacles that never hide or tint the body: moved away from the viewer."""
        away = -view.axes[2] * 4 * view.width
        return [
            Drawable(solid.translate(away), color=COLOR, flat=True)
            for solid in self.solids.values()
        ]

    def seen_through(self) -> list[Drawable]:
        """Obstacles where they are, with their edges, through which the body is seen."""
        layers = []
        for solid in self.solids.values():
            edges = solid.extract_feature_edges(
                feature_angle=30, boundary_edges=True, manifold_edges=False
            )
            layers.append(Drawable(solid, color=COLOR, opacity=_SEEN_THROUGH))
            layers.append(Drawable(edges, color="#707070", radius=self._line, flat=True))
        return layers

    def touch(self, name: str, body: Floats) -> Floats:
        """The point of an obstacle in the middle of where the body is nearest to it, (3,), mm.

        Args:
            name: of the obstacle.
            body: points of the body's surface, (n, 3), mm.
        """
        import pyvista as pv

        solid, body = self.solids[name], body[:: max(1, len(body) // _MOST)]
        cloud = pv.PolyData(np.asarray(body, dtype=float))
        distance = np.asarray(cloud.compute_implicit_distance(solid)["implicit_distance"])
        near = distance <= distance.min() + _TOUCHES
        _, point = solid.find_closest_cell(body[near].mean(axis=0), return_closest_point=True)
        return np.asarray(point)


def write_forces(
    panel: Panel,
    obstacles: Obstacles,
    body: Floats,
    state: Snapshot | None = None,
    fontsize: float = 11,
    tip: Floats | None = None,
) -> None:
    """Name each obstacle beside it, with its force on the body and an arrow where that is known.

    Args:
        panel: where.
        obstacles: of the run.
        body: points of the body in the state, (n, 3), mm.
        state: the state; None: names only.
        fontsize: in points.
        tip: the middle of the tip's outer face in the state, (3,), mm; None: a body without one.
    """
    scenery = obstacles.scenery
    forces = {} if state is None else scenery.forces.get(state.step, {})
    greatest = scenery.greatest()
    for name, solid in obstacles.solids.items():
        force = np.array(forces.get(name, (0.0, 0.0, 0.0)))
        size = float(np.linalg.norm(force))
        text = f"{name} {short_number(size)} N" if name in forces else name
        if size > _NO_FORCE * greatest:
            panel.force(text, obstacles.touch(name, body), force, greatest, fontsize)
        else:
            panel.name(text, np.asarray(solid.center), fontsize)
    write_at_tip(panel, scenery, tip, state, fontsize)


def write_at_tip(
    panel: Panel,
    scenery: Scenery,
    tip: Floats | None,
    state: Snapshot | None,
    fontsize: float,
) -> None:
    """Name what acts at the tip's outer face, with an arrow where its direction is known.

    Args:
        panel: where.
        scenery: has it.
        tip: the middle of that face, (3,), mm; None: not drawn.
        state: the state; None: at rest, nothing acts yet.
        fontsize: in points.
    """
    if tip is None or state is None:
        return
    greatest = scenery.greatest()
    for name, force in scenery.at_tip.get(state.step, {}).items():
        size = 0.0 if force is None else float(np.linalg.norm(force))
        if size > _NO_FORCE * greatest:
            panel.force(f"{name} {short_number(size)} N", tip, np.array(force), greatest, fontsize)
        else:
            panel.name(name, tip, fontsize)


def _solid(surface: Any) -> Any:
    """A surface; of a flat sheet a thin plate below it, so that it is seen from its edge, too."""
    points = np.asarray(surface.points, dtype=float)
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if spread[2] > 1e-9 * spread[0]:
        return surface.triangulate()
    normal = np.asarray(surface.face_normals)[0]
    down = -normal * _THICK * float(np.linalg.norm(np.ptp(points, axis=0)))
    return surface.extrude(down, capping=True).triangulate()

"""What makes each finite-element model: its mesh, kinematics, control quantity and gauges."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np

from fem.kinematics.body import Body
from fem.kinematics.cell import Cell
from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Kinematics
from fem.kinematics.section import Section
from fem.kinematics.uniform import CurvatureAngle, Uniform
from fem.march.frames import Frames
from fem.results.measures import BendingAngle
from fem.scene import Scene
from fem.solver.side_conditions import Functional
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects.table import StraightEffect, WindingEffect
from fiberbend.models.body import BodyGauge, UniformGauge
from fiberbend.models.choice import choose_half
from fiberbend.models.mesh_size import cell_slice, mesh_size
from fiberbend.models.parts import helix, twisting
from fiberbend.running.history import Gauge
from geometry.mesh.data import MeshData

Make = Callable[[Domain, Iterable[str]], Kinematics]


@dataclasses.dataclass(frozen=True)
class Reading:
    """What is read off the states of a scene.

    Attributes:
        frames: rod frames of a body; None where the kinematics turns by itself.
        control: the bending angle.
        gauge: makes the columns of the history; call it when the scene is at rest.
    """

    frames: Frames | None
    control: Functional
    gauge: Callable[[], Gauge]


def kinematics(case: Case, model: str) -> Make:
    """The kinematics of a model, to be made from a domain and the names of the fields."""
    if model == "body":
        return Body
    kind = Section if model == "section" else Cell
    return functools.partial(kind, length=case.actuator.length, twisted=twisting(case))


def reading(case: Case, scene: Scene) -> Reading:
    """What is read off the states of a scene."""
    body = scene.body
    if isinstance(body, Uniform):
        actuator = convert.dimensions(case.actuator)
        straight = case.find(StraightEffect) is not None
        return Reading(None, CurvatureAngle(body), lambda: UniformGauge(scene, actuator, straight))
    frames = Frames(body)
    return Reading(frames, BendingAngle(body, frames), lambda: BodyGauge(scene, frames))


def make_mesh(case: Case, model: str, msh: Path | None = None) -> MeshData:
    """The mesh of a model; only a body starts gmsh.

    Args:
        case: the case.
        model: "section", "cell" or "body".
        msh: where gmsh leaves the body and its fibers.

    Raises:
        MeshError: gmsh failed.
    """
    half, _ = choose_half(case)
    actuator = convert.dimensions(case.actuator)
    size = mesh_size(case, model, half)
    winding = case.find(WindingEffect)
    if model == "section":
        from geometry.bodies.extrude import swept_section

        return swept_section(actuator, size)
    if model == "cell":
        from geometry.bodies.extrude import swept_slice

        return swept_slice(actuator, size, *cell_slice(case, half))
    from geometry.bodies.gmsh_body import build_body

    curves = None
    if winding is not None:
        helices = helix(winding)
        turns = int(np.ceil(actuator.length / winding.pitch)) * 24
        curves = [helices.points(actuator, curve, turns)[0] for curve in range(helices.curves)]
    return build_body(actuator, size, convert.strips(convert.tip_support(case)), curves, msh)

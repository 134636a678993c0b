"""Made-up states of a section and of a cell: kinematics without a solver."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fiberbend.states.snapshot import FamilyLook, ModelMesh, Snapshot
from geometry.bodies.extrude import hexahedral_slice, section_quadrilaterals
from geometry.mesh.data import Floats
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.smear import smear
from tests.output.bending import MATERIALS, SHORT

PITCH = 3.0
DOUBLE = Winding("double-helix", PITCH, 0.38)


def section(half: bool = True) -> ModelMesh:
    mesh = section_quadrilaterals(SHORT, MeshSize(axial=PITCH, half=half))
    fibers = smear(mesh, SHORT, DOUBLE)
    return ModelMesh(mesh, MATERIALS, fibers, smeared=True, title="Section", uniform=True)


HANDS = (FamilyLook("fiber", 1), FamilyLook("fiber", 0))
"""Of a double helix."""


def cell(half: bool = True, fineness: int = 1) -> ModelMesh:
    extent = PITCH / 2 if half else PITCH
    mesh = hexahedral_slice(SHORT, MeshSize(axial=PITCH, section=fineness, half=half), extent, 2)
    fibers = embed(mesh, SHORT, DOUBLE)
    return ModelMesh(
        mesh, MATERIALS, fibers, smeared=False, title="Cell", uniform=True, families=HANDS
    )


def state(
    scene: ModelMesh,
    degrees: float = 90.0,
    stretch: float = 1.0,
    move: Callable[[Floats], Floats] | None = None,
    twist: float = 0.0,
) -> Snapshot:
    """A state of given kinematics, with a made-up fiber force of 2 N and more."""
    mesh, fibers = scene.mesh, scene.fibers
    assert fibers is not None
    displacement = np.zeros_like(mesh.nodes) if move is None else move(mesh.nodes)
    return Snapshot(
        label=f"{degrees:.0f}deg",
        step=1,
        pressure_kpa=degrees / 2,
        angle_deg=degrees,
        displacement=displacement,
        multiplier=np.zeros(mesh.cells.shape),
        fiber_force=fibers.share * (2 + np.cos(fibers.s / 5)),
        curvature=np.radians(degrees) / SHORT.length,
        stretch=stretch,
        twist=twist,
    )


def wave(nodes: Floats) -> Floats:
    """What differs between mirror planes: largest between them, with slices that are no planes."""
    turn = np.pi * nodes[:, 2] / (PITCH / 2)
    return np.column_stack(
        [0.01 * nodes[:, 0], 0.1 - 0.1 * np.cos(turn), 0.05 * nodes[:, 1] * np.sin(turn)]
    )


def warp(nodes: Floats) -> Floats:
    """A section that warps as the twofold axis allows: w odd in x."""
    return np.column_stack([0.0 * nodes[:, 0], 0.0 * nodes[:, 0], 0.05 * nodes[:, 0]])

"""Quantities that a user reads off a state: tip, reactions."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.effects.embedded_fibers import FiberPotential
from fem.kinematics.kinematics import Kinematics
from fem.scene import Scene

Floats = npt.NDArray[np.float64]


class Tip:
    """Centroid of the tip cap's outer face."""

    def __init__(self, body: Kinematics, surface: str = "tip") -> None:
        self._body = body
        weights = body.domain.surface_weights(surface)
        weights /= weights.sum()
        nodes = body.owned_nodes[weights[body.owned_nodes] > 0]
        self._weights = weights[nodes]
        self._dofs = body.node_dofs[nodes]
        self._nodes = body.domain.data.nodes[nodes]

    def position(self) -> Floats:
        """Deformed position in mm, (3,); of what is modelled."""
        x = self._nodes + self._body.w.x.array[self._dofs]
        position: Floats = self._body.domain.comm.allreduce(self._weights @ x, MPI.SUM)
        return position


@dataclasses.dataclass(frozen=True)
class Resultant:
    """Force in N and moment about the origin in N mm, of the whole body."""

    force: Floats
    moment: Floats

    def __add__(self, other: Resultant) -> Resultant:
        return Resultant(self.force + other.force, self.moment + other.moment)


def resultant(scene: Scene, vector: Floats, only: npt.NDArray[np.int32] | None) -> Resultant:
    """Force and moment of owned nodal forces at the deformed positions, of the whole body.

    In a half model the mirror image is added.

    Args:
        scene: gives positions.
        vector: owned entries of a force vector, N.
        only: local dofs to which it is restricted, (n,), or None for all.
    """
    body = scene.body
    mask = np.full(body.local, only is None)
    if only is not None:
        mask[only] = True
    dofs = body.node_dofs[body.owned_nodes]
    force = np.where(mask[dofs], vector[dofs], 0.0)
    x = body.domain.data.nodes[body.owned_nodes] + body.w.x.array[dofs]
    total = np.concatenate([force.sum(axis=0), np.cross(x, force).sum(axis=0)])
    total = body.domain.comm.allreduce(total, MPI.SUM)
    if body.domain.data.half:
        total *= [0, 2, 2, 2, 0, 0]
    return Resultant(total[:3], total[3:])


@dataclasses.dataclass(frozen=True)
class Balance:
    """Supports and loads at an equilibrium.

    Attributes:
        supports: what each support, and each effect that acts from outside, does to the body; a
            mirror plane is internal and not among them.
        force: what is left of all forces, relative to the greatest support force.
        moment: what is left of all moments about the origin, likewise.
    """

    supports: dict[str, Resultant]
    force: float
    moment: float


def balance(scene: Scene, mirror: str = "symmetry") -> Balance:
    """Reactions by the residual, contact by its own forces, and how far all is from balance.

    A pressurised closed chamber has no resultant, so that the supports must balance the other
    loads, and each other without any.
    """
    residual, _ = scene.residual()
    supports = {
        name: resultant(scene, residual, scene.fixed(name))
        for name in scene.supports
        if name != mirror
    }
    supports |= {key: resultant(scene, scene.force(key), None) for key in scene.outside}
    total = Resultant(np.zeros(3), np.zeros(3))
    for support in supports.values():
        total += support
    for name in scene.body.scalars:
        load = -scene.scalar(name) * scene.load(name, constrained=True)
        total += resultant(scene, load, None)
    forces = [float(np.linalg.norm(s.force)) for s in supports.values()]
    moments = [float(np.linalg.norm(s.moment)) for s in supports.values()]
    return Balance(
        supports,
        float(np.linalg.norm(total.force)) / max([*forces, 1e-30]),
        float(np.linalg.norm(total.moment)) / max([*moments, 1e-30]),
    )


def fiber_forces(scene: Scene) -> tuple[float, float] | None:
    """Least and greatest axial force of a scene's fibers, N; None without fibers; collective."""
    ranges = [
        discrete.force_range()
        for discrete in scene.discrete.values()
        if isinstance(discrete, FiberPotential)
    ]
    if not ranges:
        return None
    lows, highs = zip(*ranges, strict=True)
    return min(lows), max(highs)

"""Quantities that a user reads off a state: angle, tip, reactions."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.effects.embedded_fibers import FiberPotential
from fem.kinematics.kinematics import Kinematics
from fem.march.frames import Frames, Shape
from fem.scene import Scene

Floats = npt.NDArray[np.float64]


class _SectionAngle:
    """Rotation about x of one plane section: best fit of its nodes, area weighted.

    tan α = Σ m (Y − Ȳ) z / Σ m (Y − Ȳ) y, positive toward −y; two linear functionals.
    """

    def __init__(self, body: Kinematics, surface: str) -> None:
        self._body = body
        domain = body.domain
        weights = domain.surface_weights(surface)
        y = domain.data.nodes[:, 1]
        lever = weights * (y - (weights @ y) / weights.sum())
        nodes = body.owned_nodes[lever[body.owned_nodes] != 0]
        self._lever = lever[nodes]
        self._dofs = body.node_dofs[nodes]
        self._nodes = domain.data.nodes[nodes]

    def sums(self) -> tuple[float, float]:
        """(Σ m Y' y, Σ m Y' z) of the deformed section."""
        x = self._nodes + self._body.w.x.array[self._dofs]
        mine = self._lever @ x[:, 1:]
        total = self._body.domain.comm.allreduce(mine, MPI.SUM)
        return float(total[0]), float(total[1])

    def angle(self) -> float:
        """The rotation in (−π, π], rad."""
        y, z = self.sums()
        return float(np.arctan2(z, y))

    def add_row(self, row: Floats, factor: float) -> None:
        """Add factor · ∂α/∂w to owned dofs."""
        y, z = self.sums()
        square = y * y + z * z
        row[self._dofs[:, 2]] += factor * self._lever * y / square
        row[self._dofs[:, 1]] -= factor * self._lever * z / square


class BendingAngle:
    """θ: rotation of the section z = L against z = 0, positive toward −y, unwrapped.

    Args:
        body: kinematics of a mesh with the surfaces 'section_root' and 'section_tip'.
        frames: stations, to count full turns along the body.
    """

    def __init__(self, body: Kinematics, frames: Frames) -> None:
        self._body = body
        self._frames = frames
        self._root = _SectionAngle(body, "section_root")
        self._tip = _SectionAngle(body, "section_tip")
        nodes = body.domain.data.nodes
        self._ends = [
            float(nodes[body.domain.surface_nodes(name), 2].mean())
            for name in ("section_root", "section_tip")
        ]

    def value(self) -> float:
        """θ at the present state, rad."""
        wrapped = self._tip.angle() - self._root.angle()
        along = self._frames.bending(self._frames.fit(self._body.displacement()))
        root, tip = np.interp(self._ends, self._frames.z, along)
        turns = np.round((tip - root - wrapped) / (2 * np.pi))
        return float(wrapped + 2 * np.pi * turns)

    def row(self) -> Floats:
        """∂θ/∂w on the owned dofs, rad/mm."""
        row = np.zeros(self._body.owned)
        self._tip.add_row(row, 1.0)
        self._root.add_row(row, -1.0)
        return row

    def slope(self, scalar: str) -> float:
        """∂θ/∂q of a global scalar: none enters."""
        return 0.0


class UniformAngle:
    """L times the curvature of the body's middle half: what the angle were without end effects.

    Near the caps the sections warp and the curvature differs; models of uniform bending compare
    with this angle.

    Args:
        body: kinematics of a mesh with the surfaces 'section_root' and 'section_tip'.
        frames: stations.
    """

    def __init__(self, body: Kinematics, frames: Frames) -> None:
        nodes, domain = body.domain.data.nodes, body.domain
        root, tip = (
            float(nodes[domain.surface_nodes(name), 2].mean())
            for name in ("section_root", "section_tip")
        )
        self._frames = frames
        self._length = tip - root
        middle = np.abs(frames.mean_z - (root + tip) / 2)
        self._middle = np.argsort(middle)[: max(2, int(np.sum(middle <= (tip - root) / 4)))]

    def value(self, shape: Shape) -> float:
        """The angle of a shape, rad."""
        z = self._frames.mean_z[self._middle]
        slope = np.polyfit(z, self._frames.bending(shape)[self._middle], 1)[0]
        return float(slope * self._length)


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
        """Deformed position in mm, (3,)."""
        x = self._nodes + self._body.w.x.array[self._dofs]
        return self._body.domain.comm.allreduce(self._weights @ x, MPI.SUM)  # type: ignore


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
    for discrete in scene.discrete.values():
        if isinstance(discrete, FiberPotential):
            return discrete.force_range()
    return None

"""How well the rubber keeps its volume, as the elements are held to it."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt
import ufl
from mpi4py import MPI

from fem import compat
from fem.effects.incompressible import Incompressible
from fem.ranks import total
from fem.scene import Scene
from geometry.mesh.reference import jacobians

Floats = npt.NDArray[np.float64]

_CHUNK = 20_000


@dataclasses.dataclass(frozen=True)
class VolumeError:
    """How far volumes are from what the material keeps, relative to those at rest.

    Attributes:
        element: greatest of an element.
        whole: that of all elements together.
    """

    element: float
    whole: float


class VolumeProbe:
    """Reads |∫ (J − 1 − p/κ) dX| / V off elements; 1/κ is zero in incompressible rubber.

    An equilibrium has ∫ (J − 1 − p/κ) φ dX = 0 for every function φ of the pressure, not J = 1 at
    every point. On bricks (Q2–P1 discontinuous) φ may be 1 in one element and 0 elsewhere, so that
    each keeps its volume; on tetrahedra (Taylor–Hood, P2–P1) φ is continuous in each region, so
    that volume is kept by all elements of it together, weighted about every vertex, and by a single
    one only as far as the mesh is fine. Both in Boffi, Brezzi, Fortin 2013, Mixed Finite Element
    Methods and Applications, chapter 8.

    Args:
        scene: the scene.
        rubber: what keeps the volume, one of its effects.
    """

    def __init__(self, scene: Scene, rubber: Incompressible) -> None:
        body, domain = scene.body, scene.domain
        self._comm = domain.comm
        points, weights = compat.quadrature(domain.data.cell_type, domain.degree)
        mine = domain.cells[: domain.owned]
        starts = range(0, max(len(mine), 1), _CHUNK)
        parts = [jacobians(domain.data, mine[i : i + _CHUNK], points)[1] for i in starts]
        self._weights = np.abs(np.concatenate([np.linalg.det(part) for part in parts])) * weights
        """Volume at rest that each point stands for, (cells, points)."""
        self._jacobian = compat.PointValues(domain.mesh, ufl.det(body.F), points)
        self._pressure: compat.PointValues | None = None
        if rubber.bulk:
            self._pressure = compat.PointValues(domain.mesh, body.p, points)
            by_region = {region: 1 / bulk for region, bulk in rubber.bulk.items()}
            self._compliance = domain.cell_values(by_region)[: domain.owned, None]

    @classmethod
    def of(cls, scene: Scene) -> VolumeProbe | None:
        """The probe of a scene; None where nothing keeps the volume."""
        kept = [effect for effect in scene.effects.values() if isinstance(effect, Incompressible)]
        return cls(scene, kept[0]) if kept else None

    def read(self) -> VolumeError:
        """The errors at the present state, over all ranks; collective."""
        excess = self._jacobian()[..., 0] - 1
        if self._pressure is not None:
            excess -= self._compliance * self._pressure()[..., 0]
        change, volume = (self._weights * excess).sum(axis=1), self._weights.sum(axis=1)
        greatest = float(np.max(np.abs(change) / volume, initial=0.0))
        sums = total(self._comm, np.array([change.sum(), volume.sum()]))
        return VolumeError(self._comm.allreduce(greatest, MPI.MAX), float(abs(sums[0]) / sums[1]))

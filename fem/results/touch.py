"""What a user reads off a contact: how much of a surface touches, and how deep it lies in."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from fem.effects.contact import Contact
from fem.scene import Scene
from geometry.mesh.reference import area_vectors, facet_rules, shape_functions

Floats = npt.NDArray[np.float64]


ROUND_OFF = 1e-9
"""Part of the body's length by which a gap that is zero at rest may miss it: gmsh's nodes lie
within 3e-10 of their places."""


@dataclasses.dataclass(frozen=True)
class Touch:
    """A contact at a state, of the whole body.

    Attributes:
        gap: least gap, mm; negative where the obstacle yields.
        area: area at rest of what touches, mm².
        slack: gap of either sign that is none, mm.
    """

    gap: float
    area: float
    slack: float

    @property
    def touches(self) -> bool:
        """Whether anything touches: round-off of a gap that is zero at rest does not."""
        return self.gap < -self.slack

    @property
    def apart(self) -> bool:
        """Whether there is a gap to be closed."""
        return self.gap > self.slack


def probes(scene: Scene) -> dict[str, Probe]:
    """A probe for every contact of a scene, by the name of its obstacle."""
    contacts = [effect for effect in scene.effects.values() if isinstance(effect, Contact)]
    return {contact.name: Probe(scene, contact) for contact in contacts}


class Probe:
    """Reads a contact at the points of quadrature.

    Args:
        scene: the scene.
        contact: one of its effects.

    Attributes:
        key: the effect's key, under which the scene has the forces on it.
    """

    def __init__(self, scene: Scene, contact: Contact) -> None:
        self.key = contact.key
        self._body, self._obstacle = scene.body, contact.obstacle
        self._numbers = contact.obstacle.numbers()
        domain = scene.domain
        data = domain.data
        pairs = np.concatenate([data.facets[name] for name in contact.surfaces])
        vectors = np.concatenate([area_vectors(data, name)[1] for name in contact.surfaces])
        mine = np.flatnonzero(domain.local_cell[pairs[:, 0]] >= 0)
        points, _, _ = facet_rules(data.cell_type)
        self._values = shape_functions(data.cell_type, points)[0][pairs[mine, 1]]
        self._nodes = data.cells[pairs[mine, 0]]
        self._area = np.linalg.norm(vectors[mine], axis=2)
        self._slack = ROUND_OFF * scene.body.span

    def read(self) -> Touch:
        """The contact at the present state; collective."""
        body = self._body
        comm = body.domain.comm
        nodes = body.domain.data.nodes[self._nodes] + body.w.x.array[body.node_dofs[self._nodes]]
        x = np.einsum("nqa,nai->inq", self._values, nodes)
        gap = np.asarray(self._obstacle.gap(x, self._numbers))
        least = comm.allreduce(float(gap.min(initial=np.inf)), MPI.MIN)
        area = comm.allreduce(float(self._area[gap < -self._slack].sum()), MPI.SUM)
        return Touch(least, body.symmetry_factor * area, self._slack)

"""Whether opposite walls of the chamber have passed through each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from fem.march.hooks import Hook, Marching
from fem.march.records import State
from fem.scene import Scene
from fem.solver.newton import Outcome
from geometry.mesh.reference import facet_rules, shape_functions

Floats = npt.NDArray[np.float64]

CHAMBER = "chamber"
NEAR = 0.1
"""Opposite walls that have met are sought so deep in each other, in parts of the chamber's height:
where they cross they lie at every depth from none on."""
LEAST = 1e-3
"""The same below which they are none the deeper for round-off."""
FACING = -0.5
"""Cosine of two normals of the wall below which the points face each other."""


class Walls(Hook):
    """Sees where opposite walls of the chamber pass through each other: no contact keeps them.

    Two points of the wall that are more than half the chamber's height apart at rest, and whose
    normals into the chamber face each other, have passed if each lies behind the other, deeper than
    aside.

    Args:
        scene: the scene.

    Attributes:
        passed: measures of the first state at which they have; None: they have not.
    """

    def __init__(self, scene: Scene) -> None:
        self._body = body = scene.body
        self.passed: dict[str, float] | None = None
        domain, data = body.domain, body.domain.data
        pairs = data.facets.get(CHAMBER, np.zeros((0, 2), dtype=np.int64))
        pairs = pairs[domain.local_cell[pairs[:, 0]] >= 0]
        points, _, normals = facet_rules(data.cell_type)
        values, slopes = shape_functions(data.cell_type, points)
        self._values, self._slopes = values[pairs[:, 1]], slopes[pairs[:, 1]]
        self._normals, self._nodes = normals[pairs[:, 1]], data.cells[pairs[:, 0]]
        rest = np.einsum("nqa,nai->nqi", self._values, data.nodes[self._nodes])
        self._rest = self._gathered(rest.reshape(-1, data.nodes.shape[1]))
        self._height = float(np.ptp(self._rest[:, 1])) if len(self._rest) else 0.0

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Look at the new state."""
        if self.passed is None and self._crossed():
            self.passed = dict(state.measures)

    def memory(self) -> dict[str, Any]:
        """Where it was seen."""
        return {"passed": self.passed}

    def recall(self, memory: dict[str, Any]) -> None:
        """Seen already."""
        self.passed = memory["passed"]

    def _crossed(self) -> bool:
        """Whether walls have passed each other at the present state; collective."""
        rest, height = self._rest, self._height
        x, normal = self._present()
        if self._body.domain.data.half:
            flip = np.ones(x.shape[1])
            flip[0] = -1.0
            rest, x, normal = (np.vstack([part, flip * part]) for part in (rest, x, normal))
        if not len(x):
            return False
        a, b = KDTree(x).query_pairs(NEAR * height, output_type="ndarray").T
        apart, between = rest[b] - rest[a], x[b] - x[a]
        opposite = np.linalg.norm(apart[:, :2], axis=1) > height / 2
        if rest.shape[1] == 3:  # not of another turn of a body that coils
            opposite &= np.abs(apart[:, 2]) < height
        opposite &= np.sum(normal[a] * normal[b], axis=1) < FACING
        size = np.linalg.norm(between, axis=1)
        behind = -np.sum(between * normal[a], axis=1), np.sum(between * normal[b], axis=1)
        depth = np.minimum(*behind)
        return bool(np.any(opposite & (depth > LEAST * height) & (depth > size / np.sqrt(2))))

    def _present(self) -> tuple[Floats, Floats]:
        """Points of the wall and unit normals into the chamber, (n, d) both, of all ranks."""
        body, data = self._body, self._body.domain.data
        nodes = data.nodes[self._nodes].copy()
        shown = min(body.components, nodes.shape[-1])
        nodes[..., :shown] += body.w.x.array[body.node_dofs[self._nodes]][..., :shown]
        x = np.einsum("nqa,nai->nqi", self._values, nodes)
        gradient = np.einsum("nai,nqaj->nqij", nodes, self._slopes)
        # an area vector by the cofactor (Nanson)
        cofactor = np.linalg.inv(gradient).swapaxes(2, 3) * np.linalg.det(gradient)[..., None, None]
        normal = np.einsum("nqij,nj->nqi", cofactor, self._normals)
        normal /= np.linalg.norm(normal, axis=2, keepdims=True)
        d = x.shape[2]
        return self._gathered(x.reshape(-1, d)), self._gathered(normal.reshape(-1, d))

    def _gathered(self, rows: Floats) -> Floats:
        """Rows of all ranks."""
        gathered: Floats = np.concatenate(self._body.domain.comm.allgather(rows))
        return gathered

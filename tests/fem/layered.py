"""A tall body's tangent factorised in layers, on however many ranks there are."""

from __future__ import annotations

import itertools
import json

import numpy as np
from mpi4py import MPI

from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp
from fem.kinematics.domain import Domain
from fem.ranks import total
from fem.scene import Scene
from fem.solver.layers import Layers
from tests.exact.solids import box

NARROW, WIDE = (2, 2), (5, 3)
"""Columns of elements of a tower."""


def tower(comm: MPI.Comm, pressure: float = 0.0, columns: tuple[int, int] = NARROW) -> Scene:
    """A clamped tower that leans under a pressure in its rubber, MPa; its tangent is assembled."""
    scene = Scene(
        Domain(box((3.0, 2.0, 20.0), (*columns, 10)), comm),
        [
            Elastic("neo-hooke", {"solid": {"mu": 0.2}}),
            Incompressible(),
            Clamp("bottom"),
            Gravity({"solid": 1.0}, (1e-4, 2e-4, -1e-4)),
        ],
    )
    body = scene.body
    x = body.domain.data.nodes[body.owned_nodes]
    moved = np.column_stack(
        [
            0.001 * x[:, 2] ** 2,
            -0.002 * x[:, 2] ** 2,
            0.01 * x[:, 2],
        ]
    )
    body.set_displacement(moved)
    w = scene.w.copy()
    w[scene.volumetric] = -pressure
    scene.set(w)
    scene.assemble_tangent()
    return scene


def measure(comm: MPI.Comm) -> dict[str, float]:
    """What the factor finds."""
    found = {}
    for pressure, columns in itertools.product((0.0, 0.2), (NARROW, WIDE)):
        scene = tower(comm, pressure, columns)
        layers = Layers(scene.matrix, scene.volumetric)
        layers.renew()
        residual = np.where(scene.free[: scene.body.owned], scene.residual()[0], 0.0)
        rest = np.where(scene.volumetric, residual, 0.0)
        x = layers.solve(np.array([residual, rest]))
        found[f"pivots {pressure} {columns}"] = float(layers.negative_pivots)
        found[f"solution {pressure} {columns}"] = float(total(comm, x[0] @ x[0]))
        found[f"work {pressure} {columns}"] = float(total(comm, x[1] @ residual))
    return found


if __name__ == "__main__":
    values = measure(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(values))

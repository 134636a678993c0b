"""A tall body's tangent solved by slabs, on however many ranks there are."""

from __future__ import annotations

import json

import numpy as np
from mpi4py import MPI

from fem.ranks import total
from fem.solver.slabs import Slabs
from tests.fem.layered import tower


def measure(comm: MPI.Comm) -> dict[str, float]:
    """What the slabs find."""
    found = {}
    for pressure in (0.0, 0.2):
        scene = tower(comm, pressure)
        free = scene.free[: scene.body.owned]
        slabs = Slabs(scene.matrix, scene.volumetric, free, scene.place)
        slabs.renew()
        residual = np.where(free, scene.residual()[0], 0.0)
        rest = np.where(scene.volumetric, residual, 0.0)
        x = slabs.solve_many([residual, rest])
        found["slabs"] = float(slabs.slabs)
        found[f"iterations {pressure}"] = float(slabs.iterations)
        found[f"solution {pressure}"] = float(total(comm, x[0] @ x[0]))
        found[f"work {pressure}"] = float(total(comm, x[1] @ residual))
    return found


if __name__ == "__main__":
    values = measure(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(values))

"""A heavy column that buckles, on any number of ranks."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
from mpi4py import MPI

from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp
from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.march.hooks import AfterStep
from fem.march.march import March
from fem.march.records import Ramp, Rules, State
from fem.ranks import total
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from tests.exact.solids import box

COLUMN = (2.0, 1.0, 20.0)
"""Sides and height, mm."""
SHEAR = 0.22
GREENHILL = 7.8373 * 3 * SHEAR / 12 / COLUMN[2] ** 3
"""Weight per volume, N/mm³, at which a heavy column 1 mm thick buckles (Greenhill 1881)."""


@dataclasses.dataclass
class Column:
    """A column that stands under a growing weight, in parts of Greenhill's."""

    march: March
    states: list[State]

    def lean(self, state: State) -> float:
        """Mean displacement of the nodes across the thin side, mm; collective."""
        body = self.march.equilibrium.scene.body
        across = state.w[body.node_dofs[body.owned_nodes, 1]]
        found = total(body.domain.comm, np.array([across.sum(), len(across)]))
        return float(found[0] / found[1])


def standing(comm: MPI.Comm | None = None) -> Column:
    """The column without weight."""
    domain = Domain(box(COLUMN, (1, 1, 6)), comm or MPI.COMM_SELF)
    scene = Scene(
        domain,
        [
            Elastic("neo-hooke", {"solid": {"mu": SHEAR}}),
            Incompressible(),
            Clamp("bottom"),
            Gravity({"solid": 1.0}, (0.0, 0.0, -GREENHILL)),
        ],
    )
    states: list[State] = []

    def keep(state: State, _outcome: Outcome) -> None:
        states.append(state)

    newton = Newton(scene, domain.comm, Settings())
    frames = Frames(scene.body)
    return Column(March(scene, newton, Rules(), frames=frames, hooks=[AfterStep(keep)]), states)


def measure(comm: MPI.Comm) -> dict[str, float]:
    """Where it buckles and how it rests beyond, on the ranks of a communicator."""
    column = standing(comm)
    report = column.march.run([Ramp("gravity", 1.1, first=1.1)])
    (point,) = report.critical
    end = column.states[-1]
    return {
        "critical": point.value,
        "lean": column.lean(end),
        "modes": end.measures["modes"],
        "conjugate": end.measures["conjugate gravity"],
        "weight": end.scalars["gravity"],
    }


if __name__ == "__main__":
    found = measure(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))

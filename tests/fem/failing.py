"""What is said of a body that fails, on however many ranks there are; prints it."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.march.march import Ramp, Rules
from fem.march.selfcontact import BodyRod, clearance
from fem.results.diagnosis import Diagnosis
from fem.solver.bordered import SideCondition
from fem.solver.newton import Outcome
from geometry.bodies.extrude import hexahedral_body
from geometry.sections.size import MeshSize
from tests.fem.parts import SHORT, Bender, Floats, bender


def short(comm: MPI.Comm, rules: Rules | None = None) -> Bender:
    """The short actuator with caps and a sheath."""
    mesh = hexahedral_body(SHORT, MeshSize(axial=12, section=1, half=True))
    return bender(rules, domain=Domain(mesh, comm))


def turn_inside_out(body: Bender, cell: int) -> None:
    """Push the first corner of a cell, by its input number, through the opposite one."""
    kinematics, data = body.scene.body, body.scene.domain.data
    first, last = data.cells[cell][[0, 26]]
    w = np.zeros(kinematics.owned)
    if first in kinematics.owned_nodes:
        w[kinematics.node_dofs[first]] = 1.5 * (data.nodes[last] - data.nodes[first])
    body.scene.set(w)


def cap_sheath(body: Bender) -> int:
    """A cell of the sheath in the tip cap, the last of the mesh along z."""
    data = body.scene.domain.data
    sheath = np.flatnonzero(data.cell_region == data.regions["sheath"])
    return int(sheath[np.argmax(data.nodes[data.cells[sheath], 2].mean(axis=1))])


def stop_newton(body: Bender, after: int) -> None:
    """Let Newton fail from some call on."""
    newton = body.newton
    solve, calls = newton.solve, [0]

    def fail(
        w: Floats, unknown: Sequence[str] = (), conditions: Sequence[SideCondition] = ()
    ) -> Outcome:
        calls[0] += 1
        outcome = solve(w, unknown, conditions)
        if calls[0] <= after:
            return outcome
        turn_inside_out(body, cap_sheath(body))
        return dataclasses.replace(outcome, converged=False, reason="so says the test")

    newton.solve = fail  # type: ignore[method-assign]


def found(comm: MPI.Comm) -> dict[str, str | float]:
    """The reason of a failure, where an element is inverted, and the clearance of a bent state."""
    body = short(comm, Rules(cutbacks=1))
    stop_newton(body, 1)
    report = body.run([Ramp("pressure", 0.02, largest=0.005)])
    state = body.states[-1]
    gap = clearance(BodyRod(body.scene.body, Frames(body.scene.body)).pose(state, state, 1.0))
    turn_inside_out(body, cap_sheath(body))
    inverted = Diagnosis(body.scene).inverted()
    return {"reason": report.reason, "inverted": inverted, "clearance": gap}


if __name__ == "__main__":
    result = found(MPI.COMM_WORLD)
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(result))

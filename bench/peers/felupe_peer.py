"""The actuator in felupe: 27-node hexahedra with pressure and volume, hoops as trusses.

Runs in an environment of its own, which holds felupe and pypardiso; see `bench.peers.run`. The
fields of pressure and volume are felupe's own choice for this element, Newton's method has its own
settings, and a load step that fails is cut back by felupe's plugin.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import felupe as fem
import numpy as np
import pypardiso
from felupe.math import cdya_ik, cdya_il, ddot, det, dya, identity, inv, transpose

from bench.peers.arrays import Body, bending_angles, load_body


class Yeoh:
    """C1 (Ī1 − 3) + C2 (Ī1 − 3)² with coefficients of every element, (m,), MPa."""

    def __init__(self, c1: Any, c2: Any) -> None:
        self.c1, self.c2 = c1, c2
        self.x = [np.eye(3), np.zeros(0)]

    def gradient(self, x: list[Any]) -> list[Any]:
        """First Piola–Kirchhoff stress; the state is left as it is."""
        F = x[0]
        excess, _, slope, _ = self._excess(F)
        return [(self.c1 + 2 * self.c2 * excess) * slope, x[-1]]

    def hessian(self, x: list[Any]) -> list[Any]:
        """Slope of the stress by the deformation gradient."""
        F = x[0]
        excess, scale, slope, G = self._excess(F)
        eye = identity(F)
        second = scale * (
            2 * cdya_ik(eye, eye)
            - 4 / 3 * (dya(F, G) + dya(G, F))
            + ddot(F, F) * (4 / 9 * dya(G, G) + 2 / 3 * cdya_il(G, G))
        )
        return [(self.c1 + 2 * self.c2 * excess) * second + 2 * self.c2 * dya(slope, slope)]

    @staticmethod
    def _excess(F: Any) -> tuple[Any, Any, Any, Any]:
        """Ī1 − 3, J^(−2/3), the slope of Ī1, and F⁻ᵀ."""
        scale, G, square = det(F) ** (-2 / 3), transpose(inv(F)), ddot(F, F)
        return scale * square - 3, scale, scale * (2 * F - 2 / 3 * square * G), G


class Thread:
    """A thread that is linear in its nominal strain; its area is its stiffness EA."""

    def gradient(self, x: list[Any]) -> list[Any]:
        """Force over stiffness at a stretch."""
        return [x[0] - 1, x[-1]]

    def hessian(self, x: list[Any]) -> list[Any]:
        """Its slope."""
        return [np.ones_like(x[0])]


def items(body: Body, rubbers: list[list[float]]) -> tuple[Any, list[Any], Any]:
    """Fields, what acts on them, and the pressure among these."""
    mesh = fem.Mesh(body.points, body.cells, "hexahedron27")
    field = fem.FieldsMixed(fem.RegionTriQuadraticHexahedron(mesh), n=3)
    c1, c2, bulk = np.array(rubbers).T[:, body.region]
    rubber = fem.NearlyIncompressible(Yeoh(c1, c2), bulk)
    # felupe would take the elements of a larger mesh by parts, and their coefficients whole
    rubber.chunksize = None
    solid = fem.SolidBody(rubber, field)

    line = fem.Mesh(body.points, body.hoops, "line")
    thread_field = fem.FieldContainer([fem.Field(fem.RegionTruss(line), dim=3)])
    hoops = fem.TrussBody(Thread(), thread_field, area=body.hoop_stiffness)

    inside = np.zeros(len(body.points), dtype=bool)
    inside[np.unique(body.chamber)] = True
    wall = fem.RegionTriQuadraticHexahedronBoundary(mesh, only_surface=True, mask=inside)
    pressure = fem.SolidBodyPressure(fem.FieldContainer([fem.Field(wall, dim=3)]))
    return field, [solid, hoops, pressure], pressure


def solve(task: dict[str, Any]) -> None:
    """Bend the actuator and write a line for every load step.

    Args:
        task: the body's file (`body`), rubbers (C1, C2, bulk in MPa), pressure and step in MPa,
            file to write (`out`).
    """
    body = load_body(Path(task["body"]))
    field, parts, pressure = items(body, list(task["rubbers"].values()))
    held, plane = (np.zeros(len(body.points), dtype=bool) for _ in range(2))
    held[body.clamp], plane[body.symmetry] = True, True
    supports = {
        "clamp": fem.Boundary(field[0], mask=held),
        "symmetry": fem.Boundary(field[0], mask=plane, skip=(False, True, True)),
    }
    unknowns = int(sum(field.fieldsizes))
    states: list[Any] = []

    with Path(task["out"]).open("w") as file:

        def record(context: Any, state: Any) -> None:
            states.append(body.points + context.substep.x[0].values)
            angle = np.degrees(bending_angles(body.points, states, body.root, body.tip)[-1])
            line = {
                "MPa": float(pressure.results.pressure),
                "degrees": float(angle),
                "iterations": int(context.substep.iterations),
                "unknowns": unknowns,
            }
            file.write(json.dumps(line) + "\n")
            file.flush()

        number = round(task["pressure"] / task["step"])
        loads = np.linspace(task["step"], task["pressure"], number)
        step = fem.Step(items=parts, ramp={pressure: loads}, boundaries=supports)
        job = fem.Job(steps=[step], plugins=[record, fem.CutbackPlugin()])
        try:
            job.evaluate(solver=pypardiso.spsolve, verbose=0)
        except ValueError as error:
            file.write(json.dumps({"failed": str(error).splitlines()[0]}) + "\n")


if __name__ == "__main__":
    solve(json.loads(Path(sys.argv[1]).read_text()))

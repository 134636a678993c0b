"""A solid silicone beam, clamped at one end, under its weight and a load on its upper edge.

Dubied et al. 2022, arXiv 2201.12560: 30 × 30 × 100 mm of Dragon Skin 10. Half of it is
modelled. x is across, y up from the lower side, z along the beam from the clamp.
"""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import ufl
from mpi4py import MPI

from bench.outside.table import Row, percent
from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.kinematics.domain import Domain
from fem.kinematics.kinematics import Kinematics
from fem.march.march import March
from fem.march.records import Ramp, Rules
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.bodies.extrude import extrude
from geometry.bodies.quads import section_mesh
from geometry.bodies.stations import Segment, Stations
from geometry.mesh.data import MeshData
from geometry.sections.blocks import Layout

SIDE, LENGTH = 30.0, 100.0
YOUNG, POISSON = 0.263824, 0.499
MU = YOUNG / (2 * (1 + POISSON))
BULK = YOUNG / (3 * (1 - 2 * POISSON))
DENSITY = 1070e-12
GRAVITY = 9807.09
LOADS = (0.0, 0.51012, 1.00062)
POINTS = {"top, middle": (15.0, 30.0), "left": (0.0, 24.0), "right": (30.0, 6.0)}
"""Across and up, on the free end's face, mm."""
COMSOL = {
    0.0: (-6.774, -6.752, -6.691),
    0.51012: (-17.331, -16.841, -16.282),
    1.00062: (-27.542, -26.352, -25.022),
}
"""As the repository of the measurements has them, at the points in their order, mm."""
MARKERS = Path(__file__).resolve().parent / "data" / "beam_dragonskin10_markers.csv"
STANDOFF = 6.0
"""Of the markers from the faces, mm."""
SUBJECT = "Solid beam of Dragon Skin 10"
_MARKER = {"top, middle": 0, "left": 1, "right": 2}


class EdgeLoad(Effect):
    """A dead load, spread evenly along the upper edge of the free end.

    Π = q ∫ w(s) u_y dA / width over a strip of one row of elements beside the edge, s from the
    edge: w is the quadratic with which ∫ w f ds = f(0) for every quadratic f. So for 27-node
    hexahedra this is the edge's own load.

    Args:
        depth: of the strip, mm.
        width: of the edge, mm.
    """

    scalar = "edge-load"
    units: ClassVar = {scalar: ("N", "mm")}

    def __init__(self, depth: float, width: float) -> None:
        self.depth, self.width = depth, width

    def potential(self, body: Kinematics) -> Any:
        """The load's potential as a form."""
        s = (LENGTH - ufl.SpatialCoordinate(body.domain.mesh)[2]) / self.depth
        weight = (9 - 36 * s + 30 * s**2) / (self.depth * self.width)
        return body.scalar(self.scalar) * weight * body.u[1] * body.ds("edge")


class Locking(Effect):
    """The same rubber by displacements alone: Π = ∫ μ (I1 − 3)/2 − μ ln J + λ (ln J)²/2 dX.

    Near ν = 1/2 such elements are too stiff, and the less the finer they are.
    """

    def potential(self, body: Kinematics) -> Any:
        """The energy as a form."""
        jump = ufl.ln(ufl.det(body.F))
        shear = MU * (ufl.tr(body.F.T * body.F) - 3 - 2 * jump) / 2
        return (shear + (BULK - 2 * MU / 3) * jump**2 / 2) * body.dx()


def mesh(n: int) -> MeshData:
    """Half the beam, x from 0 in the mirror plane to 15 mm; n elements over these."""
    depth = LENGTH / (6 * n)
    layout = Layout()
    layout.add(
        "solid",
        ((0.0, 0.0), (SIDE / 2, 0.0), (0.0, SIDE), (SIDE / 2, SIDE)),
        (n, 5 * max(1, n // 2)),
        {},
        {1: ("symmetry",), 3: ("edge",)},
    )
    sides = frozenset({"symmetry"})
    stations = Stations(
        (
            Segment(0.0, LENGTH - depth, 6 * n - 1, sides, False),
            Segment(LENGTH - depth, LENGTH, 1, sides | {"edge"}, False),
        ),
        (("clamp", None), (None, None), ("tip", None)),
    )
    return extrude(section_mesh(layout), stations)


def solve(n: int, locking: bool = False) -> dict[float, dict[str, float]]:
    """Displacement upwards in mm by load in N and point; and the turn of the face in rad.

    Args:
        n: refinement of the mesh.
        locking: by displacements alone.

    Raises:
        RuntimeError: a load was not reached.
    """
    data = mesh(n)
    rubber: list[Effect] = [Elastic("neo-hooke", {"solid": {"mu": MU}})]
    rubber.append(Incompressible({"solid": BULK}))
    scene = Scene(
        Domain(data, MPI.COMM_SELF),
        [
            *([Locking()] if locking else rubber),
            Gravity({"solid": DENSITY}, (0.0, -GRAVITY, 0.0)),
            EdgeLoad(LENGTH / (6 * n), SIDE),
            Clamp(),
            Symmetry(),
        ],
    )

    def moved(across: float, up: float) -> Any:
        gaps = np.linalg.norm(data.nodes - [abs(across - SIDE / 2), up, LENGTH], axis=1)
        if gaps.min() > 1e-6:
            raise RuntimeError(f"no node {across} mm across and {up} mm up")
        return scene.body.w.x.array[scene.body.node_dofs[gaps.argmin()]]

    found: dict[float, dict[str, float]] = {}
    for load in LOADS:
        runner = March(scene, Newton(scene, MPI.COMM_SELF, Settings()), Rules())
        report = runner.run([Ramp(EdgeLoad.scalar, load) if load else Ramp("gravity", 1.0)])
        if report.status != "converged":
            raise RuntimeError(f"beam under {load} N: {report.reason}")
        top, bottom = moved(SIDE / 2, SIDE), moved(SIDE / 2, 0.0)
        found[load] = {name: float(moved(*place)[1]) for name, place in POINTS.items()}
        found[load]["turn"] = float(np.arctan2(top[2] - bottom[2], SIDE + top[1] - bottom[1]))
    return found


def measured() -> dict[float, dict[str, float]]:
    """Mean over the trials of the markers' fall in mm, by load in N and point."""
    lines = MARKERS.read_text(encoding="utf-8").splitlines()
    falls: dict[tuple[float, int], list[float]] = {}
    for row in csv.DictReader(line for line in lines if not line.startswith("#")):
        key = float(row["tip_load_N"]), int(row["marker"])
        falls.setdefault(key, []).append(float(row["x1"]) - float(row["x0"]))
    return {
        load: {name: float(np.mean(falls[load, marker])) for name, marker in _MARKER.items()}
        for load in LOADS
    }


def _texts(values: Sequence[float]) -> str:
    return ", ".join(f"{value:.2f}" for value in values) + " mm"


def _worst(ours: Sequence[float], theirs: Sequence[float]) -> float:
    return max((a / b - 1 for a, b in zip(ours, theirs, strict=True)), key=abs)


def rows(n: int = 4) -> list[Row]:
    """Each load beside COMSOL and beside the markers.

    Args:
        n: refinement; one of half of it says what the mesh does.
    """
    fine, coarse, locked = solve(n), solve(n // 2), solve(n, locking=True)
    seen, made = measured(), []
    names = list(POINTS)
    for load in LOADS:
        ours = [fine[load][name] for name in names]
        apart = _worst([coarse[load][name] for name in names], ours)
        stiff = [locked[load][name] for name in names]
        made += [
            Row(
                SUBJECT,
                f"{load:g} N: rise of the end's top middle, left, right; off: the worst",
                _texts(ours),
                _texts(COMSOL[load]),
                _worst(ours, COMSOL[load]),
                0.01,
                "COMSOL",
                f"COMSOL's law, elements and mesh. A mesh of half the elements is {percent(apart)} "
                "away; a line load lets the edge itself sink ever further the finer it is",
            ),
            Row(
                SUBJECT,
                f"{load:g} N: the same on the same mesh without pressures as unknowns, so that the "
                "elements are too stiff near ν = 1/2",
                _texts(stiff),
                _texts(COMSOL[load]),
                _worst(stiff, COMSOL[load]),
                None,
                "COMSOL",
                "whether COMSOL's elements had pressures",
            ),
        ]
        # the top's marker stands above a face that turns; the others beside it, along its axis
        lift = STANDOFF * (np.cos(fine[load]["turn"]) - 1)
        marked = [ours[0] + float(lift), *ours[1:]]
        theirs = [seen[load][name] for name in names]
        made.append(
            Row(
                SUBJECT,
                f"{load:g} N: rise of the markers there; off: the worst",
                _texts(marked),
                _texts(theirs),
                _worst(marked, theirs),
                0.08,
                "Dubied 2022",
                "E is that source's own fit; how the beam was held before; two trials, up to 1 mm "
                "apart",
            )
        )
    return made

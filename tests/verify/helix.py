"""The hoop-wound tube with real fibers: a double helix whose pitch goes to zero."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from mpi4py import MPI

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Symmetry
from fem.effects.winding import Winding
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from tests.exact.solutions import Tube, wound_tube
from tests.verify.hoops import double_helix, half_tube
from tests.verify.ladder import YEOH, balanced_pressure, end_load, start_from
from tests.verify.problems import LAW, ORIGIN

INNER, OUTER, STRETCH = 8.0, 10.0, 1.1
STIFFNESS = 881.0
"""EA of a fiber in N, the paper's. It moves p by a thirteenth of the error, also of first order.
Ten times as stiff, the lines of a ribbon that are pressed together buckle: several equilibria."""
WIDTH = 0.38 / 3
"""Width of the ribbon over the pitch, the paper's fiber at a pitch of 3 mm."""
TITLE = "Hoop-wound extending tube, a double helix of decreasing pitch"
TEXT = (
    "A = 8, B = 10, λz = 1.1, closed free ends; a slice of half a pitch, half the circumference, "
    "elements in proportion to the pitch, fibers of EA = 881 N as ribbons. The exact "
    "pressure is that of hoops, the limit of zero pitch. Rubber bulges between "
    "the fibers, so the error is of the first order in the pitch."
)
EXACT = wound_tube(LAW, INNER, OUTER, STRETCH)
FINENESS = (2, 3, 4, 6)


@dataclasses.dataclass
class Pitch:
    """What one pitch gave: pressure in MPa, tension range in N."""

    pitch: float
    unknowns: int
    pressure: float
    tension: tuple[float, float]
    iterations: int

    @property
    def error(self) -> float:
        """Relative, against hoops."""
        return self.pressure / EXACT.pressure - 1


def _start(pitch: float) -> Tube:
    """The tube at the radius that keeps the length of the helix."""
    angle = math.atan(pitch / (2 * math.pi * OUTER))
    around = math.sqrt(1 - (STRETCH * math.sin(angle)) ** 2) / math.cos(angle)
    inner = math.sqrt((OUTER * around) ** 2 - (OUTER**2 - INNER**2) / STRETCH)
    return Tube(LAW, INNER, OUTER, inner, STRETCH, EXACT.outside)


def solve(k: int) -> Pitch:
    """A pitch of 4/k mm with 2 k elements through the wall."""
    pitch = 4.0 / k
    mesh = half_tube(INNER, OUTER, pitch / 2, (2 * k, 4 * k, 2))
    domain = Domain(mesh, MPI.COMM_SELF)
    fibers = double_helix(mesh, "outer", pitch, WIDTH * pitch)
    scene = Scene(
        domain,
        [
            Elastic("yeoh", {"solid": YEOH}),
            Incompressible(),
            ChamberPressure("inner"),
            Symmetry("cut", 1),
            Symmetry("bottom", 2),
            Winding(fibers, STIFFNESS),
        ],
    )
    start_from(scene, _start(pitch))
    top = scene.body.node_dofs[domain.surface_nodes("top"), 2]
    scene.fix(top, np.full(len(top), (STRETCH - 1) * pitch / 2))
    # half a turn about the y axis maps the winding to itself, so this point stays on it
    middle = int(np.argmin(np.abs(mesh.nodes - [0.0, OUTER, pitch / 4]).sum(axis=1)))
    scene.fix(scene.body.node_dofs[middle, :1], np.zeros(1))
    scene.set(scene.w.copy())
    newton = Newton(scene, MPI.COMM_SELF, Settings(iterations=25))
    outcome, pressure = balanced_pressure(
        scene,
        lambda: newton.solve(scene.w.copy()),
        lambda: float(end_load(scene, "top", ORIGIN)[0][2]),
        EXACT.pressure,
    )
    assert outcome.converged, f"pitch {pitch:g} mm: {outcome.reason}"
    tension = scene.discrete["Winding"].force_range()  # type: ignore[attr-defined]
    return Pitch(pitch, scene.body.size, pressure, tension, outcome.iterations)

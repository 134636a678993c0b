"""Small meshes, states and scenes for the tests of fem."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.effects.winding import CalibratedWinding, SmearedWinding
from fem.effects.winding import Winding as Discrete
from fem.kinematics.domain import Domain
from fem.march.frames import Frames
from fem.march.hooks import Hook, Marching
from fem.march.march import (
    March,
    Ramp,
    Report,
    Rules,
    State,
)
from fem.results.centre_line import BendingAngle, CentreLine
from fem.results.diagnosis import Diagnosis
from fem.results.measures import Tip
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from geometry.actuator import Actuator
from geometry.bodies.extrude import hexahedral_body
from geometry.mesh.data import MeshData
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.smear import smear
from materials.bulging import Bulging
from materials.laws.table import LAWS
from tests.exact.solids import tube_sector
from tests.materials.rubber import RUBBERS

Floats = npt.NDArray[np.float64]
CELLS = ("hexahedron", "tetrahedron")

STUB = HemicircleActuator(radius=8, length=8, wall=2, floor=2, cap=4)
"""Shortest actuator with every surface."""
SHORT = HemicircleActuator(radius=8, length=24, wall=2, floor=2, sheath=1, cap=5)
"""Cheapest actuator that bends."""
PITCH = 3.0
EA = 881.0
BULGING = Bulging(0.72, 1.1, 3.0)
"""Stiffness between turns 3 mm apart, each of its three terms felt."""


def _as(cell: str, mesh: MeshData) -> MeshData:
    return to_tetrahedra(mesh) if cell == "tetrahedron" else mesh


@functools.cache
def stub(cell: str, half: bool = False) -> Domain:
    """A whole closed chamber, 80 hexahedra or 480 tetrahedra."""
    return Domain(_as(cell, hexahedral_body(STUB, MeshSize(axial=8, section=1, half=half))))


@functools.cache
def sector(cell: str) -> Domain:
    """A quarter of a short tube."""
    return Domain(_as(cell, tube_sector(8.0, 10.0, np.pi / 2, 3.0, (1, 2, 1))))


def law(name: str, regions: Sequence[str], scale: float = 1.0) -> Elastic:
    """An elastic effect with the numbers of a rubber, its stresses scaled."""
    units = {parameter.name: parameter.unit for parameter in LAWS[name].parameters}
    numbers = {
        key: value * scale if units[key] == "MPa" else value
        for key, value in RUBBERS[name].parameters.items()
    }
    return Elastic(name, dict.fromkeys(regions, numbers))


def winding(domain: Domain, width: float, tension_only: bool = False) -> Discrete:
    """The stub's fibers, every one."""
    segments = embed(domain.data, STUB, Winding("double-helix", PITCH, width))
    return Discrete(segments, EA, tension_only)


def smeared(domain: Domain, actuator: Actuator = STUB) -> SmearedWinding:
    """The same fibers smeared."""
    segments = smear(domain.data, actuator, Winding("double-helix", PITCH, 0.38))
    return SmearedWinding(segments, EA)


def calibrated(
    domain: Domain, actuator: Actuator = STUB, tension_only: bool = False
) -> CalibratedWinding:
    """The same fibers smeared, rubber bulging between their turns."""
    segments = smear(domain.data, actuator, Winding("double-helix", PITCH, 0.38))
    return CalibratedWinding(segments, EA, BULGING, tension_only)


def perturb(scene: Scene, amplitude: float, seed: int) -> Floats:
    """Set a random state: displacements in mm, pressures in MPa, scalars; returns w."""
    rng = np.random.default_rng(seed)
    for name in scene.body.scalars:
        scene.set_scalar(name, 0.3 + rng.random())
    scene.set(amplitude * rng.uniform(-1, 1, scene.body.owned))
    scene.predict(None)
    return scene.w.copy()


def times_tangent(scene: Scene, v: Floats) -> Floats:
    """K v at the present state, (owned,)."""
    matrix = scene.assemble_tangent()
    x, y = matrix.createVecs()
    x.array_w[:] = v
    matrix.mult(x, y)
    result: Floats = y.array_r.copy()
    return result


def set_positions(scene: Scene, x: Floats) -> None:
    """Move every node to a deformed position (n, 3) given by input numbers."""
    body = scene.body
    body.set_displacement((x - body.domain.data.nodes)[body.owned_nodes])
    scene.set(scene.w.copy())


# --- a small actuator that bends ----------------------------------------------------------------


@functools.cache
def short_domain() -> Domain:
    """Half of the short actuator, 124 hexahedra."""
    return Domain(hexahedral_body(SHORT, MeshSize(axial=6, section=1, half=True)))


def actuator_effects(domain: Domain) -> list[Effect]:
    """The paper's actuator with a smeared winding."""
    wall, floor, sheath = {"c1": 0.11, "c2": 0.02}, {"c1": 7.9}, {"c1": 0.012662}
    return [
        Elastic("yeoh", {"wall": wall, "floor": floor, "sheath": sheath}),
        Incompressible(),
        ChamberPressure(),
        smeared(domain, SHORT),
        Clamp(),
        Symmetry(),
    ]


@dataclasses.dataclass
class Bender:
    """The short actuator with all that a march needs, and what the march told.

    Attributes:
        states: every converged state, the state at rest first.
    """

    scene: Scene
    newton: Newton
    angle: BendingAngle
    tip: Tip
    march: March
    states: list[State]
    energies: list[float]
    warnings: list[str]

    def run(self, ramps: Sequence[Ramp]) -> Report:
        """March from where it is."""
        return self.march.run(ramps)


def stored(scene: Scene) -> dict[str, float]:
    """Energies of everything but the load."""
    return {key: e for key, e in scene.energies().items() if key != "ChamberPressure"}


class Keeper(Hook):
    """Keeps what a march tells, the energies at rest first."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self.states: list[State] = []
        self.energies = [sum(stored(scene).values())]
        self.warnings: list[str] = []

    def after_step(self, march: Marching, state: State, outcome: Outcome) -> None:
        """Keep the state and its energy."""
        self.states.append(state)
        self.energies.append(sum(stored(self._scene).values()))

    def after_cutback(self, march: Marching, reason: str) -> None:
        """Keep what failed."""
        self.warnings.append(reason)


def bender(
    rules: Rules | None = None,
    settings: Settings | None = None,
    wrap: Callable[[Newton], Newton] = lambda newton: newton,
    domain: Domain | None = None,
    hooks: Sequence[Hook] = (),
) -> Bender:
    """A fresh short actuator at rest; `wrap` may put something in front of Newton."""
    domain = domain or short_domain()
    scene = Scene(domain, actuator_effects(domain))
    newton = wrap(Newton(scene, domain.comm, settings or Settings()))
    frames = Frames(scene.body)
    angle = BendingAngle(CentreLine(scene.body))
    keeper = Keeper(scene)
    march = March(
        scene,
        newton,
        rules or Rules(),
        frames=frames,
        control=angle,
        causes=Diagnosis(scene),
        hooks=[keeper, *hooks],
    )
    tip = Tip(scene.body)
    states = keeper.states
    states.append(march.rest)
    return Bender(scene, newton, angle, tip, march, states, keeper.energies, keeper.warnings)


def gravity(regions: Sequence[str]) -> Gravity:
    """Weight of a rubber, a thousandfold so that it counts."""
    return Gravity(dict.fromkeys(regions, 1.07e-06), (1200.0, -9810.0, 500.0))

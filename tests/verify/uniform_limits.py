"""The section model where the answer is known exactly."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
from mpi4py import MPI

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.supports import StraightAxis
from fem.effects.winding import CalibratedWinding, SmearedWinding
from fem.kinematics.uniform import CURVATURE, STRETCH, TWIST
from fem.march.records import Ramp
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.winding.helix import Winding
from geometry.winding.patterns import PATTERNS
from geometry.winding.smear import smear
from materials.bulging import Bulging
from materials.material import Material
from tests.exact.solutions import Torsion, closed_tube
from tests.verify.helix_tube import HelixTube
from tests.verify.ladder import YEOH
from tests.verify.uniform import (
    Floats,
    Held,
    Law,
    domain,
    linear,
    march,
    resultants,
    rubber,
    section,
)

BASELINE = HemicircleActuator(radius=8, length=160, wall=2, floor=2, sheath=1, cap=15)
LAWS: dict[str, Law] = {"wall": YEOH, "floor": {"c1": 7.9}, "sheath": {"c1": 0.012662}}
"""The paper's materials, for the baseline."""
BARE = HemicircleActuator(radius=8, length=160, wall=2, floor=2, cap=15)
SOFT: dict[str, Law] = {name: {"c1": 0.11} for name in ("wall", "floor")}
"""One material all over, for the bare section."""
TUBE = CircleActuator(radius=8, length=160, wall=2, cap=15)
INNER, OUTER = 8.0, 10.0
LAW = Material("yeoh", YEOH).principal
EA = 881.0
"""Of a fiber, N: Kevlar of half the radius of 0.38 mm diameter."""
FINE_PITCH = 0.5
BULGING, BULGY_PITCH = Bulging(0.4, 0.7, 3.0), 20.0
"""A bulge that takes up more than the thread does, and a pitch that its path shows."""
STEP = 1e-5


@dataclasses.dataclass(frozen=True)
class Check:
    """A number of the section model beside the exact one."""

    name: str
    found: float
    exact: float

    @property
    def error(self) -> float:
        """Relative; absolute where the exact number is zero."""
        return self.found - self.exact if self.exact == 0 else self.found / self.exact - 1


# --- linear beam theory -------------------------------------------------------------------------


def half_disk(radius: float, y: float) -> Floats:
    """Area and first two moments about y = 0 of the upper half of a disk about (0, y)."""
    area, first = math.pi * radius**2 / 2, 2 / 3 * radius**3
    second = math.pi * radius**4 / 8
    return np.array([area, first + y * area, second + 2 * y * first + y * y * area])


def box(width: float, low: float, high: float) -> Floats:
    """The same of a rectangle."""
    return width * np.array([high - low, (high**2 - low**2) / 2, (high**3 - low**3) / 3])


CHAMBER = half_disk(8, 2)
_OUTLINE = half_disk(10, 2) + box(20, 0, 2)
_FLOOR = box(20, 0, 2)
_OUTER = half_disk(11, 2) + box(22, -1, 2)
PARTS = {"wall": _OUTLINE - _FLOOR - CHAMBER, "floor": _FLOOR, "sheath": _OUTER - _OUTLINE}
"""Area, first and second moment about y = 0 of each region of the baseline."""


def beam(n: int) -> list[Check]:
    """k → 0 without pressure: a composite beam, Young's moduli 6 C1, all of ν = 1/2.

    With one ν the plane sections' own strains fit together, and beam theory is exact.
    """
    stiffness = np.sum([6 * LAWS[name]["c1"] * part for name, part in PARTS.items()], axis=0)
    axial, first, second = (float(x) for x in stiffness)
    where = domain(BASELINE, n)
    bent = linear(
        section(where, BASELINE, [*rubber(LAWS), Held({CURVATURE: 0.0})]), CURVATURE, STEP
    )
    held = Held({CURVATURE: 0.0, STRETCH: 1.0})
    pulled = linear(section(where, BASELINE, [*rubber(LAWS), held]), STRETCH, STEP)
    return [
        Check(
            "EI of the composite section, N mm²",
            bent.resultants[CURVATURE],
            second - first**2 / axial,
        ),
        Check("height of its neutral axis, mm", -bent.natural[STRETCH], first / axial),
        Check("EA, N", pulled.resultants[STRETCH], axial),
    ]


def bulk_bending(n: int, bulk: float | None) -> Check:
    """dk/dP at rest of a bare section of one material.

    Reciprocity with u = (xy, (y² − x²)/2) gives ∫(σxx + σyy)(1, y) dA = 2 P A (1, ȳ) of the chamber
    for any section, so that k' = (1 − 2ν) A (ȳ − ȳ_solid)/(E I), with (1 − 2ν)/E = 1/(3κ).
    """
    effects = [*rubber(SOFT, bulk), ChamberPressure()]
    found = linear(section(domain(BARE, n), BARE, effects), "pressure", STEP).natural[CURVATURE]
    area, first, second = PARTS["wall"] + PARTS["floor"]
    own = second - first**2 / area
    exact = (CHAMBER[1] - CHAMBER[0] * first / area) / (3 * bulk * own) if bulk else 0.0
    text = f"κ = {bulk:g} MPa" if bulk else "incompressible"
    return Check(f"dk/dP of the bare section, {text}, 1/(mm MPa)", found, float(exact))


def composite_bending(n: int) -> Check:
    """The same of the baseline's three materials, all incompressible: with one ν it is zero too."""
    effects = [*rubber(LAWS), ChamberPressure()]
    found = linear(section(domain(BASELINE, n), BASELINE, effects), "pressure", STEP)
    return Check("dk/dP of the baseline without winding, 1/(mm MPa)", found.natural[CURVATURE], 0.0)


# --- round tubes --------------------------------------------------------------------------------


def _wound(
    n: int, pattern: str, pitch: float, straight: bool, bulging: Bulging | None = None
) -> Scene:
    where = domain(TUBE, n)
    segments = smear(where.data, TUBE, Winding(pattern, pitch, 0.38))
    fibers: Effect = SmearedWinding(segments, EA)
    if bulging is not None:
        fibers = CalibratedWinding(segments, EA, bulging)
    effects = [*rubber({"wall": YEOH}), ChamberPressure(), fibers]
    if straight:
        effects.append(StraightAxis())
    return section(where, TUBE, effects, twisted=not PATTERNS[pattern].mirrored)


def extending_tube(n: int, pitch: float, stretch: float, bulging: Bulging | None = None) -> float:
    """Pressure in MPa that stretches the tube with a smeared double helix."""
    scene = _wound(n, "double-helix", pitch, True, bulging)
    march(scene, Ramp("pressure", stretch, drive="control"))
    return scene.scalar("pressure")


def wound_tube(n: int) -> list[Check]:
    """The extending tube at a fine pitch, beside the exact tube of the same pitch."""
    exact = HelixTube(YEOH["c1"], YEOH["c2"], INNER, OUTER, FINE_PITCH, EA, (1, -1))
    return [
        Check(
            f"P of the wound tube, pitch {FINE_PITCH:g} mm, λz = {stretch:g}, MPa",
            extending_tube(n, FINE_PITCH, stretch),
            exact.at_stretch(stretch),
        )
        for stretch in (1.1, 1.5)
    ]


def bulging_tube(n: int) -> list[Check]:
    """The extending tube whose rubber bulges, beside one whose bulge is an unknown of its own."""
    exact = HelixTube(YEOH["c1"], YEOH["c2"], INNER, OUTER, BULGY_PITCH, EA, (1, -1), BULGING)
    return [
        Check(
            f"P of the tube that bulges, pitch {BULGY_PITCH:g} mm, λz = {stretch:g}, MPa",
            extending_tube(n, BULGY_PITCH, stretch, BULGING),
            exact.at_stretch(stretch),
        )
        for stretch in (1.1, 1.5)
    ]


def free_tube(n: int) -> list[Check]:
    """The tube without winding, its ends closed and free, at a/A = 1.1."""
    exact = closed_tube(LAW, INNER, OUTER, 1.1 * INNER)
    scene = section(
        domain(TUBE, n), TUBE, [*rubber({"wall": YEOH}), ChamberPressure(), StraightAxis()]
    )
    scene.set(np.zeros(scene.body.owned))
    volume = scene.conjugate("pressure") * 1.1**2 * exact.stretch
    march(scene, Ramp("pressure", volume, drive="conjugate"))
    return [
        Check(
            "P of the free closed tube, a/A = 1.1, MPa", scene.scalar("pressure"), exact.pressure
        ),
        Check("its λz", scene.scalar(STRETCH), exact.stretch),
    ]


def single_helix(
    n: int,
    hand: int,
    pitch: float = 3.0,
    pressure: float = 0.03,
    bulging: Bulging | None = None,
) -> list[Check]:
    """A free tube wound by one helix: it stretches and twists, straight.

    The pin is not on the tube's axis: there the straight tube's frame follows a helix, ω turned
    against z. |ω| is the twist, and the advance along ω is the stretch.
    """
    pattern = {1: "single-helix-right", -1: "single-helix-left"}[hand]
    scene = _wound(n, pattern, pitch, False, bulging)
    march(scene, Ramp("pressure", pressure, first=pressure / 10))
    k, along, twist = (scene.scalar(name) for name in (CURVATURE, STRETCH, TWIST))
    spin = math.copysign(math.hypot(k, twist), twist)
    exact = HelixTube(YEOH["c1"], YEOH["c2"], INNER, OUTER, pitch, EA, (hand,), bulging)
    stretch, turn = exact.at_pressure(pressure)
    name = f"{pattern}, pitch {pitch:g} mm, {1e3 * pressure:g} kPa"
    return [
        Check(f"twist of the tube, {name}, rad/mm", spin, turn),
        Check("its λz", along * twist / spin, stretch),
    ]


def double_helix_twist(n: int, pressure: float) -> float:
    """τ in rad/mm of the baseline with both hands, smeared, at a pressure in MPa."""
    where = domain(BASELINE, n)
    fibers = smear(where.data, BASELINE, Winding("double-helix", 3.0, 0.38))
    effects = [*rubber(LAWS), ChamberPressure(), SmearedWinding(fibers, EA)]
    scene = section(where, BASELINE, effects, twisted=True)
    march(scene, Ramp("pressure", pressure, first=pressure / 10))
    return scene.scalar(TWIST)


def torsion(n: int) -> list[Check]:
    """The tube twisted by ψ = 0.05 rad/mm at constant length and radii, which takes a pressure.

    All three rates are held at those of the pin's helix; what holds them is M by ψ and N by λz.
    """
    psi, radius = 0.05, OUTER
    whole, core = Torsion(LAW, OUTER, psi), Torsion(LAW, INNER, psi)
    pressure = -float(whole.radial_stress(np.array(INNER)))
    points, weights = np.polynomial.legendre.leggauss(20)
    R = (OUTER + INNER) / 2 + (OUTER - INNER) / 2 * points
    force = math.pi * (OUTER - INNER) * float(weights @ (whole.radial_stress(R) * R))
    force -= math.pi * INNER**2 * pressure
    held = Held({CURVATURE: 0.0, STRETCH: 1.0, TWIST: 0.0})
    effects = [*rubber({"wall": YEOH}), ChamberPressure(), held]
    scene = section(domain(TUBE, n), TUBE, effects, twisted=True)
    newton = Newton(scene, MPI.COMM_SELF, Settings())
    k = spin = along = 0.0
    for part in np.linspace(0.1, 1.0, 10):
        along = math.hypot(1.0, radius * psi * part)
        spin, k = psi * part / along, -radius * (psi * part) ** 2 / along
        for name, value in {CURVATURE: k, STRETCH: along, TWIST: spin}.items():
            scene.set_scalar(name, value)
        scene.set_scalar("pressure", pressure * part**2)
        outcome = newton.solve(scene.w.copy(), [], [])
        assert outcome.converged, outcome.reason
    # ψ = |ω|, λz = λ0 τ/ψ: chain rule from (ψ, λz) to (λ0, k)
    found = resultants(scene)
    axial = found[STRETCH] * psi / spin
    moment = (found[CURVATURE] + axial * along * spin * k / psi**3) * psi / k
    return [
        Check(
            "torque of the twisted tube, ψ = 0.05 rad/mm, N mm", moment, whole.moment - core.moment
        ),
        Check("its axial force, N", axial, force),
        Check(
            "its ∂Π/∂τ, N mm",
            found[TWIST],
            (whole.moment - core.moment) * spin / psi + force * along * k**2 / psi**3,
        ),
    ]


ALL = (
    beam,
    lambda n: [bulk_bending(n, 0.22), bulk_bending(n, 2.2), bulk_bending(n, None)],
    lambda n: [composite_bending(n)],
    free_tube,
    wound_tube,
    functools.partial(single_helix, hand=1),
    torsion,
)
"""Every limit as a function of the refinement."""

"""The exact tube: its energy, its limits, and textbook answers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytic.tube import Family, Held, Tube, TubeState
from materials.material import Material
from tests.exact.solutions import Torsion, closed_tube
from tests.verify.helix_tube import HelixTube

YEOH = Material("yeoh", {"c1": 0.11, "c2": 0.02})
OGDEN = Material("ogden", {"mu1": 0.3, "alpha1": 1.8, "mu2": -0.02, "alpha2": -2.2})
LOCKING = math.atan(math.sqrt(2))
"""54.7356°, the lean at which a thin braid is in balance."""


def balanced(angle: float, stiffness: float = math.inf) -> tuple[Family, Family]:
    """A family of either hand."""
    return Family(angle, stiffness), Family(-angle, stiffness)


def energy(tube: Tube, material: Material, inner: float, stretch: float, twist: float) -> float:
    """Of the wall per mm, by scipy's quadrature and numpy's eigenvalues."""

    def density(R: float) -> float:
        r = math.sqrt(inner**2 + (R**2 - tube.inner**2) / stretch)
        F = np.array([[R / (r * stretch), 0, 0], [0, r / R, r * twist], [0, 0, stretch]])
        squares = np.linalg.eigvalsh(F.T @ F)
        return float(material.energy(*np.sqrt(squares))) * 2 * math.pi * R

    return float(quad(density, tube.inner, tube.outer, epsabs=1e-13, epsrel=1e-13)[0])


@pytest.mark.parametrize("material", [YEOH, OGDEN])
@pytest.mark.parametrize("place", [(5.4, 1.2, 0.03), (4.5, 0.9, -0.1), (5.0, 1.0, 0.0)])
def test_slopes_are_those_of_the_energy(
    material: Material, place: tuple[float, float, float]
) -> None:
    tube = Tube(material.principal, 5.0, 6.5)
    slopes = tube.solid_slopes(*place)
    for i, slope in enumerate(slopes):
        moved = []
        for side in (1, -1):
            at = np.array(place)
            at[i] += side * 1e-4
            moved.append(energy(tube, material, *at))
        assert slope == pytest.approx((moved[0] - moved[1]) / 2e-4, rel=1e-5, abs=1e-6)


def test_a_bare_tube_inflates_as_known() -> None:
    exact = closed_tube(YEOH.principal, 8.0, 10.0, 8.8)
    tube = Tube(YEOH.principal, 8.0, 10.0)
    found = tube.solve(Held(pressure=exact.pressure))
    assert found.inner == pytest.approx(8.8, rel=1e-10)
    assert found.stretch == pytest.approx(exact.stretch, rel=1e-10)
    assert (found.twist, found.force, found.torque) == pytest.approx((0, 0, 0), abs=1e-12)
    # the pressure follows from the volume as well
    again = tube.solve(Held(volume=found.volume))
    assert again.pressure == pytest.approx(exact.pressure, rel=1e-9)


def test_torsion_is_rivlins() -> None:
    twist, tube = 0.05, Tube(YEOH.principal, 8.0, 10.0)
    whole, core = Torsion(YEOH.principal, 10.0, twist), Torsion(YEOH.principal, 8.0, twist)
    pressure = -float(whole.radial_stress(np.array(8.0)))
    found = tube.solve(Held(pressure=pressure, stretch=1.0, twist=twist))
    assert found.inner == pytest.approx(8.0, rel=1e-10)
    assert found.torque == pytest.approx(whole.moment - core.moment, rel=1e-10)


@pytest.mark.parametrize("hands", [(1,), (-1,), (1, -1)])
def test_helices_are_the_same_by_complex_steps(hands: tuple[int, ...]) -> None:
    pitch, stiffness, inner, outer = 20.0, 881.0, 8.0, 10.0
    other = HelixTube(0.11, 0.02, inner, outer, pitch, stiffness, hands)
    angle = math.atan(2 * math.pi * outer / pitch)
    per_width = stiffness / (2 * math.pi * outer * math.cos(angle))
    families = tuple(Family(hand * angle, per_width) for hand in hands)
    found = Tube(YEOH.principal, inner, outer, families).solve(Held(pressure=0.05))
    assert (found.stretch, found.twist) == pytest.approx(
        other.at_pressure(0.05), rel=1e-9, abs=1e-12
    )


def test_the_other_hand_is_the_mirror_image_and_unwinds() -> None:
    right, left = (
        Tube(YEOH.principal, 8.0, 10.0, (Family(hand * 0.9),)).solve(Held(pressure=0.03))
        for hand in (1, -1)
    )
    assert right.twist < -1e-3
    assert right.twist == pytest.approx(-left.twist, rel=1e-10)
    assert right.tensions == pytest.approx(left.tensions, rel=1e-10)
    assert right.tensions[0] > 0


@pytest.mark.parametrize("families", [(0.7,), (-0.5,), (0.9, -0.9)])
def test_stiff_fibers_tend_to_those_of_fixed_length(families: tuple[float, ...]) -> None:
    def solved(stiffness: float) -> TubeState:
        made = tuple(Family(angle, stiffness) for angle in families)
        return Tube(YEOH.principal, 8.0, 10.0, made).solve(Held(pressure=0.03))

    exact = solved(math.inf)
    gaps = [abs(solved(stiffness).stretch - exact.stretch) for stiffness in (1e3, 1e4, 1e5)]
    assert gaps[1] == pytest.approx(gaps[0] / 10, rel=0.1)
    assert gaps[2] == pytest.approx(gaps[1] / 10, rel=0.02)
    stiff = solved(1e6)
    assert stiff.twist == pytest.approx(exact.twist, rel=1e-4, abs=1e-12)
    assert stiff.tensions == pytest.approx(exact.tensions, rel=1e-3)


def test_hoops_alone_keep_the_outer_radius() -> None:
    tube = Tube(YEOH.principal, 8.0, 10.0, (Family(math.pi / 2),))
    found = tube.solve(Held(pressure=0.05))
    assert tube.outer_radius(found.inner, found.stretch) == pytest.approx(10.0, rel=1e-12)
    assert found.stretch > 1.05


def test_a_braid_is_locked_at_the_angle_of_the_textbooks() -> None:
    """A thick one too: a wall that does not move passes the pressure on as it is."""
    for wall in (0.01, 0.5, 3.0):
        rates = []
        for lean in (-0.01, 0.0, 0.01):
            tube = Tube(YEOH.principal, 10 - wall, 10.0, balanced(LOCKING + lean))
            rates.append(tube.solve(Held(pressure=1e-5)).stretch - 1)
        below, at, above = rates
        assert below < 0 < above
        assert abs(at) < 1e-3 * min(-below, above)


@pytest.mark.parametrize("degrees", [20.0, 48.0, 54.735610317, 85.0])
def test_one_family_with_ends_held_gives_the_ideal_force_and_torque(degrees: float) -> None:
    # nothing moves: F/P = −π R² (1 − 2 cot² α) pulls, M/P = −2π R³ cot α
    angle, radius, pressure = math.radians(degrees), 5.0, 0.04
    tube = Tube(YEOH.principal, 3.5, radius, (Family(angle),))
    found = tube.solve(Held(pressure=pressure, stretch=1.0, twist=0.0))
    slope = 1 / math.tan(angle)
    assert found.inner == pytest.approx(3.5, rel=1e-10)
    assert found.force / pressure == pytest.approx(
        -math.pi * radius**2 * (1 - 2 * slope**2), rel=1e-8, abs=1e-6
    )
    assert found.torque / pressure == pytest.approx(2 * math.pi * radius**3 * slope, rel=1e-8)


def test_a_path_does_not_matter() -> None:
    tube = Tube(YEOH.principal, 8.0, 10.0, (Family(0.8, 50.0), Family(-0.6, 20.0)))
    free = tube.solve(Held(pressure=0.04))
    held = tube.solve(Held(volume=free.volume, stretch=free.stretch, twist=free.twist))
    assert (held.force, held.torque) == pytest.approx((0, 0), abs=1e-8)
    assert held.pressure == pytest.approx(0.04, rel=1e-8)
    assert held.tensions == pytest.approx(free.tensions, rel=1e-8)


def test_what_cannot_be_is_refused() -> None:
    bare = Tube(YEOH.principal, 8.0, 10.0)
    with pytest.raises(ValueError, match="no state of the tube is found at pressure"):
        Tube(Material("neo-hooke", {"mu": 0.1}).principal, 8.0, 10.0).solve(Held(pressure=1.0))
    # the ends held and two families: more than three numbers can follow
    with pytest.raises(ValueError, match="no state"):
        Tube(YEOH.principal, 8.0, 10.0, balanced(0.8)).solve(
            Held(pressure=0.01, stretch=1.0, twist=0.0)
        )
    with pytest.raises(ValueError, match="force and stretch are both given"):
        Held(pressure=0.0, force=1.0, stretch=1.0)
    with pytest.raises(ValueError, match="expected a pressure or a volume"):
        Held(force=1.0)
    with pytest.raises(ValueError, match="expected a wall"):
        Tube(YEOH.principal, 8.0, 8.0)
    with pytest.raises(ValueError, match="expected −π/2 to π/2"):
        Family(2.0)
    with pytest.raises(ValueError, match="expected a positive value"):
        Family(1.0, 0.0)
    assert bare.solve(Held(pressure=0.0)) == bare.rest

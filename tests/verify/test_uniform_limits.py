"""Section model against exact limits; a coarse mesh is enough, and cheap."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tests.verify import uniform_limits as limits
from tests.verify.uniform_limits import Check


def _close(checks: list[Check], tolerance: float) -> None:
    for check in checks:
        assert check.found == pytest.approx(check.exact, rel=tolerance), check.name


def test_small_curvature_is_a_composite_beam() -> None:
    # floor 72 and 624 times as stiff as wall and sheath; quadratic arcs lose 4e-6 of EI
    _close(limits.beam(2), 1e-5)


def test_bare_section_bends_by_its_compressibility_alone() -> None:
    # k' ∝ (1 − 2ν): the exact slope is 1/κ. The concave corner of the chamber makes an error that
    # does not know κ, and falls with the fourth power of the mesh
    for bulk in (0.22, 2.2, None):
        coarse, fine = (limits.bulk_bending(n, bulk) for n in (2, 4))
        errors = [check.found - check.exact for check in (coarse, fine)]
        assert abs(errors[1]) < abs(errors[0]) / 10
        # the slope of the wound baseline is 0.21
        assert abs(errors[1]) < 3e-5
    assert limits.bulk_bending(4, 0.22).error == pytest.approx(0.0, abs=1e-3)


def test_baseline_without_winding_does_not_bend_at_first_order() -> None:
    # one ν = 1/2 in all regions: neither the stiff floor nor the sheath changes that; the wound
    # baseline has 0.21
    assert abs(limits.composite_bending(2).found) < 2e-5


def test_closed_tube_without_winding() -> None:
    # exact, by quadrature: p = 0.01347609 and λz = 1.00417997 at a/A = 1.1
    pressure, stretch = limits.free_tube(2)
    assert pressure.found == pytest.approx(0.01347609, rel=1e-5)
    assert stretch.found == pytest.approx(1.00417997, rel=1e-6)


def test_wound_tube_of_a_finite_pitch() -> None:
    # the same helices smeared, exactly: extension and inflation of a tube in a membrane
    _close(limits.wound_tube(1), 2e-5)


def test_wound_tube_that_bulges_between_the_turns() -> None:
    # exactly, with the bulge as an unknown of its own: thread and rubber in series
    checks = limits.bulging_tube(2)
    _close(checks, 2e-5)
    for check, stretch in zip(checks, (1.1, 1.5), strict=True):
        plain = limits.extending_tube(2, limits.BULGY_PITCH, stretch)
        assert abs(check.found / plain - 1) > 0.01


@pytest.mark.parametrize(("stretch", "reference"), [(1.1, 0.03107830), (1.5, 0.12667995)])
def test_wound_tube_tends_to_inextensible_hoops(stretch: float, reference: float) -> None:
    # exact, by quadrature; a pitch of 0.1 mm leaves 5e-5 and 7e-5, by the exact tube of that pitch
    errors = [limits.extending_tube(1, p, stretch) / reference - 1 for p in (1.0, 0.1)]
    assert abs(errors[1]) < 1e-4
    assert abs(errors[1]) < abs(errors[0])


@pytest.mark.parametrize("hand", [1, -1])
def test_single_helix_unwinds_under_pressure(hand: int) -> None:
    # the tensioned fiber pulls the tube's ends as if to straighten: its torque on a section is
    # along its hand, the rubber's is against it, so that a right-handed helix turns the tip
    # clockwise (ψ < 0 about +z) and loses turns
    twist, stretch = limits.single_helix(1, hand)
    assert twist.found * hand < 0
    _close([twist, stretch], 1e-4)


@pytest.mark.parametrize("hand", [1, -1])
def test_single_helix_that_bulges(hand: int) -> None:
    # a steep one: λz at the thread has a part of the twist
    found = limits.single_helix(2, hand, pitch=20.0, bulging=limits.BULGING)
    _close(found, 1e-4)
    plain = limits.single_helix(2, hand, pitch=20.0)
    for check, without in zip(found, plain, strict=True):
        assert abs(check.found - without.found) > 100 * abs(check.found - check.exact)


@pytest.mark.parametrize(
    "limit", [limits.beam, limits.free_tube, limits.wound_tube, limits.bulging_tube, limits.torsion]
)
def test_errors_fall_with_the_fourth_power(limit: Callable[[int], list[Check]]) -> None:
    # resultants and pressures are derivatives of an energy: twice the order of its strains
    for coarse, fine in zip(limit(1), limit(2), strict=True):
        assert abs(fine.error) < abs(coarse.error) / 12, coarse.name


def test_torsion_of_a_tube() -> None:
    # Rivlin's torsion; the frame rides on the outer surface, so curvature, stretch and twist all
    # enter
    _close(limits.torsion(2), 2e-5)


def test_double_helix_does_not_twist_when_it_may() -> None:
    # twist is an unknown here, and its torque zero by the symmetry of the two hands
    assert abs(limits.double_helix_twist(1, 0.06)) < 1e-10

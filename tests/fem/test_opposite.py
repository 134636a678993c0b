"""Half a body counts the modes of the opposite symmetry that it cannot follow."""

from __future__ import annotations

import pytest

from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry, TwofoldAxis
from fem.kinematics.domain import Domain
from fem.march.march import ACROSS, March
from fem.march.records import Ramp, Report, Rules
from fem.scene import Scene
from fem.solver.newton import Newton, Settings
from tests.exact.solids import box

SHEAR, HEIGHT, THIN = 0.22, 20.0, 1.0


def half(weight: float) -> tuple[March, Report]:
    """Half a column that is thin along x, cut at x = 0, under a part of Greenhill's weight."""
    domain = Domain(box((THIN / 2, 2.0, HEIGHT), (1, 1, 6)))
    greenhill = 7.8373 * 3 * SHEAR * THIN**2 / 12 / HEIGHT**3
    scene = Scene(
        domain,
        [
            Elastic("neo-hooke", {"solid": {"mu": SHEAR}}),
            Incompressible(),
            Clamp("bottom"),
            Symmetry("left", 0, halves=True),
            Gravity({"solid": 1.0}, (0.0, 0.0, -greenhill)),
        ],
    )
    march = March(scene, Newton(scene, domain.comm, Settings()), Rules())
    return march, march.run([Ramp("gravity", weight, first=weight)])


def test_half_a_column_stands_below_the_weight_that_buckles_the_whole() -> None:
    assert half(0.95)[1].status == "converged"


def test_half_a_column_does_not_stand_above_it() -> None:
    # it bends to the side, across the plane: before, 'converged' without an unstable mode
    march, report = half(1.06)
    assert (report.status, report.reason) == ("failed", ACROSS)
    assert march.states[-1].scalars["gravity"] == 0.0


def test_the_opposite_of_each_symmetry_is_fixed() -> None:
    mirror, axis = Symmetry(halves=True).opposite(), TwofoldAxis().opposite()
    assert mirror is not None
    assert axis is not None
    assert [c.component for c in mirror] == [1, 2]
    assert [c.component for c in axis] == [1]
    assert Symmetry("section_root", 2).opposite() is None


@pytest.mark.parametrize("weight", [0.5])
def test_a_count_leaves_the_state_as_it_is(weight: float) -> None:
    march, _ = half(weight)
    state = march.states[-1]
    assert march.equilibrium.opposite_modes(state, march.rest) == 0
    assert march.equilibrium.scene.scalar("gravity") == weight
    assert (march.equilibrium.scene.w == state.w).all()

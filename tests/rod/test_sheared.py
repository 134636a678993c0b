"""Rods that shear beside closed forms: Timoshenko's cantilever, a block, the centre of shear."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from rod.functions import Floats
from rod.law import Linear
from rod.layout import STRAINS, Layout
from rod.loads import TipForce
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.sheared import Sheared
from rod.statics import Path, State, solve
from tests.rod.bars import PLANE, Bar

BAR = Bar()
SHEARED = ("shear_y", *PLANE)
ON = Path(Level(), Level(amounts=(1.0,)))
TINY = 1e-6
AREA, GROWTH = 300.0, 4000.0
"""By how much the stiffness against shear grows with the pressure and its square, N/MPa, N/MPa²."""


def law(
    shear: float = BAR.shear, strains: tuple[str, ...] = SHEARED, lever: float = 0.0
) -> Sheared:
    """A bar's, shears beside a law without them; forces along x act at `lever` above the line."""
    names = [name for name in strains if not name.startswith("shear")]
    stiff = BAR.stiffnesses()
    own = Linear(
        np.diag([stiff[name] for name in names]),
        np.array([1.0 if name == "stretch" else 0.0 for name in names]),
        area=70.0,
    )
    turn = np.zeros((len(strains) - len(names), len(strains)))
    for row, name in enumerate(n for n in strains if n not in names):
        turn[row, strains.index(name)] = 1.0
        if name == "shear_x" and "twist" in strains:
            turn[row, strains.index("twist")] = -lever
    forms = np.array([shear, AREA, GROWTH])[:, None, None] * (turn.T @ turn)
    rest = np.array([1.0 if name == "stretch" else 0.0 for name in strains])
    return Sheared(own, tuple(strains.index(name) for name in names), forms, rest)


def bent(
    force: tuple[float, float, float],
    shear: float = BAR.shear,
    strains: tuple[str, ...] = SHEARED,
    lever: float = 0.0,
    pieces: int = 48,
) -> State:
    rod = Rod(BAR.layout(pieces, strains), law(shear, strains, lever), terms=[TipForce(force)])
    return solve(rod, rod.layout.at_rest(), ON, 1.0)


@pytest.mark.parametrize("pressure", [0.0, 0.1])
def test_derivatives_are_those_of_differences(pressure: float) -> None:
    strains, random = STRAINS, np.random.default_rng(1)
    own = law(50.0, strains, lever=3.0)
    at = np.array([0.1, -0.2, 1.05, 0.01, 0.02, 0.03]) + 0.01 * random.normal(size=(4, 6))
    for number, away in enumerate(TINY * np.eye(6)):
        one, other = own.value(at + away, pressure), own.value(at - away, pressure)
        told = own.gradient(at, pressure)[:, number]
        assert (one - other) / (2 * TINY) == pytest.approx(told, rel=1e-6, abs=1e-6)
        one, other = (own.gradient(at + side * away, pressure) for side in (1, -1))
        told = own.hessian(at, pressure)[:, number]
        np.testing.assert_allclose((one - other) / (2 * TINY), told, rtol=1e-6, atol=1e-4)
    one, other = (own.value(at, pressure + side * TINY) for side in (1, -1))
    assert (other - one) / (2 * TINY) == pytest.approx(own.chamber(at, pressure), rel=1e-7)
    one, other = (own.gradient(at, pressure + side * TINY) for side in (1, -1))
    told = own.chamber_gradient(at, pressure)
    np.testing.assert_allclose((other - one) / (2 * TINY), told, rtol=1e-6, atol=1e-5)
    one, other = (own.chamber(at, pressure + side * TINY) for side in (1, -1))
    told = own.chamber_slope(at, pressure)
    assert (one - other) / (2 * TINY) == pytest.approx(told, rel=1e-6)


def test_it_is_even_in_shear_and_twist() -> None:
    own = law(50.0, STRAINS, lever=3.0)
    at = np.array([[0.1, -0.2, 1.05, 0.01, 0.02, 0.03]])
    turned = at * np.array([-1.0, -1.0, 1.0, 1.0, 1.0, -1.0])
    assert own.value(at, 0.1) == pytest.approx(own.value(turned, 0.1), rel=1e-14)


def test_timoshenkos_cantilever() -> None:
    # so small that what is of the third order is below the tolerance
    force = 1e-5
    found = -bent((0.0, -force, 0.0)).shape.places[-1, 1]
    bending, length = BAR.young * BAR.second, BAR.length
    # 48 arcs with the curvature of their middles lack 1/(4 n²) of the bending part
    bends = force * length**3 / (3 * bending) * (1 - 1 / (4 * 48**2))
    assert found == pytest.approx(bends + force * length / BAR.shear, rel=1e-6)


def test_a_block_that_shears_alone() -> None:
    block = Bar(length=1.0, height=100.0, young=1e4)
    layout = block.layout(4, SHEARED)
    force, shear = 10.0, 40.0
    stiff = np.diag([shear, block.young * block.area, 1e4 * block.young * block.second])
    rod = Rod(layout, Linear(stiff, np.array([0.0, 1.0, 0.0])), terms=[TipForce((0, -force, 0))])
    state = solve(rod, layout.at_rest(), ON, 1.0)
    assert state.shape.places[-1, 1] == pytest.approx(-force / shear, rel=1e-6)
    np.testing.assert_allclose(state.shape.rotations[-1], np.eye(3), atol=1e-6)


def test_a_force_beside_the_centre_of_shear_twists() -> None:
    force, lever = 1e-5, 3.0
    strains = STRAINS
    twist = BAR.stiffnesses()["twist"]
    beside = bent((force, 0.0, 0.0), 50.0, strains, lever)
    # the torque of a force at the line about the centre of shear above it
    turned = float(np.sum(beside.strains[:, 5]) * BAR.length / 48)
    assert turned == pytest.approx(force * lever * BAR.length / twist, rel=1e-6)
    straight = bent((force, 0.0, 0.0), 50.0, strains)
    assert abs(straight.strains[:, 5]).max() < 1e-12
    # to the side it goes as far as Timoshenko's and, of its line, by the twist
    moved = beside.shape.places[-1, 0] - straight.shape.places[-1, 0]
    assert moved == pytest.approx(turned * lever, rel=1e-5)


def test_without_shear_it_is_kirchhoffs_and_nothing_locks() -> None:
    plain = Rod(
        BAR.layout(24), Linear(np.diag([160.0, BAR.second]), np.array([1.0, 0.0])),
        terms=[TipForce((0.0, -0.2, 0.0))],
    )  # fmt: skip
    exact = solve(plain, plain.layout.at_rest(), ON, 1.0)
    off = []
    for shear in (1e4, 1e6, 1e8):
        state = bent((0.0, -0.2, 0.0), shear, pieces=24)
        off.append(float(np.abs(state.shape.places - exact.shape.places).max()))
        assert state.iterations <= exact.iterations + 2
    # what is left is what shears
    assert off[0] == pytest.approx(100 * off[1], rel=0.01)
    assert off[1] == pytest.approx(100 * off[2], rel=0.01)
    assert off[2] < 1e-6


def test_constant_strains_are_a_screw() -> None:
    strains = np.array([0.1, -0.2, 1.1, 0.02, -0.01, 0.03])
    layout = Layout(np.full(12, 5.0), STRAINS)
    shape = Shape(layout, np.tile(strains, (12, 1)))
    screw = np.zeros((4, 4))
    screw[:3, :3] = [[0, -0.03, -0.01], [0.03, 0, -0.02], [0.01, 0.02, 0]]
    screw[:3, 3] = strains[:3]
    np.testing.assert_allclose(shape.frames[-1], expm(60 * screw)[:3], atol=1e-12)


def test_a_turned_rod_has_the_same_strains() -> None:
    force = np.array([0.05, -0.2, 0.1])
    turn = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()

    def found(rotation: Floats) -> State:
        layout = Layout(np.full(16, BAR.length / 16), STRAINS, rotation, np.array([1.0, 2.0, 3.0]))
        load = TipForce(tuple((rotation @ force).tolist()))
        rod = Rod(layout, law(50.0, STRAINS, 3.0), terms=[load])
        return solve(rod, layout.at_rest(), ON, 1.0)

    one, other = found(np.eye(3)), found(turn)
    np.testing.assert_allclose(one.strains, other.strains, atol=1e-10)


def test_a_form_is_symmetric() -> None:
    own = law()
    with pytest.raises(ValueError, match="symmetric matrices of 3 × 3"):
        Sheared(own.law, own.columns, own.forms[:, :2], own.rest)
    crooked = own.forms + np.triu(np.ones((3, 3)), 1)
    with pytest.raises(ValueError, match="symmetric"):
        Sheared(own.law, own.columns, crooked, own.rest)

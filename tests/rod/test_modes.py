"""Natural frequencies beside the theories of Euler and Bernoulli, and of Timoshenko."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from rod.inertia import SectionMass, lump, spread
from rod.law import Linear
from rod.layout import STRAINS
from rod.loads import TipForce
from rod.modes import modes
from rod.rod import Level, Rod
from rod.statics import Path, solve
from tests.rod.bars import PLANE, SPACE, Bar

SLENDER = Bar(length=120.0, width=4.0, height=2.0)
THICK = Bar()


def test_three_frequencies_of_euler_and_bernoulli() -> None:
    """cos β cosh β = −1, f = β²/(2π L²) √(EI/ρA), without rotary inertia."""
    bar = SLENDER
    layout = bar.layout(48, ("curvature",))
    law = Linear(np.array([[bar.young * bar.second]]), np.zeros(1))
    rod = Rod(layout, law, spread(layout, [SectionMass(bar.density * bar.area)]))
    found = modes(rod, rod.shape(layout.at_rest()), Level(), 3).frequencies
    roots = [
        brentq(lambda b: math.cos(b) * math.cosh(b) + 1, *ends) for ends in ((1, 3), (4, 6), (7, 9))
    ]
    rate = math.sqrt(bar.young * bar.second / (bar.density * bar.area)) / (
        2 * math.pi * bar.length**2
    )
    np.testing.assert_allclose(found, rate * np.array(roots) ** 2, rtol=0.002)


def timoshenko(bar: Bar, count: int) -> list[float]:
    """Hz: y' = A(ω) y with deflection, turn, moment and shear force; a clamped and a free end."""
    mass, rotary = bar.density * bar.area, bar.density * bar.second

    def free(f: float) -> float:
        w2 = (2 * math.pi * f) ** 2
        a = np.zeros((4, 4))
        a[0, 1], a[0, 3] = 1.0, 1 / bar.shear
        a[1, 2] = 1 / (bar.young * bar.second)
        a[2, 1], a[2, 3] = -w2 * rotary, -1.0
        a[3, 0] = -w2 * mass
        return float(np.linalg.det(expm(a * bar.length)[2:, 2:]))

    at = np.linspace(0.5, 60.0, 400)
    values = [free(f) for f in at]
    found = [
        brentq(free, *ends, xtol=1e-10)
        for *ends, low, high in zip(at, at[1:], values, values[1:], strict=False)
        if low * high < 0
    ]
    return found[:count]


def test_three_frequencies_of_timoshenko() -> None:
    rod = THICK.rod(48, ("shear_y", "stretch", "curvature"))
    found = modes(rod, rod.shape(rod.layout.at_rest()), Level(), 3).frequencies
    np.testing.assert_allclose(found, timoshenko(THICK, 3), rtol=0.002)


def test_frequencies_converge_with_the_square_of_a_piece() -> None:
    exact = np.array(timoshenko(THICK, 3))
    errors = []
    for pieces in (32, 64, 128):
        rod = THICK.rod(pieces, ("shear_y", "curvature"))
        errors.append(
            modes(rod, rod.shape(rod.layout.at_rest()), Level(), 3).frequencies / exact - 1
        )
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, atol=0.2)
    np.testing.assert_allclose(errors[1] / errors[2], 4.0, atol=0.1)


def test_a_bar_twists_and_stretches_by_waves() -> None:
    """f = c/4L, 3c/4L with c² = EA/ρA, or GJ/(ρ I_p)."""
    bar = THICK
    rod = bar.rod(48, ("stretch", "twist"))
    found = modes(rod, rod.shape(rod.layout.at_rest()), Level(), 3)
    waves = math.sqrt(bar.young / bar.density)
    turns = math.sqrt(bar.stiffnesses()["twist"] / (bar.density * (bar.second + bar.side)))
    exact = sorted(n * c / (4 * bar.length) for c in (waves, turns) for n in (1, 3))[:3]
    np.testing.assert_allclose(found.frequencies, exact, rtol=1e-3)
    masses = rod.shape(rod.layout.at_rest()).mass(rod.inertia)
    shapes = found.strains.reshape(3, -1)
    np.testing.assert_allclose(shapes @ masses @ shapes.T, np.eye(3), atol=1e-10)


def test_a_mass_at_the_tip_swings_as_a_spring() -> None:
    """A massless bar: f = √(3 EI/(m L³))/2π."""
    bar = SLENDER
    layout = bar.layout(48, ("curvature",))
    masses = spread(layout, [SectionMass(0.0)])
    masses[-1] += lump(1e-5, (0.0, 0.0, 0.0))
    law = Linear(np.array([[bar.young * bar.second]]), np.zeros(1))
    rod = Rod(layout, law, masses)
    # one mass, 48 strains: the others have none
    tangent = rod.tangent(rod.shape(layout.at_rest()), Level())
    mass = rod.shape(layout.at_rest()).mass(masses)
    squares = 1 / np.linalg.eigvals(np.linalg.solve(tangent, mass)).real.max()
    exact = math.sqrt(3 * bar.young * bar.second / (1e-5 * bar.length**3))
    assert math.sqrt(squares) == pytest.approx(exact, rel=2e-4)


def pressed(bar: Bar, load: float) -> float:
    """Lowest frequency of a clamped bar under a dead load P along it, Hz.

    EI d⁴w/dz⁴ + P d²w/dz² = ω² ρA w; at the free end neither moment nor EI d³w/dz³ + P dw/dz.
    """
    mass, bending = bar.density * bar.area, bar.young * bar.second

    def free(f: float) -> float:
        a = np.zeros((4, 4))
        a[0, 1], a[1, 2], a[2, 1], a[2, 3] = 1.0, 1 / bending, -load, 1.0
        a[3, 0] = (2 * math.pi * f) ** 2 * mass
        return float(np.linalg.det(expm(a * bar.length)[2:, 2:]))

    root: float = brentq(free, 1e-6, 0.9, xtol=1e-12)
    return root


def test_a_frequency_falls_to_zero_at_eulers_load() -> None:
    bar = SLENDER
    buckles = math.pi**2 * bar.young * bar.second / (4 * bar.length**2)
    found = []
    for part in (0.0, 0.5, 0.9, 0.999, 1.002):
        tip = TipForce((0.0, 0.0, -part * buckles))
        layout = bar.layout(48, ("curvature",))
        law = Linear(np.array([[bar.young * bar.second]]), np.zeros(1))
        masses = spread(layout, [SectionMass(bar.density * bar.area)])
        rod = Rod(layout, law, masses, [tip])
        shape = rod.shape(layout.at_rest())
        found.append(float(modes(rod, shape, Level(amounts=(1.0,)), 1).frequencies[0]))
    exact = [pressed(bar, part * buckles) for part in (0.0, 0.5, 0.9)]
    np.testing.assert_allclose(found[:3], exact, rtol=1e-3)
    assert found[2] > found[3] > 0 > found[4]


def test_modes_are_refused_where_there_are_none() -> None:
    bar = THICK
    bare = Rod(bar.layout(3), bar.law(PLANE))
    with pytest.raises(ValueError, match="without inertia"):
        modes(bare, bare.shape(bare.layout.at_rest()), Level(), 1)
    rod = bar.rod(3, SPACE, [TipForce((0.1, 0.05, 0.0), follows=True)])
    path = Path(Level(), Level(amounts=(0.0, 1.0)))
    state = solve(rod, rod.layout.at_rest(), path, 0.1)
    with pytest.raises(ValueError, match="has no potential"):
        modes(rod, state.shape, state.level, 1)


def test_modes_of_a_bent_rod_are_those_of_small_motions() -> None:
    """Of the tangent at the bent state: an eigenvector is a solution of K x = ω² M x."""
    rod = THICK.rod(8, STRAINS)
    state = solve(rod, rod.layout.at_rest(), Path(Level(), Level(amounts=(1.0,))), 1.0)
    found = modes(rod, state.shape, state.level, 2)
    x = found.strains[1].ravel()
    tangent, mass = rod.tangent(state.shape, state.level), state.shape.mass(rod.inertia)
    left, right = tangent @ x, (2 * math.pi * found.frequencies[1]) ** 2 * mass @ x
    np.testing.assert_allclose(left, right, atol=1e-8 * np.abs(left).max())
    assert dataclasses.is_dataclass(found)

"""Tables that refine themselves, beside the laws that they stand for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import BSpline

from rod.functions import Floats
from rod.law import Linear, Zones
from rod.layout import Layout
from rod.loads import TipForce
from rod.motion import Motion
from rod.rod import Level, Rod
from rod.spline import Axis, Samples, fitted
from rod.statics import NoEquilibriumError, Path, Volume, march
from rod.table import NotReachedError, Table, tabulate
from tests.rod.bars import Bar

RANGES = ((0.9, 1.4), (-0.01, 0.04), (0.0, 0.1))
"""Stretch, curvature in 1/mm, pressure in MPa."""
STEP = 1e-30


def energy(stretch: Floats, k: Floats, pressure: Floats) -> Floats:
    """Rubber that stiffens, around a chamber that grows with both strains."""
    rubber = 30 * (stretch**2 + 2 / stretch - 3) + 1500 * (np.cosh(30 * k) - 1) * stretch / 900
    area = 30 + 25 * (stretch - 1) + 4 * np.exp(8 * k) + 500 * k * stretch
    return rubber + 200 * k**2 - pressure * area - 3 * pressure**2 * (1 + 2 * stretch + 20 * k)


class Counted:
    """The law with its slopes by complex steps; counts what it is asked."""

    def __init__(self) -> None:
        self.points: list[list[float]] = []

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """See `rod.table.Sample`."""
        self.points += points.tolist()
        slopes = np.empty_like(points)
        for axis in range(points.shape[1]):
            moved = points.T.astype(complex)
            moved[axis] += 1j * STEP
            slopes[:, axis] = energy(*moved).imag / STEP
        return energy(*points.T), slopes


def inside(count: int, seed: int = 0) -> Floats:
    low, high = np.array(RANGES)[:2].T
    return low + np.random.default_rng(seed).random((count, 2)) * (high - low)


@pytest.mark.parametrize("degree", [1, 2, 3, 4, 5])
def test_a_basis_is_scipys(degree: int) -> None:
    lines = np.array([-1.0, 0.3, 0.5, 1.2, 2.0])
    axis = Axis(lines, degree)
    x = np.linspace(-1.0, 1.9999, 40)
    coefficients = np.random.default_rng(0).normal(size=axis.count)
    knots = np.concatenate([np.full(degree, -1.0), lines, np.full(degree, 2.0)])
    spline = BSpline(knots, coefficients, degree)
    first, basis = axis.basis(x)
    for order in range(min(3, degree + 1)):
        near = coefficients[first[:, None] + np.arange(degree + 1)]
        found = np.sum(basis[order] * near, axis=1)
        np.testing.assert_allclose(found, spline(x, order), atol=1e-11)
    highest = spline(lines[:-1] + 1e-9, degree)
    np.testing.assert_allclose(axis.highest(coefficients), highest, rtol=1e-9)


def test_lines_rise_and_points_are_enough() -> None:
    with pytest.raises(ValueError, match="that rise"):
        Axis(np.array([0.0, 1.0, 1.0]), 3)
    axis = Axis(np.array([0.0, 1.0, 2.0]), 4)
    few = Samples(np.array([[0.0], [2.0]]), np.zeros(2), np.zeros((2, 1)))
    with pytest.raises(ValueError, match="2 points do not determine 6"):
        fitted((axis,), few)


@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-4])
def test_a_table_has_the_error_that_was_asked_for(error: float) -> None:
    law = Counted()
    table = tabulate(law, RANGES, error)
    assert table.errors.max() <= error
    assert len({tuple(point) for point in law.points}) == len(law.points), "nothing is asked twice"
    strains, worst = inside(3000), np.zeros(3)
    spans = np.ptp(table.samples.slopes, axis=0)
    for pressure in (0.0, 0.013, 0.057, 0.1):
        values, slopes = Counted()(np.column_stack([strains, np.full(3000, pressure)]))
        found = np.column_stack(
            [table.gradient(strains, pressure), -table.chamber(strains, pressure)]
        )
        worst = np.maximum(worst, (np.abs(found - slopes) / spans).max(axis=0))
        assert np.abs(table.value(strains, pressure) - values).max() < error * np.ptp(values)
    # the greatest error is what it says, each within a factor: it was compared at some points
    assert worst.max() == pytest.approx(table.errors.max(), rel=0.1)
    assert np.all(worst < 2 * table.errors + 1e-9)


def test_it_is_finer_where_the_law_bends_more() -> None:
    def sharp(points: Floats) -> tuple[Floats, Floats]:
        stretch, k, pressure = points.T
        rise = np.tanh(400 * (k - 0.03))
        slopes = np.column_stack([stretch, 1 + rise, 0 * pressure])
        integral = np.log(np.cosh(400 * (k - 0.03))) / 400
        return stretch**2 / 2 + k + integral, slopes

    table = tabulate(sharp, RANGES, 0.01)
    stretches, curvatures, pressures = (np.diff(axis.lines) for axis in table.axes)
    assert (len(stretches), len(pressures)) == (3, 1)
    middle = (table.axes[1].lines[1:] + table.axes[1].lines[:-1]) / 2
    assert curvatures[middle > 0.02].min() < curvatures[middle < 0.01].min() / 2


def test_derivatives_are_those_of_differences() -> None:
    table, strains, pressure = tabulate(Counted(), RANGES, 1e-3), inside(20), 0.04
    step = np.array([1e-4, 1e-5])
    for axis in range(2):
        move = step * np.eye(2)[axis]
        up, down = strains + move, strains - move
        slope = (table.value(up, pressure) - table.value(down, pressure)) / (2 * step[axis])
        found = table.gradient(strains, pressure)[:, axis]
        np.testing.assert_allclose(found, slope, rtol=1e-5, atol=1e-4)
        second = (table.gradient(up, pressure) - table.gradient(down, pressure)) / (2 * step[axis])
        scale = np.abs(second).max()
        np.testing.assert_allclose(
            table.hessian(strains, pressure)[:, axis], second, atol=1e-5 * scale
        )
    d = 1e-5
    area = (table.value(strains, pressure - d) - table.value(strains, pressure + d)) / (2 * d)
    np.testing.assert_allclose(table.chamber(strains, pressure), area, rtol=1e-6)
    forces = table.gradient(strains, pressure - d) - table.gradient(strains, pressure + d)
    np.testing.assert_allclose(
        table.chamber_gradient(strains, pressure), forces / (2 * d), rtol=1e-5, atol=1e-4
    )


def test_what_cannot_be_reached_is_refused() -> None:
    with pytest.raises(NotReachedError, match="200 allowed"):
        tabulate(Counted(), RANGES, 1e-6, most=200)

    def broken(points: Floats) -> tuple[Floats, Floats]:
        values, slopes = Counted()(points)
        values[-1] = math.nan
        return values, slopes

    with pytest.raises(ValueError, match="not finite at"):
        tabulate(broken, RANGES, 1e-2)


def rod_of(table: Table, pieces: int = 6) -> Rod:
    bar = Bar()
    plain = bar.rod(pieces, tip=[TipForce((0.0, -0.01, 0.0))])
    return Rod(plain.layout, table, plain.inertia, plain.terms)


def test_a_rod_by_a_table_is_one_by_the_law() -> None:
    """Under pressure alone ∂Φ/∂ε = 0 for the law itself, to the table's error."""
    table = tabulate(Counted(), RANGES, 1e-4)
    rod = rod_of(table)
    path = Path(Level(pressure=0.0), Level(pressure=0.05))
    rest = np.tile([1.0, 0.0], (6, 1))
    state = march(rod, rest, path, [0.0, 0.25, 0.5, 0.75, 1.0])[-1]
    _, slopes = Counted()(np.column_stack([state.strains, np.full(6, 0.05)]))
    assert np.all(np.abs(slopes[:, :2]) < 2e-4 * np.ptp(table.samples.slopes, axis=0)[:2])
    assert np.ptp(state.strains, axis=0).max() < 1e-12
    assert state.unstable == 0
    area = 30 + 25 * (state.strains[0, 0] - 1) + 4 * math.exp(8 * state.strains[0, 1])
    area += 500 * state.strains[0, 1] * state.strains[0, 0]
    area += 6 * 0.05 * (1 + 2 * state.strains[0, 0] + 20 * state.strains[0, 1])
    assert rod.volume(state.strains, 0.05) == pytest.approx(120 * area, rel=1e-4)


def test_a_rod_by_a_table_keeps_its_energy() -> None:
    rod = rod_of(tabulate(Counted(), RANGES, 1e-3))
    level = Level(0.02, (1.0,))
    start = march(
        rod, np.tile([1.0, 0.0], (6, 1)), Path(Level(), Level(0.02, (0.2,))), [0.0, 0.5, 1.0]
    )
    motion = Motion(rod, lambda time: level)
    moving = motion.at(start[-1].strains)
    first, most = motion.energy(moving), 0.0
    for now in motion.run(moving, 1e-3, 150):
        most = max(most, float(np.sum(now.velocity @ rod.inertia * now.velocity)) / 2)
        assert motion.energy(now) == pytest.approx(first, abs=1e-9 * max(abs(first), 1.0))
    assert most > 0.01


def test_a_volume_is_reached_by_a_table() -> None:
    """Its chamber takes more air at held strains too."""
    rod = rod_of(tabulate(Counted(), RANGES, 1e-3))
    path = Path(Level(), Level(pressure=0.05))
    rest = np.tile([1.0, 0.0], (6, 1))
    begin = march(rod, rest, path, [0.0, 1.0])
    first, last = (rod.volume(state.strains, state.level.pressure) for state in begin)
    middle = march(rod, begin[0], path, [(first + last) / 2], Volume())[0]
    assert rod.volume(middle.strains, middle.level.pressure) == pytest.approx((first + last) / 2)
    assert 0.0 < middle.share < 1.0
    assert middle.iterations <= 6, "its slopes are exact"


class Kinked:
    """Φ = ½ x² + 3 max(x − P/2, 0)²: what goes taut behind a line that no axis follows."""

    def __init__(self) -> None:
        self.asked = 0

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Value and slopes."""
        self.asked += len(points)
        x, pressure = points.T
        taut = np.maximum(x - pressure / 2, 0.0)
        slopes = np.column_stack([x + 6 * taut, -3 * taut])
        return x**2 / 2 + 3 * taut**2, slopes


def test_what_goes_slack_is_known_as_far_as_states_allow() -> None:
    """No smooth spline has a kink: an error that serves ends it, and is told."""
    ranges = [(-1.0, 1.0), (0.0, 1.0)]
    with pytest.raises(NotReachedError):
        tabulate(Kinked(), ranges, 1e-4, most=600)
    law = Kinked()
    table = tabulate(law, ranges, 1e-4, most=600, enough=0.05)
    assert 1e-4 < table.errors.max() <= 0.05
    assert law.asked <= 600
    x = np.linspace(-0.95, 0.95, 39)[:, None]
    off = table.gradient(x, 0.4)[:, 0] - Kinked()(np.column_stack([x, 0.4 + 0 * x]))[1][:, 0]
    assert np.abs(off).max() <= 2 * table.errors[0] * 8.0


def test_beyond_the_table_there_is_no_state() -> None:
    table = tabulate(Counted(), RANGES, 1e-2)
    strains = inside(4)
    assert table.outside(strains, 0.05) == ""
    assert table.outside(strains, 0.11).startswith("pressure from 0.11 to 0.11 in a table from 0")
    strains[2, 1] = 0.05
    assert table.outside(strains, 0.05).startswith("strain 2 from")
    linear = Linear(np.eye(2), np.zeros(2))
    both = Zones((linear, table), [0, 0, 1, 1])
    assert both.outside(strains, 0.05).startswith("strain 2")
    named = Zones((linear, table), [0, 0, 1, 1], ("the root's cap", "the chamber"))
    assert named.outside(strains, 0.05).startswith("the chamber: strain 2")
    whole = Zones((linear, named), [1, 1, 1, 1], ("the cap", ""))
    assert whole.outside(strains, 0.05).startswith("the chamber: strain 2")
    with pytest.raises(ValueError, match="2 names expected, not 1"):
        Zones((linear, table), [0, 1], ("the chamber",))
    assert both.outside(inside(4), 0.05) == ""
    rod = rod_of(table)
    path = Path(Level(), Level(pressure=0.11))
    with pytest.raises(NoEquilibriumError, match=r"pressure from|too great|far from"):
        march(rod, np.tile([1.0, 0.0], (6, 1)), path, [0.0, 1.0])


def test_a_law_that_is_not_convex_is_found() -> None:
    def soft(points: Floats) -> tuple[Floats, Floats]:
        stretch, k, pressure = points.T
        moment = k - (k / 0.02) ** 2 * k / 3
        slopes = np.column_stack([stretch - 1, moment - 0.1 * pressure, -0.1 * k])
        value = (stretch - 1) ** 2 / 2 + k**2 / 2 - k**4 / (12 * 0.02**2) - 0.1 * pressure * k
        return value, slopes

    lowest, where = tabulate(soft, RANGES, 1e-3).softest(0.05)
    assert lowest < 0
    assert where[1] == pytest.approx(0.04)
    assert lowest == pytest.approx(-3 * 0.05**2, rel=1e-6)
    assert tabulate(Counted(), RANGES, 1e-3).softest(0.05)[0] > 0


def test_a_table_of_another_number_of_strains() -> None:
    """Curvature and twist: two strains, none of which is a stretch."""

    def law(points: Floats) -> tuple[Floats, Floats]:
        k, tau, pressure = points.T
        slopes = np.column_stack(
            [2 * k + tau**2 - pressure, 4 * tau + 2 * k * tau, 0.5 * pressure - k]
        )
        return k**2 + 2 * tau**2 + k * tau**2 - pressure * k + pressure**2 / 4, slopes

    table = tabulate(law, ((-0.1, 0.1), (-0.2, 0.2), (0.0, 0.1)), 1e-8)
    layout = Layout(np.full(3, 10.0), ("curvature", "twist"))
    rod = Rod(layout, table)
    state = march(rod, layout.at_rest(), Path(Level(), Level(pressure=0.1)), [1.0])[0]
    np.testing.assert_allclose(state.strains, np.tile([0.05, 0.0], (3, 1)), atol=1e-9)


def test_first_and_second_derivatives_at_once_are_those_one_by_one() -> None:
    table, strains, pressure = tabulate(Counted(), RANGES, 1e-2), inside(5), 0.03
    found = table.whole(strains[None], np.array([pressure]))
    value, first, second = (part[0] for part in found)
    np.testing.assert_array_equal(value, table.value(strains, pressure))
    np.testing.assert_array_equal(table.first(strains, pressure), first)
    np.testing.assert_array_equal(first[:, :2], table.gradient(strains, pressure))
    np.testing.assert_array_equal(-first[:, 2], table.chamber(strains, pressure))
    np.testing.assert_array_equal(second[:, :2, :2], table.hessian(strains, pressure))
    np.testing.assert_array_equal(-second[:, 2, :2], table.chamber_gradient(strains, pressure))
    np.testing.assert_array_equal(-second[:, :2, 2], table.chamber_gradient(strains, pressure))
    np.testing.assert_array_equal(-second[:, 2, 2], table.chamber_slope(strains, pressure))

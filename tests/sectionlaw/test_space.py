"""Laws of sections that bend to the side and twist, and stiffnesses about free states."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fiberbend.sectionlaw.made import Made, unpacked
from fiberbend.sectionlaw.states.held import Held
from fiberbend.sectionlaw.stiffness import SPACE, stiffness_at
from fiberbend.sectionlaw.store import Store
from fiberbend.sectionlaw.table import law_of
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from rod.functions import Floats
from tests.sectionlaw.test_table import BENT, TUBE
from tests.trial.cases import Data, checked, shipped, under

ERROR = 1e-2
SHORT: Data = under(BENT, angle="40 deg")
MU = 0.3
BAR: Data = {
    "actuator": {"section": "circle", "radius": "0.5 mm", "length": "100 mm", "wall": "5 mm"},
    "materials": {"wall": {"law": "neo-hooke", "mu": f"{MU} MPa"}},
    "effects": [{"pressure": {"to": "1 kPa"}}],
    "model": "section",
    "mesh": {"section": 2},
}


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    return Store(tmp_path_factory.mktemp("cache") / "tables")


@pytest.fixture(
    scope="module",
    # a law in space is of dozens of states: few curvatures, and that of a tube is long
    params=[SHORT, pytest.param(TUBE, marks=pytest.mark.long)],
    ids=["hemicircle", "tube"],
)
def made(request: pytest.FixtureRequest, store: Store) -> Made:
    return law_of(checked(request.param), SPACE, ERROR, store=store)


def inside(made: Made, count: int) -> tuple[Floats, float]:
    """Strains within the law and a pressure."""
    random = np.random.default_rng(2)
    pressure = 0.6 * float(made.section.table.axes[-1].lines[-1])
    points = np.column_stack([0.2 + 0.6 * random.random((count, 2)), np.full(count, pressure)])
    strains = np.zeros((count, 4))
    strains[:, :2] = made.section.chart.strains(points)
    assert made.side is not None
    for name, limit in zip(made.side.small, made.side.limits, strict=True):
        strains[:, SPACE.index(name)] = 0.7 * limit * (2 * random.random(count) - 1)
    if made.side.alike:
        strains[:, 2] = 0.5 * strains[:, 1]
    return strains, pressure


def test_a_law_in_space_has_exact_derivatives(made: Made) -> None:
    law, (strains, pressure) = made.law, inside(made, 4)
    assert law.strains == SPACE
    assert law.outside(strains, pressure) == ""
    force, stiff = law.gradient(strains, pressure), law.hessian(strains, pressure)
    area = law.chamber_gradient(strains, pressure)
    sizes = np.sqrt(np.abs(np.diagonal(stiff, axis1=1, axis2=2)))
    for number in range(4):
        away = 1e-6 * np.eye(4)[number]
        ahead, behind = strains + away, strains - away
        slope = (law.value(ahead, pressure) - law.value(behind, pressure)) / 2e-6
        assert force[:, number] == pytest.approx(slope, abs=1e-7 * float(sizes.max() ** 2))
        rate = (law.gradient(ahead, pressure) - law.gradient(behind, pressure)) / 2e-6
        assert np.all(np.abs(stiff[:, number] - rate) < 1e-5 * sizes * sizes[:, number, None])
        rate = (law.chamber(ahead, pressure) - law.chamber(behind, pressure)) / 2e-6
        assert area[:, number] == pytest.approx(rate, rel=1e-5, abs=1e-3)
    step = 1e-6
    ahead, behind = (law.value(strains, pressure + sign * step) for sign in (1, -1))
    assert law.chamber(strains, pressure) == pytest.approx((behind - ahead) / (2 * step), rel=1e-6)
    ahead, behind = (law.chamber(strains, pressure + sign * step) for sign in (1, -1))
    rate = (ahead - behind) / (2 * step)
    assert law.chamber_slope(strains, pressure) == pytest.approx(rate, rel=1e-4)


def test_it_is_the_section_that_is_solved(made: Made) -> None:
    """Bent to the side and twisted, away from where its second derivatives were taken."""
    assert made.side is not None
    data = TUBE if made.side.alike else SHORT
    held, (strains, pressure) = Held(checked(data), SPACE), inside(made, 3)
    for row in strains:
        at = np.array([*row, pressure])
        state = held.along(held.rest, at)
        assert state is not None
        told = made.law.gradient(row[None, :], pressure)[0]
        stiff = np.diag(state.second)[:4]
        widths = np.array([0.05, 0.02, 0.02 if made.side.alike else 0.0, 0.0])
        for name, limit in zip(made.side.small, made.side.limits, strict=True):
            widths[SPACE.index(name)] = limit
        assert np.all(np.abs(told - state.slopes[:4]) < 0.03 * stiff * widths)
        assert made.law.chamber(row[None, :], pressure)[0] == pytest.approx(
            -state.slopes[4], rel=5e-3
        )


def test_mirror_images_are_alike(made: Made) -> None:
    law, (strains, pressure) = made.law, inside(made, 4)
    for image in ([1, 1, -1, 1], [1, 1, 1, -1]):
        other = strains * image
        assert law.value(other, pressure) == pytest.approx(law.value(strains, pressure), rel=1e-12)
        turned = law.gradient(other, pressure) * image
        assert turned == pytest.approx(law.gradient(strains, pressure), rel=1e-12, abs=1e-12)


@pytest.mark.long
def test_a_tube_is_alike_in_all_directions(store: Store) -> None:
    law = law_of(checked(TUBE), SPACE, ERROR, store=store).law
    straight = np.array([[1.05, 0.0, 0.0, 0.0]])
    stiff = law.hessian(straight, 0.02)[0]
    assert law.gradient(straight, 0.02)[0, 1:] == pytest.approx(np.zeros(3), abs=1e-12)
    assert stiff[1, 1] == pytest.approx(stiff[2, 2], rel=1e-12)
    for angle in (0.3, 1.2, 2.5):
        bent = np.array([[1.05, 0.004 * math.cos(angle), 0.004 * math.sin(angle), 0.001]])
        _, moment, side, torque = law.gradient(bent, 0.02)[0]
        own = law.gradient(np.array([[1.05, 0.004, 0.0, 0.001]]), 0.02)[0]
        assert np.hypot(moment, side) == pytest.approx(own[1], rel=1e-10)
        assert math.atan2(side, moment) == pytest.approx(angle, rel=1e-10)
        assert torque == pytest.approx(own[3], rel=1e-10)


def test_the_range_ends_where_its_errors_are_known(made: Made) -> None:
    assert made.side is not None
    assert 0 < made.side.error <= 0.02
    strains, pressure = inside(made, 2)
    strains[1, 3] = 1.01 * made.side.limits[-1]
    assert made.law.outside(strains, pressure).startswith("twist ")
    again = unpacked(made.packed())
    assert np.array_equal(
        again.law.gradient(strains, pressure), made.law.gradient(strains, pressure)
    )


def test_stiffnesses_are_rates_of_forces_about_the_free_state() -> None:
    case = checked(BENT)
    rest, found = stiffness_at(case, [0.0, 0.03])
    free = solve(case, Wanted(pressures=(0.03,))).free[0]
    assert found.rest[:2] == pytest.approx([free.stretch, free.angle / case.actuator.length])
    assert found.chamber * case.actuator.length == pytest.approx(free.volume, rel=1e-6)
    assert np.array_equal(found.matrix, found.matrix.T)
    assert rest.rest == pytest.approx([1.0, 0.0, 0.0, 0.0])
    held = Held(case, SPACE)
    at = np.array([*found.rest, 0.03])
    for number, step in enumerate((1e-4, 1e-5, 1e-5, 1e-5)):
        sides = [held.along(held.rest, at + sign * step * np.eye(5)[number]) for sign in (1, -1)]
        ahead, behind = (side.slopes[:4] for side in sides if side is not None)
        rate = (ahead - behind) / (2 * step)
        sizes = np.sqrt(np.diag(found.matrix) * found.matrix[number, number])
        assert np.all(np.abs(found.matrix[number] - rate) < 1e-4 * sizes)


def test_the_other_hand_twists_the_other_way() -> None:
    """A single helix couples stretch and bending with twist: their signs turn with its hand."""
    left: Data = shipped("single_helix", model="section")
    pattern = left["effects"][1]["winding"]["pattern"]
    other = "single-helix-left" if pattern.endswith("right") else "single-helix-right"
    right = {**left, "effects": [*left["effects"]]}
    right["effects"][1] = {"winding": left["effects"][1]["winding"] | {"pattern": other}}
    one, two = (
        stiffness_at(checked(under(data, to="20 kPa")), [0.02])[0] for data in (left, right)
    )
    sign = np.array([1.0, 1.0, -1.0, -1.0])
    assert abs(one.matrix[0, 3]) > 0.05 * math.sqrt(one.matrix[0, 0] * one.matrix[3, 3])
    assert two.matrix == pytest.approx(one.matrix * np.outer(sign, sign), rel=1e-6, abs=1e-3)
    assert two.rest == pytest.approx(one.rest * sign, rel=1e-6, abs=1e-9)


def test_a_bar_of_rubber_has_the_stiffnesses_of_beams() -> None:
    """EA = 3 μ A, EI = 3 μ I and GJ = μ J of a ring."""
    (found,) = stiffness_at(checked(BAR), [0.0])
    outer, inner = 5.5, 0.5
    area, second = math.pi * (outer**2 - inner**2), math.pi / 4 * (outer**4 - inner**4)
    exact = np.diag([3 * MU * area, 3 * MU * second, 3 * MU * second, 2 * MU * second])
    assert found.matrix == pytest.approx(exact, rel=2e-3, abs=1e-6 * exact.max())
    assert found.chamber == pytest.approx(math.pi * inner**2, rel=1e-3)

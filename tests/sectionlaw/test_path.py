"""Laws about free states: derivatives, symmetries, range, fit to a law that is known, file."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from fiberbend.sectionlaw.law import Free
from fiberbend.sectionlaw.made import Checked
from fiberbend.sectionlaw.path.chart import PathChart
from fiberbend.sectionlaw.path.curve import Curve, through
from fiberbend.sectionlaw.path.fit import errors, fitted, unknowns
from fiberbend.sectionlaw.path.law import SPACE, PathLaw
from fiberbend.sectionlaw.path.made import PathMade, States, unpacked
from fiberbend.sectionlaw.path.states import About, graded
from fiberbend.sectionlaw.path.states import spread as spread_out
from fiberbend.sectionlaw.path.terms import Kept, powers_of, terms
from fiberbend.sectionlaw.states.held import HeldState
from rod.functions import Floats
from rod.inertia import SectionMass, spread
from rod.layout import Layout
from rod.rod import Level, Rod

HIGH, PRESSURE = 0.1, 0.037
TURNED = Kept(turn=True)
ROUND = Kept(turn=True, alike=True)


def chart() -> PathChart:
    """Any smooth one."""
    rng = np.random.default_rng(4)
    coefficients = rng.uniform(-0.1, 0.1, (7, 7)) + np.array([1, 0, 0, 0, 0, 0, 0])
    return PathChart(Curve(graded(HIGH, 2), 5, coefficients), (0.02, 0.03, 0.04, -0.05), 0.4)


def law_of(kept: Kept, degree: int = 3) -> PathLaw:
    """Any smooth one of these symmetries; convex."""
    rng, found = np.random.default_rng(5), terms(degree, kept)
    by_term = rng.uniform(-0.1, 0.1, (6, len(found.weights)))
    by_term[:, found.orders > 2] = by_term[0, found.orders > 2]
    coefficients = by_term @ found.weights
    for number in range(4):
        coefficients[:, powers_of(degree).index(tuple(2 * np.eye(4, dtype=int)[number]))] += 1.0
    return PathLaw(chart(), degree, Curve(graded(HIGH, 1), 5, coefficients), kept.alike)


def places(law: PathLaw, count: int, pressure: float = PRESSURE) -> Floats:
    u = np.random.default_rng(count).uniform(-0.5, 0.5, (count, 4))
    return law.chart.strains(np.column_stack([u, np.full(count, pressure)]))


def test_derivatives_are_those_of_differences() -> None:
    law, h = law_of(Kept()), 1e-6
    strains = places(law, 5)
    points = [(strains + h * e[:4], PRESSURE + h * e[4]) for e in np.eye(5)]
    back = [(strains - h * e[:4], PRESSURE - h * e[4]) for e in np.eye(5)]
    sizes = np.append(1 / law.chart.at(PRESSURE), 1 / HIGH)
    for number, (ahead, behind) in enumerate(zip(points, back, strict=True)):
        slope = (law.value(*ahead) - law.value(*behind)) / (2 * h)
        found = law.first(strains, PRESSURE)[:, number]
        np.testing.assert_allclose(found, slope, atol=1e-6 * sizes[number])
        bend = (law.first(*ahead) - law.first(*behind)) / (2 * h)
        found = law.second(strains, PRESSURE)[:, number]
        assert np.all(np.abs(found - bend) < 1e-5 * sizes * sizes[number])


def test_places_and_strains_undo_each_other() -> None:
    law = law_of(Kept())
    strains = places(law, 4)
    u = law.chart.place(strains, PRESSURE)
    again = law.chart.strains(np.column_stack([u, np.full(4, PRESSURE)]))
    np.testing.assert_allclose(again, strains, atol=1e-14)


@pytest.mark.parametrize(
    ("kept", "image"),
    [
        (Kept(across=True), (1, 1, -1, -1)),
        (Kept(along=True), (1, 1, 1, -1)),
        (TURNED, (1, 1, -1, 1)),
        (ROUND, (1, -1, 1, 1)),
    ],
    ids=["mirror x = 0", "mirror z = 0", "half a turn about y", "half a turn about x"],
)
def test_images_have_the_same_energy(kept: Kept, image: tuple[int, ...]) -> None:
    """In u: about free states that are their own images, as those of such a section are."""
    law, u = law_of(kept), np.random.default_rng(1).uniform(-1, 1, (6, 4))
    same = law.by_place(u * np.array(image), PRESSURE)[0]
    np.testing.assert_allclose(same, law.by_place(u, PRESSURE)[0], rtol=1e-12)
    assert not np.allclose(law_of(Kept()).by_place(u * np.array(image), PRESSURE)[0], same)


def test_what_is_round_is_bent_alike_in_all_directions() -> None:
    law, u = law_of(ROUND, 4), np.random.default_rng(2).uniform(-1, 1, (6, 4))
    turned = u.copy()
    turned[:, 1] = np.cos(0.7) * u[:, 1] - np.sin(0.7) * u[:, 2]
    turned[:, 2] = np.sin(0.7) * u[:, 1] + np.cos(0.7) * u[:, 2]
    same = law.by_place(turned, PRESSURE)[0]
    np.testing.assert_allclose(same, law.by_place(u, PRESSURE)[0], rtol=1e-12)


def test_it_says_what_is_outside() -> None:
    law = law_of(ROUND)
    inner = law.chart.strains(np.array([[0.0, 0.7, 0.7, 0.9, PRESSURE]]))
    assert law.outside(inner, PRESSURE) == ""
    corner = law.chart.strains(np.array([[0.0, 0.8, 0.8, 0.9, PRESSURE]]))
    assert "curvature" in law.outside(corner, PRESSURE)
    twisted = law.chart.strains(np.array([[0.0, 0.0, 0.0, 1.1, PRESSURE]]))
    assert law.outside(twisted, PRESSURE).startswith("twist")
    pulled = law.chart.strains(np.array([[1.1, 0.0, 0.0, 0.0, PRESSURE]]))
    assert "stretch by forces" in law.outside(pulled, PRESSURE)
    assert "110 kPa in a law" in law.outside(inner, 0.11)


def about(law: PathLaw, points: Floats) -> list[About]:
    """States that a law has, as a section has them."""
    found = []
    for point in points:
        p = float(point[4])
        strains = law.chart.strains(point[None])
        first, second = law.first(strains, p)[0], law.second(strains, p)[0]
        at, rest = np.append(strains[0], p), HeldState.__dataclass_fields__
        state = HeldState(**dict.fromkeys(rest) | {"at": at})  # type: ignore[arg-type]
        energy = float(law.value(strains, p)[0])
        state = dataclasses.replace(state, energy=energy, slopes=first, second=second)
        found.append(About(point, state, *law.chart.carried(point, first, second)))
    return found


@pytest.mark.parametrize("kept", [TURNED, ROUND], ids=["turned", "round"])
def test_a_fit_finds_the_law_that_is_there(kept: Kept) -> None:
    """From few states: each tells twenty-one numbers."""
    law = law_of(kept)
    points = spread_out(0, 30, kept.alike) * np.array([1, 1, 1, 1, HIGH])
    known = about(law, points)
    assert unknowns(3, 2, kept) < 21 * 24
    found = fitted(law.chart, kept, 3, 2, HIGH, known[:24], np.ones(4), 1.0)
    off = errors(found, known[24:], np.ones(4), 1.0)
    assert off.max() < 1e-9
    poor = fitted(law.chart, kept, 2, 2, HIGH, known[:24], np.ones(4), 1.0)
    assert errors(poor, known[24:], np.ones(4), 1.0).max() > 1e-4


def test_curves_go_through_values_and_slopes() -> None:
    pressures = np.linspace(0, HIGH, 6)
    curve = through(graded(HIGH, 1), 4, pressures, pressures**3, 3 * pressures**2)
    value, slope, bent = curve.at(PRESSURE)
    assert float(value) == pytest.approx(PRESSURE**3, rel=1e-9)
    assert float(slope) == pytest.approx(3 * PRESSURE**2, rel=1e-9)
    assert float(bent) == pytest.approx(6 * PRESSURE, rel=1e-8)


def test_a_file_has_it_whole() -> None:
    law = law_of(TURNED)
    points = np.column_stack([places(law, 5), np.full(5, PRESSURE)])
    made = PathMade(
        law=law,
        checked=Checked(1, 0.1, 0.2, 0.3, 0.4, 0.5, (1.0, 0.1, 0.0, 0.2, 0.05)),
        samples=States(points, np.ones(5), np.ones((5, 5)), np.ones(5)),
        error=1e-3,
        digest="abc",
        title="A tube",
        model="section",
        length=100.0,
        free=((0.05, Free(1.1, 0.2, 0.0, 0.3)),),
        solved=7,
        seconds=1.5,
        remarks=("one",),
    )
    again = unpacked(made.packed())
    strains = places(law, 3)
    np.testing.assert_array_equal(again.law.first(strains, PRESSURE), law.first(strains, PRESSURE))
    assert (again.checked, again.free, again.remarks) == (made.checked, made.free, made.remarks)
    np.testing.assert_array_equal(again.samples.slopes, made.samples.slopes)
    with pytest.raises(ValueError, match="no law"):
        unpacked(made.packed()[:-100])


def test_the_law_of_the_other_hand_is_the_mirror_image() -> None:
    """With the same numbers at mirrored places; a rod of it stands mirrored in x = 0."""
    law, image = law_of(Kept()), np.array([1.0, 1.0, -1.0, -1.0])
    own = law.chart
    turned = own.path.coefficients * np.array([*image, *image[1:]])
    path = dataclasses.replace(own.path, coefficients=turned)
    chart = dataclasses.replace(own, path=path, sizes=tuple(image * own.sizes))
    other = dataclasses.replace(law, chart=chart)
    strains = places(law, 5)
    forces = other.gradient(strains * image, PRESSURE) * image
    np.testing.assert_allclose(forces, law.gradient(strains, PRESSURE), rtol=1e-11)
    shapes = []
    for each, sign in ((law, np.ones(4)), (other, image)):
        layout = Layout(np.full(5, 12.0), SPACE)
        rod = Rod(layout, each, spread(layout, [SectionMass(0.0)]))
        shapes.append(rod.shape(strains * sign))
        assert rod.outside(shapes[-1], Level(PRESSURE)) == ""
    mirrored = shapes[1].places * np.array([-1.0, 1.0, 1.0])
    np.testing.assert_allclose(mirrored, shapes[0].places, atol=1e-12)

"""What the paper leaves open: bounds, misfit, the search, and the record beside the page."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from bench.paper.assumed.flat import FINE, profiles
from bench.paper.assumed.grid import LONG, Grid, Table
from bench.paper.assumed.record import Record
from bench.paper.assumed.solving import CASE, section
from bench.paper.assumed.under import without_under
from bench.paper.assumptions import (
    CHOICES,
    DEFAULT,
    LAYER,
    RANGES,
    Combination,
    Readings,
    changed,
    combined,
    ranges,
)
from bench.paper.combination import (
    FORCE_OFF,
    Predicted,
    Statement,
    alone,
    band,
    best_of,
    every_reading,
    misfit,
    optimise,
    statements,
)
from bench.paper.facts import BASELINE, TABLE_I
from bench.paper.figures import assumed
from bench.paper.runs import Key, Runs
from fiberbend.case import convert
from fiberbend.models.choice import meshed
from fiberbend.reader.reader import read_case
from geometry.mesh.data import Floats

RECORD = Record.load()


def test_every_field_of_a_combination_is_open_once_and_has_bounds() -> None:
    """Nothing is assumed without being on the list."""
    keys = [each.key for each in RANGES] + [choice.key for choice in CHOICES]
    assert sorted(keys) == sorted(field.name for field in dataclasses.fields(Combination))
    for each in RANGES:
        assert each.low < each.high
        assert each.low <= each.default <= each.high
        assert each.reason
        assert each.fields
    for choice in CHOICES:
        assert choice.default is False
        assert set(choice.names) == {False, True}


@pytest.mark.parametrize(
    "given",
    [
        *(
            changed(dataclasses.replace(DEFAULT, layered=each is LAYER), each.key, value)
            for each in RANGES
            for value in each.bounds
        ),
        *(changed(DEFAULT, choice.key, True) for choice in CHOICES),
    ],
    ids=str,
)
def test_a_case_takes_every_bound_and_every_reading(given: Combination) -> None:
    """The case has what the combination says."""
    case = read_case(CASE, given.settings())
    actuator, turns = case.actuator, case.turns
    assert turns is not None
    assert actuator.length == pytest.approx(130 if given.capped else 160)
    if given.layered:
        assert (actuator.floor, actuator.layer) == (2.0, given.layer)
        assert case.materials.layer is not None
        assert case.materials.layer.name == "combined-base"
    else:
        assert (actuator.floor, actuator.layer) == (given.floor, None)
    winding = case.effects[1].model_dump()
    assert winding["pitch"] == f"{given.pitch:g} mm"
    assert winding["fiber"]["radius_factor"] == (1.0 if given.whole else 0.5)


def test_ranges_follow_the_readings_and_make_the_combination() -> None:
    """The thickness is of the floor or of the layer, never of both."""
    for readings in every_reading():
        given = combined(readings, (2.0, 1.75, 9.0))
        assert given.readings == readings
        assert (given.pitch, given.thickness, given.lever) == (2.0, 1.75, 9.0)
        assert ranges(readings)[1].key == given.base
    assert len(set(every_reading())) == 2 ** len(CHOICES)


def test_a_table_is_exact_at_its_nodes_and_for_logarithms_that_are_polynomials() -> None:
    """Quadratic by linear between three nodes and two."""

    def true(x: float, y: float) -> float:
        return math.exp(0.3 * x * x - 0.2 * x * y + y - 1)

    axes = ((1.5, 3.0, 6.0), (2.0, 3.0))
    values = np.array([[true(x, y) for y in axes[1]] for x in axes[0]])
    table = Table(axes, values)
    for x in (1.5, 2.2, 4.5):
        for y in (1.8, 2.0, 2.7):
            assert float(table(x, y)) == pytest.approx(true(x, y), rel=1e-12)
    grown = table(np.linspace(2, 5, 4)[:, None], np.array([2.0, 2.5]))
    assert grown.shape == (4, 2)
    assert grown[1, 1] == pytest.approx(true(3.0, 2.5), rel=1e-12)


def _statement(low: float, high: float, scale: float) -> Statement:
    return Statement("around", "P", lambda p: p.pressures[BASELINE], low, high, scale, "kPa", "")


def test_misfit_is_zero_within_an_interval_and_counts_scales_outside() -> None:
    """Two statements add by their squares."""
    found = Predicted({BASELINE: np.array([190.0, 196.0, 204.0])}, {}, {})
    one, other = _statement(195, 197, 2.0), _statement(190, 200, 1.0)
    assert one.misfit(found) == pytest.approx([2.5, 0.0, 3.5])
    assert misfit(found, [one, other]) == pytest.approx([2.5, 0.0, math.hypot(3.5, 4.0)])


def test_a_band_is_what_one_measured_value_leaves_to_two_models() -> None:
    """Ends are reached, and by nothing beyond them."""
    low, high = band(0.103, 0.043)
    assert low == pytest.approx(0.897 / 1.043)
    assert high == pytest.approx(1.103 / 0.957)
    rng = np.random.default_rng(1)
    first, second = 1 + rng.uniform(-0.103, 0.103, 999), 1 + rng.uniform(-0.043, 0.043, 999)
    assert low <= (first / second).min() < (first / second).max() <= high


def _exactly(of: Callable[[Predicted], Floats], true: Predicted) -> Statement:
    """A number of a combination, to a part in a thousand."""
    at = float(of(true))
    return Statement("around", "a number", of, at, at, 1e-3 * at, "kPa", "")


def _known(grid: Grid, given: Combination) -> list[Statement]:
    """Every pressure of Table I and two forces of a combination."""
    true = alone(grid, given)

    def pressure(key: Key) -> Callable[[Predicted], Floats]:
        return lambda found: found.pressures[key]

    def ratio(radius: float) -> Callable[[Predicted], Floats]:
        return lambda found: found.ratio(radius)

    numbers = [*(pressure(size.key) for size in TABLE_I), ratio(6.0), ratio(8.0)]
    return [_exactly(of, true) for of in numbers]


@pytest.mark.parametrize(
    "true",
    [
        Combination(whole=True, guided=True, pitch=2.2, floor=2.3, lever=13.0),
        Combination(layered=True, guided=True, pitch=4.1, layer=0.8, lever=9.0),
    ],
    ids=["combined", "layered"],
)
def test_the_search_recovers_the_assumptions_of_an_actuator_that_has_known_ones(
    true: Combination,
) -> None:
    """A synthetic paper: readings and numbers are found, and the misfit is zero there."""
    grid = RECORD.grid
    stated = _known(grid, true)
    assert float(misfit(alone(grid, true), stated)) < 1e-9
    found = best_of(grid, true.readings, stated)
    assert found.misfit < 0.05
    assert found.given.pitch == pytest.approx(true.pitch, abs=0.02)
    assert found.given.thickness == pytest.approx(true.thickness, abs=0.01)
    assert found.given.lever == pytest.approx(true.lever, abs=0.02)
    for key in ("layered", "capped"):
        value = getattr(true, key)
        other = best_of(grid, _turned(true.readings, key, not value), stated)
        assert other.misfit > 10


def _turned(readings: Readings, key: str, value: bool) -> Readings:
    return Readings(**(dataclasses.asdict(readings) | {key: value}))


def test_the_record_has_what_the_optimiser_finds_on_its_grid() -> None:
    """Nothing in the file was written by hand."""
    found = optimise(RECORD.grid, statements())
    assert [one.given.readings for one in found[:1]] == [RECORD.best[0].given.readings]
    assert found[0].misfit == pytest.approx(RECORD.best[0].misfit, abs=1e-3)
    # where the misfit is flat, equal values are found at other numbers
    kept = {one.given.readings: one.misfit for one in RECORD.best}
    assert kept == pytest.approx({one.given.readings: one.misfit for one in found}, abs=2e-2)
    weaker = optimise(RECORD.grid, statements(ends=True))[0]
    assert weaker.misfit == pytest.approx(RECORD.ends.misfit, abs=1e-3)
    again = profiles(RECORD.grid, statements())
    for old, new in zip(RECORD.profiles, again, strict=True):
        assert len(new.across) in FINE
        assert new.misfit == pytest.approx(old.misfit, abs=1e-3)


def test_the_page_says_what_the_record_has(tmp_path: object) -> None:
    """Its words, and the number of its rows."""
    found = assumed.found(Runs(folder=CASE.parent))
    best = RECORD.best[0]
    text = " ".join(found.words)
    assert f"misfit is {best.misfit:.2f}" in text
    assert f"misfit is {RECORD.ends.misfit:.2f}" in text
    by_caption = {table.caption.split(",")[0].split(";")[0]: table for table in found.tables}
    assert len(found.tables[0].rows) == len(RANGES) + len(CHOICES)
    stated = found.tables[3]
    assert len(found.tables[2].rows) == len(RANGES) + len(CHOICES)
    assert len(stated.rows) == len(statements()) + 1
    assert stated.rows[-1][-2] == f"{best.misfit:.2f}"
    confirmed = found.tables[-1]
    assert len(confirmed.rows) == len(TABLE_I) + len(RECORD.bodies)
    assert by_caption
    assert [figure.name for figure in found.figures] == ["assumed", "assumed_best"]


def test_the_grid_is_near_sections_that_were_solved_beside_it() -> None:
    """Within what statements allow for, a pressure 1.5 and a force 3 %; by cells and bodies too."""
    assert max(abs(part) for part in RECORD.held_out) < 0.01
    assert max(abs(one.grid / one.cell - 1) for one in RECORD.cells) < 0.01
    assert max(abs(one.grid / one.body - 1) for one in RECORD.bodies) < FORCE_OFF


def test_a_section_solved_now_is_the_one_in_the_record() -> None:
    """At a node of the grid, without the cell's correction."""
    done = section(DEFAULT, 8.0, 2.0, LONG, "smeared")
    for chamber, pressure in zip(LONG, done.pressures, strict=True):
        kept = RECORD.grid.tables[f"combined a=8 t=2 {chamber:g}"]
        assert pressure == pytest.approx(float(kept(3.0, 2.0)), rel=1e-4)
    bare = section(dataclasses.replace(DEFAULT, bare=True), 8.0, 2.0, LONG[:1], "smeared")
    ratio = RECORD.grid.tables["bare combined a=8 t=2 pressure"]
    assert bare.pressures[0] / done.pressures[0] == pytest.approx(float(ratio()), rel=1e-4)


def test_only_the_sheath_below_the_floor_is_left_out() -> None:
    """Its area is its width times its thickness; the other regions keep theirs."""
    case = read_case(CASE)
    mesh, actuator = meshed(case).mesh(case), convert.dimensions(case.actuator)
    left = without_under(mesh, actuator.outline_bottom)
    gone = np.ptp(mesh.nodes[:, 1]) - np.ptp(left.nodes[:, 1])
    assert gone == pytest.approx(1.0)
    for name in ("wall", "floor"):
        count = [(m.cell_region == m.regions[name]).sum() for m in (mesh, left)]
        assert count[0] == count[1]
    assert left.nodes[left.points["pin"]] == pytest.approx(mesh.nodes[mesh.points["pin"]])
    for name, pairs in left.facets.items():
        assert set(map(tuple, np.round(left.nodes[left.facet_nodes(name)].reshape(-1, 2), 9))) <= (
            set(map(tuple, np.round(mesh.nodes[mesh.facet_nodes(name)].reshape(-1, 2), 9)))
        ), name
        assert len(pairs) <= len(mesh.facets[name])

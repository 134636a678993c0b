"""Errors of rungs whose limits are known, the front, and the sentence of advice."""

from __future__ import annotations

import dataclasses
import math
import shlex

import pytest

from fiberbend.ladder.advice import advice, chosen, front, pareto
from fiberbend.ladder.asked import Asked, asked
from fiberbend.ladder.errors import FamilyLimit, family_limit, judge, scales
from fiberbend.ladder.richardson import Limit
from fiberbend.ladder.rungs import Family, Rung
from fiberbend.ladder.table import rung_table
from fiberbend.ladder.words import seconds, settings
from fiberbend.reader.reader import read_case
from tests.conftest import ROOT
from tests.ladder.parts import judged, of_case, record, solved, truth


def test_directions_add_up_and_a_corner_shows_whether_they_do() -> None:
    def value(section: float, axial: float) -> float:
        return 45 + 2 * section**2 + 0.5 * axial

    line = [(1.0, 2.0), (1.0, 1.0), (1.0, 0.5), (0.5, 1.0), (1 / 3, 1.0)]
    points = [({"section": s, "axial": a}, value(s, a)) for s, a in line]
    without = family_limit(points)
    assert without.limit.value == pytest.approx(45)
    assert without.orders == pytest.approx({"section": 2.0, "axial": 1.0})
    corner = ({"section": 0.5, "axial": 0.5}, value(0.5, 0.5))
    same = family_limit([*points, corner])
    assert same.limit.value == pytest.approx(45)
    assert same.limit.uncertainty == pytest.approx(without.limit.uncertainty)
    apart = family_limit([*points, (corner[0], corner[1] + 0.1)])
    assert apart.limit.value == pytest.approx(45.1)
    assert apart.limit.uncertainty == pytest.approx(without.limit.uncertainty + 0.1)


def test_one_mesh_has_no_limit_and_a_closed_form_is_its_own() -> None:
    assert math.isinf(family_limit([({"section": 1.0}, 45.0)]).limit.uncertainty)
    closed = family_limit([({}, 45.0)])
    assert (closed.limit.value, closed.limit.uncertainty) == (45.0, 0.0)


def test_mesh_and_model_apart() -> None:
    judgement = judged()
    assert judgement.reference == Family("body", "turns", "hexahedron")
    reference = judgement.limits[judgement.reference]["pressure_90deg_kPa"].limit
    assert reference.value == pytest.approx(99.0, rel=1e-6)
    for each in judgement.rungs:
        for name, error in each.errors.items():
            value, family = each.record.values[name], each.rung.family
            assert error.total == pytest.approx(100 * (value / 99 - 1), abs=1e-4)
            limit = {"analytic": 130.0, "section": 97.0, "cell": 100.0}.get(family.model)
            if limit is None:
                limit = 100.0 if family.winding == "turns" else 97.0
                limit *= 0.99 if family.model == "body" else 1.0
            assert error.model == pytest.approx(100 * (limit / 99 - 1), abs=0.01), each.rung.name
            assert error.mesh == pytest.approx(100 * (value - limit) / 99, abs=0.01)
            assert error.size == pytest.approx(abs(error.mesh) + abs(error.model))
        assert not each.flaw


def test_values_that_do_not_settle_are_not_exact_at_the_last() -> None:
    """Tetrahedra whose steps turn round: the last value is taken for the limit, not for exact."""

    def wild(rung: Rung, each: Asked) -> float:
        found = truth(rung, each)
        if rung.family.element != "tetrahedron" or rung.family.winding != "turns":
            return found
        sizes = sorted({1.5, 3.0, 6.0})
        return 99.0 * (1.0, 0.97, 1.05)[sizes.index(rung.case.mesh.axial)]

    judgement = judged(wild)
    last = next(
        each
        for each in judgement.rungs
        if each.rung.family.element == "tetrahedron" and each.rung.case.mesh.axial == 1.5
    )
    assert last.worst("mesh") == pytest.approx(0.0, abs=1e-9)
    assert last.worst() == pytest.approx(3.0, rel=1e-3)
    assert last not in pareto(judgement)
    # of the reference's own family it is said apart
    own = [
        each for each in judgement.rungs if each.rung.family.discretisation == judgement.reference
    ]
    assert not any(error.unsure for each in own for error in each.errors.values())


def test_whole_and_half_share_their_limit() -> None:
    halves = {each.rung.name: each for each in judged().rungs}
    pairs = [name for name in halves if "-full-" in name]
    assert pairs
    for name in pairs:
        assert halves[name].errors == halves[name.replace("-full-", "-half-")].errors


def test_two_meshes_take_the_order_of_other_families() -> None:
    """The bodies have two sections only; section and cell show that it is 2."""
    found = judged().limits[Family("body", "turns", "hexahedron")]["pressure_90deg_kPa"]
    assert "other families" in found.limit.remark
    assert found.limit.value == pytest.approx(99.0, rel=1e-6)


def test_without_the_dear_rungs_a_cheaper_family_is_the_reference() -> None:
    few = [(rung, found) for rung, found in solved() if rung.family.model != "body"]
    quantities = asked(of_case().rungs[0].case)
    judgement = judge(quantities, few)
    assert judgement.reference == Family("cell", "turns")
    single = [pair for pair in solved() if pair[0].name.startswith("body-turns-hexahedron-half")]
    judgement = judge(quantities, [*few, single[0]])
    assert judgement.reference == Family("cell", "turns")
    alone = next(each for each in judgement.rungs if each.rung.family.model == "body")
    assert alone.flaw == "mesh error not known"
    assert math.isfinite(alone.worst())
    assert alone not in pareto(judgement)


def test_a_rung_that_misses_a_quantity_is_not_chosen() -> None:
    pairs = solved()
    rung, found = next(pair for pair in pairs if pair[0].family.model == "section")
    values = {name: value for name, value in found.values.items() if "360" not in name}
    pairs[pairs.index((rung, found))] = (rung, record(rung, values))
    judgement = judge(asked(rung.case), pairs)
    flawed = next(each for each in judgement.rungs if each.rung is rung)
    assert flawed.flaw == "not all that is asked for"
    assert flawed not in pareto(judgement)


def test_nothing_to_compare() -> None:
    judgement = judge(asked(of_case().rungs[0].case), [])
    assert judgement.reference is None
    assert advice(judgement).startswith("No advice")


def test_a_part_of_a_ladder_says_what_it_does_not_know() -> None:
    every = of_case().rungs
    quantities = asked(every[0].case)
    few = [pair for pair in solved() if pair[0].family.model == "section"]
    text = advice(judge(quantities, few, every))
    assert text.count("against the limit of section, spread winding: body, every turn") == 1
    whole = judge(quantities, solved(), every)
    assert whole.finest == whole.reference == Family("body", "turns", "hexahedron")
    assert "has none yet" not in advice(whole)


def test_a_closed_form_is_no_reference() -> None:
    alone = [pair for pair in solved() if pair[0].family.model == "analytic"]
    assert judge(asked(of_case().rungs[0].case), alone).reference is None
    body = [pair for pair in solved() if pair[0].family.model == "body"][:1]
    assert judge(asked(of_case().rungs[0].case), [*alone, *body]).reference is None


def test_front() -> None:
    points = [(1.0, 5.0), (2.0, 5.0), (2.0, 1.0), (3.0, 2.0), (9.0, 0.1), (0.5, 30.0)]
    assert front(points) == [5, 0, 2, 4]
    # what cannot be told apart is not worth its time
    assert front(points, least=1.0) == [5, 0, 2]
    assert front([]) == []
    assert front([(1.0, 1.0), (1.0, 1.0)]) == [0]


def test_nothing_beats_the_front() -> None:
    judgement = judged()
    best = pareto(judgement)
    for one in best:
        for other in judgement.rungs:
            quicker = other.record.wall_s < one.record.wall_s
            assert not (quicker and other.worst() < one.worst() - judgement.known_to())


def test_advice_names_rung_time_and_what_to_type() -> None:
    def exact(rung: Rung, each: Asked) -> float:
        """Every mesh is as good as its limit."""
        closed = rung.family.model == "analytic"
        return 130.0 if closed else 100.0 if rung.family.winding == "turns" else 99.5

    text = advice(judged(exact))
    quickest = min(rung.seconds for rung in of_case().rungs if rung.family.model == "section")
    assert 0.5 < quickest < 5
    first = '"section, spread winding, mesh.section 1"'
    second = '"cell, every turn, mesh.section 1, mesh.axial 0.75 mm"'
    cell = next(rung.seconds for rung in of_case().rungs if rung.family.model == "cell")
    assert text == (
        f"For 1 % take {first}, {seconds(quickest)}; for 0.1 % take {second}, {seconds(cell)}."
    )
    # in the words of the table
    rows = rung_table(judged(exact))
    for name in (first, second):
        assert any(f"**{name[1:-1]}**" in row for row in rows)
    *_, choice = chosen(judged(exact))
    typed = shlex.split(settings(choice.rung, ["actuator.wall=3 mm"]))[1::2]
    case = read_case(ROOT / "cases" / "free_bending.yaml", typed)
    assert (case.model, case.actuator.wall) == ("cell", 3.0)
    assert case.mesh.axial == pytest.approx(0.75)


def test_a_rung_that_serves_two_goals_is_named_once() -> None:
    text = advice(judged(lambda rung, each: 100.0))
    assert text.endswith("; for 0.1 % the same.")
    assert len(chosen(judged(lambda rung, each: 100.0))) == 1


def test_advice_says_what_of_a_time_is_spent_once() -> None:
    pairs = [
        (rung, dataclasses.replace(found, once_s=found.wall_s / 2)) for rung, found in solved()
    ]
    text = advice(judge(asked(of_case().rungs[0].case), pairs))
    assert " of them once for all runs" in text


def test_advice_takes_the_quickest_that_is_sure_though_it_lies_in_the_band() -> None:
    judgement = judged()
    known = judgement.known_to()
    goal = 1.02 * (known + min(each.worst() for each in judgement.rungs))
    assert known < goal
    text = advice(judgement, goals=(goal,))
    assert text.startswith("For ")
    assert " take " in text


def test_advice_does_not_promise_what_the_reference_does_not_know() -> None:
    text = advice(judged(truth), goals=(1.0, 1e-3))
    assert "for 0.001 % the reference itself is known to" in text
    assert "only" in text


def test_angles_of_one_state_are_judged_in_parts_of_the_greatest() -> None:
    """It bends by 90° and twists by 1°: half a degree of twist is half a percent, not half of it.

    What is not moved at all is left out.
    """
    rung = next(each for each in of_case().rungs if each.mesh)
    turns = (
        Asked("bend", "", "°", "angle_deg", together="turn", least=1e-3),
        Asked("twist", "", "°", "twist_deg", together="turn", least=1e-3),
        Asked("side", "", "°", "side_angle_deg", together="other", least=1e-3),
    )
    wanted = {"bend": -90.0, "twist": 1.0, "side": 1e-9}
    limits = {name: FamilyLimit(Limit(value, 0.0), {}) for name, value in wanted.items()}
    assert scales(turns, limits) == {"bend": -90.0, "twist": 90.0}
    finest = [each for each in of_case().rungs if each.family == rung.family]
    found = [(each, record(each, wanted)) for each in finest]
    judgement = judge(turns, found)
    assert judgement.reference == rung.family.discretisation
    assert not any(each.flaw for each in judgement.rungs)
    off = record(finest[0], {"bend": -90.0, "twist": 1.45, "side": -1e-9})
    errors = judge(turns, [(finest[0], off), *found[1:]]).rungs[0].errors
    assert errors["twist"].total == pytest.approx(0.5)
    assert errors["bend"].total == 0
    assert "side" not in errors


def test_of_what_does_not_move_there_is_no_reference() -> None:
    still = (Asked("twist", "", "°", "twist_deg", together="turn", least=1e-3),)
    rungs = [each for each in of_case().rungs if each.family.key == "section-spread"]
    judgement = judge(still, [(each, record(each, {"twist": 1e-7})) for each in rungs])
    assert judgement.reference is None
    assert advice(judgement).startswith("No advice")

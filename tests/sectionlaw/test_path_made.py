"""The law of a tube that twists, made by its section: errors, hand, direction, file, refusals."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from fiberbend.schema.problems import CaseError
from fiberbend.sectionlaw.path import words
from fiberbend.sectionlaw.path.law import SPACE
from fiberbend.sectionlaw.path.made import PathMade
from fiberbend.sectionlaw.path.make import kept_of, law_about
from fiberbend.sectionlaw.path.store import PathStore
from fiberbend.sectionlaw.path.terms import Kept
from fiberbend.sectionlaw.states.held import Held
from rod.functions import Floats
from tests.trial.cases import Data, checked, shipped, under

ERROR = 1e-3
TUBE: Data = under(shipped("twisting", model="section"), to="12 kPa")
TUBE["effects"][1]["winding"]["as"] = "smeared"


def right() -> Data:
    """Its mirror image."""
    data = copy.deepcopy(TUBE)
    data["effects"][1]["winding"]["families"][0]["hand"] = "right"
    return data


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> PathStore:
    return PathStore(tmp_path_factory.mktemp("cache") / "tables")


@pytest.fixture(scope="module")
def made(store: PathStore) -> PathMade:
    return law_about(checked(TUBE), ERROR, store)


def places(made: PathMade, pressure: float) -> Floats:
    u = np.random.default_rng(3).uniform(-0.6, 0.6, (4, 4))
    return made.law.chart.strains(np.column_stack([u, np.full(4, pressure)]))


def test_symmetries_are_those_of_the_case() -> None:
    assert kept_of(checked(TUBE)) == Kept(turn=True, alike=True)
    helix = shipped("single_helix")
    assert kept_of(checked(helix)) == Kept(turn=True)
    plain = shipped("section")
    assert kept_of(checked(plain)) == Kept(across=True, along=True, turn=True)


@pytest.mark.long
def test_it_is_the_section_that_is_solved(made: PathMade) -> None:
    """At states that are neither fitted nor compared, bent in any direction."""
    assert max(made.checked.force, made.checked.moment, made.checked.area) < ERROR
    assert made.checked.angle < ERROR
    held, pressure = Held(checked(TUBE), SPACE), 0.007
    state = held.rest
    ranges = 2 * np.abs(made.law.chart.sizes) + np.abs(np.array(made.free[-1][1]) - [1, 0, 0, 0])
    for row in places(made, pressure):
        found = held.along(state, np.append(row, pressure))
        assert found is not None
        state = found
        told = made.law.first(row[None], pressure)[0]
        off = np.abs(told - state.slopes)[:4] / np.diag(state.second)[:4]
        assert np.all(off < ERROR * ranges)
        assert told[4] == pytest.approx(state.slopes[4], rel=ERROR)


@pytest.mark.long
def test_the_other_hand_is_its_mirror_image(made: PathMade, store: PathStore) -> None:
    """To the tolerance of the states: it is made at mirrored ones."""
    other, pressure = law_about(checked(right()), ERROR, store), 0.007
    strains, image = places(made, pressure), np.array([1.0, 1.0, -1.0, -1.0])
    assert other.free[-1][1].twist == pytest.approx(-made.free[-1][1].twist, rel=1e-8)
    turned = other.law.gradient(strains * image, pressure) * image
    own = made.law.gradient(strains, pressure)
    stiff = np.diagonal(made.law.hessian(strains, pressure), axis1=1, axis2=2)
    assert np.all(np.abs(turned - own) < 1e-7 * stiff * np.abs(made.law.chart.sizes))


@pytest.mark.long
def test_it_is_kept_and_told(made: PathMade, store: PathStore) -> None:
    again = law_about(checked(TUBE), ERROR, store)
    assert again.digest == made.digest
    np.testing.assert_array_equal(again.samples.points, made.samples.points)
    out = "\n".join(words.lines(again))
    assert "bent alike in all directions" in out
    assert "twist" in out
    rows = words.text(again).splitlines()
    assert len(rows) == 1 + len(made.samples.values)
    assert rows[0].split(",")[3] == "twist_1_per_m"


def test_it_has_no_load_but_a_pressure() -> None:
    heavy = under(TUBE, {"hold": {"stretch": 1.01}}, to="12 kPa")
    with pytest.raises(CaseError, match="no load but a pressure"):
        law_about(checked(heavy), ERROR)

"""Named materials: each has a source and is stable where it was tested, and fits its tests."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bench.rubbers import SAME, refits
from materials.fit import drucker
from materials.fit.form import form_of
from materials.named.entry import Entry, Fitted, Rubber, Sheet, Source, Thread
from materials.named.table import (
    ENTRIES,
    RUBBERS,
    SHEETS_BY_NAME,
    THREADS_BY_NAME,
    by_name,
    disagreements,
    named_material,
    named_thread,
)
from materials.named.tensile import TENSILE
from tests.materials.rubber import uniaxial_stress

MEASURED: dict[str, tuple[tuple[float, float], ...]] = {
    "body-double-silk": ((1.25, 67.09), (1.5, 137.9), (2, 244.5), (2.7955, 372.7)),
    "dragon-skin-fx-pro": ((1.25, 17), (1.5, 32.44), (2, 62.34), (2.7955, 116.7)),
    "dragon-skin-fx-pro-slacker": ((1.25, 2.24), (1.5, 3.084), (2, 4.964), (2.7954, 7.488)),
    "ecoflex-0010": ((1.25, 4.11), (1.5, 7.91), (2, 14.79), (2.7955, 26.98)),
    "ecoflex-0035-fast": ((1.25, 15.89), (1.5, 29.62), (2, 54.99), (2.7955, 102.6)),
    "mold-star-16-fast": ((1.25, 51.41), (1.5, 94.69), (2, 185.5), (2.7954, 375.5)),
    "mold-star-20t": ((1.25, 67.52), (1.5, 124.5), (2, 239.1), (2.7954, 475)),
    "platsil-gel-10": ((1.25, 33.12), (1.5, 67.43), (2, 147), (2.7955, 281.9)),
    "psycho-paint": ((1.25, 73.04), (1.5, 133.4), (2, 251.3), (2.7955, 484.1)),
    "rebound-25": ((1.25, 60.73), (1.5, 113.8), (2, 231.9), (2.7955, 470.3)),
    "rtv615": ((1.25, 207.6), (1.5, 384.8), (2, 801), (2.7954, 2157)),
    "soloplast-150318": ((1.25, 40.53), (1.5, 75.95), (2, 144), (2.7955, 270.1)),
    "sorta-clear-40": ((1.25, 172.2), (1.5, 307.1), (2, 564.3), (2.7955, 1067)),
    "wagnersil-20-nf": ((1.2524, 69.03), (1.4999, 140.3), (1.9999, 314.4), (2.7979, 686.7)),
}
"""Stretch and nominal stress in kPa of tests that are not part of the program, four of each.

Read off the files of Marechal et al., DOI 10.1089/soro.2019.0115.
"""
SOURCE = Source("somebody", "10.1000/182", "CC BY 4.0")


def test_there_are_fifteen_and_more_of_every_kind_that_has_sources() -> None:
    assert len(ENTRIES) >= 30
    assert len(RUBBERS) >= 15
    assert THREADS_BY_NAME
    assert SHEETS_BY_NAME


@pytest.mark.parametrize("name", ENTRIES)
def test_an_entry_has_a_source_a_licence_and_a_stiffness(name: str) -> None:
    entry = ENTRIES[name]
    assert entry.source.text
    assert entry.source.address
    assert entry.licence
    assert entry.tested
    assert entry.stiffness > 0
    assert (entry.density is None) == (not entry.density_source)


@pytest.mark.parametrize("name", RUBBERS)
def test_a_rubber_is_stable_in_all_states_up_to_its_tests(name: str) -> None:
    entry = RUBBERS[name]
    form = form_of(entry.law)
    values = entry.material.values
    moduli = np.array([values[p.name] for p in form.moduli])
    shape = [values[p.name] for p in form.shape]
    most = 2.0 if entry.stretches is None else entry.stretches[1]
    assert drucker.stability(form, moduli, shape).stretch >= most


def test_what_is_stored_is_what_a_fit_gives() -> None:
    found = {refit.entry.name: refit for refit in refits()}
    assert {"dragon-skin-10", "ecoflex-0050", "natural-rubber-treloar"} <= set(found)
    assert set(found) | set(MEASURED) == {entry.name for entry in TENSILE}
    for refit in found.values():
        fitted = refit.entry.fitted
        assert fitted is not None
        assert refit.apart < SAME
        assert refit.rms == pytest.approx(fitted.rms, rel=0.06)
        most = max(float(test.stretch.max()) for test in refit.fit.tests)
        assert refit.entry.stretches is not None
        assert most <= refit.entry.stretches[1] * 1.001
        assert most > 0.95 * refit.entry.stretches[1]


@pytest.mark.parametrize("name", MEASURED)
def test_a_rubber_is_that_of_its_test(name: str) -> None:
    entry = RUBBERS[name]
    assert entry.fitted is not None
    # as far as it is fitted
    points = [point for point in MEASURED[name] if point[0] <= 1.001 * entry.fitted.upto]
    stretch, stress = np.array(points).T
    assert len(points) >= 3
    found = 1e3 * uniaxial_stress(entry.material, stretch)
    # the last one is near the greatest
    assert np.abs(found - stress).max() < 4 * entry.fitted.rms * stress[-1]


def test_sources_that_disagree_are_both_there_and_say_so() -> None:
    beam, bar = RUBBERS["dragon-skin-10-beam"], RUBBERS["dragon-skin-10"]
    assert beam.stiffness / bar.stiffness == pytest.approx(2.0, abs=0.1)
    assert any("dragon-skin-10-beam is 2 times as stiff" in t for t in disagreements(bar))
    assert any("dragon-skin-10 is 2 times as soft" in t for t in disagreements(beam))
    assert not list(disagreements(RUBBERS["rtv615"]))


def test_the_beams_modulus_is_that_of_its_source() -> None:
    # arXiv 2201.12560: E 263 824 Pa, ν 0.499
    shear = 263824e-6 / (2 * 1.499)
    assert RUBBERS["dragon-skin-10-beam"].coefficients["mu"] == pytest.approx(shear, abs=5e-5)


def test_threads_of_any_diameter() -> None:
    assert named_thread("nylon", 0.3).stiffness == pytest.approx(4560 * np.pi * 0.15**2)
    with pytest.raises(ValueError, match="no diameter of its own"):
        named_thread("nylon")
    with pytest.raises(ValueError, match="another kind than a rubber"):
        named_thread("ecoflex-0030")


def test_a_sheet_is_a_solid_of_its_modulus() -> None:
    assert 3 * named_material("printer-paper").initial_shear_modulus == pytest.approx(5320)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"text": " "}, "without text"),
        ({"licence": ""}, "without licence"),
        ({"address": ""}, "without address"),
        ({"address": "a shelf"}, "expected a DOI or a URL"),
    ],
)
def test_without_a_source_there_is_no_entry(change: dict[str, str], message: str) -> None:
    known = {"text": "somebody", "address": "10.1000/182", "licence": "MIT"}
    with pytest.raises(ValueError, match=message):
        Source(**known | change)


def test_entries_that_nobody_could_use_are_refused() -> None:
    plain = Thread(name="rope", product="rope", source=SOURCE, tested="pulled", modulus=1.0)
    with pytest.raises(ValueError, match="rope is there twice"):
        by_name([plain, plain])
    with pytest.raises(ValueError, match="modulus"):
        Thread(name="rope", product="rope", source=SOURCE, tested="pulled", modulus=-1.0)
    with pytest.raises(ValueError, match="positive number"):
        Sheet(name="a", product="a", source=SOURCE, tested="pulled", sort="paper", modulus=0.0)
    more: dict[str, Any] = {"law": "yeoh", "coefficients": {"c1": 0.1}, "stretches": (1.0, 2.0)}
    for change, message in (
        ({"law": "hooke"}, "law 'hooke'"),
        ({"stretches": (1.5, 2.0)}, "stretches with 1 within"),
        ({"name": "Rope"}, "small letters"),
        ({"name": "rope.yaml"}, "no file's"),
        ({"tested": ""}, "without tested"),
        ({"density": 1000.0}, "a density and its source"),
    ):
        known: dict[str, Any] = {"name": "rope", "product": "rope", "source": SOURCE}
        known["tested"] = "pulled"
        with pytest.raises(ValueError, match=message):
            _ = Rubber(**known | more | change).material


def test_an_entry_says_what_it_is() -> None:
    with pytest.raises(NotImplementedError):
        _ = Entry(name="a", product="a", source=SOURCE, tested="pulled").kind
    fitted = Fitted((("uniaxial", "no such test.csv"),), "yeoh", 2.0, 0.01)
    assert fitted.shipped is None

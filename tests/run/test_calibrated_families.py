"""Families calibrated by their cell: the section gives what the cell gives, also in between."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bench.families import BETWEEN, CALIBRATED, CELL, EXAMPLES, MORE, PAGE, state
from fiberbend import run
from fiberbend.calibration import calibrate as calibrating
from fiberbend.calibration.calibrate import calibrate, known
from fiberbend.calibration.expected import expected
from fiberbend.calibration.store import FOLDER, Store
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError

WITHIN = 0.015
"""Of turns and of the stretch, as asked."""


@pytest.fixture
def store(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Store:
    """A cache of its own."""
    path = tmp_path / FOLDER
    monkeypatch.setattr(calibrating, "Store", lambda: Store(path))
    return Store(path)


@pytest.mark.parametrize(
    "name", ["twist", "braid", pytest.param("unequal", marks=pytest.mark.long)]
)
def test_the_section_gives_what_its_cell_gives(name: str, store: Store) -> None:
    example = EXAMPLES[name]
    section, cell = example.solved(CALIBRATED), example.solved(CELL, layers=2)
    assert section.run["calibration"]["left_percent"] < 100 * WITHIN / 2
    for part in (BETWEEN, 1.0):
        found, beside = state(section, part), state(cell, part)
        for key, value in beside.items():
            assert found[key] == pytest.approx(value, rel=WITHIN, abs=1e-6)
        longer = found["stretch"] - 1
        assert longer == pytest.approx(beside["stretch"] - 1, rel=WITHIN)


def _case(name: str = "braid", mirrored: bool = False, **changes: Any) -> dict[str, Any]:
    return (EXAMPLES | MORE)[name].case(CALIBRATED, mirrored=mirrored) | changes


@pytest.mark.long
def test_mirrored_hands_have_the_same_bed_and_mirrored_answers(store: Store) -> None:
    one, other = (run(_case("twist", mirrored=each)) for each in (False, True))
    numbers = ("normal_MPa", "along_MPa", "across", "pressure")
    for key in numbers:
        # rounded to six digits, of which the last may differ
        assert other.run["calibration"][key] == pytest.approx(one.run["calibration"][key], rel=1e-5)
    assert state(other)["twist"] == pytest.approx(-state(one)["twist"], rel=1e-6)
    assert state(other)["stretch"] == pytest.approx(state(one)["stretch"], rel=1e-8)


def test_numbers_are_kept_and_given(store: Store) -> None:
    case = parse_case(_case())
    assert any("to be calibrated" in line for line in expected(case))
    first, again = calibrate(case), calibrate(case)
    assert (first.kept, again.kept) == (False, True)
    assert again.found == first.found
    assert known(case) is not None
    numbers = first.found.bulging()
    given = _case()
    given["effects"][1]["winding"]["bedding"] = {
        "normal": f"{numbers.normal!r} MPa",  # type: ignore[union-attr]
        "along": f"{numbers.along!r} MPa",  # type: ignore[union-attr]
        "across": numbers.across,  # type: ignore[union-attr]
        "pressure": numbers.pressure,  # type: ignore[union-attr]
    }
    by_cell, by_hand = run(_case()), run(given)
    assert state(by_hand) == pytest.approx(state(by_cell), rel=1e-9)
    # another pressure is another way
    other = _case()
    other["effects"][0]["pressure"]["to"] = "20 kPa"
    other["output"] = {}
    assert known(parse_case(other)) is None


@pytest.mark.parametrize(
    ("more", "text"),
    [
        ({"hold": {"stretch": 1.0}}, "families are calibrated where nothing is held"),
        ({"pressure": {"volume": "9 mL"}}, "on the way to a pressure or an angle"),
    ],
)
def test_what_is_not_calibrated_is_refused(more: dict[str, Any], text: str, store: Store) -> None:
    case = _case()
    case["output"] = {}
    effects = [e for e in case["effects"] if not e.keys() & more.keys()]
    parsed = parse_case(case | {"effects": [*effects, more]})
    assert any(text in line for line in expected(parsed))
    with pytest.raises(CaseError, match=text):
        calibrate(parsed)


def test_families_without_a_period_have_no_cell(store: Store) -> None:
    case = _case()
    families = case["effects"][1]["winding"]["families"]
    families[0]["angle_from_axis"] = "41.3 deg"
    with pytest.raises(CaseError, match="do not repeat together"):
        calibrate(parse_case(case))


def test_the_page_says_what_is_left() -> None:
    text = PAGE.read_text(encoding="utf-8").split("## Sections calibrated")[1]
    for example in (*EXAMPLES.values(), *MORE.values()):
        assert f"### {example.title}: calibrated" in text

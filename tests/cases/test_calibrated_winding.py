"""A winding that is to be calibrated, before anything is solved."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from fiberbend.calibration import reach
from fiberbend.calibration.calibrate import known, waits, with_bulging
from fiberbend.calibration.digest import content, digest
from fiberbend.calibration.record import OfPattern
from fiberbend.calibration.store import FOLDER, Store
from fiberbend.case.case import Case
from fiberbend.case.section_beside import as_section
from fiberbend.effects.pressure import inflate
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from materials.bulging import Bulging
from tests.run.conftest import small

KNOWN: dict[str, Any] = {"as": None, "bulging": {"stiffness": "0.7 MPa/mm", "quadratic": 6.0}}
FOUND = OfPattern(
    stiffness=0.6,
    linear=1.2,
    quadratic=5.0,
    bent_percent=0.1,
    straight_percent=0.8,
    states=7,
    strain=0.5,
    pressure=0.2,
    growth=1.8,
    whole=True,
    seconds=4.0,
)


def wound(model: str = "section", load: dict[str, str] | None = None, /, **winding: Any) -> Case:
    """The small case with settings of its winding, calibrated by default."""
    made = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "calibrated"}
    effects = [{"pressure": load or {"to": "60 kPa"}}, {"winding": made | winding}]
    return parse_case(small(model=model, effects=effects))


def mark(case: Case) -> str:
    """The digest of a case in its first class."""
    return digest(content(case, reach.first(case)))


@pytest.mark.parametrize(
    ("model", "winding", "text"),
    [
        ("section", {"as": "smeared", "bulging": {"stiffness": "0.7 MPa/mm"}}, "on a smeared"),
        ("body", {"as": "discrete", "bulging": {"stiffness": "0.7 MPa/mm"}}, "every turn lies"),
        ("body", {"bulging": {"stiffness": "0.7 MPa/mm"}, "lines": 3}, "no cell solved"),
        ("body", {"bulging": {"stiffness": "0.7 MPa/mm", "linear": -3.0}}, "above zero at every"),
        ("analytic", {}, "no rubber bulges"),
    ],
)
def test_what_has_no_effect_or_no_meaning_is_refused(
    model: str, winding: dict[str, Any], text: str
) -> None:
    with pytest.raises(CaseError, match=text):
        wound(model, **winding)


def test_a_thread_without_curved_parts_is_refused() -> None:
    case = small(model="section")
    size = {"section": "rectangle", "width": "16 mm", "height": "8 mm"}
    rest = {key: value for key, value in case["actuator"].items() if key != "radius"}
    case["actuator"] = rest | size
    case["effects"][1]["winding"]["as"] = "calibrated"
    with pytest.raises(CaseError, match="straight apart from corners"):
        parse_case(case)


def test_numbers_alone_mean_calibrated_and_need_no_cell() -> None:
    case = wound(**KNOWN)
    winding = case.effects[1]
    assert not waits(case)
    assert winding.bulges() == Bulging(0.7, 0.0, 6.0)
    again = parse_case(case.resolved())
    assert again == case
    assert "bulging as the case says (K0 0.7 MPa/mm" in str(make_plan(case))


def test_a_case_with_its_numbers_reads_back() -> None:
    case = with_bulging(wound(), Bulging(0.633786, 1.04035, 5.03827))
    assert parse_case(case.resolved()) == case
    assert case.effects[1].bulges() == Bulging(0.633786, 1.04035, 5.03827)


@pytest.mark.parametrize("model", ["section", "cell", "body"])
def test_the_section_beside_has_the_same_numbers(model: str) -> None:
    case = with_bulging(wound(model), Bulging(0.6))
    beside = as_section(case, inflate(angle=0.1))
    assert beside.effects[1].bulges() == Bulging(0.6)
    turns = case.turns
    assert turns is not None
    assert turns.bulges
    assert not turns.discrete


@pytest.mark.parametrize(
    "change",
    [
        {"actuator": {"length": "48 mm"}},
        {"actuator": {"cap": "9 mm"}},
        {"effects": {"pressure": {"to": "90 kPa"}}},
        {"mesh": {"axial": "6 mm", "section": 3}},
    ],
)
def test_length_caps_loads_and_elements_do_not_enter(change: dict[str, Any]) -> None:
    assert mark(changed(change)) == mark(wound("body"))


@pytest.mark.parametrize(
    "change",
    [
        {"actuator": {"wall": "2.1 mm"}},
        {"actuator": {"sheath": "1.1 mm"}},
        {"effects": {"winding": {"pitch": "3.1 mm"}}},
        {"effects": {"winding": {"width": "0.3 mm"}}},
        {"effects": {"winding": {"tension_only": True}}},
        {"effects": {"winding": {"pattern": "single-helix-left"}}},
        {"materials": {"wall": "ecoflex-0030"}},
    ],
)
def test_section_thread_and_rubber_enter(change: dict[str, Any]) -> None:
    assert mark(changed(change)) != mark(wound("body"))


def changed(change: dict[str, Any]) -> Case:
    """The calibrated small body with values changed, by part or effect."""
    case = small()
    case["effects"][1]["winding"]["as"] = "calibrated"
    for part, values in change.items():
        if part == "effects":
            for entry in case["effects"]:
                for name in entry:
                    entry[name] |= values.get(name, {})
        else:
            case[part] |= values
    return parse_case(case)


def test_a_class_holds_the_angles_of_the_case() -> None:
    length, height = 24.0, 12.0
    for degrees in (10.0, 50.0, 60.0, 100.0):
        case = wound("section", {"angle": f"{degrees} deg"})
        strain = math.radians(degrees) / length * height
        found = reach.first(case)
        assert strain <= 1.02 * found.strain
        assert found.number == 0 or strain > 1.02 * reach.Reach.of(found.number - 1).strain


def test_what_lies_beyond_the_states_is_said() -> None:
    assert reach.short_of(wound("section", {"to": "190 kPa"}), FOUND) == ""
    assert reach.short_of(wound("section", {"to": "250 kPa"}), FOUND) == "beyond 200 kPa"
    assert "bent further" in reach.short_of(wound("section", {"angle": "100 deg"}), FOUND)
    assert "beyond" in reach.short_of(wound("section", {"volume": "9 mL"}), FOUND)


# --- what is kept -----------------------------------------------------------------------------


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / FOLDER)


def keep(store: Store, case: Case) -> Path:
    """Keep the made-up calibration for a case; its file."""
    with store.alone(mark(case)):
        store.keep(mark(case), FOUND, content(case, reach.first(case)))
    assert not store.remarks
    assert store._path is not None
    (file,) = store._path.glob("*.json")
    return file


def test_what_is_kept_is_found_again_and_planned_with(store: Store) -> None:
    case = wound()
    assert known(case, store) is None
    file = keep(store, case)
    found = known(case, store)
    assert found is not None
    assert found.found == FOUND
    assert found.kept
    assert found.left_percent == 0.1
    assert "left 0.10 %" in found.line()
    assert file.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize("damage", ["half", "number", "other", "nan", "list"])
def test_a_damaged_file_is_refused_and_said(store: Store, damage: str) -> None:
    case = wound()
    file = keep(store, case)
    text = file.read_text()
    if damage == "other":
        case = wound(pitch="4 mm")
        file.rename(file.with_name(f"{mark(case)}.json"))
    else:
        file.write_text(
            {
                "half": text[: len(text) // 2],
                "number": text.replace('"stiffness": 0.6', '"stiffness": 0.7'),
                "nan": text.replace('"stiffness": 0.6', '"stiffness": NaN'),
                "list": "[]",
            }[damage]
        )
    assert known(case, store) is None
    assert len(store.remarks) == 1
    assert "is damaged and made anew" in store.remarks[0]


def test_a_folder_that_others_can_write_is_not_used(store: Store) -> None:
    keep(store, wound())
    assert store._path is not None
    store._path.chmod(0o777)
    other = Store(store._path)
    assert other.remarks == [f"{store._path} is not used for calibrations: others can write it"]
    assert known(wound(), other) is None
    other.keep(mark(wound()), FOUND, {})
    assert len(list(store._path.glob("*.json"))) == 1


def test_a_blocked_actuator_is_told_what_is_left_of_its_moment(store: Store) -> None:
    effects = [*small()["effects"], {"straight": {}}]
    effects[1]["winding"]["as"] = "calibrated"
    case = parse_case(small(model="section", effects=effects, output={"fields": False}))
    assert mark(case) != mark(wound())
    keep(store, case)
    found = known(case, store)
    assert found is not None
    assert found.left_percent == 0.8
    assert any("leaves 0.8 %" in line for line in found.remarks)

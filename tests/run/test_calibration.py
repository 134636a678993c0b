"""A winding calibrated by its cell: the section gives what the cell gives, and a run keeps how."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from fiberbend import run
from fiberbend.calibration import calibrate as calibrating
from fiberbend.calibration import cases, fit
from fiberbend.calibration.calibrate import calibrate
from fiberbend.calibration.reach import Reach, height
from fiberbend.calibration.store import FOLDER, Store
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from fiberbend.uniform.small import Small
from tests.conftest import MpiRun
from tests.run.conftest import small, write_case

LONG = {
    "section": "hemicircle",
    "radius": "8 mm",
    "length": "160 mm",
    "wall": "2 mm",
    "floor": "2 mm",
    "sheath": "1 mm",
    "cap": "6 mm",
}
CELL = {90.0: 46.50, 180.0: 92.11, 270.0: 139.04, 360.0: 188.39}
"""P in kPa by angle, of the baseline's cell of two elements through each thickness and twelve along
half a pitch (docs/evidence/calibration.md)."""


def wound(model: str = "section", **changes: Any) -> dict[str, Any]:
    """The small case with a calibrated winding."""
    case = small(model=model, **changes)
    case["effects"][1]["winding"]["as"] = "calibrated"
    return case


@pytest.fixture
def coarse(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Store:
    """A cell of two layers with two states bent and one straight, and a cache of its own."""
    monkeypatch.setattr(cases, "LAYERS", 2)
    monkeypatch.setattr(cases, "PARTS", (0.25, 0.5))
    monkeypatch.setattr(cases, "PRESSED", (0.5,))
    store = tmp_path / FOLDER
    monkeypatch.setattr(calibrating, "Store", lambda: Store(store))
    return Store(store)


def test_the_section_gives_what_its_cell_gives() -> None:
    """On the baseline, whose smeared section is 3 to 4 % below."""
    asked = {"at_angles": [f"{angle} deg" for angle in CELL], "fields": False, "pictures": False}
    case = wound(actuator=LONG, output=asked)
    case["effects"][0] = {"pressure": {"angle": "360 deg"}}
    result = run(case)
    pressure = {round(row["angle_deg"]): row["pressure_kPa"] for row in result.rows}
    for angle, value in CELL.items():
        assert pressure[angle] == pytest.approx(value, rel=3e-3)
    entry = result.run["calibration"]
    assert entry["left_percent"] < 0.1
    assert entry["straight_percent"] < 0.5
    assert 0.5 < entry["stiffness_MPa_per_mm"] < 0.8
    assert entry["states"] == len(cases.PARTS) + len(cases.PRESSED)


def test_least_squares_find_a_known_minimum() -> None:
    target = np.array([0.4, -1.3, 2.0])

    def residual(x: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        lifted = np.array([np.exp(x[0]) - np.exp(target[0]), x[1] * x[2] - target[1] * target[2]])
        return np.r_[lifted, x - target, 0.1 * (x[0] - target[0])]

    def slopes(x: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        columns = [(residual(x + h) - residual(x - h)) / 2e-6 for h in 1e-6 * np.eye(3)]
        return np.array(columns).T

    found = fit.least_squares(residual, np.zeros(3), slopes)
    assert found == pytest.approx(target, abs=1e-6)


def test_a_shared_scene_gives_the_states_of_one_of_its_own() -> None:
    """Kept straight after it was bent, and bent again after that."""
    case, reach = parse_case(wound()), Reach.of(0)
    wound_case = calibrating.with_bulging(case, fit.Bulging(0.8, 0.6, 4.5))
    bent = Small(cases.bent_section(wound_case, reach, (1.0, 2.0)))
    first = bent.march()[0]
    kept_case = cases.straight_section(wound_case, reach, bent.read(first[-1]).pressure)
    shared, alone = Small(kept_case, bent), Small(kept_case)
    pairs = zip(shared.march()[0], alone.march()[0], strict=True)
    moments = [(shared.read(one).moment, alone.read(other).moment) for one, other in pairs]
    assert len(moments) == len(cases.PRESSED)
    for one, other in moments:
        assert one == pytest.approx(other, rel=1e-7)
    again = bent.again(first[0])
    assert again is not None
    assert bent.read(again).pressure == pytest.approx(bent.read(first[0]).pressure, rel=1e-7)


def test_a_step_with_one_tangent_gives_a_neighbour() -> None:
    """As Newton's method finds it, but for the square of what is changed."""
    case, reach = parse_case(wound()), Reach.of(0)
    numbers, other = fit.Bulging(0.8, 0.6, 4.5), fit.Bulging(0.8008, 0.601, 4.51)
    small = Small(cases.bent_section(calibrating.with_bulging(case, numbers), reach, (1.0, 2.0)))
    state = small.march()[0][0]
    (winding,) = (effect for effect in case.effects if effect.winds())
    changed = small.windings(winding.with_bulging(other))
    (near,) = small.near(state, [changed])
    exact = small.again(state)
    assert exact is not None
    moved = small.read(exact).pressure - small.read(state).pressure
    assert small.read(near).pressure - small.read(state).pressure == pytest.approx(moved, rel=1e-2)


@pytest.mark.long
def test_numbers_that_made_a_section_are_found_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """States of a section in place of a cell's: what is left is round-off."""
    case, reach = parse_case(wound()), Reach.of(0)
    numbers = fit.Bulging(0.8, 0.6, 4.5)
    wound_case = calibrating.with_bulging(case, numbers)
    end = reach.strain / height(case) * cases.bent_cell(case, reach).actuator.length
    bent = Small(cases.bent_section(wound_case, reach, tuple(p * end for p in cases.PARTS)))
    readings = tuple(bent.read(state) for state in bent.march()[0])
    kept = Small(cases.straight_section(wound_case, reach, readings[-1].pressure))
    straight = tuple(kept.read(state) for state in kept.march()[0])
    found = fit.fit(case, reach, fit.CellStates(readings, straight, True), 0.0)
    assert found.bent_percent < 1e-3
    assert found.straight_percent < 1e-3
    assert found.stiffness == pytest.approx(0.8, rel=1e-3)
    assert found.linear == pytest.approx(0.6, abs=0.01)
    assert found.quadratic == pytest.approx(4.5, abs=0.02)
    assert found.pressure == pytest.approx(readings[-1].pressure)


@pytest.mark.long
def test_a_second_case_of_the_same_section_takes_what_is_kept(coarse: Store) -> None:
    told: list[str] = []
    first = calibrate(parse_case(wound()), coarse, told.append)
    longer = wound(actuator=LONG)
    second = calibrate(parse_case(longer), coarse, told.append)
    assert (first.kept, second.kept) == (False, True)
    assert second.found == first.found
    assert told == ["winding: its cell is solved to calibrate it"]


@pytest.mark.long
def test_what_is_damaged_is_made_anew(coarse: Store, tmp_path: Path) -> None:
    case = parse_case(wound())
    first = calibrate(case, coarse)
    (file,) = (tmp_path / FOLDER).glob("*.json")
    file.write_text(file.read_text()[:-20])
    again = calibrate(case, Store(tmp_path / FOLDER))
    assert not again.kept
    assert any("damaged" in line for line in again.remarks)
    assert again.found.bulging() == first.found.bulging()
    assert calibrate(case, Store(tmp_path / FOLDER)).kept


@pytest.mark.long
def test_a_load_beyond_the_states_takes_the_next_class(coarse: Store, tmp_path: Path) -> None:
    case = wound()
    near = calibrate(parse_case(case), coarse)
    case["effects"][0] = {"pressure": {"to": f"{1.2e3 * near.found.pressure} kPa"}}
    far = calibrate(parse_case(case), coarse)
    assert far.found.pressure > 1.1 * near.found.pressure
    assert far.digest != near.digest
    assert len(list((tmp_path / FOLDER).glob("*.json"))) == 2


def test_a_section_that_no_pressure_bends_is_refused(coarse: Store) -> None:
    size = {"section": "circle", "radius": "8 mm", "length": "24 mm", "wall": "2 mm"}
    case = wound(actuator=size, materials={"wall": "elastosil-m4601"}, output={"fields": False})
    with pytest.raises(CaseError, match=r"effects\.1\.winding\.as: .*no pressure bends the cell"):
        calibrate(parse_case(case), coarse)


def test_a_run_keeps_its_numbers_and_goes_on_with_them(coarse: Store, tmp_path: Path) -> None:
    case, folder = wound("body", mesh={"axial": "8 mm"}), tmp_path / "run"
    first = run(case, folder)
    kept = yaml.safe_load((folder / "case.resolved.yaml").read_text())
    winding = kept["effects"][1]["winding"]
    entry = json.loads((folder / "run.json").read_text())["calibration"]
    stiffness = f"{entry['stiffness_MPa_per_mm']} MPa/mm"
    assert winding["bulging"]["stiffness"] == stiffness
    assert "width" not in winding
    assert entry["text"] in (folder / "run.log").read_text()
    # the section that guides and checks the body is calibrated too: only the caps are between them
    assert abs(first.run["crosscheck"]["section"]["greatest_percent"]) < 20
    assert first.run["crosscheck"]["section"]["band_percent"] == 2.0
    shutil.rmtree(tmp_path / FOLDER)
    again = run(case, folder, resume=True)
    assert again.rows[-1] == first.rows[-1]
    assert again.run["calibration"]["stiffness_MPa_per_mm"] == entry["stiffness_MPa_per_mm"]
    assert not (tmp_path / FOLDER).exists()


@pytest.mark.long
@pytest.mark.mpi
def test_two_ranks_have_the_numbers_of_one(mpirun: MpiRun, tmp_path: Path) -> None:
    case = wound("body", mesh={"axial": "8 mm"})
    alone = run(case)
    path = write_case(tmp_path, case)
    done = mpirun(2, ["-m", "fiberbend", "run", path, "--out", tmp_path / "run"])
    assert done.returncode == 0, done.stderr
    entry = json.loads((tmp_path / "run" / "run.json").read_text())
    own = alone.run["calibration"]
    assert entry["ranks"] == 2
    for name in ("stiffness_MPa_per_mm", "linear", "quadratic", "digest"):
        assert entry["calibration"][name] == own[name]

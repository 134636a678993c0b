"""docs/evidence/rod.md is of its records, and they are of the scenes that they name."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

from bench.rod import compare, page, record
from bench.rod.record import Record
from bench.rod.scenes import COARSE, MESHES, SCENES, SECTION, Scene
from fiberbend.reader.reader import parse_case


def test_the_page_is_that_of_its_records() -> None:
    assert page.PAGE.read_text(encoding="utf-8") == page.page(), "python -m bench.rod page"


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("model", ["rod", "body", SECTION])
def test_records_are_of_the_scenes(model: str, mesh: str) -> None:
    for scene in SCENES:
        path = record.path_of(scene.name, model, mesh)
        if path.exists():
            case = scene.case(model, mesh)
            assert record.read(path).case == case, f"python -m bench.rod solve {scene.name}"


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_rod_and_body_differ_by_their_model_alone(scene: Scene) -> None:
    rod, body = scene.case("rod"), scene.case("body")
    assert {key for key in body if rod.get(key) != body[key]} == {"model"}
    assert rod.keys() == body.keys()
    parse_case(body)


def made(columns: dict[str, list[float]]) -> Record:
    rows = tuple(zip(*columns.values(), strict=True))
    none: dict[str, Any] = dict.fromkeys(field.name for field in dataclasses.fields(Record))
    return Record(**none | {"columns": tuple(columns), "rows": rows})


def test_histories_are_compared_at_equal_loads() -> None:
    load = [0.0, 0.5, 1.0, 1.0, 1.0, 1.0]
    pressure = [0.0, 0.0, 0.0, 10.0, 30.0, 60.0]
    one = made({"load_gravity": load, "pressure_kPa": pressure, "a": [0, 1, 2, 4, 8, 14.0]})
    fewer = [0, 2, 4, 5]
    other = made(
        {
            "load_gravity": [load[n] for n in fewer],
            "pressure_kPa": [pressure[n] for n in fewer],
            "a": [0.0, 2.0, 8.0, 15.0],
        }
    )
    found = compare.difference(one, other, "a")
    assert found is not None
    # each load is a straight line by itself, to the error of the last state
    assert (found.scale, found.last) == (14.0, 1.0)
    assert found.greatest == 1.0
    assert compare.difference(one, other, "b") is None


def test_a_shorter_history_is_compared_as_far_as_it_goes() -> None:
    one = made({"pressure_kPa": [0.0, 10.0, 20.0], "a": [0.0, 1.0, 2.0]})
    short = made({"pressure_kPa": [0.0, 10.0], "a": [0.0, 1.5]})
    found = compare.difference(one, short, "a")
    assert found is not None
    assert (found.greatest, found.last) == (0.5, 0.5)


def test_touch_is_where_the_gap_before_it_closes() -> None:
    pressure = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0]
    gap = [math.nan, 9.0, 6.0, 3.0, -1e-3, -2e-3]
    force = [0.0, 0.0, 0.0, 0.0, 0.1, 0.2]
    columns = {"pressure_kPa": pressure, "contact_bar_gap_mm": gap, "contact_bar_y_N": force}
    touched = made(columns | {"contact_bar_z_N": [0.0] * 6})
    assert compare.touch(touched, "bar") == pytest.approx(40.0)
    assert math.isnan(compare.touch(touched, "other"))
    twice = made(columns | {"contact_bar_z_N": [2 * each for each in force]})
    found = compare.forces(touched, twice, "bar")
    assert found is not None
    assert found.share == pytest.approx(np.sqrt(5) - 1)


def test_a_record_is_read_as_it_is_kept(tmp_path: Any) -> None:
    path = record.path_of("free", "body", COARSE)
    known = record.read(path)
    record.keep(known, tmp_path / "again.json")
    assert record.read(tmp_path / "again.json") == known
    assert known.column("angle_deg")[-1] == pytest.approx(90.91, abs=0.01)

"""A sweep from Python: its table and its points."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import fiberbend
from fiberbend import CaseError, Result, Sweep
from tests.api.test_result import QUIET, section

FILE: dict[str, Any] = {
    "case": section(**QUIET),
    "vary": {"actuator.wall": ["2 mm", "3 mm"]},
    "report": {"angles": ["90 deg"]},
}


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    return fiberbend.sweep(FILE, tmp_path_factory.mktemp("sweep") / "points")


def test_table_and_points(done: Sweep, capsys: pytest.CaptureFixture[str]) -> None:
    assert len(done) == len(done.points) == 2
    assert repr(done).startswith("<Sweep of 2 points: 2 converged, in ")
    assert done.frame["wall_mm"].tolist() == [2.0, 3.0]
    assert done.frame["tip_force_N"].isna().all()
    assert {*done.frame} - {*done.frame.select_dtypes("number")} == {"point", "status", "solved_by"}
    thin, thick = done.frame["pressure_90deg_kPa"]
    assert 0 < thin < thick
    run = done.point(wall_mm=3)
    assert isinstance(run, Result)
    assert run.case.actuator.wall == 3
    assert run.last("pressure_kPa") == pytest.approx(thick)
    assert [result.status for result in done.points.values()] == ["converged"] * 2
    for values, message in (({"walls": 3.0}, "no column"), ({"wall_mm": 5.0}, "0 points of 2")):
        with pytest.raises(CaseError, match=message):
            done.point(**values)
    with pytest.raises(KeyError, match="expected one of"):
        done.points["colour"]


def test_folder_gives_the_same_and_is_gone_on_with(done: Sweep) -> None:
    loaded = fiberbend.load(done.folder)
    assert isinstance(loaded, Sweep)
    assert loaded.rows == done.rows
    before = (next(iter(done.points.values())).folder or Path()) / "run.json"
    stamp = before.stat().st_mtime_ns
    fiberbend.sweep(FILE, done.folder)
    assert before.stat().st_mtime_ns == stamp


def test_problems_of_a_mapping_have_no_lines(tmp_path: Path) -> None:
    wrong = FILE | {"vary": {"actuator.walls": ["2 mm"]}}
    with pytest.raises(CaseError, match=r"actuator\.walls") as error:
        fiberbend.sweep(wrong, tmp_path / "points")
    assert "(line " not in str(error.value)
    for file, message in ((3, "a mapping or the path"), (tmp_path / "no.yaml", "no such file")):
        with pytest.raises(CaseError, match=message):
            fiberbend.sweep(file, tmp_path / "points")  # type: ignore[arg-type]
    with pytest.raises(CaseError, match="jobs: 0, expected a whole number"):
        fiberbend.sweep(FILE, tmp_path / "points", jobs=0)


def test_a_sweep_that_has_no_table_yet(tmp_path: Path) -> None:
    (tmp_path / "points").mkdir()
    loaded = fiberbend.load(tmp_path)
    assert isinstance(loaded, Sweep)
    assert repr(loaded).startswith("<Sweep without a table, 0 points begun")
    with pytest.raises(CaseError, match="start it again"):
        _ = loaded.rows

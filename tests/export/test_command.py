"""`fiberbend export`: from a run to files, and what is refused in one line."""

from __future__ import annotations

import hashlib
import json
import shutil
from importlib.resources import files
from pathlib import Path

import jsonschema  # type: ignore[import-untyped]
import numpy as np
import pytest

import fiberbend
from fiberbend.cli import main
from fiberbend.commands.export import _case as exported_case
from fiberbend.export.ends import KEYS
from fiberbend.export.hand import law_case, outline
from fiberbend.export.law import known
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError
from fiberbend.slender.moments import section_of
from tests.conftest import ROOT
from tests.export import rods
from tests.trial.cases import Data, shipped, under

DATA: Data = under(shipped("section"), to="60 kPa")


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "bent"
    fiberbend.run(DATA, folder)
    return folder


@pytest.fixture(scope="module")
def exported(run: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("out") / "rod"
    options = ["--to", "mujoco", "--density", "floor=1.3 g/cm^3", "--out", str(out)]
    assert main(["export", str(run), *options]) == 0
    return out


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """What a call says that ends with code 1 and one line."""
    assert main(["export", *arguments]) == 1
    said = capsys.readouterr()
    assert said.out == ""
    assert len(said.err.splitlines()) == 1, said.err
    return said.err


def test_the_file_is_the_section_of_the_run(exported: Path, run: Path) -> None:
    record = json.loads((exported / "rod.json").read_text(encoding="utf-8"))
    schema = (files("fiberbend.export") / "rod.schema.json").read_text(encoding="utf-8")
    jsonschema.validate(record, json.loads(schema))
    section, rows = record["section"], fiberbend.load(run).rows
    pressures = np.array(section["pressure_kPa"])
    assert pressures[[0, -1]] == pytest.approx([0.0, 60.0])
    angles = np.degrees(np.array(section["rest_curvature_1_per_mm"]) * 160.0)
    for row in rows[1:]:
        pressure, angle = row["pressure_kPa"], row["angle_deg"]
        assert isinstance(pressure, float)
        told = np.interp(pressure, pressures, angles)
        assert told == pytest.approx(angle, rel=2e-3, abs=0.05)
    for matrix in section["stiffness_N_mm"]:
        assert np.array(matrix) == pytest.approx(np.array(matrix).T, rel=1e-6, abs=1e-3)
        assert np.linalg.eigvalsh(matrix).min() > 0
    case = record["provenance"]["case"]
    content = json.dumps(case, sort_keys=True).encode()
    assert hashlib.sha256(content).hexdigest() == record["provenance"]["case_sha256"]
    assert parse_case(case).actuator.length == 160.0
    straightened = record["validity"]["straightened"]
    assert straightened["by_stiffness_N_mm"] == pytest.approx(straightened["moment_N_mm"], rel=0.2)


def test_a_run_that_ended_early_hands_over_what_it_has_reached(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert exported_case(run)[1] is None
    early = tmp_path / "early"
    shutil.copytree(run, early)
    about = json.loads((early / "run.json").read_text(encoding="utf-8"))
    about |= {"status": "failed", "reason": "stopped by a test"}
    (early / "run.json").write_text(json.dumps(about), encoding="utf-8")
    lines = (early / "history.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    (early / "history.csv").write_text("".join(lines[:-1]), encoding="utf-8")
    rows = fiberbend.load(early).rows
    reached = exported_case(early)[1]
    assert reached == pytest.approx(1e-3 * float(rows[-1]["pressure_kPa"] or 0.0))
    assert reached is not None
    assert 0 < reached < 0.06
    law = known(law_case(parse_case(DATA))[0], 3, reached)
    assert law.section.pressures[-1] == reached
    (early / "history.csv").write_text("".join(lines[:2]), encoding="utf-8")
    said = refused(capsys, str(early), "--to", "json", "--out", str(tmp_path / "rod"))
    assert "the run is failed and has reached no pressure" in said


def test_the_least_stiffness_is_the_slope_of_free_bending_under_a_moment(exported: Path) -> None:
    """Of the table's own numbers: a section that is straightened takes about EI k."""
    axis = json.loads((exported / "rod.json").read_text(encoding="utf-8"))["axis"]
    bending = np.array(axis["bending_stiffness_N_mm2"])
    assert bending[:, 0, 0].min() > 3000
    assert bending[:, 1, 1].min() > 3 * bending[:, 0, 0].max()
    assert axis["coupling_of_bending"] < 1e-6
    assert -6 < axis["y_mm"] < -3


@pytest.mark.skipif(not rods.PYTHON.exists(), reason="`make robots` makes MuJoCo's environment")
def test_mujoco_bends_it_as_the_run_did(exported: Path, run: Path) -> None:
    found = rods.run(exported, "rod_mujoco.py", "--pressure", "60")
    record = json.loads((exported / "rod.json").read_text(encoding="utf-8"))
    turns = sum(record["ends"][key]["turn_rad"][-1] for key in KEYS)
    angle = float(fiberbend.load(run).rows[-1]["angle_deg"] or 0.0)
    assert found["tip_angle_deg"] == pytest.approx(angle + np.degrees(turns), rel=2e-3)


def test_a_part_without_density_is_named(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "rod")
    said = refused(capsys, str(run), "--to", "pyelastica", "--out", out)
    assert "--density floor=" in said
    assert not Path(out).exists()
    assert main(["export", str(run), "--to", "json", "--out", out]) == 0
    record = json.loads((Path(out) / "rod.json").read_text(encoding="utf-8"))
    assert record["mass"]["known"] is False
    assert "no mass" in capsys.readouterr().out
    assert "--overwrite" in refused(capsys, str(run), "--to", "json", "--out", out)
    assert main(["export", str(run), "--to", "json", "--out", out, "--overwrite"]) == 0


def test_wrong_input_is_one_line(
    run: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = ("--out", str(tmp_path / "rod"))
    said = refused(capsys, str(run), "--to", "mujocco", *out)
    assert "expected one of pyelastica, mujoco, sofa, json" in said
    assert "no such folder" in refused(capsys, str(tmp_path / "none"), "--to", "json", *out)
    (tmp_path / "empty").mkdir()
    assert "contains nothing" in refused(capsys, str(tmp_path / "empty"), "--to", "json", *out)
    said = refused(capsys, str(run), "--to", "json", "--density", "cap=1 g/cm^3", *out)
    assert "one of wall, floor, sheath" in said
    said = refused(capsys, str(run), "--to", "json", "--density", "floor=heavy", *out)
    assert "--density" in said
    said = refused(capsys, str(run), "--to", "json", "--density", "wall=1 g/cm^3", *out)
    assert "knows the density of wall" in said
    (tmp_path / "file").write_text("", encoding="utf-8")
    said = refused(capsys, str(run), "--to", "json", "--out", str(tmp_path / "file" / "rod"))
    assert "is a file, expected a folder" in said


def test_cases_without_a_law_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(ROOT / "cases" / "thumb.yaml", tmp_path)
    out = ("--out", str(tmp_path / "rod"))
    assert "zones" in refused(capsys, str(tmp_path / "thumb.yaml"), "--to", "json", *out)


def test_what_acts_beside_the_pressure_is_left_out_and_told() -> None:
    alone, left_out = law_case(parse_case(shipped("grasp")))
    assert [effect.name for effect in alone.effects] == ["pressure", "winding"]
    assert left_out == ["contact"]
    assert alone.model == "section"
    assert law_case(parse_case(shipped("swing")))[1] == ["gravity", "time"]
    alone, left_out = law_case(parse_case(shipped("cell")))
    assert (alone.model, left_out) == ("cell", [])
    effects = [{"gravity": {"direction": "-y"}}]
    wound = [effect for effect in shipped("free_bending")["effects"] if "winding" in effect]
    materials = {"floor": {"name": "combined-base", "density": "1.3 g/cm^3"}}
    data = shipped("free_bending")
    data["materials"] |= materials
    data.pop("output", None)
    with pytest.raises(CaseError, match="expected effect pressure"):
        law_case(parse_case(data | {"effects": [*wound, *effects], "model": "body"}))


def test_the_outline_is_about_the_centroid() -> None:
    case = parse_case(DATA)
    line = outline(case, section_of(case))
    x, y = line.T
    assert x.min() == pytest.approx(-x.max())
    # radius, wall and sheath
    assert x.max() == pytest.approx(11.0)
    assert np.ptp(y) == pytest.approx(8 + 2 + 2 + 2 * 1)
    turned = x * np.roll(y, -1) - np.roll(x, -1) * y
    assert turned.sum() > 0

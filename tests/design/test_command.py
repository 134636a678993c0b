"""`fiberbend design` from a file to its folder, with section, cell and body."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest
import yaml

import fiberbend
from fiberbend.cli import main
from fiberbend.design.solving.models import UnsolvedError
from fiberbend.results.folder import DESIGN
from fiberbend.schema.problems import CaseError, Problem
from tests.design.made_up import ROOT

DESIGNS = ROOT / "cases" / "designs"
_LONG = {"mesh.axial": "8 mm"}


def changed(folder: Path, name: str, **parts: Any) -> str:
    """A design that is shipped with other parts, its base case where it was."""
    data = yaml.safe_load((DESIGNS / f"{name}.yaml").read_text(encoding="utf-8"))
    data["case"] = str((DESIGNS / data["case"]).resolve())
    path = folder / f"{name}.yaml"
    path.write_text(yaml.safe_dump({**data, **parts}), encoding="utf-8")
    return str(path)


def made(folder: Path) -> dict[str, Any]:
    """Content of design.json, by the words of its quantities."""
    found: dict[str, Any] = json.loads((folder / DESIGN).read_text(encoding="utf-8"))
    found["by"] = {each["words"]: each for each in found["quantities"]}
    return found


@pytest.mark.long
def test_ninety_degrees_with_the_least_work(tmp_path: Path) -> None:
    out = tmp_path / "out"
    file = changed(tmp_path, "bend_at_pressure")
    set_ = [word for path, value in _LONG.items() for word in ("--set", f"{path}={value}")]
    assert main(["design", file, "--out", str(out), "--quiet", *set_]) == 0
    found = made(out)
    assert found["status"] == "met"
    angle = found["by"]["angle at 60 kPa"]
    assert angle["model"] == "body"
    assert angle["value"] == pytest.approx(90, rel=0.02)
    assert found["by"]["greatest strain at 60 kPa"]["model"] == "cell"
    # smaller chambers and thinner walls take less work
    assert {"actuator.radius", "actuator.wall"} <= {each["name"] for each in found["limits"]}
    case = fiberbend.validate(out / "winner.yaml")
    assert case.model == "body"
    run = fiberbend.run(case, states=False)
    assert run.rows[-1]["angle_deg"] == pytest.approx(angle["value"], rel=1e-4)
    assert "winner.yaml" in (out / "report.html").read_text(encoding="utf-8")
    assert (out / "design_angle.png").exists()


@pytest.mark.long
def test_three_newtons_in_an_envelope(tmp_path: Path) -> None:
    out = tmp_path / "out"
    file = changed(tmp_path, "blocked_force")
    set_ = [word for path, value in _LONG.items() for word in ("--set", f"{path}={value}")]
    assert main(["design", file, "--out", str(out), "--quiet", *set_]) == 0
    found = made(out)
    assert found["status"] == "met"
    force = found["by"]["blocked force at 100 kPa"]
    assert force["by_model"]["body"] == pytest.approx(3, rel=0.02)
    assert force["by_model"]["section"] > 1.4 * force["by_model"]["body"]
    assert found["by"]["outer width"]["value"] <= 20
    case = fiberbend.validate(out / "winner.yaml")
    assert case.straight


@pytest.mark.long
def test_what_cannot_be_met_names_its_limit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    file = changed(tmp_path, "impossible", confirm="cell")
    assert main(["design", file, "--out", str(out)]) == 0
    found = made(out)
    assert found["status"] == "not met"
    printed = capsys.readouterr()
    assert "wall is at its lower limit 1 mm" in printed.err
    assert "135." in printed.out
    assert not (out / "winner.yaml").exists()
    assert fiberbend.validate(out / "nearest.yaml").actuator.wall == 1.0
    # the width is kept
    assert found["by"]["outer width"]["value"] <= 20.01


@pytest.mark.long
def test_tables_and_the_trade_off(tmp_path: Path) -> None:
    out = tmp_path / "out"
    parts = {"search": {"starts": 3, "descents": 1, "front": 4}, "confirm": "none"}
    file = changed(tmp_path, "trade_off", **parts)
    assert main(["design", file, "--out", str(out), "--quiet"]) == 0
    with (out / "front.csv").open(encoding="utf-8", newline="") as text:
        front = list(csv.DictReader(text))
    assert len(front) >= 3
    assert sum(row["knee"] == "yes" for row in front) == 1
    with (out / "tries.csv").open(encoding="utf-8", newline="") as text:
        tries = list(csv.DictReader(text))
    assert {row["materials.wall"] for row in tries} == {"elastosil-m4601", "dragon-skin-30"}
    with (out / "sensitivity.csv").open(encoding="utf-8", newline="") as text:
        rows = {row["field"]: row for row in csv.DictReader(text)}
    assert rows["actuator.wall"]["varied"] == "yes"
    assert rows["actuator.floor"]["by"] == "0.1 mm"
    assert rows["materials.wall.c1"]["by"] == "1 %"
    assert rows["materials.wall.c1"]["value"].endswith(" MPa")
    assert (out / "design_front.png").exists()
    # another design in its place is asked for
    assert main(["design", file, "--out", str(out), "--quiet"]) == 1
    assert main(["design", file, "--out", str(tmp_path), "--overwrite"]) == 1


def test_a_case_without_a_cell_is_told_by_its_section(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    near = [{"angle": {"at": "20 kPa", "is": "30 deg"}}]
    parts = {"targets": near, "confirm": "cell", "search": {"starts": 2, "descents": 1}}
    file = changed(tmp_path, "impossible", **parts)

    def none(*_: object) -> None:
        raise CaseError([Problem("model", "no cell")])

    monkeypatch.setattr("fiberbend.design.solving.models.Cell.states", none)
    assert main(["design", file, "--out", str(out), "--quiet"]) == 0
    found = made(out)
    assert found["status"] == "met"
    assert found["sentence"] == "All targets are met; the section alone has said so."
    assert found["checks"][0]["reason"] == "model: no cell"

    def fails(*_: object) -> None:
        raise UnsolvedError("it ends before")

    monkeypatch.setattr("fiberbend.design.solving.models.Cell.states", fails)
    assert main(["design", file, "--out", str(out), "--quiet", "--overwrite"]) == 2
    assert made(out)["status"] == "not confirmed"
    assert made(out)["reason"] == "cell: it ends before"


def test_ctrl_c_leaves_what_was_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "out"
    file = changed(tmp_path, "impossible", search={"starts": 2, "descents": 1})

    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("fiberbend.design.search.confirm.Confirmer.confirm", stopped)
    assert main(["design", file, "--out", str(out), "--quiet"]) == 130
    found = made(out)
    assert found["status"] == "interrupted"
    assert found["fields"]
    assert (out / "nearest.yaml").exists()
    assert (out / "tries.csv").exists()


@pytest.mark.long
def test_a_trade_off_tells_all_that_its_confirmation_took(tmp_path: Path) -> None:
    out = tmp_path / "out"
    parts = {"search": {"starts": 2, "descents": 1, "front": 3}, "confirm": "cell"}
    varied = {"actuator.wall": {"from": "1 mm", "to": "3 mm"}}
    file = changed(tmp_path, "trade_off", **parts, vary=varied)
    assert main(["design", file, "--out", str(out), "--quiet"]) == 0
    found = made(out)
    spent = sum(check["cpu_s"] for check in found["checks"])
    # before the front with corrections, and after it
    assert len(found["checks"]) >= 2
    assert found["cpu_s"]["confirmation"] == pytest.approx(spent, abs=0.01)

"""The command `fiberbend hand`: what it prints and leaves."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.cli import main
from fiberbend.hand import solved
from rod.statics import NoEquilibriumError
from tests.hand.hands import known_at_once, written


def test_a_folder_with_everything(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    known_at_once(monkeypatch)
    file, out = written(tmp_path, output={"steps": 2}), tmp_path / "out"
    assert main(["hand", str(file), "--out", str(out), "--quiet"]) == 0
    printed = capsys.readouterr().out
    assert "3 fingers as rods" in printed
    assert "sphere    touched from" in printed
    with (out / "history.csv").open(encoding="utf-8") as history:
        rows = list(csv.DictReader(history))
    # at rest, with the weight, and two steps
    assert [row["pressure_kPa"] for row in rows] == ["0", "0", "30", "60"]
    run = json.loads((out / "run.json").read_text(encoding="utf-8"))
    assert (run["status"], run["model"]) == ("converged", "rod")
    assert [touch["what"] for touch in run["touches"]] == 3 * ["sphere"]
    again = yaml.safe_load((out / "hand.resolved.yaml").read_text(encoding="utf-8"))
    assert [finger["case"]["model"] for finger in again["fingers"]] == 3 * ["rod"]
    names = {path.name for path in (out / "pictures").iterdir()}
    assert names == {"hand_views.png", "hand_states.png", "hand_curves.png", "animation.gif"}
    assert main(["hand", str(file), "--out", str(out)]) == 1
    assert "--overwrite" in capsys.readouterr().err


def test_what_is_not_found_ends_with_two(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    known_at_once(monkeypatch)
    walk = solved.steps

    def breaks_off(*given: Any) -> Iterator[Any]:
        yield next(walk(*given))
        raise NoEquilibriumError("the tangent is singular")

    monkeypatch.setattr(solved, "steps", breaks_off)
    output = {"steps": 20, "pictures": False, "animation": False}
    file, out = written(tmp_path, gravity=None, output=output), tmp_path / "out"
    assert main(["hand", str(file), "--out", str(out), "--quiet"]) == 2
    assert "failed: the tangent is singular" in capsys.readouterr().err
    assert json.loads((out / "run.json").read_text(encoding="utf-8"))["status"] == "failed"
    assert len((out / "history.csv").read_text(encoding="utf-8").splitlines()) == 3

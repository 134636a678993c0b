"""Run folders and progress."""

from __future__ import annotations

import io
import json
import re
from pathlib import Path
from typing import IO

import numpy as np
import pytest

from fiberbend.reader.reader import read_case
from fiberbend.running.folder import (
    HISTORY_COLUMNS,
    RUN_KEYS,
    RunFolder,
    read_history,
)
from fiberbend.running.progress import Progress
from fiberbend.schema.problems import CaseError

CASE = read_case(Path(__file__).resolve().parents[2] / "cases" / "free_bending.yaml")


@pytest.fixture
def folder(tmp_path: Path) -> RunFolder:
    return RunFolder.create(tmp_path / "deep" / "run", CASE)


def test_new_folder_has_the_case(folder: RunFolder) -> None:
    assert [path.name for path in folder.path.iterdir()] == ["case.resolved.yaml"]
    assert [path.name for path in folder.path.parent.iterdir()] == ["run"]


def test_history(folder: RunFolder) -> None:
    rows: list[dict[str, float | None]] = [{"step": 1, "pressure_kPa": 2.5, "energy wall mJ": 1.0}]
    folder.write_history(rows)
    rows.append({"step": 2, "angle_deg": None, "fiber_max_N": 3.0, "roof_force_N": 4.0})
    folder.write_history(rows)
    lines = (folder.path / "history.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == ",".join([*HISTORY_COLUMNS, "energy wall mJ", "roof_force_N"])
    assert lines[2] == "2,,,,,,,,,,3.0,,4.0"
    read = read_history(folder.path / "history.csv")
    assert (read[0]["pressure_kPa"], read[1]["pressure_kPa"]) == (2.5, None)


def test_run_json_always_has_its_keys(folder: RunFolder) -> None:
    folder.write_run(status="converged", wall_s={"solve": np.float64(1.5)}, mesh={"cells": 3})
    data = json.loads((folder.path / "run.json").read_text(encoding="utf-8"))
    assert list(data)[: len(RUN_KEYS)] == list(RUN_KEYS)
    assert (data["status"], data["wall_s"], data["reason"]) == ("converged", {"solve": 1.5}, None)


def test_a_write_that_breaks_leaves_the_old_file(folder: RunFolder) -> None:
    def broken(file: IO[bytes]) -> None:
        file.write(b"half a fi")
        raise OSError("disk full")

    folder.write_text("curve.txt", "whole")
    with pytest.raises(OSError, match="disk full"):
        folder.write("curve.txt", broken)
    assert (folder.path / "curve.txt").read_text(encoding="utf-8") == "whole"
    assert sorted(path.name for path in folder.path.iterdir()) == [
        "case.resolved.yaml",
        "curve.txt",
    ]


def test_arrays_and_subfolders(folder: RunFolder) -> None:
    folder.write_arrays("checkpoint/state.npz", u=np.arange(3.0))
    with np.load(folder.path / "checkpoint" / "state.npz") as data:
        assert data["u"].tolist() == [0.0, 1.0, 2.0]


def test_other_ranks_write_nothing(tmp_path: Path) -> None:
    RunFolder(tmp_path, writes=False).write_text("a", "b")
    assert list(tmp_path.iterdir()) == []


def test_overwrite_spares_what_is_no_run(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("years", encoding="utf-8")
    with pytest.raises(CaseError, match="contains no run"):
        RunFolder.create(tmp_path, CASE, overwrite=True)
    with pytest.raises(CaseError, match="is a file"):
        RunFolder.create(tmp_path / "thesis.tex", CASE, overwrite=True)
    with pytest.raises(CaseError, match="expected a folder"):
        RunFolder.create(tmp_path / "thesis.tex" / "run", CASE)
    assert (tmp_path / "thesis.tex").read_text(encoding="utf-8") == "years"


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def _report(stream: io.StringIO, quiet: bool = False) -> Progress:
    times = iter(range(1000))
    progress = Progress(quiet, stream, clock=lambda: 10.0 * next(times))
    progress.phase("mesh")
    progress.phase("solve")
    progress.step(1, 0.25, 50.0, 12.5, 4)
    progress.message("step 2 cut back")
    progress.step(2, 1.0, 200.0, 374.0, 5)
    progress.close()
    return progress


def test_plain_lines() -> None:
    stream = io.StringIO()
    progress = _report(stream)
    lines = stream.getvalue().splitlines()
    assert lines[:2] == ["mesh …", "solve …"]
    assert "P    50.00 kPa  θ   12.50°   4 iterations   25.0 %" in lines[2]
    assert lines[2].endswith("0:40 elapsed, about 0:30 to go")
    assert lines[3] == "step 2 cut back"
    assert "θ  374.00°" in lines[4]
    assert list(progress.wall_s) == ["mesh", "solve"]
    assert progress.wall_s["mesh"] == 10.0


def plain(stream: io.StringIO) -> str:
    """What a terminal shows, without colours."""
    return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", stream.getvalue())


def test_a_bar_on_a_terminal() -> None:
    stream = _Terminal()
    _report(stream)
    assert "\x1b[" in stream.getvalue()
    assert "374.0°" in stream.getvalue()
    # the whole run's time, of the clock of the test, and of what is left once a speed is known
    assert "12.5°  4 iter. 0:00:30 elapsed, --:-- to go" in plain(stream)
    assert "374.0°  5 iter. 0:00:30 elapsed, 00:00 to go" in plain(stream)
    assert "step 2 cut back" in stream.getvalue()


def test_quiet_and_other_ranks(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    assert _report(stream, quiet=True).wall_s["mesh"] == 10.0
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    _report(stream)
    assert stream.getvalue() == ""

"""Run folders and progress."""

from __future__ import annotations

import io
import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import IO

import numpy as np
import pytest

from fiberbend.process import remains
from fiberbend.process.lock import LOCK_FILE
from fiberbend.reader.reader import read_case
from fiberbend.results.folder import (
    CASE_FILE,
    FILES,
    HISTORY_COLUMNS,
    RUN_KEYS,
    RunFolder,
)
from fiberbend.results.reading import read_history
from fiberbend.running.progress import Progress
from fiberbend.schema.problems import CaseError

CASE = read_case(Path(__file__).resolve().parents[2] / "cases" / "free_bending.yaml")


@pytest.fixture
def folder(tmp_path: Path) -> RunFolder:
    return RunFolder.create(tmp_path / "deep" / "run", CASE)


def test_new_folder_has_the_case(folder: RunFolder) -> None:
    folder.close()
    assert [path.name for path in folder.path.iterdir()] == ["case.resolved.yaml"]
    assert [path.name for path in folder.path.parent.iterdir()] == ["run"]


def test_history(folder: RunFolder) -> None:
    rows: list[dict[str, float | None]] = [{"step": 1, "pressure_kPa": 2.5, "energy_wall_mJ": 1.0}]
    folder.write_history(rows)
    rows.append({"step": 2, "angle_deg": None, "fiber_max_N": 3.0, "roof_force_N": 4.0})
    folder.write_history(rows)
    lines = (folder.path / "history.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == ",".join([*HISTORY_COLUMNS, "energy_wall_mJ", "roof_force_N"])
    assert lines[2] == "2,,,,,,,,,,3,,4"
    read = read_history(folder.path / "history.csv")
    assert (read[0]["pressure_kPa"], read[1]["pressure_kPa"]) == (2.5, None)


def test_history_has_ten_digits_and_whole_numbers(folder: RunFolder) -> None:
    folder.write_history([{"step": 3, "pressure_kPa": 100 / 3, "newton_iterations": 7}])
    row = (folder.path / "history.csv").read_text(encoding="utf-8").splitlines()[1]
    assert row.startswith("3,33.33333333,,")
    (read,) = read_history(folder.path / "history.csv")
    assert (read["step"], read["newton_iterations"]) == (3, 7)
    assert isinstance(read["step"], int)
    assert isinstance(read["newton_iterations"], int)


def test_history_of_an_older_version(tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    old = "step,pressure_kPa,energy Winding mJ,load pressure,load gravity\n1,20.0,1.5,0.02,1.0\n"
    path.write_text(old, encoding="utf-8")
    assert read_history(path) == [
        {"step": 1, "pressure_kPa": 20.0, "energy_winding_mJ": 1.5, "load_gravity": 1.0}
    ]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("step,colour\n0,1\n", "column 'colour' is not in the table"),
        ("step,angle_deg\n0,0\n1,ninety\n", "line 3: angle_deg is 'ninety', expected a number"),
        ("step,angle_deg\n0,0\n1\n", "line 3: not as many cells as the 2 columns"),
        ("step,angle_deg\n0,0,1\n", "line 2: not as many cells as the 2 columns"),
    ],
)
def test_history_that_cannot_be_read_is_refused(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "history.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as error:
        read_history(path)
    assert message in str(error.value)


def test_run_json_always_has_its_keys(folder: RunFolder) -> None:
    folder.write_run(status="converged", wall_s={"solve": np.float64(1.5)}, mesh={"cells": 3})
    data = json.loads((folder.path / "run.json").read_text(encoding="utf-8"))
    assert list(data)[: len(RUN_KEYS)] == list(RUN_KEYS)
    assert (data["status"], data["wall_s"], data["reason"]) == ("converged", {"solve": 1.5}, None)


def test_a_write_that_breaks_leaves_the_old_file(folder: RunFolder) -> None:
    def broken(file: IO[bytes]) -> None:
        file.write(b"half a fi")
        raise OSError("disk full")

    folder.write_text("trends.md", "whole")
    with pytest.raises(OSError, match="disk full"):
        folder.write("trends.md", broken)
    assert (folder.path / "trends.md").read_text(encoding="utf-8") == "whole"
    assert sorted(path.name for path in folder.path.iterdir()) == [
        LOCK_FILE,
        "case.resolved.yaml",
        "trends.md",
    ]


def test_arrays_and_subfolders(folder: RunFolder) -> None:
    folder.write_arrays("snapshots/008deg.npz", u=np.arange(3.0))
    with np.load(folder.path / "snapshots" / "008deg.npz") as data:
        assert data["u"].tolist() == [0.0, 1.0, 2.0]


def test_other_ranks_write_nothing(tmp_path: Path) -> None:
    RunFolder(tmp_path, writes=False).write_text("run.json", "b")
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


OLD = {"history.csv": "old", "snapshots/008deg.npz": "old", "pictures/bent_last.png": "old"}
MINE = {"notes.txt": "mine", "pictures/mine.png": "mine", ".lock.bak": "mine"}


def _earlier(path: Path) -> Path:
    """The folder of an earlier run, with files that no run wrote."""
    RunFolder.create(path, CASE).close()
    for name, text in {**OLD, **MINE}.items():
        (path / name).parent.mkdir(exist_ok=True)
        (path / name).write_text(text, encoding="utf-8")
    return path


def _files(path: Path) -> list[str]:
    return sorted(str(file.relative_to(path)) for file in path.rglob("*") if file.is_file())


@pytest.mark.parametrize("how", ["path", "link", ".", ".."])
def test_overwrite_removes_what_a_run_wrote_and_nothing_else(
    how: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = _earlier(tmp_path / "run")
    inode = path.stat().st_ino
    (tmp_path / "link").symlink_to(path)
    monkeypatch.chdir({".": path, "..": path / "pictures"}.get(how, tmp_path))
    given = Path({"path": "run"}.get(how, how))
    RunFolder.create(given, CASE, overwrite=True).close()
    assert _files(path) == sorted([CASE_FILE, *MINE])
    assert all((path / name).read_text(encoding="utf-8") == "mine" for name in MINE)
    # it may be a mount point: no other folder takes its place
    assert path.stat().st_ino == inode
    assert (tmp_path / "link").is_symlink()


def test_an_overwrite_that_fails_puts_all_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = _earlier(tmp_path / "run")
    before = _files(path)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", full)
        with pytest.raises(CaseError, match="No space left on device, expected a folder"):
            RunFolder.create(path, CASE, overwrite=True)
    assert _files(path) == before


class _Kill(BaseException):
    """Stands for the end of a process: nothing is put in order."""


@pytest.mark.parametrize("after", [0, 1, 3, 4])
def test_an_overwrite_that_is_killed_is_finished_or_undone(
    after: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of the old run or nothing of it, at whichever file the kill comes."""
    path, replace = _earlier(tmp_path / "run"), os.replace
    before = _files(path)
    moved: list[Path] = []

    def dying(source: Path, target: Path) -> None:
        if len(moved) == after:
            raise _Kill
        moved.append(source)
        replace(source, target)

    with monkeypatch.context() as patch:
        patch.setattr("os.replace", dying)
        # what would be put back is not: the process is dead
        with pytest.raises(_Kill):
            RunFolder.create(path, CASE, overwrite=True)
    if after < 4:  # four files are moved, the case last
        remains.clear(path, CASE_FILE, FILES)
        assert _files(path) == before
    # whatever is left, the next run may have it
    RunFolder.create(path, CASE, overwrite=True).close()
    assert _files(path) == sorted([CASE_FILE, *MINE])


def test_a_start_clears_what_kills_have_left(tmp_path: Path) -> None:
    path = _earlier(tmp_path / "run")
    part = remains.begin(path / "snapshots" / "last.npz")[1]
    (path / LOCK_FILE).write_text("1\nelsewhere\n", encoding="utf-8")
    assert Path(part).exists()
    RunFolder.resume(path, CASE).close()
    assert _files(path) == sorted([CASE_FILE, *OLD, *MINE])


@pytest.mark.parametrize("left", [[], [LOCK_FILE], [".case.resolved.yaml.abcd1234.part"]])
def test_killed_at_once_it_begins_anew(left: list[str], tmp_path: Path) -> None:
    """Whichever of the three ways is taken."""
    starts: list[Callable[[Path], RunFolder]] = [
        lambda path: RunFolder.create(path, CASE),
        lambda path: RunFolder.resume(path, CASE),
        lambda path: RunFolder.create(path, CASE, overwrite=True),
    ]
    for number, start in enumerate(starts):
        path = tmp_path / str(number)
        path.mkdir()
        for name in left:
            (path / name).touch()
        start(path).close()
        assert _files(path) == [CASE_FILE]


def test_one_run_at_a_time(tmp_path: Path) -> None:
    first = RunFolder.create(tmp_path / "run", CASE)
    who = r"run: in use by process \d+ on \S+, expected its end, or another folder by --out$"
    with pytest.raises(CaseError, match=who):
        RunFolder.create(tmp_path / "run", CASE, overwrite=True)
    with pytest.raises(CaseError, match=who):
        RunFolder.resume(tmp_path / "run", CASE)
    with pytest.raises(CaseError, match="in use by process"):
        RunFolder.create(tmp_path / "run", CASE)
    first.close()
    RunFolder.resume(tmp_path / "run", CASE).close()


def test_a_file_that_is_not_listed_cannot_be_written(folder: RunFolder) -> None:
    """Else `overwrite` would leave it there."""
    with pytest.raises(ValueError, match=r"pictures/new\.png is no file of a run"):
        folder.write_text("pictures/new.png", "")


class _Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def _report(stream: io.StringIO, quiet: bool = False, verbose: bool = False) -> Progress:
    times = iter(range(1000))
    progress = Progress(quiet, stream, clock=lambda: 10.0 * next(times), verbose=verbose)
    progress.phase("mesh")
    progress.phase("solve")
    progress.step(1, 0.25, 50.0, 12.5, 4)
    progress.message("the body buckles")
    progress.detail("step 2 cut back")
    progress.step(2, 1.0, 200.0, 374.0, 5)
    progress.close()
    return progress


def test_plain_lines() -> None:
    stream = io.StringIO()
    progress = _report(stream, verbose=True)
    lines = stream.getvalue().splitlines()
    assert lines[:2] == ["mesh …", "solve …"]
    assert "P    50.00 kPa  θ   12.50°   4 iterations   25.0 %" in lines[2]
    assert lines[2].endswith("0:40 elapsed, about 0:30 to go")
    assert lines[3:5] == ["the body buckles", "step 2 cut back"]
    assert "θ  374.00°" in lines[5]
    assert list(progress.wall_s) == ["mesh", "solve"]
    assert progress.wall_s["mesh"] == 10.0


def test_phases_and_cutbacks_are_for_who_asks() -> None:
    stream = io.StringIO()
    _report(stream)
    lines = stream.getvalue().splitlines()
    assert [line[:8] for line in lines] == ["step   1", "the body", "step   2"]


@pytest.mark.parametrize("quiet", [True, False])
def test_the_log_has_everything(quiet: bool) -> None:
    written: list[str] = []
    stream, times = io.StringIO(), iter(range(1000))
    progress = Progress(quiet, stream, clock=lambda: 10.0 * next(times))

    def run() -> None:
        with progress.logged(written.append, ["fiberbend run it"]):
            progress.phase("solve")
            progress.step(1, 0.25, 50.0, 12.5, 4)
            progress.message("the body buckles")
            progress.detail("step 2 cut back")
            raise ZeroDivisionError("nothing left to divide\nreally")

    with pytest.raises(ZeroDivisionError):
        run()
    progress.message("after it")
    assert bool(stream.getvalue()) != quiet
    assert all(text.endswith("\n") and text.count("\n") == 1 for text in written)
    texts = [text[13:].rstrip() for text in written]
    assert re.match(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d", texts[0])
    assert texts[1:3] == ["fiberbend run it", "solve …"]
    assert texts[3].startswith("step   1  P    50.00 kPa  θ   12.50°   4 iterations   25.0 %")
    assert texts[4:] == [
        "the body buckles",
        "step 2 cut back",
        "ended by ZeroDivisionError: nothing left to divide",
    ]
    seconds = [float(text[:9]) for text in written]
    assert seconds == sorted(seconds)
    assert len(set(seconds)) == len(seconds)


@pytest.mark.parametrize("stream", [io.StringIO(), _Terminal()])
def test_nothing_has_no_sign(stream: io.StringIO) -> None:
    progress = Progress(stream=stream)
    progress.step(1, 1.0, -1e-9, -1e-7, 1)
    progress.close()
    assert "-0.0" not in plain(stream)
    assert "0.0" in plain(stream)


def test_one_iteration_is_no_plural() -> None:
    stream = io.StringIO()
    Progress(stream=stream).step(1, 1.0, 5.0, 0.0, 1)
    assert " 1 iteration   100.0 %" in stream.getvalue()


def plain(stream: io.StringIO) -> str:
    """What a terminal shows, without colours."""
    return re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", stream.getvalue())


def test_a_bar_on_a_terminal() -> None:
    stream = _Terminal()
    _report(stream)
    assert "\x1b[" in stream.getvalue()
    assert "374.0°" in stream.getvalue()
    # the whole run's time, of the clock of the test, and of what is left once a speed is known
    assert "12.5°  4 iter. 0:00:20 elapsed, --:-- to go" in plain(stream)
    assert "374.0°  5 iter. 0:00:20 elapsed, 00:00 to go" in plain(stream)
    # before the first step the phase
    assert "solve … 0:00:20 elapsed" in plain(stream)
    assert "the body buckles" in plain(stream)
    assert "step 2 cut back" not in plain(stream)


def test_quiet_and_other_ranks(monkeypatch: pytest.MonkeyPatch) -> None:
    stream = io.StringIO()
    assert _report(stream, quiet=True).wall_s["mesh"] == 10.0
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    _report(stream)
    assert stream.getvalue() == ""

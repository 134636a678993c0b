"""Killed and gone on with: the same steps to the last bit, wherever the kill came."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from fem.march.records import MODES
from fem.results.checkpoint import Archive
from fem.solver.factor import Factor
from fem.solver.newton import Outcome
from fiberbend.models.choice import meshed
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import as_case
from fiberbend.results.folder import (
    CHECKPOINT,
    CHECKPOINT_BEFORE,
    MESH,
    RUN_FILE,
    RunFolder,
)
from fiberbend.results.reading import read_history
from fiberbend.running import messages
from fiberbend.running.assembly import assemble
from fiberbend.running.history import Recorder
from fiberbend.running.hooks import Recording
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from fiberbend.schema.problems import CaseError
from tests.run import test_contact
from tests.run.conftest import small

QUIET = {"at_angles": ["8 deg"], "stop_at_angle": "16 deg", "fields": False, "pictures": False}


class _KillError(Exception):
    """Stands for the end of the process."""


class _Killed(Progress):
    """Ends a run when it reports a step, of which the checkpoint is not written yet, or a phase."""

    def __init__(self, step: int = 0, phase: str = "") -> None:
        super().__init__(quiet=True)
        self._step, self._at = step, phase

    def step(self, step: int, *rest: Any) -> None:
        """End it."""
        if step == self._step:
            raise _KillError

    def phase(self, name: str) -> None:
        """End it."""
        super().phase(name)
        if name == self._at:
            raise _KillError


class _Heard(Progress):
    """Keeps the lines for the user."""

    def __init__(self) -> None:
        super().__init__(quiet=True)
        self.lines: list[str] = []

    def message(self, text: str) -> None:
        """Keep it."""
        self.lines.append(text)


def _cut(case: dict[str, Any], out: Path, step: int = 0, phase: str = "") -> Path:
    """The folder of a run that was killed."""
    with pytest.raises(_KillError):
        run_case(as_case(case), out, progress=_Killed(step, phase))
    return out


def _on(case: dict[str, Any], out: Path) -> tuple[RunResult, list[str]]:
    heard = _Heard()
    return run_case(as_case(case), out, resume=True, progress=heard), heard.lines


CASE = small(solver={"max_step": "20 kPa"}, output=QUIET)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> RunResult:
    """The run that nobody has killed; some steps to 16°."""
    result = run_case(as_case(CASE), tmp_path_factory.mktemp("whole") / "run")
    assert (result.status, result.run["load_steps"] >= 3) == ("converged", True)
    return result


@pytest.fixture(scope="module")
def cut(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Killed in its third step."""
    return _cut(CASE, tmp_path_factory.mktemp("cut") / "run", step=3)


def _copy(cut: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(cut, tmp_path / "run"))


def assert_bitwise(again: RunResult, whole: RunResult) -> None:
    """Iterations, increments and all that is read off the states."""
    assert again.rows == whole.rows
    for key in ("status", "load_steps", "newton_iterations", "factorisations", "cutbacks"):
        assert again.run[key] == whole.run[key], key


def test_the_same_to_the_last_bit(whole: RunResult, cut: Path, tmp_path: Path) -> None:
    again, lines = _on(CASE, _copy(cut, tmp_path))
    assert "resumed after step 2" in lines
    assert_bitwise(again, whole)


def test_what_was_warned_of_is_warned_of_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run that has gone over to MUMPS does not again where it goes on: the warning stays."""
    begin = Factor.__init__

    def left(self: Factor, *given: Any, **named: Any) -> None:
        begin(self, *given, **named)
        self.left = "a residual of 1e-9 of its terms"

    with monkeypatch.context() as patch:
        patch.setattr(Factor, "__init__", left)
        out = _cut(CASE, tmp_path / "run", step=3)
    again, lines = _on(CASE, out)
    text = messages.left_to_mumps("a residual of 1e-9 of its terms")
    assert lines.count(text) == 1
    assert again.run["warnings"].count(text) == 1


@pytest.mark.hard
def test_a_way_to_an_obstacle_is_remembered(tmp_path: Path) -> None:
    """The increment that an approach has shortened comes back once it touches."""
    case = test_contact._case(test_contact.GAPS)
    whole = run_case(as_case(case), tmp_path / "whole")
    _cut(case, tmp_path / "cut", step=2)
    again, _ = _on(case, tmp_path / "cut")
    assert_bitwise(again, whole)


@pytest.mark.parametrize("damage", ["cut off", "changed"])
def test_a_damaged_checkpoint_gives_way_to_the_one_before(
    damage: str, whole: RunResult, cut: Path, tmp_path: Path
) -> None:
    out = _copy(cut, tmp_path)
    content = (out / CHECKPOINT).read_bytes()
    middle = len(content) // 2
    changed = {
        "cut off": content[:middle],
        "changed": content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :],
    }[damage]
    (out / CHECKPOINT).write_bytes(changed)
    again, lines = _on(CASE, out)
    assert f"{out / CHECKPOINT} is damaged: goes on from the one before" in lines
    assert "resumed after step 1" in lines
    assert again.rows == whole.rows


def test_with_nothing_whole_it_begins_anew(whole: RunResult, cut: Path, tmp_path: Path) -> None:
    out = _copy(cut, tmp_path)
    for name in (CHECKPOINT, CHECKPOINT_BEFORE, MESH):
        (out / name).write_bytes((out / name).read_bytes()[:1000])
    again, lines = _on(CASE, out)
    assert f"{out / CHECKPOINT_BEFORE} is damaged: goes on from the beginning" in lines
    assert again.rows == whole.rows


def test_rows_of_an_older_version_are_refused(cut: Path, tmp_path: Path) -> None:
    """Their columns had other names: work could not be added up across them."""
    out = _copy(cut, tmp_path)
    with np.load(out / CHECKPOINT) as file:
        arrays = dict(file)
    rows = json.loads(str(arrays["rows"]))
    arrays["rows"] = np.array(json.dumps([row | {"load pressure": 0.01} for row in rows]))
    np.savez(out / CHECKPOINT, **arrays)
    with pytest.raises(CaseError, match="of another version of fiberbend, cannot be resumed"):
        _on(CASE, out)


def test_killed_while_meshing(whole: RunResult, tmp_path: Path) -> None:
    again, _ = _on(CASE, _cut(CASE, tmp_path / "run", phase="mesh"))
    assert again.rows == whole.rows


def test_a_run_that_had_ended_goes_to_output(whole: RunResult, tmp_path: Path) -> None:
    """Not past the angle at which it stops, and nothing is solved again."""
    out = _cut(CASE, tmp_path / "run", phase="output")
    assert json.loads((out / RUN_FILE).read_text())["status"] == "running"
    again, _ = _on(CASE, out)
    assert_bitwise(again, whole)
    assert json.loads((out / RUN_FILE).read_text())["status"] == "converged"
    assert read_history(out / "history.csv")[-1]["angle_deg"] == pytest.approx(16.0)


@pytest.mark.parametrize("entering", [True, False])
def test_no_checkpoint_is_left_while_a_branch_is_entered(
    entering: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Near the crossing a load does not tell the branches apart: none goes on from there."""
    saved: list[int] = []
    monkeypatch.setattr(Recording, "_save", lambda _self, _folder, _march, step: saved.append(step))
    case = as_case(CASE)
    assembly = assemble(case, meshed(case).mesh(case), MPI.COMM_SELF)
    march, gauge = assembly.march, assembly.observables.gauge()
    recorder = Recorder(assembly.scene, gauge, meshed(case), march.rest)
    archive = Archive(assembly.scene, assembly.observables.frames)
    quiet = Progress(quiet=True)
    folder = RunFolder(tmp_path)
    recording = Recording(case, assembly, archive, recorder, folder, quiet, meshed(case))
    march.position.entering = entering
    state = dataclasses.replace(march.rest, measures={**march.rest.measures, MODES: 0})
    recording.after_step(march, state, Outcome(True, 1, 1, "", [], 1.0))
    assert saved == ([] if entering else [1])

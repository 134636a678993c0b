"""A task in a second process: the same result, its errors, and its end with the first one."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from fiberbend.cli import main
from fiberbend.process import beside
from fiberbend.process.beside import Beside

CASE = Path(__file__).resolve().parents[2] / "cases" / "section.yaml"
SHORT = ("effects.0={pressure: {to: 60 kPa}}", "output.at_angles=[90 deg]", "output.fields=false")
SETTINGS = [f"--set={setting}" for setting in (*SHORT, "output.stop_at_angle=90 deg")]


@pytest.fixture
def _enabled(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1})
    beside.enable()
    yield
    beside.dismiss()
    beside.enable(False)


def pid_and(value: int) -> tuple[int, int]:
    return os.getpid(), value


def loaded(module: str) -> tuple[int, bool]:
    return os.getpid(), module in sys.modules


def fails() -> None:
    raise OSError(28, "No space left on device")


def dies_elsewhere(home: int) -> int:
    if os.getpid() != home:
        os.kill(os.getpid(), signal.SIGKILL)
    return os.getpid()


def sleeps(file: str) -> None:
    Path(file).write_text(str(os.getpid()))
    time.sleep(60)


def test_a_task_runs_here_unless_a_command_allows_more() -> None:
    assert Beside(pid_and, 3).result() == (os.getpid(), 3)


@pytest.mark.usefixtures("_enabled")
def test_a_task_runs_in_another_process() -> None:
    tasks = [Beside(pid_and, value) for value in range(2)]
    (first, zero), (second, one) = (task.result() for task in tasks)
    assert (zero, one) == (0, 1)
    assert len({first, second, os.getpid()}) == 3


@pytest.mark.usefixtures("_enabled")
def test_its_error_is_that_of_the_task() -> None:
    with pytest.raises(OSError, match="No space left"):
        Beside(fails).result()


@pytest.mark.usefixtures("_enabled")
def test_a_process_that_dies_leaves_its_task_to_this_one() -> None:
    assert Beside(dies_elsewhere, os.getpid()).result() == os.getpid()


@pytest.mark.usefixtures("_enabled")
def test_a_process_that_waits_takes_the_next_task() -> None:
    beside.prepare("fractions", "no_such_module")
    beside.prepare("a second one is not started")
    child = beside._Setting.waiting
    assert child is not None
    assert Beside(loaded, "fractions").result() == (child.process.pid, True)
    assert Beside(loaded, "fractions").result()[0] != child.process.pid


@pytest.mark.usefixtures("_enabled")
def test_a_process_without_a_task_is_dismissed() -> None:
    beside.prepare()
    child = beside._Setting.waiting
    assert child is not None
    beside.dismiss()
    assert gone(child.process.pid)


def test_the_task_of_a_process_that_died_waiting_is_done_here() -> None:
    """In a process of its own: where PETSc came before the command, a broken pipe ends it."""
    script = (
        "import os; os.sched_getaffinity = lambda _: {0, 1}\n"
        "from fiberbend.process import beside; beside.enable(); beside.prepare()\n"
        "from tests.run.test_beside import pid_and\n"
        "child = beside._Setting.waiting.process; child.kill(); child.wait()\n"
        "assert beside.Beside(pid_and, 1).result() == (os.getpid(), 1)"
    )
    root = str(CASE.parents[1])
    environment = {**os.environ, "PYTHONPATH": root}
    subprocess.run([sys.executable, "-c", script], cwd=root, env=environment, check=True)


@pytest.mark.usefixtures("_enabled")
def test_stopped_it_is_gone(tmp_path: Path) -> None:
    file = tmp_path / "pid"
    task = Beside(sleeps, str(file))
    number = started(file)
    task.stop()
    assert gone(number)


def test_it_ends_with_the_process_that_waits_for_it(tmp_path: Path) -> None:
    file = tmp_path / "pid"
    script = (
        "import os; os.sched_getaffinity = lambda _: {0, 1}\n"
        "from fiberbend.process import beside; beside.enable()\n"
        "from tests.run.test_beside import sleeps\n"
        f"beside.Beside(sleeps, {str(file)!r}).result()"
    )
    root = str(CASE.parents[1])
    environment = {**os.environ, "PYTHONPATH": root}
    first = subprocess.Popen([sys.executable, "-c", script], cwd=root, env=environment)
    number = started(file)
    first.kill()
    first.wait()
    assert gone(number)


@pytest.mark.long
@pytest.mark.skipif(len(os.sched_getaffinity(0)) < 2, reason="one core: nothing runs beside")
def test_pictures_are_the_same_by_one_process_or_two(tmp_path: Path) -> None:
    one, two = tmp_path / "one", tmp_path / "two"
    assert main(["run", str(CASE), "--out", str(one), "--quiet", *SETTINGS]) == 0
    command = [sys.executable, "-m", "fiberbend", "run", str(CASE), "--out", str(two), "--quiet"]
    subprocess.run([*command, *SETTINGS], cwd=CASE.parents[1], check=True, capture_output=True)
    names = sorted(path.name for path in (one / "pictures").iterdir())
    assert names == sorted(path.name for path in (two / "pictures").iterdir())
    assert {"pressure_angle.png", "section_strain.png", "rest.png"} <= {*names}
    for name in names:
        assert (one / "pictures" / name).read_bytes() == (two / "pictures" / name).read_bytes()


def started(file: Path) -> int:
    """The number of the process that has written it."""
    for _ in range(600):
        if file.exists() and file.read_text():
            return int(file.read_text())
        time.sleep(0.05)
    raise AssertionError("the other process has not begun")


def gone(number: int) -> bool:
    """Whether a process ends within a few seconds."""
    for _ in range(100):
        state = Path(f"/proc/{number}/stat")
        try:
            if state.read_text().rpartition(")")[2].split()[0] == "Z":
                return True
        except (FileNotFoundError, ProcessLookupError):
            return True
        time.sleep(0.05)
    return False

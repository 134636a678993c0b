"""A process among others: its rank, its signals, its output, and the folder that it holds."""

from __future__ import annotations

import functools
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from fiberbend.process import lock, ranks, streams
from fiberbend.process.lock import LOCK_FILE, FolderLock, HeldError
from fiberbend.running import launch
from machine.folders import MachineError

ROOT = Path(__file__).resolve().parents[2]
CASE = str(ROOT / "cases" / "section.yaml")
SLURM = {
    "SLURM_JOB_ID": "7",
    "SLURM_PROCID": "3",
    "SLURM_NTASKS": "4",
    "SLURM_STEP_NUM_TASKS": "4",
    "PMI_RANK": "2",
    "PMI_SIZE": "4",
    "PMIX_RANK": "1",
}
"""Of a batch job and of what shells hand on, without an MPI launch."""


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({}, (0, 1, False)),
        (SLURM, (0, 1, False)),
        (SLURM | {"OMPI_COMM_WORLD_RANK": "1", "OMPI_COMM_WORLD_SIZE": "2"}, (1, 2, True)),
        (SLURM | {"PMI_FD": "5"}, (2, 4, True)),
        (SLURM | {"PMIX_NAMESPACE": "slurm.7.0"}, (1, 4, True)),
    ],
)
def test_a_launch_is_one_by_mpi(
    variables: dict[str, str], expected: tuple[int, int, bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.environ", variables)
    assert (ranks.rank(), ranks.size(), ranks.launched()) == expected


@pytest.mark.parametrize(
    ("sign", "said"), [("HYDI_CONTROL_FD", b"cmd=abort exitcode=1\n"), ("", b"")]
)
def test_only_mpichs_launcher_is_told_to_end_all(
    sign: str, said: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Others, which know other words, end all by themselves."""
    monkeypatch.delenv("HYDI_CONTROL_FD", raising=False)
    reading, writing = os.pipe()
    for name in filter(None, ("PMI_FD", sign)):
        monkeypatch.setenv(name, str(writing))
    ranks.end_all(1)
    os.close(writing)
    with open(reading, "rb") as pipe:
        assert pipe.read() == said


@pytest.fixture
def mpich(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Launchers of MPICH beside this Python; their folder."""
    for name in ("mpirun", "mpiexec.hydra"):
        (tmp_path / name).touch()
    monkeypatch.setattr("sys.executable", str(tmp_path / "python"))
    return tmp_path


def test_mpich_under_open_mpi_is_refused_before_it_starts(
    mpich: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert not ranks.foreign_launcher()
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "1")
    with pytest.raises(MachineError, match="by the mpirun of Open MPI") as caught:
        launch.start_mpi()
    assert str(caught.value).endswith(f", {mpich / 'mpirun'}")
    (mpich / "mpiexec.hydra").unlink()
    assert not ranks.foreign_launcher()


def test_variables_of_slurm_change_nothing() -> None:
    """One process that is alone in MPI, speaks, and keeps its threads."""
    code = (
        "import os; from fiberbend.running import launch; launch.set_threads(); "
        "launch.start_mpi(); from mpi4py import MPI; "
        "launch.say(str((MPI.COMM_WORLD.size, 'OPENBLAS_NUM_THREADS' in os.environ)))"
    )
    environment = {k: v for k, v in os.environ.items() if k != "OPENBLAS_NUM_THREADS"} | SLURM
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=60)
    assert (done.stdout, done.stderr) == ("(1, False)\n", "")


# --- signals -------------------------------------------------------------------------------------

WAIT = (
    "import sys, time; from fiberbend.process import signals; signals.install(); "
    "print('up', flush=True); time.sleep(30)"
)
RAISE = """
import sys, time
from fiberbend.process import signals

class Finalised:
    def __del__(self):
        print("up", flush=True)
        time.sleep(30)

signals.install()
try:
    with signals.raising():
        if sys.argv[1:] == ["lost"]:
            # in a finaliser an exception goes nowhere
            Finalised()
            signals.check()
        print("up", flush=True)
        time.sleep(30)
except KeyboardInterrupt as error:
    stop = signals.stop_of(error)
    print("left in order", flush=True)
    sys.exit(stop.code)
"""


def _stopped(code: str, number: int, *arguments: str) -> tuple[int, str, str]:
    """Exit code, output and errors of a script that gets a signal once it says 'up'."""
    process = subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        # a shell's background job would ignore Ctrl-C
        preexec_fn=functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "up\n"
    process.send_signal(number)
    out, err = process.communicate(timeout=30)
    return process.returncode, out, err


SWALLOWED = """
import sys, time
from fiberbend.process import signals

class Finalised:
    def __del__(self):
        print("up", flush=True)
        time.sleep(30)

signals.install()
try:
    with signals.raising():
        Finalised()
        time.sleep(30)
except KeyboardInterrupt as error:
    sys.exit(signals.stop_of(error).code)
"""


def test_a_signal_that_a_finaliser_swallows_comes_again() -> None:
    """Nobody asks for it: what draws pictures for ten seconds knows of no signals."""
    assert _stopped(SWALLOWED, signal.SIGINT) == (130, "", "")


HELD = """
import time
from fiberbend.process import signals

signals.install()
try:
    with signals.raising():
        with signals.held():
            print("up", flush=True)
            end = time.monotonic() + 1
            while time.monotonic() < end:
                time.sleep(0.01)
            print("whole", flush=True)
        print("not stopped", flush=True)
except KeyboardInterrupt as error:
    with signals.held():
        print("written of the stop", flush=True)
    raise SystemExit(signals.stop_of(error).code)
"""


def test_a_signal_waits_for_what_cannot_be_left_halfway() -> None:
    code, out, err = _stopped(HELD, signal.SIGTERM)
    assert (code, out, err) == (143, "whole\nwritten of the stop\n", "")


def test_nothing_slow_is_loaded_before_signals_are_taken() -> None:
    """Else Ctrl-C in the first moments is a traceback."""
    code = "import sys; import fiberbend.process.signals; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"importlib.metadata", "email", "numpy"} & {*done.stdout.split()}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_is_one_line_and_its_exit_code(number: int) -> None:
    assert _stopped(WAIT, number) == (
        128 + number,
        "",
        "fiberbend: stopped before anything was written\n",
    )
    assert _stopped(RAISE, number) == (128 + number, "left in order\n", "")


def test_a_signal_that_a_finaliser_swallows_is_raised_at_the_next_step() -> None:
    code, out, _ = _stopped(RAISE, signal.SIGTERM, "lost")
    assert (code, out) == (143, "left in order\n")


def test_what_is_ignored_stays_so() -> None:
    """Under nohup, and in the background of a shell."""
    code = (
        "import os, signal; from fiberbend.process import signals; "
        "signal.signal(signal.SIGHUP, signal.SIG_IGN); signals.install(); "
        "os.kill(os.getpid(), signal.SIGHUP); print('goes on')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, "goes on\n")


def test_the_command_takes_signals_before_anything_slow() -> None:
    code = (
        "import sys; from fiberbend import __main__; from fiberbend.process import signals; "
        "print(sorted({'cyclopts', 'numpy', 'pydantic', 'yaml'} & {*sys.modules}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout == "[]\n"


# --- standard output -----------------------------------------------------------------------------


@pytest.mark.parametrize("command", [["validate", CASE], ["schema"], ["--help"]])
def test_a_reader_that_wants_no_more_is_no_error(command: list[str]) -> None:
    process = subprocess.Popen(
        [sys.executable, "-m", "fiberbend", *command],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    process.stdout.close()
    assert process.stderr.read() == b""
    assert process.wait(timeout=30) == 0


def test_a_full_output_is_one_line_where_nothing_else_is_left() -> None:
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run(
            [sys.executable, "-m", "fiberbend", "schema"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 1
    assert done.stderr == "fiberbend: standard output: No space left on device\n"


def test_no_stream_at_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stdout", None)
    streams.guard()
    print("goes nowhere")
    assert streams.loss() == ""


# --- the folder ----------------------------------------------------------------------------------

HOLD = (
    "import sys, time; from pathlib import Path; from fiberbend.process.lock import FolderLock; "
    "lock = FolderLock(Path(sys.argv[1])); print('up', flush=True); time.sleep(60)"
)


def test_one_process_holds_a_folder_and_the_second_learns_who(tmp_path: Path) -> None:
    command = [sys.executable, "-c", HOLD, str(tmp_path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "up\n"
        with pytest.raises(HeldError, match=rf"in use by process {process.pid} on \S+$"):
            FolderLock(tmp_path)
        assert lock.holder(tmp_path).startswith(f"in use by process {process.pid}")
        process.kill()
    # the dead hold nothing, whatever file they leave
    assert (tmp_path / LOCK_FILE).exists()
    assert lock.holder(tmp_path) == ""
    FolderLock(tmp_path).release()
    assert list(tmp_path.iterdir()) == []


def test_two_locks_of_one_process(tmp_path: Path) -> None:
    first = FolderLock(tmp_path)
    with pytest.raises(HeldError, match=f"process {os.getpid()} "):
        FolderLock(tmp_path)
    first.release()
    first.release()
    FolderLock(tmp_path).release()


@pytest.mark.parametrize("missing", ["ENOLCK", "ENOSYS"])
def test_where_the_file_system_has_no_locks(
    missing: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A file with the process stands for one; a dead one's is taken as left over."""
    import errno
    import fcntl

    def none(*_: object) -> None:
        raise OSError(getattr(errno, missing), "no locks")

    monkeypatch.setattr(fcntl, "flock", none)
    held = FolderLock(tmp_path)
    with pytest.raises(HeldError, match=f"process {os.getpid()} "):
        FolderLock(tmp_path)
    held.release()
    assert list(tmp_path.iterdir()) == []
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    host = os.uname().nodename
    (tmp_path / LOCK_FILE).write_text(f"{dead.pid}\n{host}\n", encoding="utf-8")
    FolderLock(tmp_path).release()

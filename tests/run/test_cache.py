"""Compiled kernels: a killed compiler, damaged libraries, two compilers at once, none at all."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.conftest import ROOT, MpiRun

PROGRAM = """
import ufl
from mpi4py import MPI
from fem import compat
from tests.exact.solids import box
mesh = box((1.0, 1.0, 1.0), (1, 1, 1))
m = compat.create_mesh(MPI.COMM_WORLD, mesh.cell_type, mesh.nodes, mesh.cells)
x = ufl.SpatialCoordinate(m)
form = compat.compile_form(m, sum(x[0] ** i * ufl.sin(i * x[1]) for i in range(9)) * ufl.dx)
print("compiled", compat.assemble_scalar(form))
"""


def test_killed_compiler_leaves_nothing_in_the_way(tmp_path: Path) -> None:
    """A source without the mark that it is compiled: dolfinx waits 10 s for the mark, then dies."""
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-c", PROGRAM]
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)

    def unfinished() -> list[Path]:
        found = tmp_path.rglob("*.c")
        return [c for c in found if not c.with_suffix(".c.cached").exists()]

    while process.poll() is None and not unfinished():
        time.sleep(0.001)
    process.kill()
    process.wait()
    assert unfinished(), "the compiler was not caught at work"
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert "compiled" in done.stdout
    assert not unfinished()


SHORT = PROGRAM.replace("range(9)", "range(2)").replace("ufl.dx", "ufl.dx(degree=3)")


def begin(cache: Path, **more: str) -> subprocess.Popen[str]:
    """Start the short program with a cache of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", SHORT],
        cwd=ROOT,
        env=os.environ | {"XDG_CACHE_HOME": str(cache)} | more,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def end(process: subprocess.Popen[str]) -> tuple[str, list[str]]:
    """What it printed, and the lines of its messages."""
    out, messages = process.communicate(timeout=300)
    return out, messages.splitlines()


def test_damaged_kernels_are_compiled_anew(tmp_path: Path) -> None:
    """Two processes compile into one empty cache; then every library is damaged."""
    both = [begin(tmp_path), begin(tmp_path)]
    (first, said), (second, said_too) = (end(process) for process in both)
    assert first.startswith("compiled")
    assert (second, said, said_too) == (first, [], [])
    libraries = list(tmp_path.rglob("*.so"))
    assert libraries
    for number, library in enumerate(libraries):
        content = bytearray(library.read_bytes())
        if number % 3 == 0:
            # as long as before: what a crash of the machine leaves
            content[len(content) // 2 :] = bytes(len(content) - len(content) // 2)
        library.write_bytes(content[: (None, 5000, 0)[number % 3]])
    again, lines = end(begin(tmp_path))
    assert again == first
    (line,) = lines
    assert line.startswith("fiberbend: compiled kernels in ")
    assert line.endswith(" were damaged: they are compiled anew")
    assert end(begin(tmp_path)) == (first, [])


def test_without_a_compiler_the_message_says_so(tmp_path: Path) -> None:
    _, lines = end(begin(tmp_path, CC="no-such-cc"))
    assert lines[-1] == (
        "machine.folders.MachineError: no C compiler: no-such-cc is not found; install gcc, or "
        "set CC or PATH"
    )


@pytest.mark.parametrize("command", ["run", "control"])
def test_without_a_compiler_a_command_is_one_line(command: str, tmp_path: Path) -> None:
    arguments = [command, str(ROOT / "cases" / "section.yaml"), "--out", str(tmp_path / "run")]
    done = subprocess.run(
        [sys.executable, "-m", "fiberbend", *arguments],
        env=os.environ | {"CC": "no-such-cc", "XDG_CACHE_HOME": str(tmp_path / "cache")},
        capture_output=True,
        text=True,
    )
    line = "no C compiler: no-such-cc is not found; install gcc, or set CC or PATH\n"
    assert (done.returncode, done.stderr) == (1, line)


@pytest.mark.mpi
def test_without_a_compiler_two_ranks_say_one_line(
    mpirun: MpiRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", " no-such-cc")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    case = ROOT / "cases" / "section.yaml"
    done = mpirun(2, ["-m", "fiberbend", "run", case, "--out", tmp_path / "run"])
    assert done.returncode == 1
    assert done.stderr.count("no C compiler: no-such-cc is not found") == 1
    assert "rank" not in done.stderr.partition("---")[0]


def test_the_working_folder_steers_nothing(tmp_path: Path) -> None:
    """Settings of PETSc, dolfinx and ffcx that lie beside a case are not read."""
    (tmp_path / ".petscrc").write_text("-log_view\n-no_such_option\n")
    for name in ("dolfinx_jit_parameters.json", "ffcx_parameters.json"):
        (tmp_path / name).write_text("{ not JSON")
    done = subprocess.run(
        [sys.executable, "-P", "-c", SHORT],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.stderr == ""
    assert done.stdout.startswith("compiled")
    assert len(done.stdout.splitlines()) == 1

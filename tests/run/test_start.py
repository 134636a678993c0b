"""What a start loads: each library only where something of it is used."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
CASE = "cases/free_bending.yaml"
MODULES = "import sys; from fiberbend.cli import main; main(sys.argv[1:]); print(*sys.modules)"
UNASKED = ("fiberbend.accuracy", "fiberbend.calibration", "fiberbend.report", "fiberbend.sweep")
"""For cases that ask for an accuracy, calibrated windings, a page, a sweep."""
DRAWING = ("matplotlib", "pyvista", "vtkmodules", "PIL", "fiberbend.results.fields")
NUMBERS = ("numpy", "scipy", "fem", "mpi4py", "analytic", "fiberbend.case.measured")
OTHERS = ("gmsh", "meshio", "pandas", "pint", "jinja2", "rich", "asyncio", "multiprocessing")


def loaded(arguments: list[str], wanted: tuple[str, ...]) -> list[str]:
    """Those of the modules, and of what is in them, that a command has loaded."""
    done = subprocess.run(
        [sys.executable, "-c", MODULES, *arguments],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    found = done.stdout.splitlines()[-1].split()
    assert "fiberbend.reader.reader" in found
    return [name for name in found if any(f"{name}.".startswith(f"{one}.") for one in wanted)]


def test_a_case_is_validated_by_what_reads_it() -> None:
    alone = ("subprocess", "ctypes", "pickle")
    assert loaded(["validate", CASE], (*UNASKED, *DRAWING, *NUMBERS, *OTHERS, *alone)) == []


def test_a_section_is_run_by_what_solves_it(tmp_path: Path) -> None:
    quiet = ["output.pictures=false", "output.fields=false", "output.report=false"]
    changes = ["model=section", "output.at_angles=[]", "output.stop_at_angle=10 deg", *quiet]
    command = ["run", CASE, "--quiet", "--out", str(tmp_path / "run")]
    command += [word for change in changes for word in ("--set", change)]
    slow = ("scipy.interpolate", "scipy.optimize")
    assert loaded(command, (*UNASKED, *DRAWING, *OTHERS, *slow)) == []


def test_a_script_that_imports_it_keeps_its_plugins_of_pydantic() -> None:
    code = (
        "import os; before = dict(os.environ); import fiberbend; from fiberbend import api;"
        f"from fiberbend.reader.reader import read_case; read_case('{CASE}');"
        "print(sorted({*os.environ} - {*before}))"
    )
    environment = {key: value for key, value in os.environ.items() if "PYDANTIC" not in key}
    environment |= {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert "PYDANTIC_DISABLE_PLUGINS" not in done.stdout


@pytest.mark.parametrize(("given", "kept"), [(None, "__all__"), ("logger", "logger")])
def test_the_command_looks_for_no_plugins_of_pydantic(given: str | None, kept: str) -> None:
    name = "PYDANTIC_DISABLE_PLUGINS"
    environment = {key: value for key, value in os.environ.items() if key != name}
    environment |= {"PYTHONPATH": str(ROOT)} | ({} if given is None else {name: given})
    code = (
        "import atexit, os, sys; sys.argv = ['fiberbend', '--version'];"
        f"atexit.register(lambda: print(os.environ['{name}']));"
        "from fiberbend.__main__ import entry; entry()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, env=environment, capture_output=True, text=True
    )
    assert done.stdout.splitlines()[-1] == kept


def test_the_command_ends_without_a_search_for_cycles() -> None:
    code = (
        "import atexit, gc, sys; sys.argv = ['fiberbend', '--version'];"
        "atexit.register(lambda: print(gc.get_freeze_count() > 0));"
        "from fiberbend.__main__ import entry; entry()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.stdout.splitlines()[-1] == "True"


def test_every_process_comes_to_the_same_to_the_last_bit(tmp_path: Path) -> None:
    """Python orders sets anew in each process; from dolfinx 0.9 on integrals come as a set."""
    changes = ["output.pictures=false", "output.fields=false", "output.report=false"]
    changes += ["model=section", "output.at_angles=[]", "output.stop_at_angle=30 deg"]
    words = [word for change in changes for word in ("--set", change)]
    histories = set()
    for seed in "0123":
        out = tmp_path / seed
        environment = os.environ | {"PYTHONPATH": str(ROOT), "PYTHONHASHSEED": seed}
        command = [sys.executable, "-m", "fiberbend", "run", CASE, "--quiet", "--out", str(out)]
        done = subprocess.run([*command, *words], cwd=ROOT, env=environment, capture_output=True)
        assert done.returncode == 0, done.stderr
        histories.add((out / "history.csv").read_bytes())
    assert len(histories) == 1

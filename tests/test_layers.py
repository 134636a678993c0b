"""The arrows between folders, read from every import of the source."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("machine", "materials", "geometry", "analytic", "rod", "fem", "fiberbend")
LEAVES = ("machine", "materials", "geometry", "analytic", "rod")
SOURCES = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
FENICS = {"dolfinx", "ufl", "ffcx", "basix", "petsc4py", "mpi4py"}
LIGHT = (
    *("schema", "effects", "case", "reader", "plan"),
    *("running/progress", "results/folder", "running/launch"),
)
"""Folders and modules of the application that a wrong case does not go beyond."""
HEAVY = {"numpy", "scipy", "fem", *FENICS, "gmsh", "vtk", "pyvista", "matplotlib"}
BELOW_EFFECTS = {"effects", "kinematics", "compat", "kernels", "matrix", "quick_start", "ranks"}
MAX_LINES = 400


def imports(path: Path) -> Iterator[str]:
    """Every module that a file imports, anywhere in it; `from a import b` gives a and a.b."""
    package = path.relative_to(ROOT).with_suffix("").parts[:-1]
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*base, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


def offenders(paths: list[Path], forbidden: set[str]) -> list[str]:
    """Imports of the forbidden modules, or of anything inside them."""
    return [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in paths
        for name in imports(path)
        if any(name == module or name.startswith(f"{module}.") for module in forbidden)
    ]


def within(*places: str) -> list[Path]:
    return [path for path in SOURCES if str(path.relative_to(ROOT)).startswith(places)]


@pytest.mark.parametrize("leaf", LEAVES)
def test_leaves_stand_alone(leaf: str) -> None:
    others = {package for package in PACKAGES if package != leaf}
    assert offenders(within(f"{leaf}/"), others | FENICS) == []


def test_fem_does_not_know_the_application() -> None:
    assert offenders(within("fem/"), {"fiberbend"}) == []


def test_only_fem_imports_fenics() -> None:
    outside = [path for path in SOURCES if path not in within("fem/")]
    # mpi4py alone is allowed at the top: the command aborts all ranks.
    assert offenders(outside, FENICS - {"mpi4py"}) == []


def test_fem_means_our_own_folder() -> None:
    hiding = [
        str(path.relative_to(ROOT))
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and node.module == "dolfinx"
        if any(alias.name == "fem" for alias in node.names)
    ]
    assert hiding == [], "write `import dolfinx.fem as dfem`"


def test_a_wrong_case_fails_without_libraries() -> None:
    """What reads, checks and plans a case imports no library of numbers; fem is loaded to build."""
    names = [
        ".".join(path.relative_to(ROOT).with_suffix("").parts)
        for place in LIGHT
        for path in within(f"fiberbend/{place}")
    ]
    assert len(names) > 25
    script = f"import sys\nfor name in {names!r}: __import__(name)\nprint(*sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert HEAVY & {name.split(".")[0] for name in done.stdout.split()} == set()


def test_solver_knows_no_effect() -> None:
    solver = within("fem/march/", "fem/solver/", "fem/scene.py")
    assert solver, "the solver has other names now: list them here"
    named = {
        name.split(".")[2] for path in solver for name in imports(path) if "fem.effects." in name
    }
    assert named <= {"effect"}


def test_effects_know_only_what_lies_below() -> None:
    effects = within("fem/effects/")
    assert effects
    strangers = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in effects
        for name in imports(path)
        if name.startswith("fem.") and name.split(".")[1] not in BELOW_EFFECTS
    ]
    assert strangers == []


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_modules_are_short(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= MAX_LINES


def test_no_path_of_one_machine_in_tracked_files() -> None:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip("not a git checkout")
    machine = re.compile(r"(?<![\w.])/(?:home|root|work|Users|mnt|farm)/")
    found = []
    for name in listed.stdout.splitlines():
        path = ROOT / name
        if path == Path(__file__) or not path.is_file():
            continue
        content = path.read_bytes()
        if b"\0" not in content and machine.search(content.decode("utf-8", "replace")):
            found.append(name)
    assert found == []

"""One file knows versions of dolfinx; those that it does not know are refused."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import ufl

from fem import compat
from fem.libraries import Builder
from machine.folders import MachineError
from tests.conftest import ROOT
from tests.fem.parts import sector

KNOWN = ["0.5.2", "0.9.0", "0.9.0.post1", "0.11.0.post0"]
PACKAGES = (
    *("analytic", "bench", "fem", "fiberbend", "geometry", "machine", "materials", "rod", "tests"),
)
OTHERS = [
    path
    for package in PACKAGES
    for path in sorted((ROOT / package).rglob("*.py"))
    if path.relative_to(ROOT).as_posix() not in ("fem/compat.py", "tests/fem/test_compat.py")
]
LIBRARIES = r"\b(dolfinx|dfem|ufl|ffcx|basix|PETSc|petsc4py|jit)\b"


@pytest.mark.parametrize("version", KNOWN)
def test_supported_versions(version: str) -> None:
    numbers = tuple(int(part) for part in version.split(".")[:2])
    assert compat.supported_release(version) == numbers


@pytest.mark.parametrize(
    "version", ["0.4.1", "0.6.0", "0.8.0", "0.10.0", "0.12.0.dev0", "1.0", "main"]
)
def test_other_versions_are_refused_in_one_line(version: str) -> None:
    with pytest.raises(MachineError) as caught:
        compat.supported_release(version)
    text = str(caught.value)
    assert f"dolfinx {version} " in text
    assert "\n" not in text
    assert re.findall(r"\b0\.\d+", text.replace(version, "")) == ["0.5", "0.9", "0.11"]


def test_a_run_with_another_version_ends_at_its_start(tmp_path: Path) -> None:
    script = (
        "import sys, mpi4py.MPI, dolfinx; dolfinx.__version__ = '0.7.3'; "
        "sys.argv[0] = 'fiberbend'; from fiberbend.__main__ import entry; entry()"
    )
    case, out = ROOT / "cases" / "section.yaml", tmp_path / "run"
    done = subprocess.run(
        [sys.executable, "-c", script, "run", case, "--out", out],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("dolfinx 0.7.3 is not supported")
    assert done.stderr.count("\n") == 1


def test_every_function_says_what_it_bridges() -> None:
    own = [
        thing
        for _, thing in inspect.getmembers(compat)
        if getattr(thing, "__module__", "") == compat.__name__ and inspect.isroutine(thing)
    ]
    assert len(own) > 20
    silent = [f.__name__ for f in own if "bridge" not in (f.__doc__ or "").lower()]
    assert silent == ["supported_release"]


def questions(path: Path) -> Iterator[str]:
    """Text of every condition, and of every question whether something exists, in a file."""
    source = path.read_text(encoding="utf-8")
    if not re.search(rf"{LIBRARIES}|metadata", source):
        return  # none of the patterns below can be in it, and most files are so
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            yield ast.unparse(node.test)
        elif isinstance(node, ast.Compare | ast.Match):
            yield ast.unparse(node)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id == "hasattr" or (node.func.id == "getattr" and len(node.args) == 3):
                yield ast.unparse(node)
        elif isinstance(node, ast.Try):
            kinds = {ast.unparse(handler.type) for handler in node.handlers if handler.type}
            if kinds & {"ImportError", "ModuleNotFoundError", "AttributeError"}:
                yield " ".join(ast.unparse(part) for part in node.body)


VERSION = re.compile(rf"{LIBRARIES}.*(__version__|getVersion|version)|metadata\.version")
EXISTS = re.compile(rf"(hasattr|getattr)\({LIBRARIES}")
IMPORTS = re.compile(rf"(import|from) .*{LIBRARIES}")


def versions(path: Path) -> list[str]:
    """Questions of a file that ask for a version of what compat bridges."""
    patterns = (VERSION, EXISTS, IMPORTS)
    return [text for text in questions(path) if any(each.search(text) for each in patterns)]


def test_no_other_file_asks_for_a_version() -> None:
    asked = [f"{path.relative_to(ROOT)}: {text}" for path in OTHERS for text in versions(path)]
    assert asked == []


@pytest.mark.parametrize(
    "text",
    [
        "x = 1 if dolfinx.__version__ > '0.5' else 2",
        "if PETSc.Sys.getVersion() < (3, 20): pass",
        "f = getattr(ufl, 'VectorElement', None)",
        "y = hasattr(dfem, 'functionspace')",
        "try:\n    from dolfinx.fem import functionspace\nexcept ImportError:\n    pass",
        "z = importlib.metadata.version('dolfinx') < '1'",
    ],
)
def test_questions_for_versions_are_found(text: str, tmp_path: Path) -> None:
    file = tmp_path / "file.py"
    file.write_text(text)
    assert list(versions(file))


@pytest.mark.parametrize("path", sorted((ROOT / "fem").rglob("*.c")), ids=lambda path: path.name)
def test_own_code_exports_no_name(path: Path) -> None:
    """Another library's function by the same name, as libc's bind, would be called instead."""
    head = re.compile(r"^(\w[\w ]*?)[ *]+(\w+)\([^;]*?\)\s*\{", re.MULTILINE)
    functions = head.findall(path.read_text())
    assert functions
    assert [name for kind, name in functions if not kind.startswith("static")] == []


def test_values_at_points_are_compiled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """However many variables the process has made meanwhile."""
    mesh = sector("hexahedron").mesh

    def values() -> Any:
        place = ufl.variable(ufl.SpatialCoordinate(mesh))
        return compat.PointValues(mesh, place[2] ** 2, np.full((1, 3), 0.25))()

    first, compiled = values(), list[str]()
    monkeypatch.setattr(Builder, "compile", lambda *_, **given: compiled.append(str(given)))
    assert np.array_equal(values(), first)
    assert compiled == []

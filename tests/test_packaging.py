"""What an installation needs and what it contains is what the code imports and reads."""

from __future__ import annotations

import ast
import importlib.metadata
import re
import sys
import tomllib
from pathlib import Path

from tests.conftest import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PACKAGES = ("analytic", "fem", "fiberbend", "geometry", "machine", "materials")
DEBIAN = {"basix", "cffi", "dolfinx", "ffcx", "gmsh", "mpi4py", "petsc4py", "ufl"}
"""Comes with FEniCSx: pip cannot install it."""
PART_OF = {"pydantic-core": "pydantic"}


def files() -> list[Path]:
    """Files of the packages, without what Python caches."""
    every = (path for name in PACKAGES for path in (ROOT / name).rglob("*") if path.is_file())
    return sorted(path.relative_to(ROOT) for path in every if "__pycache__" not in path.parts)


def imported(file: Path) -> set[str]:
    """Packages that a module imports, anywhere in it."""
    names = set()
    for node in ast.walk(ast.parse((ROOT / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names.add(node.module or "")
    return {name.split(".")[0] for name in names}


def test_dependencies_are_what_is_imported() -> None:
    used = set().union(*(imported(file) for file in files() if file.suffix == ".py"))
    used -= {*sys.stdlib_module_names, *PACKAGES, *DEBIAN}
    found_in = importlib.metadata.packages_distributions()
    needed = {found_in[name][0].lower() for name in used}
    needed = {PART_OF.get(name.replace("_", "-"), name) for name in needed}
    given = {re.split("[<>=]", line)[0] for line in PROJECT["project"]["dependencies"]}
    assert given == needed


def test_an_installation_has_every_file() -> None:
    data = PROJECT["tool"]["setuptools"]["package-data"]
    patterns = [
        f"{package.replace('.', '/')}/{name}" for package, names in data.items() for name in names
    ]
    others = [file for file in files() if file.suffix != ".py"]
    assert [str(file) for file in others if not any(map(file.match, patterns))] == []
    # with the notice of what others wrote
    assert Path("fiberbend/report/assets/three/LICENSE") in others

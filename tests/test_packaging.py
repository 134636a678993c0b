"""What an installation needs and what it contains is what the code imports and reads."""

from __future__ import annotations

import ast
import hashlib
import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
import zipfile
from collections.abc import Sequence
from pathlib import Path

import pytest

from fiberbend.process import own
from tests.conftest import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PACKAGES = ("analytic", "fem", "fiberbend", "geometry", "machine", "materials", "rod")
DEBIAN = {"basix", "cffi", "dolfinx", "ffcx", "gmsh", "mpi4py", "petsc4py", "ufl"}
"""Comes with FEniCSx: pip cannot install it."""
OPTIONAL = {"IPython"}
"""Is there where a notebook is."""
HANDED_OVER = {"Sofa", "elastica", "mujoco"}
"""Is imported by scripts that `fiberbend export` writes for other programs."""
PART_OF = {"pydantic-core": "pydantic"}


def files() -> list[Path]:
    """Files of the packages, without what Python caches."""
    every = [path for name in PACKAGES for path in (ROOT / name).rglob("*")]
    # rglob follows no links
    every += [path for link in every if link.is_symlink() for path in link.rglob("*")]
    files = (path for path in every if path.is_file() and "__pycache__" not in path.parts)
    return sorted(path.relative_to(ROOT) for path in files)


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
    used -= {*sys.stdlib_module_names, *PACKAGES, *DEBIAN, *OPTIONAL, *HANDED_OVER}
    found_in = importlib.metadata.packages_distributions()
    # Debian's packages need not say what modules they have
    needed = {found_in.get(name, [name])[0].lower() for name in used}
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
    # with the notice of what others wrote, and what every user begins with
    assert Path("fiberbend/report/assets/three/LICENSE") in others
    assert Path("fiberbend/cases/section.yaml") in others
    assert Path("fiberbend/cases/case.schema.json") in others


# --- a wheel -------------------------------------------------------------------------------------


def _built(source: Path, target: Path) -> Path:
    """A wheel of a source; without a network."""
    pip("wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", target, source)
    (wheel,) = target.glob("*.whl")
    return wheel


def pip(*arguments: str | Path) -> None:
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, env=alone())
    assert done.returncode == 0, done.stdout + done.stderr


def alone() -> dict[str, str]:
    """An environment in which nothing names the source."""
    return {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}


def contents(wheel: Path) -> dict[str, str]:
    """Hashes of what a wheel contains."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the source, so that nothing is built within it."""
    target = tmp_path_factory.mktemp("source")
    for name in (*PACKAGES, "cases"):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / name, target / name, symlinks=True, ignore=ignored)
    for name in ("CITATION.cff", "LICENSE", "README.md", "pyproject.toml", "setup.py"):
        shutil.copy(ROOT / name, target)
    return target


@pytest.fixture(scope="module")
def wheel(source: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return _built(source, tmp_path_factory.mktemp("wheel"))


def test_a_wheel_has_what_the_source_has_each_time(
    source: Path, wheel: Path, tmp_path: Path
) -> None:
    first = contents(wheel)
    # what is left of a module that is no more
    (source / "build" / "lib" / "fiberbend" / "gone.py").write_text("", encoding="utf-8")
    assert contents(_built(source, tmp_path)) == first
    assert {name for name in first if ".dist-info/" not in name} == {*map(str, files())}


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The Python of an environment with the wheel, and what is installed beside the source."""
    env = tmp_path_factory.mktemp("env")
    venv.create(env, system_site_packages=True, with_pip=False, symlinks=True)
    python = env / "bin" / "python"
    pip("--python", python, "install", "--no-deps", "--no-index", wheel)
    (site,) = env.glob("lib/*/site-packages")
    # folders alone: the link to the source is in a file of theirs
    beside = [path for path in sys.path if path.endswith("-packages")]
    (site / "beside.pth").write_text("\n".join(beside), encoding="utf-8")
    return python


def called(command: Sequence[str | Path], work: Path, **variables: str) -> tuple[int, str, str]:
    """Exit code, output and errors of a program in a folder."""
    environment = alone() | variables
    done = subprocess.run(command, cwd=work, env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def test_a_wheel_works_from_any_folder(installed: Path, tmp_path: Path) -> None:
    program = installed.with_name("fiberbend")
    assert called([program, "cases", "section", "sweeps/table1"], tmp_path)[0] == 0
    for name in ("section.yaml", "sweeps/table1.yaml", "free_bending_smeared.yaml"):
        same = (tmp_path / "cases" / name).read_bytes() == (ROOT / "cases" / name).read_bytes()
        assert same, name
    assert (tmp_path / "cases" / "case.schema.json").exists()
    quick = ("effects.0.pressure.angle=30 deg", "output={pictures: false, fields: false}")
    changes = [word for change in quick for word in ("--set", change)]
    code, out, err = called([program, "run", "cases/section.yaml", *changes], tmp_path)
    assert code == 0, err
    assert "bends to 30°" in out
    assert (tmp_path / "runs/section/report.html").stat().st_size > 500_000, "with three.js"


def test_packages_of_others_are_refused(installed: Path, tmp_path: Path) -> None:
    other = tmp_path / "others" / "materials"
    other.mkdir(parents=True)
    version: list[str | Path] = [installed.with_name("fiberbend"), "version"]
    path = str(other.parent)
    assert called(version, tmp_path, PYTHONPATH=path)[0] == 0, "a folder alone shadows nothing"
    (other / "__init__.py").touch()
    code, out, err = called(version, tmp_path, PYTHONPATH=path)
    assert (code, out) == (1, "")
    line = f"fiberbend: package materials is {other}/__init__.py, expected "
    assert err.startswith(line)
    assert err.count("\n") == 1
    script: list[str | Path] = [installed, "-c", "import fiberbend; fiberbend.run"]
    code, _, err = called(script, tmp_path, PYTHONPATH=path)
    assert code == 1
    assert err.splitlines()[-1].startswith(f"ImportError: {line}")
    # installed into the same folder
    (mine,) = installed.parent.parent.glob("lib/*/site-packages/geometry/__init__.py")
    text = mine.read_text(encoding="utf-8")
    mine.write_text("def area(): ...\n", encoding="utf-8")
    code, _, err = called(version, tmp_path)
    mine.write_text(text, encoding="utf-8")
    assert code == 1
    assert err.startswith("fiberbend: package geometry is that of another program, expected ")
    loaded: list[str | Path] = [installed, "-c", "import materials, fiberbend; fiberbend.run"]
    assert called(loaded, tmp_path, PYTHONPATH=path)[2].splitlines()[-1].startswith("ImportError")


def test_its_packages_are_those_that_are_looked_for() -> None:
    assert {*own.NAMES, "fiberbend"} == {*PACKAGES}
    assert own.shadowed() == ""

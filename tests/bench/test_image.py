"""The Dockerfile installs what setup.sh does on Debian 13; how its steps are read and followed."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest
import yaml

from fem.compat import SUPPORTED
from tests.conftest import ROOT


def _image() -> ModuleType:
    """bench/stacks/image.py, which is a script."""
    spec = importlib.util.spec_from_file_location("image", ROOT / "bench" / "stacks" / "image.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


image = _image()
STEPS = image.steps((ROOT / "Dockerfile").read_text(encoding="utf-8"))
PATTERNS = (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines()


def all_of(name: str) -> list[str]:
    """What stands behind every instruction of a name."""
    return [text for each, text in STEPS if each == name]


def test_it_installs_the_packages_of_setup() -> None:
    """By the same files; a package or a version that is named here would be another."""
    assert all_of("FROM") == ["debian:trixie-slim"]
    debian, python, program, user = all_of("RUN")
    assert "xargs -a apt-packages.txt" in debian
    assert "--no-install-recommends" in debian
    named = re.findall(r"install ((?:-\S+ )*)(.*?) *&&", debian)
    assert [rest for _, rest in named] == [""], "a package by its name"
    assert "--constraint constraints-debian13.txt --requirement needed.txt" in python
    assert "--system-site-packages" in python
    assert "--no-deps --no-build-isolation ./source" in program
    assert "==" not in debian + python + program + user


def test_what_changes_seldom_comes_first() -> None:
    """An edited source installs no package again."""
    assert all_of("COPY") == [
        "apt-packages.txt ./",
        "constraints-debian13.txt requirements.txt pyproject.toml ./",
        ". source",
    ]
    names = [name for name, _ in STEPS]
    assert names.index("USER") > max(index for index, name in enumerate(names) if name == "RUN")
    assert all_of("USER") == ["fiberbend"]
    assert all_of("ENTRYPOINT") == ['["fiberbend"]']


def test_the_image_has_the_source_and_nothing_else() -> None:
    given = {str(path) for path in image.context(ROOT, PATTERNS)}
    packages = ("analytic", "fem", "fiberbend", "geometry", "machine", "materials", "rod")
    for package in packages:
        for path in (ROOT / package).rglob("*"):
            name = str(path.relative_to(ROOT))
            if (path.is_file() or path.is_symlink()) and "__pycache__" not in name:
                assert name in given
    beside = {name.partition("/")[0] for name in given} - {*packages, "cases"}
    assert beside == {
        *("apt-packages.txt", "constraints-debian13.txt", "requirements.txt"),
        *("pyproject.toml", "setup.py", "CITATION.cff", "LICENSE", "README.md"),
    }
    assert not [name for name in given if "__pycache__" in name or name.endswith(".pyc")]


def test_steps_are_read_as_docker_does() -> None:
    text = "# first\nFROM a\n\nRUN one \\\n    # between\n    && two\nENV A=1 \\\n    B=2\n"
    assert image.steps(text) == [("FROM", "a"), ("RUN", "one      && two"), ("ENV", "A=1      B=2")]


@pytest.mark.parametrize(
    "text", ["ADD . /", "FROM debian:bookworm", "FROM debian:trixie-slim\nCOPY nothing ./"]
)
def test_a_step_that_is_not_known_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "Dockerfile").write_text(text, encoding="utf-8")
    (tmp_path / ".dockerignore").write_text("*\n", encoding="utf-8")
    with pytest.raises(ValueError, match="Dockerfile: "):
        image.Image(tmp_path / "root", tmp_path).follow()


@pytest.mark.parametrize("patterns", [[], ["docs"], ["*", "!a/b"], ["*", "docs/"], ["*", "!gone"]])
def test_patterns_of_another_kind_are_refused(patterns: list[str], tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"\.dockerignore"):
        list(image.context(tmp_path, patterns))


def test_files_are_copied_and_variables_kept(tmp_path: Path) -> None:
    source, root = tmp_path / "source", tmp_path / "root"
    (source / "pack" / "__pycache__").mkdir(parents=True)
    (source / "pack" / "__pycache__" / "a.pyc").touch()
    (source / "pack" / "a.py").touch()
    (source / "list.txt").write_text("gcc", encoding="utf-8")
    (source / "pack" / "link").symlink_to("../list.txt")
    (source / ".dockerignore").write_text("*\n!pack\n!list.txt\n**/__pycache__\n", encoding="utf-8")
    lines = ["FROM debian:trixie-slim", "WORKDIR /opt", "COPY list.txt ./", "COPY . all"]
    lines += ["ENV A=1 B=two", "USER somebody", "WORKDIR /data", 'ENTRYPOINT ["program"]']
    (source / "Dockerfile").write_text("\n".join(lines), encoding="utf-8")
    made = image.Image(root, source)
    made.follow()
    found = {str(path.relative_to(root)) for path in root.rglob("*") if not path.is_dir()}
    inside = ("list.txt", "pack/a.py", "pack/link")
    copied = {"opt/list.txt", *(f"opt/all/{name}" for name in inside)}
    assert found - {"etc/dpkg/dpkg.cfg.d/docker-apt-speedup"} == copied
    assert (root / "opt/all/pack/link").is_symlink()
    assert (made.folder, made.user, made.entry) == ("/data", "somebody", ["program"])
    assert made.variables["B"] == "two"


def test_the_environment_of_conda_has_a_dolfinx_that_is_supported() -> None:
    text = (ROOT / "environment.yml").read_text(encoding="utf-8")
    needed = yaml.safe_load(text)["dependencies"]
    found = [re.fullmatch(r"fenics-dolfinx=(\d+)\.(\d+)\.0", str(line)) for line in needed]
    [release] = [match.groups() for match in found if match]
    assert tuple(map(int, release)) in SUPPORTED
    assert {"pip": ["--requirement requirements.txt", "."]} in needed
    assert text.startswith("# UNTESTED")

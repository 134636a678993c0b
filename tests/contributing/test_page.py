"""CONTRIBUTING.md says where everything is, and by which commands it is checked."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest

from tests.conftest import ROOT
from tests.contributing.recipes import PACKAGES, PAGE, recipe

TEXT = PAGE.read_text(encoding="utf-8")
CONTRACTS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
    "importlinter"
]["contracts"]


def rooms() -> list[str]:
    """Folders and modules of the house, in the order of the page."""
    (block,) = re.findall(r"^```text\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)
    return [line.split()[0] for line in block.splitlines()]


def within(package: str) -> list[str]:
    """Names of the rooms of a package, in the order of the page."""
    paths = (Path(room) for room in rooms())
    return [path.stem for path in paths if path.parts[0] == package and len(path.parts) > 1]


@pytest.mark.parametrize("package", ["geometry", "fem", "fiberbend"])
def test_the_order_of_the_page_is_that_of_the_contract(package: str) -> None:
    (layers,) = (c["layers"] for c in CONTRACTS if c.get("containers") == [package])
    listed = within(package)
    floors = [set(layer.replace(" ", "").split("|")) for layer in reversed(layers)]
    for floor in floors:
        here, listed = set(listed[: len(floor)]), listed[len(floor) :]
        assert here == floor
    assert listed == []


def test_every_room_is_there_and_every_package_is_listed() -> None:
    assert all((ROOT / room).exists() for room in rooms())
    assert list(dict.fromkeys(Path(room).parts[0] for room in rooms())) == list(PACKAGES)


def test_every_command_is_said() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = re.findall(r"^([a-z]+):.*## ", makefile, re.MULTILINE)
    assert targets
    said = set(re.findall(r"`make ([a-z]+)`", TEXT))
    assert said == set(targets)


def test_what_make_test_leaves_out_is_run_by_ci() -> None:
    """Tests that are long; what everybody needs at once is none of them."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert "not long" in settings["tool"]["pytest"]["ini_options"]["addopts"]
    assert "-m 'long and" in (ROOT / "Makefile").read_text(encoding="utf-8")
    steps = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert steps.index("step test-long") == steps.index("step test") + 1
    for name in ("test_regression", "test_run", "test_restart"):
        assert "mark.long" not in (ROOT / "tests" / "run" / f"{name}.py").read_text("utf-8")


def test_every_recipe_is_tested() -> None:
    tests = (Path(__file__).parent / "test_recipes.py").read_text(encoding="utf-8")
    titles = re.findall(r"^### (.+)$", TEXT, re.MULTILINE)
    assert len(titles) == 5
    for title in titles:
        assert f'House(tmp_path, "{title}")' in tests
        assert recipe(title).diffs
        assert recipe(title).case

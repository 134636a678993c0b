"""Generated pages are those of the present code; the site builds; the notebook runs."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from bench import actuator_drawing
from bench import pages as written

ROOT = written.ROOT
NOTEBOOK = ROOT / "examples" / "first_actuator.ipynb"


def _tool(name: str) -> ModuleType:
    """A module of docs/."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("page", "text"), written.PAGES.items())
def test_the_page_is_that_of_the_code(page: str, text: Callable[[], str]) -> None:
    assert (ROOT / page).read_text(encoding="utf-8") == text(), "make docs"


def test_the_case_file_page_has_every_key() -> None:
    text = written.case_file()
    for key in ("actuator", "radius", "pitch", "stop_at_angle", "max_turn", "young"):
        assert f"`{key}`" in text
    assert "(materials.md)" in text
    assert "elastosil-m4601" in written.PAGES["docs/materials.md"]()
    assert "length, such as `8 mm`" in text


def test_the_drawing_is_that_of_its_script(tmp_path: Path) -> None:
    actuator_drawing.draw(tmp_path / "actuator.svg")
    drawn = (tmp_path / "actuator.svg").read_text(encoding="utf-8")
    assert drawn == actuator_drawing.PICTURE.read_text(encoding="utf-8"), "make docs"


def test_formulas_are_drawn() -> None:
    pytest.importorskip("matplotlib")
    picture = _tool("math_pictures").picture
    drawn = picture(r"\frac{a}{b} + \sqrt{\bar{I}_1}")
    assert drawn.startswith("<svg")
    assert drawn.count("Z") >= 6
    with pytest.raises(ValueError, match="nosuchsign"):
        picture(r"\nosuchsign")


def test_the_notebook_has_no_outputs() -> None:
    nbformat = pytest.importorskip("nbformat", reason="make tools installs it")
    for cell in nbformat.read(NOTEBOOK, as_version=4).cells:
        assert not cell.get("outputs"), "clear the outputs before a commit"
        assert cell.get("execution_count") is None


@pytest.mark.long
def test_the_site_builds_with_the_notebook_run_and_without_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("sphinx", reason="make tools installs it")
    built = subprocess.run(
        [
            *(sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"),
            *("-d", tmp_path / "trees", ROOT / "docs", tmp_path / "site"),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    notebook = (tmp_path / "site" / "_generated" / "first_actuator.html").read_text(
        encoding="utf-8"
    )
    assert "first_actuator_1.png" in notebook, "the notebook draws something"
    front = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert "actuator.svg" in front
    # what a page fetches by itself must be beside it
    for page in (tmp_path / "site").rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert 'src="http' not in text, page
        assert 'rel="stylesheet" href="http' not in text, page

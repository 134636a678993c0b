"""In a notebook: runs in its event loop and in threads, a bar, and results that show themselves."""

from __future__ import annotations

import asyncio
import importlib.util
import json
import re
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml

import fiberbend
from fiberbend.notebook import blocks
from fiberbend.process import signals
from tests.conftest import ROOT

NOTEBOOK = ROOT / "examples" / "first_actuator.ipynb"
GROWTH_MB = 1.0
"""Of a process in the quietest ten runs of sixty: pools that fill up grow by steps, and rest."""


def case(angle: str = "30 deg") -> dict[str, Any]:
    """A section that needs a fraction of a second."""
    text = (ROOT / "cases" / "section.yaml").read_text(encoding="utf-8")
    given: dict[str, Any] = yaml.safe_load(text)
    given["effects"][0] = {"pressure": {"angle": angle}}
    return given | {"title": "<b>A & B</b>", "output": {}}


@pytest.fixture(scope="module")
def result() -> fiberbend.Result:
    return fiberbend.run(case())


# --- what is shown --------------------------------------------------------------------------------


class _Tags(HTMLParser):
    """Tags that are open, and everything that would fetch or run something."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.bad: list[str] = []
        self.words = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.open.append(tag)
        if tag in ("script", "style", "link", "img", "b"):
            self.bad.append(tag)
        self.bad += [name for name, _ in attrs if name in ("src", "href") or name.startswith("on")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words += f"{data}\n"


def words(shown: Any) -> str:
    """The text of what an object shows, which is closed, small, and fetches nothing."""
    text = shown._repr_html_()
    tags = _Tags(text)
    assert tags.open == tags.bad == []
    assert len(text) < 20_000
    colours = re.findall(r"(?:color|background|fill|stroke)\s*[:=]\s*\"?([^;\"]+)", text)
    # both themes have these
    assert {*colours} <= {"inherit", "currentColor", "none", blocks.ACCENT}
    return tags.words


def test_a_run_shows_itself(result: fiberbend.Result) -> None:
    text = words(result)
    assert "<b>A & B</b>" in text
    for part in ("The actuator bends to 30°", "pressure P (kPa)", "bending angle θ (°)", "Trust"):
        assert part in text
    assert "<polyline" in result._repr_html_()
    assert "The actuator bends to 30°" in words(result.answer)
    at = words(result.at(angle="30 deg"))
    assert at.startswith("30 deg, at step")
    assert f"{result.last('pressure_kPa'):.5g}" in at


def test_a_run_without_a_load_step_shows_itself(result: fiberbend.Result) -> None:
    began = fiberbend.Result("failed", "no <mesh>", [], {}, None, result.case, None)
    assert "failed: no <mesh>" in words(began)
    assert "No load step." in words(began)


def test_a_case_and_a_plan_show_themselves() -> None:
    text = words(fiberbend.validate(case()))
    for part in ("section hemicircle, radius 8 mm", "angle 30 deg", "double-helix", "tolerance"):
        assert part in text
    text = words(fiberbend.plan(case()))
    assert "Plan of a run of the section model" in text
    assert "unknowns" in text


def test_a_sweep_shows_itself(tmp_path: Path) -> None:
    file = {
        "case": case() | {"output": {"report": False, "pictures": False, "fields": False}},
        "vary": {"actuator.wall": ["1.5 mm", "2 mm"]},
        "report": {"angles": ["30 deg"]},
    }
    found = fiberbend.sweep(file, tmp_path)
    text = words(found)
    for part in ("2 points: 2 converged", "wall (mm)", "pressure at 30° (kPa)", str(tmp_path)):
        assert part in text
    (tmp_path / "sweep.csv").unlink()
    assert "2 points begun, no table yet" in words(fiberbend.load(tmp_path))


def test_a_figure_shows_itself_without_pyplot(result: fiberbend.Result) -> None:
    png, size = result.plot()._repr_png_()  # type: ignore[attr-defined]
    assert png.startswith(b"\x89PNG")
    assert size["width"] == pytest.approx(1.5 * 96 * 85 / 25.4, abs=1)


def test_a_table_keeps_its_first_and_last_rows() -> None:
    text = blocks.table(["n", "name (mm)"], [[i, f"<{i}>"] for i in range(100)])
    for part in ("&lt;0&gt;", "&lt;4&gt;", "…", "&lt;95&gt;", "&lt;99&gt;", "name (mm)"):
        assert part in text
    assert "&lt;50&gt;" not in text
    assert blocks.curve([(0.0, 0.0)], "x", "y") == blocks.curve([(0, 1)] * 9, "x", "y") == ""


# --- where it runs --------------------------------------------------------------------------------


def test_runs_in_threads_take_turns(result: fiberbend.Result) -> None:
    with ThreadPoolExecutor(3) as threads:
        runs = [*threads.map(fiberbend.run, [case(), case("20 deg"), case()])]
    assert [run.status for run in runs] == ["converged"] * 3
    same = [run.last("pressure_kPa") for run in (runs[0], runs[2])]
    assert same == pytest.approx([result.last("pressure_kPa")] * 2, rel=1e-9)


def test_a_run_within_an_event_loop(result: fiberbend.Result) -> None:
    async def within() -> list[fiberbend.Result]:
        here = fiberbend.run(case())
        return [here, await asyncio.to_thread(fiberbend.run, case())]

    for run in asyncio.run(within()):
        assert run.last("pressure_kPa") == pytest.approx(result.last("pressure_kPa"), rel=1e-9)


def test_signals_are_not_taken_in_a_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("signal.signal", lambda *_: pytest.fail("taken"))
    thread = threading.Thread(target=signals.install)
    thread.start()
    thread.join()


SIXTY = """
import json, re, signal, sys
import fiberbend

def status(name):
    text = open("/proc/self/status", encoding="utf-8").read()
    return re.search(rf"{name}:\\s*(\\w+)", text)[1]

case, resident = json.loads(sys.argv[1]), []
for _ in range(60):
    fiberbend.run(case)
    resident.append(int(status("VmRSS")) / 1024)
caught = [n for n in range(1, 32) if int(status("SigCgt"), 16) >> (n - 1) & 1]
print(json.dumps({"resident": resident, "caught": caught}))
"""


@pytest.mark.long
def test_runs_take_no_more_memory_and_no_signals() -> None:
    command = [sys.executable, "-c", SIXTY, json.dumps(case())]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    resident = found["resident"]
    # what every run keeps grows in all of them: 0.1 MB a run is seen
    grown = [after - before for before, after in zip(resident, resident[10:], strict=False)]
    assert min(grown) < GROWTH_MB, resident
    # a notebook lives on where a pipe breaks, and ends by SIGTERM as ever
    assert not {*found["caught"]} & {1, 13, 15}, "SIGHUP, SIGPIPE, SIGTERM"


# --- in a kernel ----------------------------------------------------------------------------------

CELLS = (
    "import asyncio, json, fiberbend\nfrom fiberbend.notebook.place import Place",
    # else the bar is gone at the end
    "Place.clear = lambda self: None",
    "asyncio.get_running_loop()\ncase = json.loads({!r})\nrun = fiberbend.run(case, quiet=False)",
    "run",
    "await asyncio.to_thread(fiberbend.run, case)",
)


def page() -> ModuleType:
    """The module that runs notebooks."""
    spec = importlib.util.spec_from_file_location("page", ROOT / "docs" / "notebook_page.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run_notebook(path: Path) -> list[Any]:
    """Outputs of each cell of code; none of them writes to stderr."""
    cells = page().executed(path).cells
    outputs = [cell.outputs for cell in cells if cell.cell_type == "code"]
    assert [o for each in outputs for o in each if o.get("name") == "stderr"] == []
    return outputs


def test_a_kernel_shows_a_bar_and_results(tmp_path: Path) -> None:
    nbformat = pytest.importorskip("nbformat", reason="make tools installs it")
    v4, path = nbformat.v4, tmp_path / "cells.ipynb"
    sources = [text.format(json.dumps(case())) if "{!r}" in text else text for text in CELLS]
    nbformat.write(v4.new_notebook(cells=[v4.new_code_cell(text) for text in sources]), path)
    _, _, bar, shown, in_thread = run_notebook(path)
    # in one place, with the last state
    assert [output.output_type for output in bar] == ["display_data"]
    assert re.search(r"━{10}.*output …", bar[0].data["text/html"])
    for outputs in (shown, in_thread):
        assert "The actuator bends to 30°" in outputs[-1].data["text/html"]


def test_the_notebook_runs_and_shows_itself() -> None:
    pytest.importorskip("nbclient", reason="make tools installs it")
    checked, plan, run, frame, pressure, walls, plot, path, sweep = run_notebook(NOTEBOOK)
    for outputs in (checked, plan, run, frame, sweep):
        assert "text/html" in outputs[-1].data
    for outputs in (plot, path):
        assert "image/png" in outputs[-1].data
    thin, usual, thick = re.findall(r"mm (\S+) kPa", walls[0].text)
    assert float(thin) < float(usual) == float(pressure[0].data["text/plain"]) < float(thick)

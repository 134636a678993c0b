from __future__ import annotations

import base64
import json
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.cli import main
from fiberbend.commands import opening
from fiberbend.reader.reader import parse_case
from fiberbend.report.case_tables import steps
from fiberbend.report.run_page import report, rows_of_states, write_report
from fiberbend.results.folder import REPORT, RunFolder
from tests.report.folders import CASE, HOSTILE, bent_folder, case, rows, run_of

ROOT = Path(__file__).resolve().parents[2]
VOID = {"meta", "img", "input", "br", "link", "hr"}
ASKING = ("src", "href", "srcset", "poster", "data", "action", "xlink:href")


class Page(HTMLParser):
    """What a page is made of; its end tags fit."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self.scripts: list[str] = []
        self._open: list[str] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Open it."""
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close the tag that is open."""
        assert self._open.pop() == tag, f"</{tag}> in {self.getpos()}"

    def handle_data(self, data: str) -> None:
        """Keep text and scripts apart."""
        if self._open and self._open[-1] in ("script", "style"):
            self.scripts.append(data)
        elif data.strip():
            self.texts.append(data.strip())

    @property
    def ids(self) -> list[str]:
        """Names of places."""
        return [str(found["id"]) for _, found in self.tags if "id" in found]

    @property
    def text(self) -> str:
        """What a reader sees."""
        return " ".join(self.texts)

    def links(self) -> list[tuple[str, str]]:
        """Tag and address of all that a browser could fetch or follow."""
        return [(t, str(a[k])) for t, a in self.tags for k in ASKING if a.get(k) is not None]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = bent_folder(tmp_path_factory.mktemp("page") / "run", case(), run_of())
    write_report(RunFolder(path), case(), rows(), run_of())
    return path


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    return Page((folder / REPORT).read_text(encoding="utf-8"))


def test_the_page_has_all_its_parts(page: Page) -> None:
    wanted = {"answer", "space", "curves", "path", "case", "plan", "steps", "time", "files", "cite"}
    assert wanted <= set(page.ids)
    assert len(page.ids) == len(set(page.ids))
    inner = {address for tag, address in page.links() if address.startswith("#")}
    assert {address[1:] for address in inner} <= set(page.ids)
    assert "radius" in page.text
    assert "8 mm" in page.text
    assert "elastosil-m4601" in page.text
    assert "45 kPa" in page.text
    assert "the body <b>passes</b> through itself" in page.text


def test_text_of_a_user_stays_text(page: Page, folder: Path) -> None:
    assert sum(text == HOSTILE for text in page.texts) >= 2
    assert not any("alert('title')" in script for script in page.scripts)
    assert "<script>alert" not in (folder / REPORT).read_text(encoding="utf-8")
    assert not [tag for tag, _ in page.tags if tag == "b"]


def test_nothing_is_fetched(page: Page) -> None:
    for tag, address in page.links():
        inside = address.startswith(("data:", "#"))
        beside = address.startswith("./") and tag == "a"
        assert inside or beside or (tag == "a" and address.startswith("https://doi.org/"))
    (policy,) = [
        str(found["content"])
        for tag, found in page.tags
        if tag == "meta" and found.get("http-equiv") == "Content-Security-Policy"
    ]
    allowed = dict(part.strip().split(" ", 1) for part in policy.split(";"))
    assert allowed["default-src"] == "'none'"
    assert allowed["img-src"] == "data:"
    assert not any("http" in value for value in allowed.values())
    assert not re.search(r"@import|url\(", "".join(page.scripts[:1]))


def test_downloads_are_the_files(page: Page, folder: Path) -> None:
    found = {
        str(attributes["download"]): str(attributes["href"])
        for tag, attributes in page.tags
        if tag == "a" and "download" in attributes
    }
    assert set(found) == {"history.csv", "case.resolved.yaml", "run.json"}
    for name, address in found.items():
        content = base64.b64decode(address.partition(";base64,")[2])
        assert content == (folder / name).read_bytes()


def test_the_page_is_small(folder: Path) -> None:
    assert (folder / REPORT).stat().st_size < 2_000_000


def test_how_to_cite_is_that_of_the_project(page: Page) -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["title"] in page.text
    assert citation["references"][0]["doi"] in page.text
    assert "Kevin C. Galloway" in page.text


def test_three_js_comes_with_its_licence(page: Page) -> None:
    assert any("Permission is hereby granted, free of charge" in text for text in page.scripts)
    assets = ROOT / "fiberbend" / "report" / "assets" / "three"
    assert "MIT" in (assets / "LICENSE").read_text(encoding="utf-8")
    assert "</script" not in (assets / "three.min.js").read_text(encoding="utf-8").lower()


ENDS: dict[str, dict[str, Any]] = {
    "failed": {"reason": "Newton's method <failed> after 8 cut-backs"},
    "stopped": {"reason": "the pressure has its greatest value"},
    "interrupted": {"reason": "stopped at step 2, kept; go on with --resume"},
}


@pytest.mark.parametrize("status", ENDS)
def test_a_run_that_did_not_converge_says_so(status: str, folder: Path) -> None:
    found = Page(report(folder, case(), rows(), run_of(status, **ENDS[status])))
    assert f"{status}: {ENDS[status]['reason']}" in found.text
    assert "scene-data" in found.ids


def test_a_killed_run_shows_what_it_kept(folder: Path, tmp_path: Path) -> None:
    path = shutil.copytree(folder, tmp_path / "run")
    (path / "history.csv").unlink()
    (path / "run.json").unlink()
    assert main(["report", str(path)]) == 0
    found = Page((path / REPORT).read_text(encoding="utf-8"))
    assert "There is no history.csv" in found.text
    assert "scene-data" in found.ids
    assert [row["step"] for row in rows_of_states(path)] == [0, 1, 2, 3]
    for snapshot in path.glob("snapshots/*"):
        snapshot.unlink()
    found = Page(report(path, case(), [], {}))
    assert "has not made a load step" in found.text
    assert "scene-data" not in found.ids


def test_a_damaged_state_is_left_out_and_the_page_says_so(folder: Path, tmp_path: Path) -> None:
    path = shutil.copytree(folder, tmp_path / "run")
    (path / "snapshots" / "step_0002.npz").write_bytes(b"PK no zip")
    found = Page(report(path, case(), rows(), run_of()))
    assert "damaged" in found.text
    (scene,) = [text for text in found.scripts if text.startswith('{"around"')]
    assert [step["step"] for step in json.loads(scene)["steps"]] == [0, 1, 3]


def test_a_damaged_mesh_costs_the_view_and_the_page_says_so(folder: Path, tmp_path: Path) -> None:
    path = shutil.copytree(folder, tmp_path / "run")
    (path / "mesh.npz").write_bytes((folder / "mesh.npz").read_bytes()[:900])
    found = Page(report(path, case(), rows(), run_of()))
    assert "mesh.npz is damaged" in found.text
    assert "scene-data" not in found.ids
    assert {"answer", "path", "steps"} <= set(found.ids)


def closed_form() -> dict[str, Any]:
    actuator = {key: value for key, value in CASE["actuator"].items() if key != "sheath"}
    materials = {"wall": "elastosil-m4601", "floor": "combined-base"}
    effects = [{"pressure": {"to": "40 kPa"}}, {"hoops": {}}]
    return CASE | {
        "actuator": actuator,
        "materials": materials,
        "effects": effects,
        "model": "analytic",
        "mesh": {},
        "output": {"at_pressures": ["20 kPa"]},
    }


def test_a_closed_form_says_that_it_has_no_body(tmp_path: Path) -> None:
    import fiberbend

    fiberbend.run(parse_case(closed_form()), tmp_path / "run")
    found = Page((tmp_path / "run" / REPORT).read_text(encoding="utf-8"))
    assert "closed form: it has no body" in found.text
    assert "scene-data" not in found.ids
    assert {"answer", "curves", "path", "steps"} <= set(found.ids)
    assert HOSTILE in found.text


def test_a_run_leaves_no_page_where_none_is_wanted(tmp_path: Path) -> None:
    import fiberbend

    without = parse_case(closed_form() | {"output": {"report": False, "pictures": False}})
    fiberbend.run(without, tmp_path / "run")
    assert not (tmp_path / "run" / REPORT).exists()


def test_a_page_that_cannot_be_made_costs_a_line_not_the_results(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import fiberbend
    from fiberbend.report import run_page

    def broken(*_: Any) -> None:
        raise RuntimeError("no page today")

    monkeypatch.setattr(run_page, "write_report", broken)
    result = fiberbend.run(parse_case(closed_form()), tmp_path / "run", quiet=False)
    assert result.status == "converged"
    assert (tmp_path / "run" / "history.csv").exists()
    text = "no report, writing it failed: RuntimeError: no page today"
    assert text in capsys.readouterr().out
    assert text in json.loads((tmp_path / "run" / "run.json").read_text())["warnings"]
    assert text in result.run["warnings"]


def test_the_command_writes_the_page_where_it_is_asked_to(folder: Path, tmp_path: Path) -> None:
    (folder / "run.log").write_text("a line\n", encoding="utf-8")
    target = tmp_path / "pages" / "my report.html"
    assert main(["report", str(folder), "--out", str(target)]) == 0
    found = Page(target.read_text(encoding="utf-8"))
    (beside,) = [address for tag, address in found.links() if address.endswith("run.log")]
    assert (target.parent / beside).resolve() == folder / "run.log"


def test_the_command_refuses_what_is_no_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["report", str(tmp_path)]) == 1
    assert "contains nothing, expected the folder of a run or a sweep" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_page_that_cannot_be_written_is_one_line(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert main(["report", str(folder), "--out", str(tmp_path / "file" / "page.html")]) == 1
    error = capsys.readouterr().err
    assert error.startswith(f"{tmp_path / 'file'}")
    assert error.endswith("expected a file that can be written\n")
    assert error.count("\n") == 1


def test_open_starts_the_browser_that_is_asked_for(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[str] = []

    def start(url: str) -> bool:
        seen.append(url)
        return True

    monkeypatch.setenv("BROWSER", "true")
    monkeypatch.setattr(opening.webbrowser, "open", start)
    assert main(["report", str(folder), "--open"]) == 0
    assert seen == [(folder / REPORT).as_uri()]


def test_without_a_desktop_open_says_so(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(opening.sys, "platform", "linux")
    assert not opening.open_file(folder / REPORT)
    assert "expected a desktop or BROWSER" in capsys.readouterr().err


def test_help_has_examples(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", "--help"]) == 0
    _, _, examples = capsys.readouterr().out.partition("Examples:")
    assert "fiberbend report runs/section --open" in examples


def test_round_off_is_nothing_beside_a_column() -> None:
    angles = [-1.4e-13, 18.6, 40.0]
    table = steps(
        [{"step": i, "angle_deg": a, "volume_error": 1e-15 * i} for i, a in enumerate(angles)],
        ["angle_deg", "volume_error"],
    )
    assert [line[0] for line in table.rows] == ["0", "18.6", "40"]
    assert [line[1] for line in table.rows] == ["0", "1e−15", "2e−15"]

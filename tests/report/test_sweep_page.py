from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
import yaml

from fiberbend.cli import main
from fiberbend.report.sweep_page import sweep_report
from fiberbend.results.folder import REPORT
from tests.report.test_page import Page, closed_form

TITLE = "Walls <i>and</i> radii"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("sweep")
    base = closed_form() | {"effects": [{"pressure": {"angle": "90 deg"}}, {"hoops": {}}]}
    base |= {"output": {"report": True, "pictures": False}}
    sweep = {
        "title": TITLE,
        "case": base,
        "vary": {"actuator.wall": ["2 mm", "3 mm"], "actuator.radius": ["7 mm", "8 mm"]},
        "report": {"angles": ["90 deg"]},
    }
    (path / "sweep.yaml").write_text(yaml.safe_dump(sweep), encoding="utf-8")
    assert main(["sweep", str(path / "sweep.yaml"), "--out", str(path / "out")]) == 0
    return path / "out"


@pytest.mark.long
def test_a_sweep_leaves_a_page(folder: Path) -> None:
    found = Page((folder / REPORT).read_text(encoding="utf-8"))
    assert {"points", "maps", "trends", "files", "cite"} <= set(found.ids)
    assert TITLE in found.texts
    assert not [tag for tag, _ in found.tags if tag == "i"]
    assert "4 points: 4 converged." in found.text
    maps = [address for tag, address in found.links() if tag == "img"]
    assert len(maps) == len(list((folder / "maps").iterdir())) > 0
    assert all(address.startswith("data:image/png;base64,") for address in maps)
    assert "Pressure at 90°." in found.texts


def test_points_lead_to_their_reports(folder: Path) -> None:
    found = Page((folder / REPORT).read_text(encoding="utf-8"))
    links = [address for tag, address in found.links() if address.startswith("./points/")]
    assert len(links) == 4
    assert all((folder / link).is_file() for link in links)


def test_nothing_is_fetched(folder: Path) -> None:
    found = Page((folder / REPORT).read_text(encoding="utf-8"))
    for tag, address in found.links():
        assert address.startswith(("data:", "#", "./", "https://doi.org/"))
        assert tag == "a" or address.startswith("data:")


def test_the_command_makes_it_anew(folder: Path, tmp_path: Path) -> None:
    path = shutil.copytree(folder, tmp_path / "out")
    (path / REPORT).unlink()
    assert main(["report", str(path)]) == 0
    found = Page((path / REPORT).read_text(encoding="utf-8"))
    assert "4 points: 4 converged." in found.text


def test_failures_and_what_is_hostile_in_files_stay_text(folder: Path, tmp_path: Path) -> None:
    path = shutil.copytree(folder, tmp_path / "out")
    table = (path / "sweep.csv").read_text(encoding="utf-8")
    head, first, *rest = table.splitlines()
    values = first.split(",")
    columns = head.split(",")
    values[columns.index("status")] = "failed"
    values[columns.index("reason")] = "<script>alert(2)</script>"
    (path / "sweep.csv").write_text("\n".join([head, ",".join(values), *rest]), encoding="utf-8")
    (path / "trends.md").write_text("# T\n\n<script>alert(3)</script>\n\n| a |\n|---|\n| 1 |\n")
    about = {"title": TITLE, "notes": ["<b>note</b>"], "quantities": []}
    (path / "sweep.json").write_text(json.dumps(about), encoding="utf-8")
    found = Page(sweep_report(path))
    assert "1 point failed" in found.text
    assert f"{values[0]}: <script>alert(2)</script>" in found.text
    assert "<script>alert(3)</script>" in found.text
    assert "<b>note</b>" in found.text
    assert [tag for tag, _ in found.tags if tag in ("script", "b")] == []
    assert found.scripts != []

"""The actuator at rest: the layers over x = 0 are those of the case, and obstacles are in view."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fiberbend.api.show import blueprint, facts
from fiberbend.cli import main
from fiberbend.reader.reader import read_case
from fiberbend.states.obstacles import Sheet

CASES = Path(__file__).resolve().parents[2] / "cases"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("section", [("sheath", 1), ("floor", 2), ("", 8), ("wall", 2), ("sheath", 1)]),
        ("rectangle", [("sheath", 1), ("floor", 2), ("", 8), ("wall", 2), ("sheath", 1)]),
        (
            "circle",
            [("sheath", 1), ("floor", 1), ("wall", 1), ("", 16), ("wall", 2), ("sheath", 1)],
        ),
    ],
)
def test_layers_are_those_of_the_case(name: str, expected: list[tuple[str, float]]) -> None:
    layers = blueprint(read_case(CASES / f"{name}.yaml")).layers
    assert [(region, pytest.approx(high - low)) for region, low, high in layers] == expected
    for (_, _, high), (_, low, _) in itertools.pairwise(layers):
        assert low == pytest.approx(high)


def test_facts_name_what_there_is() -> None:
    found = dict(facts(read_case(CASES / "grasp.yaml")))
    assert found["obstacle"] == "cylinder"
    assert found["caps"] == "15 mm each; 190 mm in all"
    assert "radius 8 mm" in found["section"]
    assert "53.3 turns" in found["winding"]
    # half a disk of radius 8, 160 long
    assert found["chamber"] == "160 mm long, 16.1 mL"


@pytest.mark.parametrize("name", ["grasp", "grasp_table", "blocked_contact", "circle"])
def test_every_obstacle_is_drawn(name: str, tmp_path: Path) -> None:
    target = tmp_path / "rest.png"
    case = CASES / f"{name}.yaml"
    assert main(["show", str(case), "--out", str(target)]) == 0
    with Image.open(target) as image:
        pixels = np.asarray(image.convert("RGB"), dtype=int)
    # the obstacles' own grey in the view from the side: in space they are seen through
    grey = int((pixels == 0xD9).all(axis=2).sum())
    has = bool(blueprint(read_case(case)).scenery.shapes)
    assert (grey > 300) == has


def test_show_refuses_what_it_cannot_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = str(CASES / "section.yaml")
    assert main(["show", case, "--out", str(tmp_path / "a.jpg")]) == 1
    assert ".png" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["show", case, "--out", str(tmp_path / "file" / "a.png")]) == 1


@pytest.mark.parametrize("name", ["section", "grasp", "grasp_table", "blocked_contact"])
def test_the_page_is_as_high_as_what_it_shows(name: str, tmp_path: Path) -> None:
    target = tmp_path / "rest.png"
    assert main(["show", str(CASES / f"{name}.yaml"), "--out", str(target)]) == 0
    with Image.open(target) as image:
        empty = (np.asarray(image.convert("L")) > 250).all(axis=1)
    # rows of white one after the other
    runs = [len(list(rows)) for white, rows in itertools.groupby(empty) if white]
    # the table is 40 mm below the body
    assert max(runs) < 150


@pytest.mark.parametrize("normal", [(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 1.0, 1.0)])
def test_the_strip_of_a_plane_is_behind_it(normal: tuple[float, float, float]) -> None:
    drawing = blueprint(read_case(CASES / "grasp_table.yaml"))
    plane = Sheet((0.0, -40.0, 20.0), normal)
    away = (drawing._strip(plane) - plane.point) @ np.array(normal)
    assert away.max() == pytest.approx(0.0, abs=1e-9)
    assert away.min() == pytest.approx(-3.0 * np.linalg.norm(normal))
    assert len(drawing._strip(Sheet((1.0, 0.0, 0.0), (1.0, 0.0, 0.0)))) == 0

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

CASES = Path(__file__).resolve().parents[2] / "cases"
OBSTACLE, FLOOR = (214, 170, 131), (230, 132, 42)
WALL = "effects.2.contact.plane={point: [0 mm, 0 mm, 195 mm], normal: [0, 0, -1]}"


def columns(image: Image.Image, color: tuple[int, int, int]) -> np.ndarray:
    """Columns of the pixels of a colour in the view from the side, one for each pixel."""
    pixels = np.asarray(image.convert("RGB"), dtype=int)[60:540]
    return np.nonzero((np.abs(pixels - color) < 8).all(axis=2))[1]


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
        brown = len(columns(image, OBSTACLE))
    has = bool(blueprint(read_case(case)).scenery.shapes)
    assert (brown > 300) == has


def test_a_wall_before_the_tip_is_drawn_where_it_is(tmp_path: Path) -> None:
    case, target = read_case(CASES / "grasp_table.yaml", (WALL,)), tmp_path / "rest.png"
    with target.open("wb") as file:
        blueprint(case).save(file)
    with Image.open(target) as image:
        wall, floor = columns(image, OBSTACLE), columns(image, FLOOR)
    per_mm = np.ptp(floor) / 190.0
    # from the tip, at 175 mm, to the wall, whose strip is thin
    beyond = (wall - floor.max()) / per_mm
    assert beyond.min() == pytest.approx(20.0, abs=2.0)
    assert np.ptp(beyond) < 20.0


def test_show_refuses_what_it_cannot_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = str(CASES / "section.yaml")
    assert main(["show", case, "--out", str(tmp_path / "a.jpg")]) == 1
    assert ".png" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["show", case, "--out", str(tmp_path / "file" / "a.png")]) == 1

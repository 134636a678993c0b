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
        red, green, blue = np.asarray(image.convert("RGB"), dtype=int)[60:540].transpose(2, 0, 1)
    # the obstacles' own brown over white, alone in the upper half
    warm, pale = red - green, green - blue
    brown = int(((warm > 15) & (warm < 80) & (pale > 25) & (pale < 70)).sum())
    has = bool(blueprint(read_case(case)).scenery.shapes)
    assert (brown > 300) == has


def test_show_refuses_what_it_cannot_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = str(CASES / "section.yaml")
    assert main(["show", case, "--out", str(tmp_path / "a.jpg")]) == 1
    assert ".png" in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert main(["show", case, "--out", str(tmp_path / "file" / "a.png")]) == 1

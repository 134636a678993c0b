"""What an actuator may do by its symmetry, and what a sweep tells of it at a pressure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.answer.motion import BEND, SIDE, STRETCH, TWIST
from fiberbend.answer.moves import bends, moves
from fiberbend.reader.reader import as_case, read_case
from fiberbend.sweep.points import read_sweep
from fiberbend.sweep.quantities import quantities
from fiberbend.sweep.store import Store
from fiberbend.sweep.table import collect
from tests.conftest import ROOT

CASES = ROOT / "cases"


def tube(*effects: dict[str, Any], name: str = "twisting") -> Any:
    """A tube with further effects."""
    data = yaml.safe_load((CASES / f"{name}.yaml").read_text(encoding="utf-8"))
    data["effects"] += effects
    return as_case(data)


def strip(at: str) -> dict[str, Any]:
    return {"strip": {"at": at, "width": "3 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}}


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("twisting", (TWIST,)),
        ("extending", (STRETCH,)),
        ("contracting", (STRETCH,)),
        ("free_bending", (BEND,)),
        ("single_helix", (BEND, TWIST)),
    ],
)
def test_of_shipped_cases(name: str, wanted: tuple[Any, ...]) -> None:
    assert moves(read_case(CASES / f"{name}.yaml")) == wanted


def test_a_strip_bends_toward_its_side() -> None:
    """Below in the plane, at the side out of it; beside a family of threads both with a twist."""
    assert moves(tube(strip("bottom"), name="extending")) == (BEND,)
    assert moves(tube(strip("right"), name="extending")) == (SIDE,)
    assert moves(tube(strip("bottom"))) == (BEND, TWIST)
    assert moves(tube(strip("right"))) == (SIDE, TWIST)


def test_what_is_held_is_no_motion() -> None:
    held = {"hold": {"twist": "0 deg"}}
    data = yaml.safe_load((CASES / "twisting.yaml").read_text(encoding="utf-8"))
    data["effects"].insert(0, held)
    assert moves(as_case(data)) == (STRETCH,)


def test_zones_move_each_by_itself() -> None:
    thumb = read_case(CASES / "thumb.yaml")
    assert [each.name for each in moves(thumb)] == [
        "stretch of zone 1",
        "angle of zone 2",
        "twist of zone 3",
    ]
    assert bends([thumb])
    assert not bends([read_case(CASES / "twisting.yaml")])


def test_a_sweep_of_tubes_tells_their_twist(tmp_path: Path) -> None:
    """No column of angles that are all zero; where one point bends there is one."""
    data: dict[str, Any] = {
        "case": str(CASES / "twisting.yaml"),
        "set": {"model": "section", "effects.1.winding.as": "smeared", "output": {}},
        "vary": {"effects.1.winding.families.0.starts": [3, 6]},
        "report": {"pressures": ["10 kPa"]},
    }
    path = tmp_path / "sweep.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    sweep = read_sweep(path)
    rows = collect(sweep, Store(Path("nowhere")))
    assert "twist_10kPa_deg" in rows[0]
    assert not any(name.startswith(("angle_10kPa", "stretch_10kPa")) for name in rows[0])
    known = [{**row, "twist_10kPa_deg": 15.0, "solved_by": "section"} for row in rows]
    assert [each.label for each in quantities(sweep.report, known)] == ["twist at 10 kPa"]
    base = yaml.safe_load((CASES / "twisting.yaml").read_text(encoding="utf-8"))
    base["effects"].append(strip("bottom"))
    data |= {"case": base, "vary": {"effects.2.strip.at": ["bottom", "right"]}}
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    bent = collect(read_sweep(path), Store(Path("nowhere")))
    for row in bent:
        assert {"angle_10kPa_deg", "side_angle_10kPa_deg", "twist_10kPa_deg"} <= row.keys()

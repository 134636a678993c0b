"""A sweep over the angle and the number of threads of a tube."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest
import yaml

from fiberbend.sweep.command import run_sweep
from materials.named.table import named_material, named_thread
from tests.conftest import ROOT
from tests.verify.helix_tube import HelixTube

FAMILY = "effects.1.winding.families.0"


def test_a_sweep_over_angle_and_starts(tmp_path: Path) -> None:
    shipped = yaml.safe_load((ROOT / "cases/sweeps/fiber_angle.yaml").read_text(encoding="utf-8"))
    shipped["case"] = str(ROOT / "cases/twisting.yaml")
    shipped["set"]["effects.0"] = {"pressure": {"to": "6 kPa"}}
    shipped["vary"] = {
        f"{FAMILY}.angle_from_axis": ["30 deg", "45 deg", "60 deg"],
        f"{FAMILY}.starts": [3, 12],
    }
    shipped["report"] |= {"pressures": ["6 kPa"]}
    path, said = tmp_path / "six.yaml", list[str]()
    path.write_text(yaml.safe_dump(shipped), encoding="utf-8")
    assert run_sweep(path, tmp_path / "out", say=said.append) == 0, said
    with (tmp_path / "out" / "sweep.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    given = [(row["angle_from_axis_deg"], row["starts"]) for row in rows]
    assert given == [(angle, starts) for angle in ("30", "45", "60") for starts in ("3", "12")]
    c, fiber = named_material("dragon-skin-30").parameters, named_thread("kevlar").stiffness
    for row in rows:
        pitch = 2 * math.pi * 6.5 / math.tan(math.radians(float(row["angle_from_axis_deg"])))
        tube = HelixTube(c["c1"], c["c2"], 5.0, 6.5, pitch, int(row["starts"]) * fiber, (-1,))
        stretch, twist = tube.at_pressure(0.006)
        assert float(row["axis_stretch"]) == pytest.approx(stretch, rel=1e-5)
        assert float(row["twist_deg"]) == pytest.approx(math.degrees(100 * twist), rel=2e-3)
        # a tube does not bend: it is asked for its twist
        assert "angle_6kPa_deg" not in row
        assert float(row["twist_6kPa_deg"]) == pytest.approx(float(row["twist_deg"]), rel=1e-9)
    trends = (tmp_path / "out" / "trends.md").read_text(encoding="utf-8")
    assert "angle from axis 30 to 60 deg: stays within 1 % in both groups" in trends
    assert "angle from axis 30 to 60 deg: rises in both groups" in trends
    assert {path.name for path in (tmp_path / "out" / "maps").iterdir()} == {
        "end_twist_deg.png",
        "end_axis_stretch.png",
    }

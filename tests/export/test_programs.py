"""What PyElastica and MuJoCo make of the files, beside this project's rod with the same law."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fiberbend.export import mjcf
from rod.functions import Floats
from tests.export import rods

pytestmark = pytest.mark.skipif(
    not rods.PYTHON.exists(), reason="`make robots` makes the environment of PyElastica and MuJoCo"
)
KPA = 90.0
LOADS = {
    "free": ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "weight down": ((0.0, -9.81, 0.0), (0.0, 0.0, 0.0)),
    "weight along": ((0.0, 0.0, -9.81), (0.0, 0.0, 0.0)),
    "force up": ((0.0, 0.0, 0.0), (0.0, 0.15, 0.0)),
    "weight aside": ((9.81, 0.0, 0.0), (0.0, 0.0, 0.0)),
}


def arguments(load: str) -> list[str]:
    gravity, force = LOADS[load]
    numbers = [f"{part:g}" for part in (*gravity, *force)]
    return ["--pressure", f"{KPA:g}", "--gravity", *numbers[:3], "--tip-force", *numbers[3:]]


def expected(load: str, lever: float = rods.LEVER) -> tuple[Floats, float]:
    gravity, force = LOADS[load]
    x, y, z = (1e3 * part for part in gravity)
    state = rods.rested(1e-3 * KPA, (x, y, z), force, lever)
    return state.shape.places[-1], rods.angle_of(state)


@pytest.mark.parametrize("load", LOADS)
def test_mujoco_rests_where_the_rod_does(load: str, tmp_path: Path) -> None:
    rods.write(tmp_path, "mujoco")
    found = rods.run(tmp_path, "rod_mujoco.py", *arguments(load))
    place, angle = expected(load)
    assert found["tip_angle_deg"] == pytest.approx(angle, rel=1e-3)
    assert found["tip_mm"] == pytest.approx(place, abs=0.15)
    assert found["speed"] < 1e-3


@pytest.mark.parametrize(
    ("load", "lever"), [("free", rods.LEVER), ("weight along", rods.LEVER), ("weight aside", 0.0)]
)
def test_pyelastica_rests_where_the_rod_does(load: str, lever: float, tmp_path: Path) -> None:
    """It shears a little, and its caps do not turn under a force along them.

    It twists about its own line, which is that of the centroids where the lever is none.
    """
    rods.write(tmp_path, "pyelastica", rods.handed(rods.section(lever)))
    found = rods.run(tmp_path, "rod_pyelastica.py", *arguments(load), "--elements", "20")
    place, angle = expected(load, lever)
    assert found["tip_angle_deg"] == pytest.approx(angle, rel=2e-3)
    assert found["tip_mm"] == pytest.approx(place, abs=1.0)
    assert found["speed_mm_per_s"] < 0.5


def test_mujocos_control_alone_is_off_by_what_the_file_says(tmp_path: Path) -> None:
    made = rods.write(tmp_path, "mujoco")
    line = mjcf.line_of(made)
    off, stiff = 100 * line.rest_off[1], 100 * line.stiffness_off[1]
    said = " ".join((tmp_path / "rod.xml").read_text(encoding="utf-8").split())
    assert f"without load is off by up to {off:.2g} % of the greatest" in said
    assert f"bending stiffness by {stiff:.2g} %" in said
    found = rods.run(tmp_path, "rod_mujoco.py", *arguments("free"), "--as-actuator")
    pressures = made["section"]["pressure_kPa"]
    greatest = max(made["section"]["rest_curvature_1_per_mm"])
    _, angle = expected("free")
    apart = math.radians(abs(found["tip_angle_deg"] - angle))
    at = float(np.interp(KPA, pressures, made["section"]["rest_curvature_1_per_mm"]))
    chamber = abs(line.slope[1] * KPA * 1e-3 - at) * rods.LENGTH
    assert 0 < chamber <= 1.001 * line.rest_off[1] * greatest * rods.LENGTH
    # what the ends turn is linear in the control too
    turns, p = mjcf.turns_of(made), np.array(pressures)
    ends = abs(p @ turns / (p @ p) * KPA - float(np.interp(KPA, p, turns)))
    assert 0 < ends <= mjcf.ends_off(made) * np.abs(turns).max()
    assert f"that of the ends by {100 * mjcf.ends_off(made):.2g} %" in said
    assert apart == pytest.approx(chamber + ends, rel=0.02)


@pytest.mark.parametrize("script", ["rod_mujoco.py", "rod_pyelastica.py"])
def test_a_pressure_beyond_the_table_is_refused(script: str, tmp_path: Path) -> None:
    rods.write(tmp_path, script[4:-3])
    with pytest.raises(AssertionError, match=r"rod\.json reaches from 0 to 200 kPa"):
        rods.run(tmp_path, script, "--pressure", "250")

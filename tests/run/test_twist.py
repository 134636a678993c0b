"""Angle, side angle, twist and tip under a winding with a hand, in every model."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.path import section_axes
from fiberbend import run
from fiberbend.case import convert
from fiberbend.models.choice import meshed
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import as_case
from fiberbend.schema.problems import CaseError
from geometry.mesh.centroid import section_fit
from tests.run.conftest import small
from tests.verify.helix_tube import HelixTube

INNER, OUTER, CAP = 6.35, 8.35, 15.0
MODULUS, DIAMETER = 31067.0, 0.1778
NO_FILES = {"fields": False, "pictures": False}


def _tube(pitch: float, hand: int, pressure: float, model: str = "section") -> dict[str, Any]:
    pattern = {1: "single-helix-right", -1: "single-helix-left"}[hand]
    fiber = {"modulus": f"{MODULUS} MPa", "diameter": f"{DIAMETER} mm"}
    winding = {"pattern": pattern, "pitch": f"{pitch} mm", "fiber": fiber, "as": "smeared"}
    return {
        "title": "A tube that twists",
        "actuator": {
            "section": "circle",
            "radius": f"{INNER} mm",
            "length": "320 mm",
            "wall": f"{OUTER - INNER} mm",
        },
        "materials": {"wall": {"law": "neo-hooke", "mu": "0.24 MPa"}},
        "effects": [{"pressure": {"to": f"{pressure} kPa"}}, {"winding": winding}],
        "model": model,
        "output": NO_FILES,
    }


@pytest.mark.parametrize(
    ("from_axis", "pressure", "hand"),
    [(60.0, 62.05, 1), (60.0, 62.05, -1), (30.0, 20.0, -1), (10.0, 10.0, 1)],
)
def test_a_round_tube_with_one_helix_stays_straight(
    from_axis: float, pressure: float, hand: int
) -> None:
    # its exact state is extension, inflation and torsion; the lowest line alone is a helix, whose
    # curvature was reported as a bend of up to hundreds of degrees
    pitch = 2 * math.pi * OUTER / math.tan(math.radians(from_axis))
    result = run(_tube(pitch, hand, pressure))
    area = math.pi * (DIAMETER / 2) ** 2
    exact = HelixTube(0.12, 0.0, INNER, OUTER, pitch, MODULUS * area, (hand,))
    stretch, turn = exact.at_pressure(1e-3 * pressure)
    end = result.rows[-1]
    assert (result.status, end["pressure_kPa"]) == ("converged", pytest.approx(pressure))
    assert end["twist_deg"] == pytest.approx(math.degrees(turn * 320), rel=1e-3)
    assert end["axis_stretch"] == pytest.approx(stretch, rel=1e-4)
    assert (end["angle_deg"], end["side_angle_deg"]) == pytest.approx((0, 0), abs=1e-4)
    # on the axis, ahead by the stretched length and the cap
    ahead = 320 * end["axis_stretch"] + CAP
    tip = [end[f"tip_{axis}_mm"] for axis in "xyz"]
    assert tip == pytest.approx([0.0, OUTER, ahead], abs=1e-4)
    assert end["floor_stretch"] == pytest.approx(end["crown_stretch"], rel=1e-6)
    assert end["floor_stretch"] > end["axis_stretch"]
    # the angle is unwrapped: no row is a full turn off
    twist = np.array([row["twist_deg"] for row in result.rows])
    assert np.all(np.diff(hand * np.sign(turn * hand) * twist) > 0)


def _finger(hand: str = "left", load: dict[str, str] | None = None, **changes: Any) -> RunResult:
    winding = {"pattern": f"single-helix-{hand}", "pitch": "6 mm", "fiber": "kevlar"}
    effects = [{"pressure": load or {"to": "60 kPa"}}, {"winding": winding | {"as": "smeared"}}]
    case = small(effects=effects, model="section", mesh={"section": 1}, output=NO_FILES)
    case["actuator"] |= {"length": "80 mm", "cap": "15 mm"}
    return run(case | changes)


def test_the_other_hand_is_the_mirror_image() -> None:
    left, right = _finger("left"), _finger("right")
    assert len(left.rows) == len(right.rows)
    for name, sign in (
        *(("angle_deg", 1), ("twist_deg", -1), ("tip_x_mm", -1), ("tip_y_mm", 1), ("tip_z_mm", 1)),
        *(("axis_stretch", 1), ("floor_stretch", 1), ("crown_stretch", 1), ("chamber_mm3", 1)),
    ):
        assert left.last(name) == pytest.approx(sign * right.last(name), rel=1e-9), name
    assert left.last("twist_deg") > 10
    assert left.last("tip_x_mm") > 1
    assert left.last("side_angle_deg") == pytest.approx(0, abs=1e-9)
    # the floor hardly stretches, the crown most; the centroid is between
    stretches = [left.last(f"{line}_stretch") for line in ("floor", "axis", "crown")]
    assert stretches == sorted(stretches)


def test_requested_angles_are_hit_under_twist() -> None:
    output = NO_FILES | {"at_angles": ["15 deg", "30 deg"]}
    by_angle = _finger(load={"angle": "40 deg"}, output=output)
    assert by_angle.status == "converged"
    assert by_angle.last("angle_deg") == pytest.approx(40, abs=1e-6)
    stopped = _finger(load={"to": "90 kPa"}, output=output | {"stop_at_angle": "40 deg"})
    assert stopped.last("angle_deg") == pytest.approx(40, abs=1e-6)
    assert stopped.last("pressure_kPa") == pytest.approx(by_angle.last("pressure_kPa"), rel=1e-6)
    for rows in (by_angle.rows, stopped.rows):
        for angle in (15, 30):
            assert min(abs(row["angle_deg"] - angle) for row in rows) < 1e-6


def test_the_tip_is_that_of_the_runs_own_fields(tmp_path: Path) -> None:
    # the body of the file ends where the cap begins: its last section, the cap straight across it
    import pyvista as pv

    case = small(
        effects=[{"pressure": {"to": "60 kPa"}}, {"winding": _winding("6 mm")}],
        model="section",
        mesh={"section": 1},
        output={"fields": True, "pictures": False},
    )
    case["actuator"] |= {"length": "40 mm", "cap": "15 mm"}
    result = run(case, tmp_path / "run")
    assert result.folder is not None
    grid = pv.read(result.folder / "fields" / "last.vtm")["body"].combine()
    rest = np.asarray(grid.points, dtype=float)
    placed = rest + grid.point_data["displacement_mm"]
    checked = as_case(case)
    mesh = meshed(checked).mesh(checked)
    rows, _, centre = section_fit(mesh)
    used = np.flatnonzero(np.any(rows != 0, axis=0))

    def fit(sign: float) -> np.ndarray:
        wanted = np.column_stack([mesh.nodes[used] * [sign, 1], np.full(len(used), 40.0)])
        gap = np.linalg.norm(rest[None] - wanted[:, None], axis=2)
        assert gap.min(axis=1).max() < 1e-5
        moved: np.ndarray = rows[:, used] @ placed[gap.argmin(axis=1)]
        return moved

    # the image's own a_x points to the other side
    c, a_x, a_y = (fit(1.0) + fit(-1.0) * [[1], [-1], [1]]) / 2
    axes = section_axes(a_x, a_y, np.cross(a_x, a_y))
    face = convert.dimensions(checked.actuator).face_height
    tip = c + axes @ [0.0, face - centre[1], 15.0]
    assert [result.last(f"tip_{axis}_mm") for axis in "xyz"] == pytest.approx(tip, abs=1e-5)
    assert abs(result.last("tip_x_mm")) > 0.1


def test_a_held_round_tube_pushes_along_its_axis_only() -> None:
    # the force was taken about the lowest line: a tip force of 2.3 N on a tube that has none
    case = {
        "title": "A held round tube",
        "actuator": {"section": "circle", "radius": "8 mm", "length": "100 mm", "wall": "2 mm"},
        "materials": {"wall": {"law": "neo-hooke", "mu": "0.22 MPa"}},
        "effects": [{"pressure": {"to": "0.3 bar"}}, {"straight": {"stretch": "held"}}],
        "model": "section",
        "output": NO_FILES,
    }
    end = run(case).rows[-1]
    assert end["axial_force_N"] == pytest.approx(2.811, rel=1e-3)
    assert end["tip_force_N"] == pytest.approx(0.0, abs=1e-9)
    assert end["blocked_moment_Nmm"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("model", ["section", "cell"])
def test_kept_straight_a_winding_with_a_hand_is_refused(model: str) -> None:
    case = _tube(30.29, 1, 10.0, model)
    case["effects"].append({"straight": {}})
    with pytest.raises(CaseError, match=r"effects\.2\.straight.*winding with a hand"):
        run(case)


def _round(model: str, **changes: Any) -> RunResult:
    """A short tube with a stiff strip at its lower side, which bends and twists."""
    case = {
        "title": "A tube with a strip",
        "actuator": {
            **{"section": "circle", "radius": "8 mm", "length": "80 mm"},
            **{"wall": "2 mm", "floor": "2 mm", "cap": "15 mm"},
        },
        "materials": {"wall": "elastosil-m4601", "floor": "combined-base"},
        "effects": [
            {"pressure": {"angle": "20 deg"}},
            {"winding": _winding("10 mm")},
        ],
        "model": model,
        "mesh": {"axial": "10 mm"} if model == "body" else {"section": 1},
        "output": NO_FILES | {"at_angles": ["12 deg"]},
    }
    return run(case | changes)


def _winding(pitch: str) -> dict[str, str]:
    return {"pattern": "single-helix-left", "pitch": pitch, "fiber": "kevlar", "as": "smeared"}


@pytest.mark.long
def test_a_body_hits_its_angle_and_twists_as_its_section() -> None:
    body, section = _round("body"), _round("section")
    assert min(abs(row["angle_deg"] - 12) for row in body.rows) < 1e-6
    assert body.last("angle_deg") == pytest.approx(20, abs=1e-6)
    assert body.last("uniform_angle_deg") == pytest.approx(20, rel=0.01)
    assert body.last("uniform_twist_deg") == pytest.approx(section.last("twist_deg"), rel=0.01)
    assert body.last("uniform_side_angle_deg") == pytest.approx(0, abs=0.1)
    assert body.last("axis_stretch") == pytest.approx(section.last("axis_stretch"), rel=2e-3)
    # caps are not free to warp: less than the middle
    assert 0.9 < body.last("twist_deg") / section.last("twist_deg") < 1


@pytest.mark.verify
def test_a_body_under_twist_is_its_section() -> None:
    # long enough for the ends to fade: angle, side angle and twist of the middle to 1 %, the tip to
    # 1 mm of 175 mm, of which the ends' own bend of a tenth of a degree is most
    load = {"to": "18 kPa"}
    actuator = small()["actuator"] | {"length": "160 mm", "cap": "15 mm"}
    section = _finger(load=load, actuator=actuator)
    body = _finger(load=load, actuator=actuator, model="body", mesh={"axial": "6 mm"})
    for name in ("angle_deg", "twist_deg"):
        assert body.last(f"uniform_{name}") == pytest.approx(section.last(name), rel=0.01), name
    assert body.last("angle_deg") == pytest.approx(section.last("angle_deg"), rel=0.01)
    assert body.last("side_angle_deg") == pytest.approx(0, abs=0.1)
    assert body.last("uniform_side_angle_deg") == pytest.approx(0, abs=0.1)
    tips = [np.array([run.last(f"tip_{axis}_mm") for axis in "xyz"]) for run in (body, section)]
    assert np.linalg.norm(tips[0] - tips[1]) < 1.0
    assert section.last("angle_deg") > 30
    assert section.last("twist_deg") > 20

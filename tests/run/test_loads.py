"""Loads on the tip and uniform bends that are held, through whole runs."""

from __future__ import annotations

import math
from typing import Any

import pytest

from fiberbend import Result, run
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError

QUIET = {"pictures": False, "fields": False, "report": False}
SOFT = {"law": "neo-hooke", "mu": "0.3 MPa", "density": "1.1 g/cm^3"}
TUBE: dict[str, Any] = {
    "actuator": {
        "section": "circle",
        "radius": "3 mm",
        "wall": "2 mm",
        "length": "64 mm",
        "cap": "8 mm",
    },
    "materials": {"wall": {"law": "neo-hooke", "mu": "0.3 MPa"}},
    "mesh": {"axial": "8 mm"},
    "output": QUIET,
}
"""A bare tube, slender enough for beam theory."""
WOUND: dict[str, Any] = {
    "actuator": {"radius": "8 mm", "length": "40 mm", "wall": "2 mm", "floor": "2 mm"},
    "materials": {"wall": SOFT, "floor": {"law": "neo-hooke", "mu": "16 MPa"}},
    "output": QUIET,
}
EI = 3 * 0.3 * math.pi * (5**4 - 3**4) / 4
"""Of the tube, N mm²."""


def load(*force: str, moment: tuple[str, str, str] | None = None, **more: Any) -> dict[str, Any]:
    """A tip load."""
    parts: dict[str, Any] = {"force": list(force)} if force else {}
    return {"tip-load": parts | ({"moment": list(moment)} if moment else {}) | more}


def solve(base: dict[str, Any], *effects: dict[str, Any], **more: Any) -> Result:
    """Run a case that converges."""
    result = run(parse_case(base | {"effects": list(effects)} | more))
    assert result.status == "converged", result.run["reason"]
    return result


def refused(base: dict[str, Any], *effects: dict[str, Any], **more: Any) -> str:
    """Why a case is refused."""
    with pytest.raises(CaseError) as caught:
        parse_case(base | {"effects": list(effects)} | more)
    return str(caught.value)


def test_a_force_is_held_by_the_clamp_and_bends_as_a_beam() -> None:
    row = solve(TUBE, load("0 N", "-50 mN", "20 mN")).rows[-1]
    assert row["clamp_force_y_N"] == pytest.approx(0.05, rel=1e-9)
    assert row["clamp_force_z_N"] == pytest.approx(-0.02, rel=1e-9)
    assert row["axial_force_N"] == row["clamp_force_z_N"]
    # about the origin: −r × F, r the tip's centroid
    about = 0.02 * row["tip_y_mm"] + 0.05 * row["tip_z_mm"]
    assert row["clamp_moment_x_Nmm"] == pytest.approx(-about, rel=1e-8)
    assert max(row["balance_force"], row["balance_moment"]) < 1e-8
    assert row["unstable_modes"] == 0


def test_a_pure_moment_bends_evenly() -> None:
    row = solve(TUBE, load(moment=("2 N*mm", "0 N*mm", "0 N*mm"))).rows[-1]
    # strains of 4 %, neo-Hooke: the tangent modulus grows by less
    assert math.radians(row["angle_deg"]) == pytest.approx(2 * 64 / EI, rel=5e-3)
    assert row["clamp_moment_x_Nmm"] == pytest.approx(-2, rel=1e-8)
    assert row["moment_x_Nmm"] == pytest.approx(-2, rel=1e-8)
    assert row["balance_force"] < 1e-8


@pytest.mark.parametrize("follows", [False, True])
def test_half_and_whole_agree_and_work_is_stored(follows: bool) -> None:
    effect = load("0 N", "-40 mN", "10 mN", moment=("1 N*mm", "0 N*mm", "0 N*mm"), follows=follows)
    solver = {"max_turn": "3 deg"}
    half, whole = (
        solve(TUBE, effect, mesh=TUBE["mesh"] | {"symmetry": symmetry}, solver=solver)
        for symmetry in ("half", "full")
    )
    for key in ("tip_y_mm", "tip_z_mm", "angle_deg", "stored_mJ", "work_mJ", "moment_x_Nmm"):
        assert half.rows[-1][key] == pytest.approx(whole.rows[-1][key], rel=1e-7)
    for result in (half, whole):
        assert result.rows[-1]["work_mJ"] == pytest.approx(result.rows[-1]["stored_mJ"], rel=1e-4)
        assert result.run["stability_checked"] is not follows
        assert any("has no potential" in text for text in result.run["warnings"]) is follows


def test_mirrored_loads_give_mirrored_answers() -> None:
    ways = []
    for sign in ("", "-"):
        moment = ("1 N*mm", f"{sign}1 N*mm", f"{sign}2 N*mm")
        ways.append(solve(TUBE, load(f"{sign}10 mN", "-20 mN", "0 N", moment=moment)).rows[-1])
    one, other = ways
    for key in ("tip_y_mm", "tip_z_mm", "angle_deg", "moment_x_Nmm", "axis_stretch"):
        assert one[key] == pytest.approx(other[key], rel=1e-10)
    for key in ("tip_x_mm", "side_angle_deg", "twist_deg", "torque_Nmm", "moment_y_Nmm"):
        assert abs(one[key]) > 0.1
        assert one[key] == pytest.approx(-other[key], rel=1e-10)


def test_a_mass_is_its_weight() -> None:
    weight = {"gravity": {"direction": "-y"}}
    heavy = TUBE | {"materials": {"wall": SOFT}}
    mass = solve(heavy, weight, {"tip-mass": {"mass": "5 g"}})
    force = solve(heavy, weight, load("0 N", f"{-5e-6 * 9810} N", "0 N"))
    for key in ("tip_y_mm", "tip_z_mm", "angle_deg", "clamp_force_y_N", "moment_x_Nmm"):
        assert mass.rows[-1][key] == pytest.approx(force.rows[-1][key], rel=1e-7)
    volume = math.pi * (25 * 80 - 9 * 64)
    expected = 9.81e3 * (5e-6 + 1.1e-9 * volume)
    # quadratic arcs lose 5e-5 of the area
    assert mass.rows[-1]["clamp_force_y_N"] == pytest.approx(expected, rel=1e-4)
    assert mass.rows[-1]["balance_force"] < 1e-7
    text = refused(heavy, {"pressure": {"to": "1 kPa"}}, {"tip-mass": {"mass": "5 g"}})
    assert "weighs nothing without effect gravity" in text


def test_no_load_leaves_a_pressure_as_it_was() -> None:
    pressure = {"pressure": {"to": "10 kPa"}}
    sharp = TUBE | {"model": "body", "solver": {"tolerance": 1e-9}}
    before = solve(sharp, pressure).rows[-1]
    # it comes after the pressure, and is more than the forces that Newton's method leaves
    after = solve(sharp, pressure, load("0 N", "1 mN", "0 N")).rows
    at = next(row for row in after if row["pressure_kPa"] == 10.0)
    for key in ("chamber_mm3", "tip_z_mm", "stored_mJ"):
        assert at[key] == pytest.approx(before[key], rel=1e-10)
    assert not any("load" in key or "clamp" in key for key in before)


def test_loads_that_half_a_body_cannot_have_are_named() -> None:
    for effect, why in (
        (load("1 mN", "0 N", "0 N"), "along x pulls"),
        (load(moment=("0 N*mm", "1 N*mm", "0 N*mm")), "about y or z turns"),
    ):
        assert why in refused(TUBE, effect, mesh={"axial": "8 mm", "symmetry": "half"})
    assert "nothing pulls" in refused(TUBE, load("0 N", "0 N", "0 N"))
    only = load(moment=("1 N*mm", "0 N*mm", "0 N*mm"), follows=True)
    assert "keeps its direction in the plane" in refused(TUBE, only)
    text = refused(TUBE, load("0 N", "1 mN", "0 N"), model="section")
    assert "model section does not support it: only a whole body has a tip" in text


WINDING = {"winding": {"pattern": "double-helix", "pitch": "4 mm", "fiber": "kevlar"}}
SECTION = WOUND | {
    "model": "section",
    "materials": {
        "wall": {"law": "neo-hooke", "mu": "0.3 MPa"},
        "floor": WOUND["materials"]["floor"],
    },
    "mesh": {"section": 1},
}
PRESSURE = {"pressure": {"to": "30 kPa"}}


@pytest.mark.parametrize("stretch", [False, True])
def test_bend_held_at_none_is_straight(stretch: bool) -> None:
    hold = {"hold": {"bend": "0 deg"} | ({"stretch": 1.0} if stretch else {})}
    straight = {"straight": {"stretch": "held"} if stretch else {}}
    new, old = (solve(SECTION, PRESSURE, WINDING, e).rows[-1] for e in (hold, straight))
    for key in ("chamber_mm3", "axis_stretch", "stored_mJ", "moment_x_Nmm"):
        assert new[key] == pytest.approx(old[key], rel=1e-9)
    assert old["blocked_moment_Nmm"] == old["moment_x_Nmm"]
    assert new["axial_force_N"] == pytest.approx(old.get("axial_force_N", 0.0), rel=1e-9)
    assert new["torque_Nmm"] == 0.0


@pytest.mark.parametrize("model", ["section", "cell"])
def test_every_hold_is_kept_and_the_rest_is_free(model: str) -> None:
    hold = {"hold": {"stretch": 1.05, "twist": "20 deg", "bend": "30 deg"}}
    case = SECTION | {"model": model, "solver": {"tolerance": 1e-12}}
    row = solve(case, PRESSURE, hold, WINDING).rows[-1]
    assert row["axis_stretch"] == pytest.approx(1.05, rel=1e-10)
    assert row["twist_deg"] == pytest.approx(20, rel=1e-10)
    assert row["angle_deg"] == pytest.approx(30, rel=1e-10)
    assert all(abs(row[key]) > 0.1 for key in ("axial_force_N", "moment_x_Nmm", "torque_Nmm"))
    assert row["unstable_modes"] == 0
    other = {"hold": {"stretch": 1.05, "twist": "-20 deg", "bend": "30 deg"}}
    mirrored = solve(case, PRESSURE, other, WINDING).rows[-1]
    assert mirrored["torque_Nmm"] == pytest.approx(-row["torque_Nmm"], rel=1e-10)
    assert mirrored["moment_x_Nmm"] == pytest.approx(row["moment_x_Nmm"], rel=1e-10)


def test_the_order_of_hold_and_pressure_does_not_matter_at_the_end() -> None:
    hold = {"hold": {"stretch": 1.08}}
    first = solve(SECTION, hold, PRESSURE, WINDING).rows
    last = solve(SECTION, PRESSURE, hold, WINDING).rows
    for key in ("angle_deg", "axial_force_N", "chamber_mm3", "stored_mJ"):
        assert first[-1][key] == pytest.approx(last[-1][key], rel=1e-7)
    for rows in (first, last):
        assert rows[-1]["work_mJ"] == pytest.approx(rows[-1]["stored_mJ"], rel=2e-2)
    # under pressure, before the hold grows, it is held as at rest
    at = next(row for row in last if row["pressure_kPa"] == 30.0 and row["load_hold"] == 0.0)
    assert at["axis_stretch"] == pytest.approx(1.0, abs=1e-8)
    assert at["axial_force_N"] > 0


def test_volume_drives_it_too_and_an_angle_does_not() -> None:
    hold = {"hold": {"twist": "10 deg"}}
    row = solve(SECTION, hold, {"pressure": {"volume": "7 mL"}}, WINDING).rows[-1]
    assert row["chamber_mm3"] == pytest.approx(7000, rel=1e-7)
    assert row["twist_deg"] == pytest.approx(10, rel=1e-7)
    bend = {"hold": {"bend": "10 deg"}}
    assert "the angle is held" in refused(SECTION, {"pressure": {"angle": "20 deg"}}, bend, WINDING)
    output = QUIET | {"at_angles": ["20 deg"]}
    text = refused(SECTION, PRESSURE, bend, WINDING, output=output)
    assert "output.at_angles.0" in text
    assert "expected one of the two" in refused(SECTION, PRESSURE, hold, {"straight": {}}, WINDING)
    assert "nothing is held" in refused(SECTION, PRESSURE, {"hold": {}}, WINDING)


def test_a_side_bend_is_held() -> None:
    hold = {"hold": {"side_bend": "15 deg"}}
    row = solve(SECTION, PRESSURE, hold, WINDING).rows[-1]
    assert row["side_angle_deg"] == pytest.approx(15, rel=1e-8)
    assert row["moment_y_Nmm"] < -0.1
    assert row["moment_x_Nmm"] == 0.0


@pytest.mark.parametrize(
    "pull", [("0 N", "-0.3 N", "0.1 N"), ("50 mN", "-0.3 N", "0.1 N")], ids=["half", "whole"]
)
@pytest.mark.parametrize("follows", [False, True])
def test_roof_post_and_clamp_hold_a_load_beside_a_blocked_tip(
    pull: tuple[str, str, str], follows: bool
) -> None:
    """Statics: what pulls at the tip is what roof, post and clamp hold beside the pressure."""
    materials = {name: {"law": "neo-hooke", "mu": mu} for name, mu in (("wall", "0.3 MPa"),)}
    materials["floor"] = {"law": "neo-hooke", "mu": "16 MPa"}
    result = solve(
        WOUND,
        {"pressure": {"to": "20 kPa"}},
        {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}},
        {"blocked-tip": {}},
        load(*pull, follows=follows),
        materials=materials,
        mesh={"axial": "4 mm"},
        solver={"tolerance": 1e-10},
    )
    assert result.run["half"] is (pull[0] == "0 N")
    before, row = (next(r for r in rows if r["load_tip_load"] == at) for rows, at in _ends(result))
    # the pressure within closed walls pulls at nothing
    for at in (before, row):
        force = dict.fromkeys("xyz", 0.0)
        if at is row:
            dead = dict(zip("xyz", (float(f.split()[0]) for f in pull), strict=True))
            dead["x"] *= 1e-3
            force = {k: row.get(f"load_tip_force_{k}_N", dead[k]) for k in "xyz"}
        held = at["tip_force_N"] - at["roof_force_N"]
        assert at["clamp_force_y_N"] + held == pytest.approx(-force["y"], abs=3e-10)
        for axis in "xz":
            assert at[f"clamp_force_{axis}_N"] == pytest.approx(-force[axis], abs=3e-10)
        assert max(at["balance_force"], at["balance_moment"]) < 2e-10
    # most of it is on the post, below which it pulls
    assert 0.25 < row["tip_force_N"] - before["tip_force_N"] < 0.4
    assert result.run["stability_checked"] is not follows


def _ends(result: Result) -> tuple[tuple[Any, float], tuple[Any, float]]:
    """The last row without the load, and that with all of it."""
    return ((result.rows[:0:-1], 0.0), (result.rows[::-1], 1.0))


def test_no_angle_is_asked_of_a_bend_that_is_held() -> None:
    """It may be held bent: straight it is not."""
    hold, asked = {"hold": {"bend": "20 deg"}}, QUIET | {"at_angles": ["10 deg"]}
    text = refused(SECTION, PRESSURE, WINDING, hold, output=asked)
    assert "no angle is reached where effects.2.hold keeps the actuator's bend" in text

"""Rods out of their plane beside closed forms: torsion, mirrored loads, side moments, zones."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.running.runner import run_case
from fiberbend.sectionlaw import table
from fiberbend.sectionlaw.law import Free
from fiberbend.slender import actuator
from fiberbend.slender.laws import PLANE, SPACE, cap_law, pieces_of, strains_of
from fiberbend.slender.moments import section_of
from fiberbend.slender.torsion import torsion
from rod.law import Law, Linear
from rod.layout import STRAINS
from tests.slender.rods import ROUND, RUBBER, case, linear, without_ends
from tests.slender.rods import by_law as by_law

Put = Callable[[Law], None]
PRESSED = {"pressure": {"to": "20 kPa"}}
TINY = {"pressure": {"to": "1 Pa"}}
RECTANGLE = {
    "section": "rectangle",
    "width": "16 mm",
    "height": "8 mm",
    "length": "100 mm",
    "wall": "2 mm",
    "floor": "2 mm",
    "cap": "10 mm",
}
EI, EI_SIDE, GJ = 1500.0, 2100.0, 900.0


def in_space(bends: float = 0.0, side: float = EI_SIDE) -> Linear:
    """EA, two EI and GJ; a pressure bends it in its plane."""
    thrust = np.array([90.0, bends, 0.0, 0.0])
    stiffness, rest = np.diag([60.0, EI, side, GJ]), np.array([1.0, 0.0, 0.0, 0.0])
    return Linear(stiffness, rest, area=70.0, thrust=thrust)


def solve(given: Case) -> RunResult:
    result = run_case(given, None)
    assert result.status == "converged", result.reason
    return result


def force(x: float, y: float = 0.0) -> dict[str, Any]:
    return {"tip-load": {"force": [f"{x} N", f"{y} N", "0 N"]}}


def moment(*about: float) -> dict[str, Any]:
    return {"tip-load": {"moment": [f"{each} N mm" for each in about]}}


def test_a_disk_does_not_warp() -> None:
    """GJ = G π R⁴/2, whatever its divisions into parts of one material."""
    given = case(**ROUND)
    law = cap_law(given, section_of(given), SPACE)
    assert law.stiffness[3, 3] == pytest.approx(0.3 * math.pi * 7.0**4 / 2, rel=1e-5)
    np.testing.assert_array_equal(law.stiffness[3, :3], 0.0)
    # alike in all directions
    assert law.stiffness[1, 1] == pytest.approx(law.stiffness[2, 2], rel=1e-6)


def test_a_disk_in_a_ring_has_the_sum_of_both() -> None:
    sheath = {"wall": RUBBER, "sheath": RUBBER | {"mu": "1.2 MPa"}}
    given = case(actuator=ROUND["actuator"] | {"sheath": "1 mm"}, materials=sheath)
    law = cap_law(given, section_of(given), SPACE)
    inner, outer = (math.pi * radius**4 / 2 for radius in (7.0, 8.0))
    assert law.stiffness[3, 3] == pytest.approx(0.3 * inner + 1.2 * (outer - inner), rel=1e-5)


def test_a_rectangle_warps() -> None:
    """Saint-Venant's series of a b × h bar, b ≤ h, wherever its axis lies."""
    mesh = section_of(case(actuator=RECTANGLE)).mesh
    wide, high = np.ptp(mesh.nodes, axis=0).tolist()
    b, h = min(wide, high), max(wide, high)
    odd = range(1, 200, 2)
    series = sum(math.tanh(n * math.pi * h / (2 * b)) / n**5 for n in odd)
    exact = h * b**3 / 3 * (1 - 192 * b / (math.pi**5 * h) * series)
    found = torsion(mesh, dict.fromkeys(mesh.regions, 2.0))
    assert found == pytest.approx(2 * exact, rel=1e-3)
    assert found > 2 * exact


def test_loads_to_the_side_make_it_leave_its_plane() -> None:
    # by itself it bends alike all along, and nothing shears it
    assert strains_of(case(PRESSED)) == PLANE
    assert strains_of(case(PRESSED, force(0.0, 0.1))) == ("shear_y", *PLANE)
    assert strains_of(case(PRESSED, moment(5, 0, 0))) == ("shear_y", *PLANE)
    for load in (force(0.1), moment(0, 5, 0), moment(0, 0, 5), {"gravity": {"direction": "+x"}}):
        assert strains_of(case(PRESSED, load)) == STRAINS


@pytest.mark.parametrize(
    ("load", "mirrored"),
    [
        (force(0.05, 0.02), force(-0.05, 0.02)),
        (moment(3, 4, 5), moment(3, -4, -5)),
        ({"gravity": {"direction": "+x"}}, {"gravity": {"direction": "-x"}}),
    ],
)
def test_mirrored_loads_have_mirrored_answers(
    by_law: Put, load: dict[str, Any], mirrored: dict[str, Any]
) -> None:
    by_law(in_space(500.0))
    one, other = (solve(case(PRESSED, each)).rows[-1] for each in (load, mirrored))
    for key in (col.ANGLE, col.TIP_Y, col.TIP_Z, col.AXIS_STRETCH, col.VOLUME, col.STORED):
        assert one[key] == pytest.approx(other[key], rel=1e-10), key
    for key in (col.SIDE_ANGLE, col.TWIST, col.TIP_X):
        assert abs(one[key]) > 1e-3, key
        assert one[key] == pytest.approx(-other[key], rel=1e-10), key


def test_to_the_side_a_tube_bends_as_it_does_down(by_law: Put) -> None:
    """A quarter of a turn about the axis carries x to y; k_y is toward x, k_x toward −y."""
    by_law(in_space(side=EI))
    sideways = solve(case(TINY, force(0.02), **ROUND)).rows[-1]
    by_law(linear((90.0, 0.0)))
    down = solve(case(TINY, force(0.0, -0.02), **ROUND)).rows[-1]
    assert down[col.ANGLE] > 1
    assert sideways[col.SIDE_ANGLE] == pytest.approx(down[col.ANGLE], rel=1e-6)
    height = section_of(case(**ROUND)).height
    assert sideways[col.TIP_X] == pytest.approx(height - down[col.TIP_Y], rel=1e-6)
    assert sideways[col.TIP_Z] == pytest.approx(down[col.TIP_Z], rel=1e-9)
    assert abs(sideways[col.TWIST]) < 1e-9


def test_a_torque_twists_it_evenly(by_law: Put) -> None:
    """τ = M/GJ of a straight rod, and no unstable modes are told: a torque has no potential."""
    by_law(in_space())
    row = solve(case(TINY, moment(0, 0, 4), **ROUND)).rows[-1]
    assert row[col.TWIST] == pytest.approx(math.degrees(4 / GJ * 100), rel=1e-9)
    assert abs(row[col.ANGLE]) < 1e-9
    assert col.MODES not in row


def test_in_space_free_bending_is_that_in_the_plane(by_law: Put) -> None:
    """A side load of next to nothing changes nothing but what is to the side."""
    by_law(in_space(500.0))
    space = solve(case(PRESSED, force(1e-9))).rows[-1]
    by_law(linear((90.0, 500.0)))
    plane = solve(case(PRESSED)).rows[-1]
    for key in (col.ANGLE, col.TIP_Y, col.TIP_Z, col.VOLUME, col.UNIFORM_ANGLE):
        assert space[key] == pytest.approx(plane[key], rel=1e-9)


def test_zones_follow_one_another(monkeypatch: pytest.MonkeyPatch) -> None:
    """k = P t/EI of each zone over its own length; the angle is their sum."""
    thrusts = iter((500.0, -300.0))

    def law_of(*_of: Any, **_by: Any) -> SimpleNamespace:
        checked = SimpleNamespace(force=0.0, moment=0.0, area=0.0)
        free, law = ((0.02, Free(1.0, 0.0)),), linear((0.0, next(thrusts)))
        return SimpleNamespace(
            law=law, free=free, model="section", solved=1, seconds=0.0, checked=checked, remarks=()
        )

    monkeypatch.setattr(table, "law_of", law_of)
    monkeypatch.setattr(actuator, "along", without_ends)
    zones = [{"length": "40 mm", "floor": RUBBER}, {"length": "60 mm"}]
    given = case(zones=zones)
    assert pieces_of(given, 48) == (19, 29)
    result = solve(given)
    row, parts = result.rows[-1], (0.02 * 500 / EI * 40, -0.02 * 300 / EI * 60)
    for number, part in enumerate(parts, 1):
        assert row[f"zone_{number}_angle_deg"] == pytest.approx(math.degrees(part), rel=1e-9)
        assert row[f"zone_{number}_stretch"] == pytest.approx(1.0, rel=1e-9)
    assert row[col.ANGLE] == pytest.approx(math.degrees(sum(parts)), rel=1e-9)
    assert result.run["section_law"]["states"] == 2


def test_on_a_table_mirrored_loads_have_mirrored_answers(by_law: Put) -> None:
    by_law(in_space(500.0))
    on = {"contact": {"plane": {"point": ["0 mm", "-20 mm", "0 mm"], "normal": [0, 1, 0]}}}
    pulled = (case(PRESSED, on, force(x)) for x in (0.02, -0.02))
    one, other = (solve(each).rows[-1] for each in pulled)
    press, gap = (col.contact("plane", name) for name in ("y_N", "gap_mm"))
    assert one[press] > 0.01
    for key in (press, gap, col.ANGLE, col.TIP_Y, col.TIP_Z):
        assert one[key] == pytest.approx(other[key], rel=1e-8), key
    for key in (col.SIDE_ANGLE, col.TWIST, col.TIP_X):
        assert one[key] == pytest.approx(-other[key], rel=1e-8), key

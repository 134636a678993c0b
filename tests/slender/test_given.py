"""What drives the chamber of a rod: its pressure, its volume or its angle, above zero and below."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.models.result import RunResult
from fiberbend.running.runner import run_case
from fiberbend.schema.problems import CaseError
from fiberbend.slender import actuator
from rod.law import Law
from tests.slender.rods import Softening, case, linear, without_ends
from tests.slender.rods import by_law as by_law

Put = Callable[[Law], None]
WEIGHT = {"gravity": {"direction": "-y"}}
SAME = (col.PRESSURE, col.ANGLE, col.TIP_Y, col.TIP_Z, col.AXIS_STRETCH, col.VOLUME)


def solve(*effects: dict[str, Any], **changes: Any) -> RunResult:
    result = run_case(case(*effects, **changes), None)
    assert result.status == "converged", result.reason
    return result


def in_ml(volume: Any) -> dict[str, Any]:
    return {"pressure": {"volume": f"{1e-3 * volume!r} mL"}}


@pytest.mark.parametrize("given", ["20 kPa", "-20 kPa"])
def test_a_volume_leads_where_its_pressure_does(given: str, by_law: Put) -> None:
    by_law(linear(thrust=(10.0, 500.0)))
    pressed = solve(WEIGHT, {"pressure": {"to": given}}).rows[-1]
    filled = solve(WEIGHT, in_ml(pressed[col.VOLUME])).rows[-1]
    for key in SAME:
        assert filled[key] == pytest.approx(pressed[key], rel=1e-8), key


def test_a_volume_leads_over_the_greatest_pressure(by_law: Put) -> None:
    """To where an angle leads: M = A P up to 20 kPa and down again."""
    law = Softening(**dataclasses.asdict(linear(thrust=(0.0, 500.0))), top=0.01)
    by_law(law)
    bent = solve({"pressure": {"angle": "70 deg"}})
    filled = solve(in_ml(bent.rows[-1][col.VOLUME]))
    for key in SAME:
        assert filled.rows[-1][key] == pytest.approx(bent.rows[-1][key], rel=1e-8), key
    (point,) = filled.run["critical_points"]
    assert point["kind"] == "limit"
    assert filled.rows[-1][col.PRESSURE] < point[col.PRESSURE]


def test_a_vacuum_is_the_mirror_image_of_a_pressure(by_law: Put) -> None:
    """Of a linear law without stretch, whose angle goes with the pressure."""
    by_law(linear(thrust=(0.0, 500.0)))
    one, other = (solve({"pressure": {"to": to}}).rows[-1] for to in ("8 kPa", "-8 kPa"))
    assert one[col.ANGLE] > 10
    assert other[col.ANGLE] == pytest.approx(-one[col.ANGLE], rel=1e-9)
    # the centroid of the tip is on the line but for the mesh that both are found by
    assert other[col.TIP_Z] == pytest.approx(one[col.TIP_Z], abs=2e-6)
    driven = solve({"pressure": {"angle": f"{other[col.ANGLE]!r} deg"}}).rows[-1]
    assert driven[col.PRESSURE] == pytest.approx(-8, rel=1e-8)


def test_a_vacuum_beyond_the_greatest_one_stops_there(by_law: Put) -> None:
    """And the branch beyond is followed as the chamber shrinks, where under pressure it grows."""
    by_law(Softening(**dataclasses.asdict(linear(thrust=(0.0, 500.0))), top=0.01))
    found = {}
    for to in (25, -25):
        result = run_case(case({"pressure": {"to": f"{to} kPa"}}), None)
        assert result.status == "stopped"
        found[to] = result
        assert f"{to} kPa is not reached: limit point at {to * 4 // 5} kPa" in result.reason
    assert "followed to 1/4 of the volume there" in found[-25].reason
    (limit,), (other,) = (each.run["critical_points"] for each in found.values())
    assert other[col.ANGLE] == pytest.approx(-limit[col.ANGLE], rel=1e-3)
    assert found[-25].rows[-1][col.VOLUME] < found[-25].rows[0][col.VOLUME] / 3


@pytest.mark.long
@pytest.mark.parametrize("given", [{"to": "-6 kPa"}, {"volume": "11 mL"}])
def test_between_its_ends_it_is_the_section(
    given: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Under a vacuum, and by a volume of more than that at rest, within 0.1 %."""
    monkeypatch.setattr(actuator, "along", without_ends)
    rod = solve({"pressure": given}).rows[-1]
    section = solve({"pressure": given}, model="section", mesh={"section": 2}).rows[-1]
    assert np.sign(rod[col.ANGLE]) == np.sign(rod[col.PRESSURE]) != 0
    for key in (col.PRESSURE, col.ANGLE, col.VOLUME):
        assert rod[key] == pytest.approx(section[key], rel=1e-3), key


@pytest.mark.long
def test_where_the_section_buckles_under_a_vacuum_the_rod_says_so() -> None:
    text = r"no such free state: it takes no pressure beyond -\d+\.\d+ kPa: "
    with pytest.raises(CaseError, match=text):
        run_case(case({"pressure": {"to": "-80 kPa"}}), None)

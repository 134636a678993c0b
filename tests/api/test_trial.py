"""`fiberbend.trial`: states in a loop of one's own."""

from __future__ import annotations

import pytest

import fiberbend
from fiberbend import CaseError
from fiberbend import columns as col
from tests.trial.cases import checked, run, shipped, under

DATA = under(shipped("section"), angle="100 deg")


def test_rows_by_the_columns_of_a_history() -> None:
    found = fiberbend.trial(
        DATA, angles=["50 deg", "100 deg"], pressures="20 kPa", straight="50 kPa"
    )
    assert (found.status, found.reason) == ("converged", "")
    assert list(found.frame["kept"]) == ["free", "free", "free", "straight"]
    rows = run(DATA, at_angles=["50 deg", "100 deg"]).rows
    for name in (col.PRESSURE, col.AXIS_STRETCH, col.VOLUME, col.FIBER_MAX, col.STORED):
        assert found.rows[1][name] == pytest.approx(rows[-1][name], rel=1e-8)
    assert found.rows[2][col.PRESSURE] == pytest.approx(20.0)
    assert found.rows[3][col.TIP_FORCE] > 0
    assert "tip_force_N" in repr(found)


def test_settings_and_checked_cases() -> None:
    thick = fiberbend.trial(DATA, angles="50 deg", settings={"actuator.wall": "3 mm"})
    thin = fiberbend.trial(checked(DATA), angles="50 deg")
    assert thick.rows[0][col.PRESSURE] > 1.2 * thin.rows[0][col.PRESSURE]


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({}, "no state given"),
        ({"angles": "90 kPa"}, "angles.0"),
        ({"pressures": ["10 kPa", "lots"]}, "pressures.1"),
    ],
)
def test_what_is_wrong_is_said(asked: dict[str, str], message: str) -> None:
    with pytest.raises(CaseError, match=message):
        fiberbend.trial(DATA, **asked)


def test_a_body_is_refused() -> None:
    with pytest.raises(CaseError, match="expected section or cell"):
        fiberbend.trial(DATA | {"model": "body", "mesh": {}}, angles="50 deg")


def test_what_is_not_found_is_left_out() -> None:
    wall = {"wall": {"law": "gent", "mu": "0.3 MPa", "jm": 0.3}}
    data = DATA | {"materials": DATA["materials"] | wall}
    found = fiberbend.trial(data, angles=["40 deg", "4000 deg"])
    assert found.status == "failed"
    assert found.reason
    assert len(found.rows) == 1

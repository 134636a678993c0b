"""Measured columns from CSV files."""

from __future__ import annotations

from pathlib import Path

import pytest

from analytic.table import read_columns

COLUMNS = ("pressure_kPa", "angle_deg")


def test_curve_is_read_from_a_csv(tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text("\ufeffangle_deg, trial,pressure_kPa\n90, a, 78.2\n\n180,b,140.7\n", "utf-8")
    assert read_columns(path, COLUMNS) == [[78.2, 90.0], [140.7, 180.0]]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no column pressure_kPa or angle_deg"),
        ("pressure,angle_deg\n1,2\n", "curve.csv: no column pressure_kPa"),
        ("pressure_kPa,angle_deg\n", "no rows"),
        ("pressure_kPa,angle_deg\n1,2\n3,much\n", "line 3: angle_deg expected, not 'much'"),
        ("pressure_kPa,angle_deg\n1\n", "line 2: angle_deg expected, not None"),
        ("pressure_kPa,angle_deg\ninf,2\n", "line 2: pressure_kPa expected, not 'inf'"),
    ],
)
def test_curve_that_cannot_be_read(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "curve.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        read_columns(path, COLUMNS)

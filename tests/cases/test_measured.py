"""The measured points that a case names: found from anywhere, and refused before anything runs.

A measurement is compared with hours of computation: a file that cannot be used has to be told at
once, by the path of the setting that names it.
"""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.case.measured import Measured, read_measured
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.schema.problems import CaseError

ROOT = Path(__file__).resolve().parents[2]
FREE = ROOT / "cases" / "free_bending.yaml"
BLOCKED = ROOT / "cases" / "blocked_tip.yaml"
ANGLES = "trial,pressure_kPa,angle_deg\n1,45,90\n1,91,180\n"
FORCES = "pressure_kPa,tip_force_N\n50,1.8\n100,3.6\n"


def case_file(folder: Path, source: Path, measured: str) -> Path:
    """An example case that names a measurement."""
    data: dict[str, Any] = yaml.safe_load(source.read_text(encoding="utf-8"))
    data["output"]["measured"] = measured
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    return path


def measured_of(path: Path) -> Measured:
    measured = read_measured(read_case(path))
    assert measured is not None
    return measured


def complaint(path: Path) -> str:
    with pytest.raises(CaseError) as error:
        read_case(path)
    return str(error.value)


def test_angles_and_forces_in_internal_units(tmp_path: Path) -> None:
    (tmp_path / "angles.csv").write_text(ANGLES, encoding="utf-8")
    (tmp_path / "forces.csv").write_text(FORCES, encoding="utf-8")
    angles = measured_of(case_file(tmp_path, FREE, "angles.csv"))
    assert (angles.quantity, angles.source) == ("angle_deg", "angles.csv")
    assert angles.pressure == pytest.approx([0.045, 0.091])
    assert angles.value == pytest.approx([math.pi / 2, math.pi])
    assert angles.shown()[0] == pytest.approx([45, 91])
    assert angles.shown()[1] == pytest.approx([90, 180])
    forces = measured_of(case_file(tmp_path, BLOCKED, "forces.csv"))
    assert forces.quantity == "tip_force_N"
    assert forces.shown()[1] == pytest.approx([1.8, 3.6])


def test_no_measurement_named() -> None:
    assert read_measured(read_case(FREE)) is None


def test_file_is_found_beside_the_case_and_from_its_run_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "angles.csv").write_text(ANGLES, encoding="utf-8")
    path = case_file(tmp_path, FREE, "data/angles.csv")
    monkeypatch.chdir(ROOT)
    case = read_case(os.path.relpath(path))
    # the resolved case lies in the run folder, and must still find it
    assert parse_case(yaml.safe_load(yaml.safe_dump(case.resolved()))) == case
    elsewhere = tmp_path / "runs" / "mine"
    elsewhere.mkdir(parents=True)
    resolved = elsewhere / "case.resolved.yaml"
    resolved.write_text(yaml.safe_dump(case.resolved()), encoding="utf-8")
    assert read_case(resolved) == case


def test_setting_on_the_command_line_is_relative_to_the_working_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "angles.csv").write_text(ANGLES, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    case = read_case(FREE, ["output.measured=angles.csv"])
    assert case.output.measured == str(tmp_path / "angles.csv")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no such file, expected a CSV file with columns pressure_kPa and angle_deg"),
        ("", "no column pressure_kPa or angle_deg, expected columns pressure_kPa and angle_deg"),
        (FORCES, "points.csv: no column angle_deg, expected"),
        ("pressure_kPa,angle_deg\n", "points.csv: no rows, expected"),
        ("pressure_kPa,angle_deg\n45,90\n91,far\n", "line 3: angle_deg expected, not 'far'"),
        ("\x00\x01", "expected columns pressure_kPa and angle_deg"),
    ],
)
def test_file_that_cannot_be_used(content: str | None, message: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "points.csv").write_text(content, encoding="utf-8")
    text = complaint(case_file(tmp_path, FREE, "points.csv"))
    assert text.startswith("output.measured: ")
    assert message in text


def test_measurement_must_fit_the_run(tmp_path: Path) -> None:
    (tmp_path / "points.csv").write_text(ANGLES, encoding="utf-8")
    text = complaint(case_file(tmp_path, BLOCKED, "points.csv"))
    assert text.startswith("output.measured: points.csv: no column tip_force_N")
    path = case_file(tmp_path, FREE, "points.csv")
    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    data["effects"][0] = {"gravity": {"direction": "-y"}}
    data["materials"]["floor"] = {"name": "combined-base", "density": "1.2 g/cm^3"}
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    text = complaint(path)
    assert text.startswith("output.measured: no effect without pressure, expected no value (line ")


def test_path_must_be_text(tmp_path: Path) -> None:
    path = case_file(tmp_path, FREE, "points.csv")
    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    data["output"]["measured"] = 3
    path.write_text(yaml.safe_dump(data), encoding="utf-8")
    assert complaint(path).startswith("output.measured: 3, expected text (line ")

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


def case_file(folder: Path, source: Path, measured: Any) -> Path:
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
    assert case.output.measured is not None
    assert case.output.measured.file == str(tmp_path / "angles.csv")
    assert case.resolved()["output"]["measured"] == str(tmp_path / "angles.csv")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "no such file, expected a CSV file with columns pressure_kPa and angle_deg"),
        ("", "points.csv: no rows, expected a line of names and lines of numbers"),
        (
            FORCES,
            "points.csv: no column angle_deg, found columns 'pressure_kPa', 'tip_force_N' between "
            "commas, expected angle_deg, a name such as 'theta [deg]', or the column's name as "
            "angle in output.measured",
        ),
        ("pressure_kPa,angle_deg\n", "points.csv: no rows, expected"),
        (
            "pressure_kPa,angle_deg\n45,90\n91,far\n",
            "points.csv, line 3: 'angle_deg' is 'far', expected a number",
        ),
        ("P;theta [deg]\n45;90\n", "column 'P' has no unit, expected a name such as 'P [kPa]'"),
        ("P [kPa];theta\n45;90\n", "column 'theta' has no unit, expected a name such as"),
        ("P [psig];theta [deg]\n4;90\n", "column 'P [psig]' in 'psig', expected a unit of press"),
        ("P [mm];theta [deg]\n4;90\n", "column 'P [mm]' in 'mm', expected a unit of pressure"),
        ("P [kPa];theta [%]\n4;90\n", "column 'theta [%]' in '%', expected a unit of angle"),
        ("pressure_max;angle_deg\n4;9\n", "no column pressure_kPa, found columns 'pressure_max'"),
        ("P [kPa];pressure (psi);theta [deg]\n4;4;9\n", "'P [kPa]' and 'pressure (psi)', expecte"),
        ("P [kPa];theta [deg]\n101,325;90\n", "'101,325' is 101.325 or 101325, expected a point"),
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
    assert complaint(path).startswith(
        "output.measured: 3, expected the name of a file, or a mapping (line "
    )


PSI = 6.894757293168361e-3
"""MPa."""


@pytest.mark.parametrize(
    ("head", "rows", "pressure", "angle"),
    [
        ("P [kPa];theta [deg]", "45;90", 0.045, math.pi / 2),
        ("pressure (psi);theta (deg)", "6,5;90", 6.5 * PSI, math.pi / 2),
        ("Pressure [bar],Angle [rad]", "0.45,1.5", 0.045, 1.5),
        ("p / kPa\tθ / °", "45,5\t90", 0.0455, math.pi / 2),
        ("pressure_psi angle_rad", "6.5 1.5", 6.5 * PSI, 1.5),
        ("pressure in mmHg;bending angle in deg", "300;90", 300 * 133.322387415e-6, math.pi / 2),
        # this program's own names come first
        ("pressure_kPa,pressure_psi,angle_deg,angle_rad", "45,1,90,1", 0.045, math.pi / 2),
    ],
)
def test_units_in_the_names(
    head: str, rows: str, pressure: float, angle: float, tmp_path: Path
) -> None:
    (tmp_path / "points.csv").write_text(f"{head}\n{rows}\n", encoding="utf-8")
    measured = measured_of(case_file(tmp_path, FREE, "points.csv"))
    assert measured.pressure == pytest.approx([pressure], rel=1e-9)
    assert measured.value == pytest.approx([angle], rel=1e-12)


def test_columns_and_units_that_a_case_names(tmp_path: Path) -> None:
    text = "t;supply [psi];P [psi];camera;load\n0;30;6,5;1,5;250\n1;30;7;1,75;300\n"
    (tmp_path / "points.csv").write_text(text, encoding="utf-8")
    spec = {"file": "points.csv", "pressure": "P [psi]", "angle": "camera", "angle_unit": "rad"}
    path = case_file(tmp_path, FREE, spec)
    measured = measured_of(path)
    assert measured.pressure == pytest.approx([6.5 * PSI, 7 * PSI])
    assert measured.value == pytest.approx([1.5, 1.75])
    assert measured.units == ("psi", "rad")
    # a name without its unit will do, and the resolved case says the same from anywhere
    assert measured_of(case_file(tmp_path, FREE, spec | {"pressure": "p"})).units == ("psi", "rad")
    case = read_case(path)
    assert parse_case(yaml.safe_load(yaml.safe_dump(case.resolved()))) == case
    force = {"pressure": "P [psi]", "force": "load", "force_unit": "mN"}
    blocked = measured_of(case_file(tmp_path, BLOCKED, spec | force))
    assert blocked.value == pytest.approx([0.25, 0.3])


def test_delimiter_and_decimal_that_a_case_names(tmp_path: Path) -> None:
    (tmp_path / "points.csv").write_text("P [kPa];theta [deg]\n10,325;90\n", encoding="utf-8")
    path = case_file(
        tmp_path, FREE, {"file": "points.csv", "decimal": ",", "delimiter": "semicolon"}
    )
    assert measured_of(path).pressure == pytest.approx([0.010325])


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ({"pressure": "Q"}, "no column 'Q', found columns 'P', 'P [psi]', 'theta', 'theta [rad]'"),
        (
            {"pressure": "P", "angle": "theta"},
            "column 'P' has no unit, expected a name such as 'P [",
        ),
        (
            {"pressure": "P [psi]", "angle": "theta [rad]", "pressure_unit": "kPa"},
            "is in psi, pressure_unit says kPa",
        ),
        ({"pressure": "theta", "angle": "theta"}, "'theta' given twice, expected two columns"),
        ({"pressure_unit": "psig"}, 'pressure_unit: "psig", expected a unit of a pressure such as'),
        ({"pressure_unit": "mm"}, 'pressure_unit: "mm", expected a unit of a pressure such as kPa'),
        ({"columns": "P"}, "output.measured.columns: "),
        ({"decimal": "x"}, "output.measured.decimal: "),
        ({"delimiter": "comma"}, "one column 'P;P [psi];theta;theta [rad]', expected two"),
    ],
)
def test_what_a_case_says_of_a_file_is_checked(
    spec: dict[str, str], message: str, tmp_path: Path
) -> None:
    text = "P;P [psi];theta;theta [rad]\n45;6,5;90;1,5\n"
    (tmp_path / "points.csv").write_text(text, encoding="utf-8")
    text = complaint(case_file(tmp_path, FREE, {"file": "points.csv", **spec}))
    assert text.startswith("output.measured")
    assert message in text


def test_a_file_must_be_named(tmp_path: Path) -> None:
    assert "output.measured.file: " in complaint(case_file(tmp_path, FREE, {"pressure": "P"}))

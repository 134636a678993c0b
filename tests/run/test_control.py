"""`fiberbend control`: its files, what it says, and what it refuses."""

from __future__ import annotations

import csv
import json
import math
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend.cli import main
from fiberbend.control.export import TABLE_ERROR, short_table, table_header

ROOT = Path(__file__).resolve().parents[2]
BASELINE = str(ROOT / "cases" / "free_bending.yaml")
QUICK = ["control", BASELINE, "--plant", "analytic"]
COMPILER = shutil.which("cc")

PROGRAM = """
#include <stdio.h>
#include "angle_filter.h"

int main(void)
{
    float pressure;
    while (scanf("%f", &pressure) == 1)
        printf("%.9g\\n", angle_filter_rad(pressure));
    return 0;
}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a run with noise and mismatch, the plant from eq. (19): no FEniCSx."""
    out = tmp_path_factory.mktemp("control") / "run"
    assert main([*QUICK, "--out", str(out), "--noise", "0.5 kPa", "--mismatch", "10 %"]) == 0
    return out


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_it_leaves_its_files(folder: Path) -> None:
    names = {path.name for path in folder.iterdir()}
    assert names == {
        "case.resolved.yaml",
        "control.csv",
        "control.json",
        "control.png",
        "filter.csv",
        "angle_filter.h",
    }
    assert (folder / "control.png").read_bytes().startswith(b"\x89PNG")


def test_the_report_and_the_samples_say_the_same(folder: Path) -> None:
    report = json.loads((folder / "control.json").read_text(encoding="utf-8"))
    assert report["filter"]["modulus_MPa"] == pytest.approx(1.1 * 0.314, rel=1e-6)
    assert report["sensor"] == {"noise_kPa": 0.5, "seed": 0}
    assert report["controller"]["rate_Hz"] == 100
    samples = rows(folder / "control.csv")
    for name in ("steps", "sine"):
        part = [row for row in samples if row["run"] == name]
        valves = np.array([int(row["valves"]) for row in part])
        opened = np.count_nonzero((np.diff(valves, prepend=0) != 0) & (valves != 0))
        assert report[name]["openings"] == opened
        assert [float(row["time_s"]) for row in part[:3]] == [0, 0.01, 0.02]
        for row in part:
            error = float(row["desired_deg"]) - float(row["filtered_deg"])
            assert float(row["error_deg"]) == pytest.approx(error, abs=2e-3)
            # printed eq. (22), in degrees
            zone = float(row["desired_deg"]) / 50 + math.degrees(0.07)
            assert float(row["dead_zone_deg"]) == pytest.approx(zone, abs=1e-4)
            command = (error > zone) - (error < -zone)
            assert int(row["valves"]) == command or abs(abs(error) - zone) < 2e-3
    noise = [float(row["measured_kPa"]) - float(row["pressure_kPa"]) for row in samples]
    # 2400 samples: the standard deviation is known to 1.4 %
    assert np.std(noise) == pytest.approx(0.5, rel=0.06)


def test_the_same_command_leaves_the_same_numbers(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "again"
    assert main([*QUICK, "--out", str(out), "--noise", "0.5 kPa", "--mismatch", "10 %"]) == 0
    for name in ("control.csv", "control.json", "filter.csv", "angle_filter.h"):
        assert (out / name).read_bytes() == (folder / name).read_bytes()


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_the_header_compiles_and_computes_the_table(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "main.c").write_text(PROGRAM, encoding="ascii")
    assert COMPILER is not None
    flags = ["-std=c99", "-Wall", "-Wextra", "-Wconversion", "-pedantic", "-Werror", f"-I{folder}"]
    build = [COMPILER, *flags, "main.c", "-o", "main"]
    subprocess.run(build, cwd=tmp_path, check=True)
    table = rows(folder / "filter.csv")
    pressure, angle = (
        np.array([float(row[name]) for row in table]) for name in ("pressure_kPa", "angle_rad")
    )
    asked = np.r_[np.random.default_rng(5).uniform(-20, 230, 2000), pressure]
    text = "\n".join(map(repr, asked.tolist()))
    done = subprocess.run(
        [tmp_path / "main"], input=text, capture_output=True, text=True, check=True
    )
    found = np.array(done.stdout.split(), dtype=float)
    expected = np.interp(asked, pressure, angle)
    # single precision: 24 bits of up to 6 rad, and of the position among the points
    assert np.abs(found - expected).max() < 5e-6
    done = subprocess.run([tmp_path / "main"], input="nan", capture_output=True, text=True)
    assert math.isnan(float(done.stdout))


def test_the_header_states_the_error_against_the_model(folder: Path) -> None:
    from analytic.bending import Hemicircle
    from analytic.stress import effective

    table = rows(folder / "filter.csv")
    pressure, angle = (
        np.array([float(row[name]) for row in table]) for name in ("pressure_kPa", "angle_rad")
    )
    assert (pressure[0], pressure[-1]) == (0, 207)
    header = (folder / "angle_filter.h").read_text(encoding="ascii")
    (line,) = [line for line in header.splitlines() if "MAX_ERROR_RAD" in line]
    stated = float(line.split()[-1].removesuffix("f"))
    model = Hemicircle(8, 2, 2, 160, stress=effective(1.1 * 0.314))
    fine = np.linspace(0, 207, 5000)
    off = np.abs(np.interp(fine, pressure, angle) - model.angle(1e-3 * fine)).max()
    assert 0.9 * stated < off < 1.01 * stated
    assert stated <= TABLE_ERROR


def test_titles_cannot_leave_the_comment() -> None:
    from analytic.bending import Hemicircle
    from analytic.control.filter import AngleFilter

    table = short_table(AngleFilter.from_model(Hemicircle(8, 2, 2, 160)), 0.2)
    header = table_header(table, "θ */ int x;\nµ", "eq. (19), μ̄ = 0.2 ± 0.1 MPa")
    head = header[: header.index("*/")]
    assert "theta * / int x; ?" in head
    assert "mu = 0.2 +/- 0.1 MPa" in head
    assert header.isascii()


def test_it_tells_the_numbers_beside_the_papers(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*QUICK, "--out", str(tmp_path / "run")]) == 0
    out = capsys.readouterr().out
    for part in ("(paper 91 ms)", "(124 ms)", "(60 ms)", "(0.85 %)", "(0.50 %)", "results in "):
        assert part in out


def test_a_step_that_does_not_converge_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    quick = [*QUICK, "--out", str(tmp_path / "run"), "--hold", "0.1 s"]
    assert main([*quick, "--steps", "0 deg", "180 deg"]) == 0
    assert "filling not within the hold" in capsys.readouterr().out
    report = json.loads((tmp_path / "run" / "control.json").read_text(encoding="utf-8"))
    assert report["steps"]["fill_ms"] is None


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (["--supply", "100"], '--supply: "100", expected a pressure with its unit'),
        (["--rate", "100"], '--rate: "100", expected a frequency with its unit'),
        (["--rate", "10 kPa"], '--rate: "10 kPa", expected a frequency'),
        (["--mismatch", "0.1"], '--mismatch: "0.1", expected a percentage above -100 %'),
        (["--mismatch", "-100 %"], '--mismatch: "-100 %", expected a percentage'),
        (["--exponent", "much"], '--exponent: "much", expected a number'),
        (["--steps", "30", "60 deg"], '--steps: "30", expected an angle with its unit'),
        (["--exponent", "2"], "--exponent: expected from 1"),
        (["--supply", "0 kPa"], "--supply: a positive number expected"),
        (["--supply", "60 kPa"], "--supply: 60 kPa, expected more than the "),
        (["--inlet", "-0.1 dm^3/(s*bar)"], "--inlet: a positive number expected"),
        (["--inlet", "2 dm^3/(s*bar)"], "--dead-time: 2 ms, but at "),
        (["--dead-time", "100 ms"], "--dead-time: 100 ms, but at "),
        (["--dead-zone", "0 deg"], "--dead-zone: a positive angle expected"),
        (["--steps", "60 deg", "30 deg"], "--steps: 60 and 30°, expected two rising angles"),
        (["--sine", "-10 deg", "30 deg"], "--sine: -10 and 30°, expected two rising angles"),
        (["--noise", "-1 kPa"], "--noise: zero or more MPa expected"),
        (["--rate", "20 Hz"], "--rate: 20 Hz, but at "),
        (["--modulus", "0 MPa"], "--modulus: "),
    ],
)
def test_wrong_options_end_with_1_and_one_line(
    arguments: list[str], line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*QUICK, "--out", str(tmp_path / "run"), *arguments]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith(line)
    assert err.count("\n") == 1
    assert not (tmp_path / "run").exists()


def test_every_unreadable_option_is_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*QUICK, "--supply", "1", "--rate", "2", "--mismatch", "3"]) == 1
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(":")[0] for line in lines] == ["--supply", "--rate", "--mismatch"]


def test_a_case_without_a_closed_form_says_the_way_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    soft = "materials.floor=elastosil-m4601"
    assert main([*QUICK, "--out", str(tmp_path / "run"), "--set", soft]) == 1
    err = capsys.readouterr().err
    assert err.startswith("case: floor and layer together stretch only")
    assert "--plant section --filter curve" in err


def test_other_runs_are_never_replaced(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*QUICK, "--out", str(folder)]) == 1
    assert "exists, expected a new folder, or --overwrite\n" in capsys.readouterr().err
    body = tmp_path / "body"
    body.mkdir()
    (body / "case.resolved.yaml").write_text("a run of fiberbend run", encoding="utf-8")
    assert main([*QUICK, "--out", str(body), "--overwrite"]) == 1
    assert "contains no control.json" in capsys.readouterr().err
    assert (body / "case.resolved.yaml").read_text(encoding="utf-8") == "a run of fiberbend run"


@pytest.fixture(scope="module")
def section(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """control.json of the baseline with everything at its default."""
    out = tmp_path_factory.mktemp("control") / "section"
    assert main(["control", BASELINE, "--out", str(out)]) == 0
    report: dict[str, Any] = json.loads((out / "control.json").read_text(encoding="utf-8"))
    return report


def test_the_baseline_repeats_the_papers_orders(section: dict[str, Any]) -> None:
    # section VI; sizes of its steps and sine, supply and valves are not stated: factor 1.5
    for part, key, paper in (
        ("steps", "fill_ms", 91),
        ("steps", "vent_ms", 124),
        ("sine", "delay_ms", 60),
    ):
        assert paper / 1.5 < section[part][key] < paper * 1.5
    assert section["steps"]["vent_ms"] > section["steps"]["fill_ms"]
    assert section["steps"]["undesired_percent"] < 1
    assert section["sine"]["undesired_percent"] < 1


def test_the_filter_is_fitted_to_the_section(section: dict[str, Any]) -> None:
    # least squares of eq. (19) to an independent section model's curve; the two differ in shape
    assert section["plant"]["curve"] == "section"
    assert section["filter"]["modulus_MPa"] == pytest.approx(0.2177, rel=0.01)
    assert section["filter"]["departure_from_plant_deg"] == pytest.approx(53, abs=2)

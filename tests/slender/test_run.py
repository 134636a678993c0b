"""Runs of rods by real laws of sections: beside the section, their folders, two ranks."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.cli import main
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import read_case
from fiberbend.results.states import States
from fiberbend.running.runner import run_case
from fiberbend.slender import actuator
from tests.conftest import MpiRun
from tests.slender.rods import case, without_ends

ROOT = Path(__file__).resolve().parents[2]
SHIPPED = ROOT / "cases" / "rod.yaml"
FREE = {"pressure": {"to": "30 kPa"}}


@pytest.fixture(scope="module")
def weighed() -> Case:
    return case({"gravity": {"direction": "-y"}}, FREE)


@pytest.fixture(scope="module")
def folder(weighed: Case, tmp_path_factory: pytest.TempPathFactory) -> tuple[RunResult, Path]:
    path = tmp_path_factory.mktemp("rod") / "run"
    output = weighed.output.model_copy(update={"report": True, "at_pressures": (0.02,)})
    result = run_case(weighed.model_copy(update={"output": output}), path)
    assert result.status == "converged", result.reason
    return result, path


def test_free_bending_is_that_of_the_section(monkeypatch: pytest.MonkeyPatch) -> None:
    """P(θ) within 0.1 %, the stretch of the line too; what is left is the table's error.

    But for its ends, which no section has.
    """
    monkeypatch.setattr(actuator, "along", without_ends)
    rod = run_case(case(FREE), None).rows[-1]
    section = run_case(case(FREE, model="section", mesh={"section": 2}), None).rows[-1]
    assert rod[col.ANGLE] == pytest.approx(section[col.ANGLE], rel=1e-3)
    assert rod[col.AXIS_STRETCH] - 1 == pytest.approx(section[col.AXIS_STRETCH] - 1, rel=2e-3)
    assert rod[col.VOLUME] == pytest.approx(section[col.VOLUME], rel=1e-4)
    assert rod[col.STORED] == pytest.approx(section[col.STORED], rel=3e-3)
    for key in (col.TIP_Y, col.TIP_Z):
        assert rod[key] == pytest.approx(section[key], abs=0.1)


def test_a_folder_has_what_a_run_leaves(folder: tuple[RunResult, Path]) -> None:
    result, path = folder
    run = json.loads((path / "run.json").read_text(encoding="utf-8"))
    assert run["model"] == "rod"
    assert run["status"] == "converged"
    assert run["stability_checked"] is True
    assert run["section_law"]["error"] < 1e-3
    assert run["unknowns"] == 168
    with (path / "history.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == run["load_steps"] + 1 == len(result.rows)
    assert float(rows[-1]["angle_deg"]) == pytest.approx(result.rows[-1][col.ANGLE], abs=1e-8)
    assert {"conjugate_gravity_mJ", "load_gravity", "unstable_modes"} <= set(rows[0])
    page = (path / "report.html").read_text(encoding="utf-8")
    assert "rod model" in page
    # its sections are carried along: no stress is known, and what is strained is the axis
    assert "logarithmic strain along the axis" in page
    assert "von Mises" not in page
    assert "maximum principal" not in page


def test_its_states_are_the_line_with_its_sections(folder: tuple[RunResult, Path]) -> None:
    """Sections keep their shape; the root stands still, the tip is that of the history."""
    result, path = folder
    given = read_case(path / "case.resolved.yaml")
    states = States(path, given, result.rows)
    assert len(states) == len(result.rows)
    mesh = states.model_mesh.mesh
    shot = states.read(states.kept[-1])
    assert shot is not None
    moved = mesh.nodes + shot.displacement
    z = mesh.nodes[:, 2]
    root, tip = np.isclose(z, z.min()), np.isclose(z, z.max())
    np.testing.assert_allclose(moved[root], mesh.nodes[root], atol=1e-12)
    for here in (tip, np.isclose(z, z[np.argmin(np.abs(z - 50))])):
        rest, now = mesh.nodes[here], moved[here]
        apart = [np.linalg.norm(x - x[0], axis=1) for x in (rest, now)]
        np.testing.assert_allclose(apart[1], apart[0], atol=1e-9)


def test_it_is_solved_again_where_it_is_resumed(
    weighed: Case, folder: tuple[RunResult, Path], tmp_path: Path
) -> None:
    path = tmp_path / "run"
    first = run_case(weighed, path)
    again = run_case(weighed, path, resume=True)
    assert [row[col.ANGLE] for row in again.rows] == [row[col.ANGLE] for row in first.rows]


@pytest.mark.mpi
def test_two_ranks_have_the_history_of_one(mpirun: MpiRun, tmp_path: Path) -> None:
    settings = ["--set", "output={pictures: false, report: false}"]
    done = mpirun(2, ["-m", "fiberbend", "run", SHIPPED, *settings, "--out", tmp_path / "run"])
    assert done.returncode == 0, done.stderr
    run = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    assert run["ranks"] == 2
    alone = run_case(read_case(SHIPPED, ["output={pictures: false}"]), None)
    with (tmp_path / "run" / "history.csv").open(encoding="utf-8") as file:
        found: list[dict[str, Any]] = list(csv.DictReader(file))
    for row, exact in zip(found, alone.rows, strict=True):
        assert float(row["tip_y_mm"]) == pytest.approx(exact[col.TIP_Y], rel=1e-9)


@pytest.mark.parametrize(
    ("setting", "code", "why"),
    [
        ("output.at_angles=[170 deg]", 0, "170° not reached"),
        (
            "effects.3={tip-load: {moment: [400 N mm, 0 N mm, 0 N mm]}}",
            2,
            "in a table from",
        ),
    ],
)
def test_a_run_that_fails_ends_with_two(
    setting: str, code: int, why: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Stopped, it has an answer up to there; beyond the range of its law there is none."""
    quiet = ["--set", "output.pictures=false", "--set", "output.report=false"]
    arguments = ["run", str(SHIPPED), "--set", setting, *quiet, "--out", str(tmp_path / "run")]
    assert main(arguments) == code
    run = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    assert run["status"] == ("failed" if code else "stopped")
    assert why in run["reason"]
    assert why in capfd.readouterr().err

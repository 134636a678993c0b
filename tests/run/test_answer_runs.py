"""Answers of runs: the greatest strain, what is printed and what stays in a folder."""

from __future__ import annotations

import io
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from fiberbend import run
from fiberbend.answer.answer import answer, lines
from fiberbend.answer.numbers import quantity
from fiberbend.answer.strain import greatest_strain
from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.results.reading import read_history
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import MeshData
from tests.run.answers import case_of, found
from tests.run.conftest import small

# --- the greatest strain ----------------------------------------------------------------------


def test_strain_of_a_bar_that_is_pulled_is_exact() -> None:
    """A slice stretched by λ along its axis, √λ less across: λ1 − 1 everywhere."""
    case = case_of("cell")
    from fiberbend.models.choice import meshed

    mesh: MeshData = meshed(case).mesh(case)
    from fiberbend.case import convert

    materials = convert.site(case).materials
    space = ModelMesh(mesh, {n: materials[n] for n in mesh.regions}, None, False, "", uniform=False)
    stretch = 1.3
    across = stretch**-0.5 - 1
    moved = mesh.nodes * [across, across, stretch - 1]
    shot = Snapshot("last", 3, 20.0, 0.0, moved, np.zeros(mesh.cells.shape), None)
    strain = greatest_strain(case, space, shot)
    assert strain["nominal"] == pytest.approx(0.3, rel=1e-9)
    assert strain["logarithmic"] == pytest.approx(math.log(1.3), rel=1e-9)
    assert (strain["step"], strain["pressure_kPa"]) == (3, 20.0)
    # more where one node's region is pulled further: found, and named
    crown = int(np.argmax(mesh.nodes[:, 1]))
    moved[crown, 1] += 0.5
    strain = greatest_strain(case, space, shot)
    assert strain["nominal"] > 0.31
    assert strain["region"] == "sheath"
    assert strain["place"].startswith("sheath, crown")


WINDING = {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}}


def test_the_upper_corner_of_a_box_is_named(tmp_path: Path) -> None:
    quiet = {"pictures": False, "fields": False, "report": True, "at_angles": ["40 deg"]}
    effects = [{"pressure": {"angle": "40 deg"}}, WINDING]
    case = case_of("rectangle", effects=effects, output=quiet)
    strain = run_case(case, tmp_path / "run").run["greatest_strain"]
    assert (strain["x_mm"], strain["y_mm"]) == pytest.approx((8.0, 10.0))
    assert strain["place"] == "wall, upper corner of the chamber"


# --- of runs ----------------------------------------------------------------------------------


def ran(
    case: Case,
    folder: Path | None,
    quiet: bool = False,
    verbose: bool = False,
    answers: bool = False,
) -> tuple[RunResult, list[str]]:
    """What a run hands back, and what it has printed."""
    stream = io.StringIO()
    progress = Progress(quiet, stream, verbose=verbose, answers=answers)
    result = run_case(case, folder, progress=progress)
    return result, stream.getvalue().splitlines()


def test_a_section_answers_from_its_folder_as_on_the_screen(tmp_path: Path) -> None:
    case = case_of(output={"pictures": False, "fields": False})
    result, printed = ran(case, tmp_path / "run")
    rows = read_history(tmp_path / "run" / "history.csv")
    run_json = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    again = read_case(tmp_path / "run" / "case.resolved.yaml")
    said = answer(again, rows, run_json)
    assert said == answer(case, result.rows, result.run)
    assert printed[-len(lines(said)) :] == lines(said)
    assert not any(line.endswith("…") or "unknowns" in line for line in printed)
    # docs/evidence/uniform.md: an independent section model, 45.1 to 181.5 kPa
    for angle, kpa in ((90, 45.1), (180, 89.2), (270, 134.3), (360, 181.5)):
        value = found(said, f"pressure at {angle}°").value
        assert float(value.removesuffix(" kPa")) == pytest.approx(kpa, abs=0.1)
    # a full circle ends where it began, but for the cap
    assert found(said, "tip at the end").value == "y = 5.08 mm, z = 15 mm"
    # its crown, λ of history.csv, is stretched less than the greatest strain
    crown = rows[-1]["crown_stretch"]
    assert crown is not None
    assert run_json["greatest_strain"]["nominal"] >= crown - 1 - 1e-6
    # where the numbers come from
    assert run_json["command"]
    assert run_json["machine"]["cores"] >= run_json["machine"]["usable_cores"] >= 1
    assert run_json["blas"]["library"]
    log = (tmp_path / "run" / "run.log").read_text(encoding="utf-8").splitlines()
    for line in (*printed, "mesh …", "882 unknowns: 36 steps"):
        assert any(line in entry for entry in log), line
    assert log[-3].endswith("  converged")
    assert log[-2].endswith(f"  results in {tmp_path / 'run'}")
    assert log[-1].endswith(f"  report in {tmp_path / 'run' / 'report.html'}")


@pytest.mark.long
def test_a_verbose_run_says_phases_counts_and_comparisons(tmp_path: Path) -> None:
    case = case_of("cell", output={"pictures": False, "fields": False})
    _, printed = ran(case, tmp_path / "run", verbose=True)
    assert printed[:3] == ["mesh …", "compile …", "solve …"]
    assert any(re.match(r"\d+ unknowns: ", line) for line in printed)
    wanted = "section model: pressure 4.0 % lower at 360.0°, as expected for a pitch of 3 mm"
    assert wanted in printed
    assert not any("BEYOND" in line for line in printed)
    trust = next(line for line in printed if line.startswith("Trust: "))
    assert trust.startswith(f"Trust: {wanted}")


def test_a_quiet_run_gives_its_answer_where_that_is_wanted() -> None:
    case = case_of("straight", output={"pictures": False, "fields": False})
    assert ran(case, None, quiet=True)[1] == []
    result, printed = ran(case, None, quiet=True, answers=True)
    assert printed == lines(answer(case, result.rows, result.run))
    force = result.rows[-1]["tip_force_N"]
    assert f"a tip force of {quantity(force, 'N')}" in printed[1]
    # a pressure presses the tip away from its crown: positive, and M = F L_f
    moment = float(re.findall(r"([\d.]+) N mm", "\n".join(printed))[0])
    assert force * 15 == pytest.approx(moment, rel=1e-3)
    # no states are kept without a folder: no strain
    assert not any("strain" in line for line in printed)


def test_a_closed_form_answers_too(tmp_path: Path) -> None:
    data = {"output": {"at_angles": ["90 deg"], "at_pressures": ["50 kPa"], "pictures": False}}
    case = case_of("free_bending", model="analytic", **data)
    result, printed = ran(case, tmp_path / "run")
    said = answer(case, result.rows, result.run)
    closed = next(r for r in result.rows if abs(r["angle_deg"] - 90) < 1e-9)
    assert found(said, "pressure at 90°").value == quantity(closed["pressure_kPa"], "kPa")
    assert printed[-len(lines(said)) :] == lines(said)
    assert (tmp_path / "run" / "run.log").exists()


def test_a_resumed_run_goes_on_with_its_log(tmp_path: Path) -> None:
    spread = small()["effects"][1]["winding"] | {"as": "smeared"}
    effects = [{"pressure": {"to": "10 kPa"}}, {"winding": spread}]
    output = {"pictures": False, "fields": False}
    case = parse_case(small(mesh={"axial": "8 mm"}, effects=effects, output=output))
    folder = tmp_path / "run"
    run(case, folder)
    first = (folder / "run.log").read_text(encoding="utf-8")
    run_case(case, folder, resume=True)
    both = (folder / "run.log").read_text(encoding="utf-8")
    assert both.startswith(first)
    assert "resumed after step" in both[len(first) :]
    run_case(case, folder, overwrite=True)
    assert "resumed after" not in (folder / "run.log").read_text(encoding="utf-8")

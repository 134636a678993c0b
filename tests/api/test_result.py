"""What a run gives a script: rows, states in space, the same from a folder."""

from __future__ import annotations

import gc
import itertools
import json
import math
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fiberbend
from fiberbend import CaseError, Result
from fiberbend.models.result import RunResult
from fiberbend.results.folder import HISTORY_COLUMNS
from fiberbend.states.snapshot import Snapshot
from tests.conftest import ROOT
from tests.run.conftest import small

SECTION = ROOT / "cases" / "section.yaml"
QUIET = {"pictures": False, "fields": False, "report": False}


def section(**output: Any) -> dict[str, Any]:
    """A section that bends to 90° in seconds."""
    case = small(model="section", mesh={}, output={"at_angles": ["45 deg"], **output})
    case["actuator"]["length"] = "160 mm"
    case["effects"][0] = {"pressure": {"angle": "90 deg"}}
    return case


@pytest.fixture(scope="module")
def bent() -> Result:
    return fiberbend.run(section())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the same run, with nothing but what is needed."""
    path = tmp_path_factory.mktemp("api") / "run"
    output = {"pictures": False, "fields": False}
    fiberbend.run(section(**output), path)
    return path


def refusal(call: Any, *arguments: Any, **named: Any) -> str:
    with pytest.raises(CaseError) as error:
        call(*arguments, **named)
    return str(error.value)


def test_it_is_what_run_has_always_returned(bent: Result) -> None:
    assert isinstance(bent, RunResult)
    assert (bent.status, bent.reason, bent.folder) == ("converged", "", None)
    assert bent.last("angle_deg") == pytest.approx(90.0)
    assert bent.run["model"] == bent.model == "section"
    assert bent.rows[0]["step"] == 0
    with pytest.raises(KeyError, match="colour"):
        bent.last("colour")
    text = repr(bent)
    assert text.startswith("<Result 'A short actuator', section model, ")
    assert text.endswith("kPa, 90°, converged>")


def test_frame(bent: Result) -> None:
    frame = bent.frame
    assert list(frame)[: len(HISTORY_COLUMNS)] == list(HISTORY_COLUMNS)
    assert len(frame) == len(bent.rows)
    assert frame["step"].dtype == frame["newton_iterations"].dtype == int
    assert frame["angle_deg"].iloc[-1] == pytest.approx(90.0)
    assert frame["tip_force_N"].isna().all()
    others = frame.drop(columns=["step", "newton_iterations"])
    assert {str(dtype) for dtype in others.dtypes} == {"float64"}


def test_between_steps_it_is_what_a_run_that_stops_there_finds(bent: Result) -> None:
    """The interpolation is closer than a thousandth of what a step changes."""
    pressures = [row["pressure_kPa"] for row in bent.rows]
    middles = [f"{(low + high) / 2!r} kPa" for low, high in itertools.pairwise(pressures)]
    settings = {"effects.0.pressure": {"to": f"{pressures[-1]!r} kPa"}}
    output = {"at_angles": [], "at_pressures": middles}
    solved = fiberbend.run(section(**output), settings=settings, states=False)
    names = ("angle_deg", "tip_y_mm", "tip_z_mm", "chamber_mm3", "work_mJ", "crown_stretch")
    # near rest the tip moves with the square of the pressure
    for step, pressure in enumerate(middles[1:], start=1):
        exact, found = solved.at(pressure=pressure), bent.at(pressure=pressure)
        assert exact.exact
        assert found.steps == (step, step + 1)
        for name in names:
            change = abs(bent.rows[step + 1][name] - bent.rows[step][name])
            assert abs(found[name] - exact[name]) < 1e-3 * change, (step, name)


def test_mesh_is_at_rest_and_its_displacement_bends_it(bent: Result) -> None:
    for angle, label in (("45 deg", None), ("90 deg", "last")):
        grid = bent.mesh(label) if label else bent.mesh(angle=angle)
        assert grid.bounds[4:] == pytest.approx((0, 160))
        far = grid.points[:, 2] > 160 - 1e-6
        moved = grid.points + grid.point_data["displacement_mm"]
        # a plane section stays plane, and its normal turns by θ toward −y
        centred = moved[far] - moved[far].mean(axis=0)
        _, sizes, axes = np.linalg.svd(centred, full_matrices=False)
        assert sizes[2] < 1e-9 * sizes[0]
        theta = math.radians(float(angle.split()[0]))
        assert abs(axes[2] @ [0, -math.sin(theta), math.cos(theta)]) == pytest.approx(1, abs=1e-9)
        near = grid.points[:, 2] < 1e-6
        assert np.ptp(moved[near][:, 2]) < 1e-9
    rest = bent.mesh("rest")
    assert np.abs(rest.point_data["displacement_mm"]).max() < 1e-12


def test_the_nearest_state_is_not_taken_for_the_one_that_is_asked_for(bent: Result) -> None:
    text = refusal(bent.mesh, pressure="20 kPa")
    assert text.startswith(
        "pressure: no state at 20 kPa (output.at_pressures of the case makes one), expected one of "
        f"{len(bent.rows)}; nearest: step "
    )
    assert "kPa, " in text
    assert " deg)" in text
    assert refusal(bent.mesh, step=99).startswith("step: no state at step 99, expected one of ")
    assert "expected last, rest, 045deg" in refusal(bent.mesh, "colour")
    assert refusal(bent.mesh) == "mesh: nothing given, expected one of pressure, angle, step"
    assert "a label and more" in refusal(bent.mesh, "last", step=3)
    assert [state.step for state in bent.states] == [row["step"] for row in bent.rows]


def test_states_go_with_the_result_and_nothing_else_is_written() -> None:
    result = fiberbend.run(section())
    kept = result.kept_in
    assert kept is not None
    assert {path.name for path in kept.iterdir()} == {"mesh.npz", "fibers.npz", "snapshots"}
    del result
    gc.collect()
    assert not kept.exists()


def test_a_run_that_breaks_leaves_no_states(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import tempfile

    from fiberbend.running.history import Recorder

    def fails(*_: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr(Recorder, "integrate", fails)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(RuntimeError, match="broken"):
        fiberbend.run(section())
    assert list(tmp_path.glob("fiberbend-*")) == []


def test_a_full_disk_costs_the_states_and_not_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    from fiberbend.results.folder import RunFolder

    write = RunFolder.write_arrays

    def full(self: RunFolder, name: str, **arrays: Any) -> None:
        if "step_0003" in name:
            raise OSError(28, "No space left on device")
        write(self, name, **arrays)

    monkeypatch.setattr(RunFolder, "write_arrays", full)
    result = fiberbend.run(section())
    assert result.status == "converged"
    warning = "states are kept up to step 2 only: No space left on device"
    assert warning in result.run["warnings"]
    assert [state.step for state in result.states] == [0, 1, 2]
    assert "no state at step 10" in refusal(result.mesh, "last")


def test_without_states() -> None:
    result = fiberbend.run(section(), states=False)
    assert result.kept_in is None
    assert "its states are gone, expected a run with `out`" in refusal(result.mesh, "last")


def test_a_closed_form_has_no_states() -> None:
    result = fiberbend.run(section(at_angles=[]), settings={"model": "analytic"})
    assert "model analytic is a closed form without states" in refusal(result.mesh, "last")
    assert len(result.frame) > 10


def test_a_run_whose_case_asks_for_no_states(tmp_path: Path) -> None:
    result = fiberbend.run(section(**QUIET), tmp_path / "run")
    assert "no state was kept, expected output.report" in refusal(result.mesh, "last")


def test_fibers(bent: Result, tmp_path: Path) -> None:
    assert "fibers: a smeared winding, no lines" in refusal(bent.fibers, "last")
    case = small(mesh={"axial": "1.5 mm"}, output={})
    case["actuator"]["length"] = "12 mm"
    case["effects"][0] = {"pressure": {"to": "5 kPa"}}
    bare = case | {"effects": case["effects"][:1]}
    result = fiberbend.run(case)
    lines, body = result.fibers("last"), result.mesh("last")
    assert lines.n_points > 100
    assert len(lines.point_data["tension_N"]) == lines.n_points
    # they lie in the body at rest, and move with it
    lows, highs = body.points.min(axis=0), body.points.max(axis=0)
    assert np.all((lines.points > lows - 1e-6) & (lines.points < highs + 1e-6))
    probed = lines.sample(body, tolerance=1e-3)
    inside = probed.point_data["vtkValidPointMask"].astype(bool)
    gap = (probed.point_data["displacement_mm"] - lines.point_data["displacement_mm"])[inside]
    assert inside.mean() > 0.5
    scale = np.linalg.norm(lines.point_data["displacement_mm"], axis=1).max()
    assert np.linalg.norm(gap, axis=1).max() < 0.02 * scale
    assert "fibers: no winding" in refusal(fiberbend.run(bare).fibers, "last")


# --- from a folder ------------------------------------------------------------------------------


def test_a_folder_gives_the_same(bent: Result, folder: Path) -> None:
    loaded = fiberbend.load(folder)
    assert isinstance(loaded, Result)
    assert (loaded.status, loaded.folder, loaded.model) == ("converged", folder, "section")
    assert repr(loaded).endswith(f"in {folder}>")
    for row, other in zip(loaded.rows, bent.rows, strict=True):
        for name, value in other.items():
            assert row[name] == pytest.approx(value, rel=1e-9, abs=1e-12), name
    assert isinstance(loaded.rows[1]["step"], int)
    one, other = loaded.mesh(angle="45 deg"), bent.mesh(angle="45 deg")
    assert one.points == pytest.approx(other.points)
    assert one.point_data["displacement_mm"] == pytest.approx(other.point_data["displacement_mm"])
    pressure = f"{bent.rows[3]['pressure_kPa']:.10g} kPa"
    assert loaded.at(pressure=pressure).exact
    assert loaded.case == fiberbend.validate(section(pictures=False, fields=False))


def test_folders_of_runs_that_came_to_no_end(folder: Path, tmp_path: Path) -> None:
    for name in ("begun", "killed", "failed"):
        shutil.copytree(folder, tmp_path / name)
    (tmp_path / "begun" / "run.json").unlink()
    (tmp_path / "begun" / "history.csv").unlink()
    begun = fiberbend.load(tmp_path / "begun")
    assert isinstance(begun, Result)
    assert (begun.status, begun.rows) == ("interrupted", [])
    assert "no load step, interrupted: killed before it wrote run.json" in repr(begun)
    assert "no row" in refusal(begun.last, "angle_deg")
    assert len(begun.frame) == 0
    reason = "at step 3, kept; where no process runs it: go on with --resume"
    run = json.loads((folder / "run.json").read_text())
    for name, changes in {
        "killed": {"status": "running", "reason": reason},
        "failed": {"status": "failed", "reason": "no solution"},
    }.items():
        (tmp_path / name / "run.json").write_text(json.dumps(run | changes))
        found = fiberbend.load(tmp_path / name)
        assert isinstance(found, Result)
        assert (found.status, found.reason) == (changes["status"], changes["reason"])
        assert found.mesh("last").n_cells > 0


def test_what_is_no_run(folder: Path, tmp_path: Path) -> None:
    assert refusal(fiberbend.load, tmp_path / "no").endswith(
        "no such folder, expected the folder of a run or a sweep"
    )
    assert "contains nothing, expected the folder" in refusal(fiberbend.load, tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    assert "contains notes.txt, expected" in refusal(fiberbend.load, tmp_path)
    assert "is a file" in refusal(fiberbend.load, tmp_path / "notes.txt")
    for name, content, message in (
        ("run.json", "{", "expected the end of a run"),
        ("run.json", "[1]", "no mapping"),
        ("case.resolved.yaml", "title: [", "malformed YAML"),
        ("case.resolved.yaml", "title: x", "actuator"),
        ("history.csv", "step,colour\n0,1\n", "colour"),
    ):
        broken = tmp_path / f"{name}-{message[:3]}"
        shutil.copytree(folder, broken)
        (broken / name).write_text(content)
        text = refusal(fiberbend.load, broken)
        assert message in text
        assert str(broken / name) in text
    (broken / "case.resolved.yaml").unlink()
    assert "no such file, expected the case" in refusal(fiberbend.load, broken)


def test_measured_points_that_are_gone_are_left_out(tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("pressure_kPa,angle_deg\n20,40\n40,80\n")
    case = section(measured=str(points), pictures=False, fields=False)
    fiberbend.run(case, tmp_path / "run")
    points.unlink()
    loaded = fiberbend.load(tmp_path / "run")
    assert isinstance(loaded, Result)
    assert loaded.case.output.measured is None


# --- other calls --------------------------------------------------------------------------------


def test_settings(bent: Result) -> None:
    thick = {"actuator.wall": "3 mm"}
    case = fiberbend.validate(section(), settings=thick)
    assert case.actuator.wall == 3
    assert case == fiberbend.validate(section(), settings=["actuator.wall=3 mm"])
    assert fiberbend.validate(bent.case, settings=thick).actuator.wall == 3
    assert bent.case.actuator.wall == 2
    changed = fiberbend.validate(SECTION, settings={"effects.0.pressure": {"to": "20 kPa"}})
    assert changed.inflation is not None
    assert changed.inflation.to == pytest.approx(0.02)
    for wrong, message in (
        ("actuator.wall=3 mm", "expected a list of path=value, or a mapping"),
        ({3: 4}, "expected a dotted path"),
        (["actuator.wall"], 'expected a path and a value, "path=value"'),
        ({"actuator.walls": "3 mm"}, "actuator.walls"),
    ):
        assert message in refusal(fiberbend.validate, section(), settings=wrong)


def test_plan() -> None:
    plan = fiberbend.plan(SECTION, settings=["actuator.wall=3 mm"])
    assert plan.model == "section"
    assert plan.unknowns > 500
    assert plan.steps is not None
    assert plan.seconds is not None
    assert plan.memory_mb is not None
    assert repr(plan) == "\n".join(plan.lines())
    assert "time: " in repr(plan)


def test_run_refuses_what_it_cannot_do() -> None:
    assert "expected one of them" in refusal(fiberbend.run, section(), overwrite=True, resume=True)
    assert "out: nothing" in refusal(fiberbend.run, section(), resume=True)


def test_report_is_written_by_its_own_module(
    bent: Result, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys
    import types

    given: list[Any] = []

    def report(
        path: Path, case: Any, rows: Any, run: Any, links: str = "", loose: bool = False
    ) -> str:
        given.append((path, case, rows, run, links, loose))
        assert all((path / name).exists() for name in ("history.csv", "run.json", "mesh.npz"))
        return "page"

    def write_report(target: Any, *of: Any) -> None:
        target.write_text("report.html", report(target.path, *of))

    module = types.ModuleType("fiberbend.report.run_page")
    module.report, module.write_report = report, write_report  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "fiberbend.report.run_page", module)
    shutil.copytree(folder, tmp_path / "run")
    loaded = fiberbend.load(tmp_path / "run")
    assert isinstance(loaded, Result)
    assert loaded.report() == tmp_path / "run" / "report.html"
    assert loaded.report().read_text() == "page"
    assert loaded.report(tmp_path / "pages" / "one.html").read_text() == "page"
    assert given[-1][4:] == ("../run/", False)
    assert "out: a run without a folder" in refusal(bent.report)
    assert bent.report(str(tmp_path / "two.html")).read_text() == "page"
    assert given[-1] == (bent.kept_in, bent.case, bent.rows, bent.run, "", True)


def test_plot_is_drawn_by_its_own_module(
    bent: Result, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import sys
    import types

    plot, runs = types.ModuleType("plot"), types.ModuleType("runs")
    runs.RunData = lambda *given: given  # type: ignore[attr-defined]
    plot.PAPER, plot.plot = "paper", lambda *given: given  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "fiberbend.api.plot", plot)
    monkeypatch.setitem(sys.modules, "fiberbend.api.runs", runs)
    other = fiberbend.load(folder)
    assert isinstance(other, Result)
    given: Any = bent.plot("pressure_kPa", "tip_y_mm", beside=[other, "runs/x"], target="a.pdf")
    (one, two, three), *rest = given
    assert one == ("A short actuator", bent.case.resolved(), bent.rows)
    assert (two[0], three) == ("run", "runs/x")
    assert rest == ["pressure_kPa", "tip_y_mm", (), "a.pdf", "paper", ()]


def test_a_damaged_state_is_named(folder: Path, tmp_path: Path) -> None:
    shutil.copytree(folder, tmp_path / "run")
    (tmp_path / "run" / "snapshots" / "step_0001.npz").write_bytes(b"PK")
    loaded = fiberbend.load(tmp_path / "run")
    assert isinstance(loaded, Result)
    with pytest.warns(UserWarning, match="is damaged"):
        assert "damaged, expected a whole file" in refusal(loaded.mesh, step=1)
    assert isinstance(loaded._read(loaded.states[0]), Snapshot)

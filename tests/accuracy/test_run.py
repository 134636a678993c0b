"""What a run says of the accuracy that its case asks for."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from fiberbend import columns as col
from fiberbend.accuracy.budget import percent
from fiberbend.accuracy.computed import MISSED, estimated, missed
from fiberbend.answer.answer import answer, lines
from fiberbend.case.case import Case
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import read_case
from fiberbend.running.runner import run_case
from tests.conftest import ROOT

QUIET = ["output.pictures=false", "output.fields=false", "output.report=false"]


def case(*settings: str) -> Case:
    """The baseline's section, bent to 40°."""
    begin = ["effects.0.pressure.angle=40 deg", "output={}", "mesh.section=1"]
    return read_case(ROOT / "cases" / "section.yaml", [*begin, *QUIET, *settings])


@pytest.fixture(scope="module")
def missing(tmp_path_factory: pytest.TempPathFactory) -> tuple[Case, RunResult]:
    """A spread winding that cannot keep 1 %, and its run."""
    made = case("accuracy=1 %", "output.at_angles=[20 deg]")
    return made, run_case(made, tmp_path_factory.mktemp("runs") / "run")


def test_the_winding_is_computed_at_its_own_angles(missing: tuple[Case, RunResult]) -> None:
    """Against a cell and a section that are solved here."""
    _, result = missing
    cell = read_case(
        ROOT / "cases" / "cell.yaml",
        ["effects.0.pressure.angle=40 deg", "output={at_angles: [20 deg]}", "mesh.section=1",
         "mesh.axial=0.1875 mm", *QUIET],
    )  # fmt: skip
    bulged = {round(row[col.ANGLE], 3): row[col.PRESSURE] for row in run_case(cell, None).rows}
    spread = {round(row[col.ANGLE], 3): row[col.PRESSURE] for row in result.rows}
    block = result.run["accuracy"]
    at = block["angle_deg"]
    assert at in (20.0, 40.0)
    apart = 100 * (1 - spread[at] / bulged[at])
    assert apart > 2
    # and what eight layers still lack
    assert apart < block["parts"]["winding"] < apart + 0.6


def test_a_missed_accuracy_is_said_everywhere(missing: tuple[Case, RunResult]) -> None:
    made, result = missing
    assert result.folder is not None
    block = json.loads((result.folder / "run.json").read_text())["accuracy"]
    assert block["asked"] == 1.0
    assert not block["promised"]
    assert block["estimated"] == pytest.approx(sum(block["parts"].values()), abs=2e-3)
    assert "winding" in block["reason"]
    assert "section and cell" in block["from"]["winding"]
    # the run is as good as it was
    assert result.status == "converged"
    assert MISSED in result.run["warnings"][-1]
    found = answer(made, result.rows, result.run)
    assert f"the 1 % asked for {MISSED}" in found.trust
    text = "\n".join(lines(found))
    assert re.search(rf"estimated error +{percent(block['estimated'])} % \(mesh ", text)
    assert "expected error" not in text


def test_a_kept_accuracy_warns_of_nothing() -> None:
    made = case("accuracy=15 %")
    result = run_case(made, None)
    block = result.run["accuracy"]
    assert block["promised"]
    assert block["reason"] == ""
    assert missed(result.run) == []
    assert (
        "the 15 % asked for is met by the estimate" in answer(made, result.rows, result.run).trust
    )


def test_a_calibrated_winding_is_as_good_as_its_calibration() -> None:
    numbers = {"left_percent": 0.2, "up_to_kPa": 100.0}
    made = read_case(
        ROOT / "cases" / "section.yaml",
        ["effects.0.pressure.angle=80 deg", "output={}", "accuracy=5 %",
         "effects.1.winding.as=calibrated"],
    )  # fmt: skip
    history = rows((40, 20), (80, 40))

    def block(calibration: dict[str, float]) -> dict[str, Any]:
        given = {"calibration": calibration}
        found = estimated(made, "converged", history, given, no_solver, lambda _: None)
        entries: dict[str, Any] = found["accuracy"]
        return entries

    good, worse = block(numbers), block(numbers | {"left_percent": 0.5})
    assert good["promised"]
    assert "calibrated" in good["from"]["winding"]
    assert 0.2 < good["parts"]["winding"] < 0.6
    apart = worse["parts"]["winding"] - good["parts"]["winding"]
    assert apart == pytest.approx(0.3, abs=2e-3)
    short = block(numbers | {"up_to_kPa": 30.0})
    assert not short["promised"]
    assert "up to 30 kPa" in short["reason"]


def test_who_asks_for_none_gets_none() -> None:
    result = run_case(case(), None)
    assert "accuracy" not in result.run


def no_solver(_: Case) -> RunResult:
    """Nothing is solved where every turn lies by itself."""
    raise AssertionError("solved")


def rows(*pairs: tuple[float, float]) -> list[dict[str, Any]]:
    """Rest, and rows of an angle in degrees and a pressure in kPa."""
    return [
        {col.STEP: step, col.ANGLE: angle, col.PRESSURE: pressure}
        for step, (angle, pressure) in enumerate([(0.0, 0.0), *pairs])
    ]


def turns(*settings: str) -> Case:
    """The baseline's cell under a pressure."""
    begin = ["effects.0.pressure={to: 60 kPa}", "output={}", "accuracy=5 %"]
    return read_case(ROOT / "cases" / "cell.yaml", [*begin, *settings])


def total(made: Case, history: list[dict[str, Any]], status: str = "converged") -> dict[str, Any]:
    """The block of a history."""
    phases: list[str] = []
    found = estimated(made, status, history, {}, no_solver, phases.append)
    assert phases == ["accuracy"]
    block: dict[str, Any] = found["accuracy"]
    return block


def test_an_angle_at_a_pressure_is_off_by_more_where_the_pressure_rises_less() -> None:
    # P ∝ √θ: a percent of P is two percent of θ
    points = [(float(n), 10 * n**0.5) for n in range(1, 37)]
    root = total(turns(), rows(*points))
    line = total(turns(), rows(*((float(n), float(n)) for n in range(1, 37))))
    assert root["estimated"] == pytest.approx(2 * line["estimated"], rel=0.05)


def test_at_the_greatest_pressure_no_angle_is_promised() -> None:
    block = total(turns(), rows((40, 40), (80, 60), (120, 66), (121, 66.0001)))
    assert not block["promised"]
    assert "greatest pressure" in block["reason"]
    # a pressure at an angle is
    made = read_case(
        ROOT / "cases" / "cell.yaml",
        ["effects.0.pressure={angle: 121 deg}", "output={}", "accuracy=5 %"],
    )
    assert total(made, rows((40, 40), (80, 60), (120, 66), (121, 66.0001)))["promised"]


def test_a_run_that_ends_early_promises_nothing() -> None:
    block = total(turns(), rows((40, 40)), "stopped")
    assert not block["promised"]
    assert "stopped" in block["reason"]
    assert not total(turns(), rows(), "failed")["promised"]


def test_points_of_a_sweep_choose_one_model(tmp_path: Path) -> None:
    from fiberbend.schema.problems import CaseError
    from fiberbend.sweep.points import read_sweep

    open_case = (
        "case: {case}\nset:\n  model: auto\n  accuracy: {asked} %\n"
        "  effects.0: {{pressure: {{angle: 90 deg}}}}\n"
        "  effects.1.winding: {{pattern: double-helix, pitch: 3 mm, fiber: kevlar}}\n"
        "  output: {{}}\n  compare: []\nvary:\n  effects.1.winding.pitch: [1.5 mm, 2 mm]\n"
        "report: {{angles: [90 deg]}}\n"
    )
    file = tmp_path / "sweep.yaml"
    asked = open_case.format(case=ROOT / "cases" / "section.yaml", asked=8)
    file.write_text(asked)
    sweep = read_sweep(file)
    assert {point.case.model for point in sweep.points} == {"section"}
    file.write_text(asked.replace("2 mm]", "6 mm]"))
    with pytest.raises(CaseError) as error:
        read_sweep(file)
    assert "the points choose different models" in str(error.value)

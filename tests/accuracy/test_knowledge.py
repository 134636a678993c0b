"""The table of errors takes no number from a run that did not reach what it was to reach."""

import dataclasses
import json
import math
from pathlib import Path
from typing import Any

import pytest

from bench import knowledge as made
from fiberbend.accuracy import budget
from fiberbend.accuracy import ends as ends_module
from fiberbend.accuracy.budget import mesh_error
from fiberbend.accuracy.computed import _beside
from fiberbend.accuracy.table import FILE, at, knowledge, outside, reaches
from fiberbend.models.model import Rung
from fiberbend.reader.reader import parse_case

CASE = made.case_of("baseline", "section", {"section": 1}, winding=made.SPREAD)


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder of solutions, of which none is solved."""
    monkeypatch.setattr(made, "KEPT", tmp_path)
    monkeypatch.setitem(made._only, "kept", True)
    return tmp_path


def keep(monkeypatch: pytest.MonkeyPatch, content: dict[str, Any]) -> None:
    """Keep a solution of the case as the script does."""

    def solve(_: dict[str, Any], path: Path) -> None:
        path.write_text(json.dumps(content), encoding="utf-8")

    monkeypatch.setattr(made, "_solve", solve)
    monkeypatch.setitem(made._only, "kept", False)


ROWS = [{"angle_deg": angle, "pressure_kPa": angle / 2} for angle in made.ANGLES]


def test_a_solution_that_reached_all_its_stops_counts(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    keep(monkeypatch, {"status": "converged", "reason": "", "rows": ROWS})
    assert list(made.pressures(CASE)) == [angle / 2 for angle in made.ANGLES]


@pytest.mark.parametrize(
    ("status", "rows"), [("failed", ROWS), ("stopped", ROWS), ("converged", ROWS[:-1])]
)
def test_one_that_ended_early_gives_no_number_at_all(
    monkeypatch: pytest.MonkeyPatch, status: str, rows: list[dict[str, float]]
) -> None:
    keep(monkeypatch, {"status": status, "reason": "ballooning", "rows": rows})
    with pytest.raises(made.UnsolvedError, match="ballooning"):
        made.pressures(CASE)
    # nor the second time, from what is kept
    with pytest.raises(made.UnsolvedError, match="ballooning"):
        made.pressures(CASE)


def test_one_that_is_not_kept_is_missing_with_its_name(kept: Path) -> None:
    assert not list(kept.iterdir())
    with made._unless_missing("baseline: cells"):
        made.pressures(CASE)
    assert made._missing.pop("baseline: cells") == "not solved yet"


def test_the_shipped_table_has_a_number_for_every_angle_that_was_asked_for() -> None:
    data = json.loads(FILE.read_text(encoding="utf-8"))
    assert data["actuators"]
    for entry in data["actuators"]:
        asked = [a for a in made.ANGLES if a <= made.UP_TO.get(entry["name"], math.inf)]
        curves = [*entry["spread"].values(), *entry.get("turns", {}).values()]
        curves += [entry["winding"]] if "winding" in entry else []
        for curve in curves:
            assert len(curve) == len(asked)
            assert all(isinstance(value, float) for value in curve)


def test_a_curve_that_ends_early_says_nothing_beyond_its_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    table = knowledge()
    last = len(table.curvatures) - 1
    curve = (1.0,) * last
    assert reaches(table.curvatures, curve, table.curvatures[last - 1])
    assert not reaches(table.curvatures, curve, table.curvatures[last])
    assert reaches(table.curvatures, (*curve, 1.0), 2 * table.curvatures[last])
    # a cell whose actuator was not bent as far
    early = next(k for k in table.actuators if k.turns and k.section == "hemicircle")
    short = {rung: values[:last] for rung, values in early.turns.items()}
    replaced = dataclasses.replace(early, turns=short)
    only = dataclasses.replace(table, actuators=(replaced,))
    monkeypatch.setattr(budget, "knowledge", lambda: only)
    cell = parse_case(made.case_of(early.name, "cell", {"section": 1}, winding=made.TURNS))
    assert mesh_error(cell, Rung(1, 1), table.curvatures[last - 1]) is not None
    assert mesh_error(cell, Rung(1, 1), table.curvatures[last]) is None


def test_a_pitch_without_a_cell_is_outside_of_what_is_known_of_turns() -> None:
    box = knowledge().of_section("rectangle")
    wide = max(known.numbers["pitch"] for known in box if known.turns)
    numbers = dict(box[0].numbers) | {"pitch": 1.3 * wide}
    found = {text.split()[0]: times for text, times in outside(box, numbers, turns=True)}
    assert found["pitch"] == pytest.approx(1.3)


@pytest.mark.parametrize("n", [1, 3])
def test_the_section_beside_a_run_has_its_elements(n: int) -> None:
    """Else the error that it shares with no cell would be missing from what is found."""
    case = parse_case(
        made.case_of("rectangle", "section", {"section": n}, winding=made.SPREAD)
        | {"accuracy": "5 %"}
    )
    beside = _beside(case, [{"angle_deg": 90.0, "pressure_kPa": 40.0}])
    assert beside.mesh.section == n


def test_ends_beyond_the_bodies_that_are_known_are_the_greatest_known() -> None:
    table = knowledge()
    ends = next(known.ends for known in table.actuators if known.ends[0])
    beyond = ends_module._longer(ends, 1.2 * ends[0][-1])
    assert beyond == max(abs(value) for value in ends[1])
    assert ends_module._longer(ends, ends[0][1]) == abs(at(*ends, ends[0][1]))

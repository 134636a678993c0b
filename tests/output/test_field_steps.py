"""Which states have fields, and the obstacles beside them: from the case to the files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import pyvista as pv

from fiberbend import run
from fiberbend.case.convert import obstacle_shapes
from fiberbend.columns import ANGLE, PRESSURE, STEP
from fiberbend.models.choice import choose_model
from fiberbend.plan.estimate import drawing_seconds
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case, read_case
from tests.run.conftest import SMALL, small

ROOT = Path(__file__).resolve().parents[2]


def section(**output: Any) -> dict[str, Any]:
    winding = SMALL["effects"][1]["winding"] | {"as": "smeared"}
    return small(
        effects=[SMALL["effects"][0], {"winding": winding}],
        model="section",
        mesh={"section": 1},
        solver={"max_turn": "4 deg"},
        output={"at_angles": ["8 deg"], "pictures": False, "report": False} | output,
    )


def test_all_steps_or_those_that_are_asked_for(tmp_path: Path) -> None:
    rows: dict[str, list[dict[str, Any]]] = {}
    times: dict[str, list[float]] = {}
    for steps in ("requested", "all"):
        folder = tmp_path / steps
        rows[steps] = run(section(field_steps=steps), folder).rows
        reader = pv.get_reader(str(folder / "fields" / "states.pvd"))
        times[steps] = list(reader.time_values)
        for row in rows[steps]:
            if row[STEP] not in times[steps]:
                continue
            reader.set_active_time_value(row[STEP])
            wall = reader.read()[0]["body"]["wall"]
            assert wall.field_data["pressure_kPa"] == pytest.approx([row[PRESSURE]])
            assert wall.field_data["angle_deg"] == pytest.approx([row[ANGLE]])
    assert times["all"] == [row[STEP] for row in rows["all"]]
    asked = [row[STEP] for row in rows["requested"] if row[ANGLE] == pytest.approx(8.0)]
    assert times["requested"] == [0, *asked, rows["requested"][-1][STEP]]
    assert len(times["all"]) > len(times["requested"]) == 3


@pytest.mark.parametrize(
    ("file", "names"),
    [
        ("free_bending.yaml", []),
        ("blocked_tip.yaml", ["roof", "post"]),
        ("grasp.yaml", ["cylinder"]),
        ("grasp_table.yaml", ["plane"]),
    ],
)
def test_obstacles_of_cases(file: str, names: list[str]) -> None:
    assert list(obstacle_shapes(read_case(ROOT / "cases" / file))) == names


def not_used(case: dict[str, Any]) -> str:
    """The line of a plan on settings without effect."""
    rows = dict(make_plan(parse_case(case)).rows)
    return ", ".join(rows.get("not used", ()))


def test_a_plan_says_which_settings_of_fields_are_not_used() -> None:
    assert not_used(section(field_halves="both", field_steps="all")) == ""
    both = {"output": {"field_halves": "both"}}
    assert not_used(small(**both)) == ""
    assert not_used(small(**both, mesh={"axial": "4 mm", "symmetry": "full"})) == (
        "output.field_halves"
    )
    off = section(fields=False, field_halves="both", field_steps="all")
    assert not_used(off) == "output.field_halves, output.field_steps"
    hand = section(field_halves="both")
    hand["effects"][1]["winding"]["pattern"] = "single-helix-right"
    # half a turn makes its section whole anyway
    assert not_used(hand) == "output.field_halves"


def test_a_plan_counts_the_time_of_all_fields() -> None:
    def seconds(**output: Any) -> float:
        case = parse_case(section(**output))
        return drawing_seconds(case, choose_model(case)[0])

    few, every = seconds(), seconds(field_steps="all")
    assert every > few > 0
    assert seconds(field_halves="both") == pytest.approx(2 * few)
    assert seconds(fields=False, field_steps="all") == 0.0

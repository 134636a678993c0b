"""Every doubt that the program knows stands in `warnings`, in the plan, and at a run's end."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import pytest

from fem.solver.layers import InaccurateError, Layers
from fiberbend import run
from fiberbend.columns import ANGLE, ITERATIONS, PRESSURE
from fiberbend.effects.effect import Effect
from fiberbend.models.choice import choose_model
from fiberbend.models.result import RunResult
from fiberbend.plan import doubts as known
from fiberbend.plan.doubts import doubts, errors
from fiberbend.plan.memory import Room
from fiberbend.plan.plan import make_plan
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from tests.conftest import ROOT
from tests.run.conftest import small

BASELINE = ROOT / "cases" / "free_bending.yaml"
SOFT = "effects.1.winding.fiber={modulus: 31076 Pa, diameter: 0.38 mm}"
BEFORE: dict[str, tuple[list[str], str]] = {
    "unresolved": (["mesh.axial=4 mm"], "winding NOT resolved (elements of 4 mm under a pitch of"),
    "soft thread": (
        ["model=section", SOFT],
        "winding: the thread's modulus, 0.031076 MPa, is below the wall's, 0.66 MPa: it holds "
        'hardly anything; did you mean "31.076 MPa"?',
    ),
    "few turns": (
        ["model=section", "effects.1.winding.pitch=80 mm"],
        "winding: 2 turns over the chamber's length are spread over its surface",
    ),
    "far turns": (
        ["model=section", "effects.1.winding.pitch=9 mm"],
        "winding: rubber bulges between turns 9 mm apart, how much too low that makes the pressure "
        "is not known beyond 6 mm",
    ),
    "closed form": (
        ["model=analytic", "materials.wall={name: elastosil-m4601, bulk: 100 MPa}"],
        "model analytic leaves out materials.wall.bulk: in closed forms every material is",
    ),
    "loose": (["solver.tolerance=0.001"], "solver.tolerance 0.001: forces balance to that part"),
}


@pytest.mark.parametrize("name", BEFORE)
def test_a_doubt_known_before_stands_in_the_plan(name: str) -> None:
    settings, text = BEFORE[name]
    case = read_case(BASELINE, settings)
    assert sum(line.startswith(text) for line in doubts(case)) == 1
    assert dict(make_plan(case).rows)["warnings"] == tuple(doubts(case))


@pytest.mark.parametrize("model", ["section", "cell", "body"])
def test_the_baseline_is_not_doubtful(model: str) -> None:
    case = read_case(BASELINE, [f"model={model}"])
    assert doubts(case) == []
    assert "warnings" not in dict(make_plan(case).rows)


def test_little_memory_is_a_doubt(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(known, "room", lambda: Room(600.0, "of this machine"))
    (text,) = doubts(read_case(BASELINE, ["model=section"]))
    assert text.startswith("memory: about 0.4")
    assert "of the 0.6 GB that are free" in text
    monkeypatch.setattr(known, "room", lambda: Room(300.0, "of this machine"))
    (text,) = doubts(read_case(BASELINE, ["model=section"]))
    assert "where 0.3 GB are free" in text


def test_an_effect_that_knows_no_error_is_a_doubt() -> None:
    class Wind(Effect):
        name = "wind"

    case = read_case(BASELINE)
    blown = case.model_copy(update={"effects": (*case.effects, Wind())})
    assert doubts(blown) == ["wind: what it adds to the error is not known"]


def ran(case: dict[str, Any], folder: Path) -> tuple[dict[str, Any], list[str]]:
    """Content of run.json, and what a run has printed."""
    stream = io.StringIO()
    result = run_case(parse_case(case), folder, progress=Progress(stream=stream))
    written = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert written["warnings"] == result.run["warnings"]
    return written, stream.getvalue().splitlines()


def end_of(printed: list[str], count: int) -> list[str]:
    """The last lines of a run, its warnings."""
    assert printed[-count - 1] == f"{count} warning{'s' if count > 1 else ''}:"
    return [line.removeprefix("  ") for line in printed[-count:]]


def test_doubts_stand_in_run_json_and_at_the_end(tmp_path: Path) -> None:
    """Known before, found on the way (none here) and by the other models, in one list."""
    pressure, file = {"pressure": {"to": "4 kPa"}}, tmp_path / "points.csv"
    # a finger that needs much less pressure, and a point beyond the run
    file.write_text(f"{PRESSURE},{ANGLE}\n1,1.1\n100,90\n", encoding="utf-8")
    output = {"pictures": False, "fields": False, "measured": str(file)}
    case = small(effects=[pressure, small()["effects"][1]], output=output)
    run, printed = ran(case, tmp_path / "body")
    warnings = run["warnings"]
    assert warnings[0].startswith("winding NOT resolved (elements of 4 mm")
    assert any(
        text.startswith("run: pressure ")
        and "higher than measured (points.csv) at" in text
        and text.endswith("beyond the 11 % expected: unexplained")
        for text in warnings
    )
    assert any("measured points lie beyond the run" in text for text in warnings)
    assert end_of(printed, len(warnings)) == warnings


def test_closed_forms_have_warnings_too(tmp_path: Path) -> None:
    run, printed = ran(small(model="analytic", mesh={}), tmp_path / "analytic")
    assert run["warnings"][0].startswith("model analytic leaves out effects.1.winding")
    assert end_of(printed, len(run["warnings"])) == run["warnings"]


def test_pictures_that_cannot_be_drawn_are_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fiberbend.drawing.renderer import PictureError
    from fiberbend.running import uniform_outputs

    def blind(*_: Any) -> None:
        raise PictureError("no display")

    monkeypatch.setattr(uniform_outputs, "draw_bent", blind)
    spread = small()["effects"][1]["winding"] | {"as": "smeared"}
    effects = [{"pressure": {"to": "2 kPa"}}, {"winding": spread}]
    output = {"pictures": True, "fields": False}
    run, printed = ran(
        small(model="section", mesh={}, effects=effects, output=output), tmp_path / "section"
    )
    assert run["warnings"] == ["no pictures in space: no display"]
    assert end_of(printed, 1) == run["warnings"]


def test_a_run_without_doubts_says_nothing(tmp_path: Path) -> None:
    spread = small()["effects"][1]["winding"] | {"as": "smeared"}
    effects = [{"pressure": {"to": "2 kPa"}}, {"winding": spread}]
    output = {"pictures": False, "fields": False}
    run, printed = ran(
        small(model="section", mesh={}, effects=effects, output=output), tmp_path / "section"
    )
    assert run["warnings"] == []
    assert not any("warning" in line for line in printed)


@pytest.mark.parametrize("where", ["renew", "solve"])
def test_a_body_left_to_mumps_midway_ends_the_same_and_says_so(
    where: str, small_run: RunResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    original, calls = getattr(Layers, where), 0
    error = {"renew": ZeroDivisionError, "solve": InaccurateError}[where]

    def fails_at_the_fourth(self: Layers, *args: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == 4:
            raise error("the fourth fails")
        return original(self, *args)

    monkeypatch.setattr(Layers, where, fails_at_the_fourth)
    found = run(small(output={"at_angles": ["8 deg"], "at_pressures": ["30 kPa"]}))
    assert calls == 4
    told = [line for line in found.run["warnings"] if "MUMPS" in line]
    assert told == ["MUMPS goes on, with the same results but slower: the fourth fails"]
    assert not any("MUMPS" in line for line in small_run.run["warnings"])
    assert len(found.rows) == len(small_run.rows)
    for mine, theirs in zip(found.rows, small_run.rows, strict=True):
        for key in (ANGLE, PRESSURE, ITERATIONS):
            assert mine[key] == pytest.approx(theirs[key], rel=1e-8, abs=1e-12)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("free_bending_smeared", "tetrahedra: P up to 1.3 % above"),
        ("blocked_tip", "tetrahedra: tip force 3 to 4 % below"),
    ],
)
def test_what_tetrahedra_cost_is_an_expected_error_and_no_warning(name: str, text: str) -> None:
    case = read_case(ROOT / "cases" / f"{name}.yaml", ["mesh.element=tetrahedron"])
    assert not any("tetrahedra" in line for line in doubts(case))
    assert sum(line.startswith(text) for line in errors(case, choose_model(case)[0])) == 1

"""The plan of a case: right in what it counts, honest in what it estimates, readable.

A user decides by it what to run. Counts must be those of the run; time, memory and error carry
where they come from. What is compared with runs is copied from their run.json.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.plan.estimate import cost_of, expected_angle
from fiberbend.plan.plan import WIDTH, Plan, make_plan
from fiberbend.reader.reader import read_case
from tests.cases.bad_cases import BLOCKED, HOOPS, SMEARED

ROOT = Path(__file__).resolve().parents[2]
CASES = sorted((ROOT / "cases").glob("*.yaml"))
BASELINE = ROOT / "cases" / "free_bending.yaml"
SINGLE = "effects.1.winding.pattern=single-helix-left"


def case(*settings: str) -> Case:
    return read_case(BASELINE, settings)


def plan(*settings: str) -> Plan:
    return make_plan(case(*settings))


def row(plan: Plan, heading: str) -> str:
    """What the plan says under a heading."""
    return "\n".join(dict(plan.rows).get(heading, ()))


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_every_case_file_has_a_readable_plan(path: Path) -> None:
    made = make_plan(read_case(path))
    headings = [heading for heading, _ in made.rows]
    wanted = [
        "effects",
        "model",
        "half",
        "elements",
        "unknowns",
        "steps",
        "time",
        "memory",
        "error",
    ]
    assert [heading for heading in headings if heading in wanted] == wanted
    assert all(0 < len(line) <= WIDTH for line in made.lines())
    assert made.steps is not None


@pytest.mark.parametrize(
    ("settings", "elements", "unknowns"),
    [
        (["model=section"], 72, 882),
        (["model=section", SINGLE], 72, 1215),
        (["model=section", "mesh.section=4"], 288, 3346),
        (["model=cell"], 18, 927),
        (["model=cell", "mesh.axial=0.75 mm"], 36, 1569),
        (["model=cell", SINGLE], 72, 2988),
        ([], 2446, 85987),
        ([SMEARED, "mesh.axial=4 mm"], 928, 32869),
        ([SMEARED, "mesh.axial=4 mm", "mesh.symmetry=full"], 1856, 62558),
        (["mesh.section=2", SMEARED, "mesh.axial=4 mm"], 3712, 118231),
    ],
    ids=str,
)
def test_size_is_that_of_the_run(settings: list[str], elements: int, unknowns: int) -> None:
    made = plan(*settings)
    assert (made.elements, made.unknowns) == (elements, unknowns)


def test_tetrahedra_are_about_as_many_as_in_the_run() -> None:
    """`make times` has run it: 9428 elements, 50492 unknowns."""
    made = plan(SMEARED, "mesh.axial=4 mm", "mesh.element=tetrahedron")
    assert made.elements == pytest.approx(9428, rel=0.05)
    assert made.unknowns == pytest.approx(50492, rel=0.05)
    assert row(made, "unknowns") == f"about {made.unknowns}"
    assert row(made, "elements") == f"about {made.elements} tetrahedra"


def test_global_unknowns_are_named() -> None:
    by_angle = "effects.0={pressure: {angle: 90 deg}}"
    assert row(plan("model=section", SINGLE, by_angle, "output={}"), "unknowns") == (
        "1215, and curvature, stretch, twist, pressure"
    )
    held = ["model=section", "effects.2.straight={stretch: held}", "output={}"]
    assert row(plan(*held), "unknowns") == "882"
    assert row(plan("effects.0={pressure: {volume: 40 mL}}"), "unknowns") == "85987, and pressure"


@pytest.mark.parametrize(
    ("name", "settings", "steps"),
    [
        ("section", [], 36),
        ("cell", [], 11),
        ("rectangle", [], 20),
        ("circle", [], 19),
        ("single_helix", [], 20),
        ("straight", [], 7),
        ("free_bending_smeared", [], 5),
        ("section", ["solver.max_turn=5 deg"], 72),
    ],
)
def test_steps_are_about_those_of_the_run(name: str, settings: list[str], steps: int) -> None:
    made = make_plan(read_case(ROOT / "cases" / f"{name}.yaml", settings))
    assert made.steps == pytest.approx(steps, rel=0.25)


def test_angle_of_a_pressure_is_foreseen_where_the_closed_form_has_it() -> None:
    # 390° by the section model: near enough to count steps
    assert expected_angle(case("output={}")) == pytest.approx(6.8, rel=0.15)
    assert expected_angle(case()) == pytest.approx(6.2832, rel=0.05)
    back = expected_angle(case("effects.0.pressure.to=-20 kPa", "output={}"))
    assert back is not None
    assert -1.6 < back < 0
    assert expected_angle(case("materials.floor=elastosil-m4601", "output={}")) is None
    unforeseen = plan("materials.floor=elastosil-m4601", "output={}", "model=section")
    assert unforeseen.steps is None
    assert row(unforeseen, "steps") == "at most 10° each"
    assert "s a step" in row(unforeseen, "time")


def test_finer_meshes_and_whole_bodies_take_longer_and_more_memory() -> None:
    settings = [
        [SMEARED, "mesh.axial=4 mm"],
        [SMEARED, "mesh.axial=2 mm"],
        [SMEARED, "mesh.axial=2 mm", "mesh.symmetry=full"],
        [SMEARED, "mesh.axial=2 mm", "mesh.section=2"],
    ]
    costs = []
    for changes in settings:
        changed = case(*changes)
        body = meshed(changed)
        costs.append(cost_of(changed, body, body.size(changed)))
    assert [c.step_s for c in costs] == sorted(c.step_s for c in costs)
    assert [c.memory_mb for c in costs] == sorted(c.memory_mb for c in costs)


def test_cold_cache_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert "more as nothing is compiled yet" in row(plan("model=section"), "time")
    folder = tmp_path / "fiberbend" / "0123456789ab"
    folder.mkdir(parents=True)
    (folder / "libffcx_forms.so").touch()
    assert "more if no scene of this kind was compiled" in row(plan("model=section"), "time")


def test_pictures_and_fields_cost_extra() -> None:
    more = "more for pictures and fields"
    assert more in row(plan("model=section"), "time")
    silent = "output={pictures: false, fields: false}"
    assert more not in row(plan("model=section", silent), "time")
    assert "more for pictures" in row(plan("model=analytic"), "time")
    assert "more for pictures" not in row(plan("model=analytic", silent), "time")


def test_plan_says_why_no_cheaper_model() -> None:
    text = row(plan("model=auto"), "model")
    assert text.startswith("cell (the cheapest that supports everything)\n")
    assert "analytic does not support effects.1.winding: only cell and body have turns" in text
    assert "section does not support effects.1.winding: only cell and body have turns" in text
    dearer = row(plan(SMEARED), "model")
    assert "analytic leaves out effects.1.winding: in closed forms a winding has" in dearer
    assert dearer.endswith("section supports everything too: auto would take it")
    assert row(plan("model=auto", HOOPS), "model") == (
        "analytic (the cheapest that supports everything)"
    )


def test_plan_says_what_is_not_used_and_left_out() -> None:
    section = plan("model=section", "mesh.section=3", "mesh.symmetry=full")
    assert row(section, "not used") == "mesh.axial, mesh.symmetry, support"
    closed = plan("model=analytic", "solver.max_turn=5 deg", BLOCKED)
    assert row(closed, "not used") == "mesh.axial, solver.max_turn, support"
    assert row(closed, "left out").count("effects.") == 2
    assert row(closed, "unknowns") == "none, a closed form"
    assert row(plan("model=cell"), "not used") == "support"
    assert row(plan("model=body"), "not used") == ""


def test_a_motion_has_steps_in_time() -> None:
    moving = make_plan(read_case(ROOT / "cases" / "swing.yaml", ["solver.max_turn=5 deg"]))
    assert row(moving, "steps").startswith("about 300, 5 ms each")
    assert moving.steps == 300
    assert row(moving, "not used") == "solver.max_turn"


def test_plan_says_whether_the_winding_is_resolved() -> None:
    assert row(plan(), "winding").startswith("resolved (elements of 1.5 mm")
    assert row(plan("mesh.axial=4 mm"), "winding").startswith("NOT resolved")
    # the slice of a cell is shorter than the elements that a body may have
    assert row(plan("mesh.axial=4 mm", "model=cell"), "winding").startswith("resolved")
    assert row(plan("model=section"), "winding") == ""


def test_expected_error_follows_the_winding() -> None:
    # 3.5 % at 90° to 5.1 % at 360° for a pitch of 3 mm: docs/crosscheck.md
    spread = row(plan("model=section"), "error")
    assert "3.5 % at 90° to 5.1 % at 360°" in spread
    assert "(docs/crosscheck.md)" in spread
    finer = row(plan("model=section", "effects.1.winding.pitch=1.5 mm"), "error")
    assert "1.4 % at 90° to 2.1 % at 360°" in finer
    assert "scaled from 3 mm" in finer
    assert "P too low" not in row(plan("model=cell"), "error")
    # one layer a half pitch is too few where the crown is stretched by half
    assert "up to 1.9 %" in row(plan("model=cell", "mesh.axial=1.5 mm"), "error")
    assert "up to 0.5 %" in row(plan("model=cell", "mesh.axial=0.375 mm"), "error")
    assert "P too low" not in row(plan(), "error")
    assert "P too low by about 2.8 %" in row(plan("mesh.axial=4 mm"), "error")
    assert "tip force" in row(plan(BLOCKED), "error")
    assert "closed form" in row(plan("model=analytic"), "error")
    weight = ["effects=[{gravity: {direction: -y}}]", "output={}"]
    heavy = "materials.floor={law: neo-hooke, mu: 16 MPa, density: 1100 kg/m^3}"
    assert row(plan(*weight, heavy), "error") == ""

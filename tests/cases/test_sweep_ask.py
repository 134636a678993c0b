"""What a sweep is asked for: states that every point hits, a part of the points, and warnings."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.schema.problems import CaseError
from fiberbend.sweep.command import run_sweep
from fiberbend.sweep.only import choose
from fiberbend.sweep.points import Sweep, read_sweep
from fiberbend.sweep.seen import hardly_seen
from fiberbend.sweep.store import Store
from fiberbend.sweep.table import collect

ROOT = Path(__file__).resolve().parents[2]
BASELINE = ROOT / "cases" / "free_bending_smeared.yaml"
PITCH = "effects.1.winding.pitch"
Read = Callable[..., Sweep]


def grid(**changes: Any) -> dict[str, Any]:
    """A sweep file of six points up to 60 kPa."""
    base = {
        "case": str(BASELINE),
        "set": {
            "model": "section",
            "effects.0": {"pressure": {"to": "60 kPa"}},
            "output": {},
            # the shipped case asks for the line of the paper
            "compare": [],
        },
        "vary": {"actuator.radius": ["6 mm", "8 mm"], "actuator.wall": ["1 mm", "2 mm", "3 mm"]},
    }
    return base | changes


@pytest.fixture
def file(tmp_path: Path) -> Callable[[dict[str, Any]], Path]:
    """Write a sweep file."""

    def write(data: dict[str, Any]) -> Path:
        path = tmp_path / "sweep.yaml"
        path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
        return path

    return write


@pytest.fixture
def read(file: Callable[[dict[str, Any]], Path]) -> Read:
    return lambda data, *settings: read_sweep(file(data), settings)


def complaints(call: Callable[[], object]) -> list[str]:
    with pytest.raises(CaseError) as error:
        call()
    return [str(problem) for problem in error.value.problems]


def row_of(sweep: Sweep, begin: str) -> dict[str, Any]:
    """The first row of the table of a sweep that has not run, of columns with a beginning."""
    row = collect(sweep, Store(Path("nowhere")))[0]
    return {name: value for name, value in row.items() if name.startswith(begin)}


# --- states ------------------------------------------------------------------------------------


def test_reported_pressures_are_asked_of_every_point(read: Read) -> None:
    """Like angles: an interpolated angle would carry the steps' coarseness into the table."""
    sweep = read(grid(report={"pressures": ["30 kPa", "0.06 MPa"]}))
    for point in sweep.points:
        assert point.case.output.at_pressures == pytest.approx([0.03, 0.06])
    assert list(row_of(sweep, "angle_")) == ["angle_30kPa_deg", "angle_60kPa_deg"]


def test_pressures_out_of_reach(read: Read) -> None:
    far = grid(report={"pressures": ["30 kPa", "70 kPa"]})
    hint = "the pressure of the base case has to reach it, effects: pressure: {to: …}"
    assert complaints(lambda: read(far)) == [
        'report.pressures.1: "70 kPa", expected a pressure between zero and "60 kPa"; '
        f"{hint} (line 20)"
    ]
    found = grid(report={"pressures": ["30 kPa"]})
    found["set"] |= {"effects.0": {"pressure": {"angle": "90 deg"}}}
    text = "no effect where the pressure is found, expected no value"
    assert complaints(lambda: read(found)) == [f"report.pressures.0: {text}; {hint} (line 19)"]


def test_force_of_a_blocked_case_is_no_interpolation(read: Read) -> None:
    tip = str(ROOT / "cases" / "blocked_tip.yaml")
    sweep = read(
        {"case": tip, "vary": {"actuator.wall": ["2 mm"]}, "report": {"force_at": "60 kPa"}}
    )
    assert 0.06 in sweep.points[0].case.output.at_pressures
    assert sweep.points[0].blocked is None


def test_points_leave_files_of_their_own_on_request(read: Read) -> None:
    """36 reports of 3 MB would bury the table; who wants one names it."""
    names = ("pictures", "fields", "report")
    quiet = read(grid(report={"force_at": "10 kPa"})).points[0]
    assert quiet.blocked is not None
    for case in quiet.cases:
        assert [getattr(case.output, name) for name in names] == [False] * 3
    asked = read(grid(), "output.report=true", "output.fields=true").points[0].case.output
    assert [getattr(asked, name) for name in names] == [False, True, True]


# --- a part of the points ----------------------------------------------------------------------


@pytest.mark.parametrize("text", ["wall=2mm", "wall=2 mm", "wall=0.2 cm", "actuator.wall=2e-3 m"])
def test_a_value_is_compared_as_a_quantity(text: str, read: Read) -> None:
    chosen = choose(read(grid()), [text])
    assert [point.name for point in chosen] == ["radius-6mm_wall-2mm", "radius-8mm_wall-2mm"]


def test_values_of_a_field_join_and_fields_narrow(read: Read) -> None:
    sweep = read(grid())
    chosen = choose(sweep, ["wall=2mm", "wall=3mm", "radius=8mm"])
    assert [point.name for point in chosen] == ["radius-8mm_wall-2mm", "radius-8mm_wall-3mm"]
    assert choose(sweep, []) == sweep.points
    part = sweep.part(chosen)
    assert part.points == chosen
    assert [column.values for column in part.columns] == [(8.0, 8.0), (2.0, 3.0)]


def test_mappings_and_text_can_be_chosen(read: Read) -> None:
    laws = ["elastosil-m4601", {"law": "neo-hooke", "mu": "0.2 MPa"}]
    sweep = read(grid(vary={"materials.wall": laws, "actuator.wall": ["1 mm", "2 mm"]}))
    chosen = choose(sweep, ["materials.wall={law: neo-hooke, mu: 200 kPa}"])
    assert {point.case.materials.wall.law for point in chosen} == {"neo-hooke"}
    assert len(choose(sweep, ["materials.wall=elastosil-m4601"])) == 2


@pytest.mark.parametrize(
    ("only", "line"),
    [
        (
            ["wal=2mm"],
            '--only wal=2mm: "wal", expected a field that varies, radius, wall; did you mean wall?',
        ),
        (["wall=4mm"], "--only wall=4mm: no point has that wall, there are 1 mm, 2 mm, 3 mm"),
        (["wall=2"], "--only wall=2: no point has that wall, there are 1 mm, 2 mm, 3 mm"),
        (["wall=2 kPa"], "--only wall=2 kPa: no point has that wall, there are 1 mm, 2 mm, 3 mm"),
        (["wall"], "--only wall: expected FIELD=VALUE, such as wall=2mm"),
        (["wall=["], "--only wall=[: '[' is not a YAML value"),
    ],
)
def test_what_no_point_has_is_refused_with_what_there_is(
    only: list[str], line: str, read: Read
) -> None:
    sweep = read(grid())
    assert complaints(lambda: choose(sweep, only)) == [line]


def test_a_name_of_two_fields_is_refused(read: Read) -> None:
    vary = {"actuator.wall": ["1 mm", "2 mm"], "materials.wall": ["elastosil-m4601"]}
    sweep = read(grid(vary=vary))
    assert complaints(lambda: choose(sweep, ["wall=1 mm"])) == [
        "--only wall=1 mm: wall is actuator.wall and materials.wall, expected one of them"
    ]


def test_values_that_no_point_has_together(read: Read) -> None:
    points = [{"actuator.wall": "1 mm", "actuator.floor": "2 mm"}]
    points += [{"actuator.wall": "2 mm", "actuator.floor": "3 mm"}]
    sweep = read(grid(points=points, vary={}))
    assert complaints(lambda: choose(sweep, ["wall=1mm", "floor=3mm"])) == [
        "--only: no point has wall=1mm and floor=3mm together"
    ]


# --- what the model hardly sees ----------------------------------------------------------------


def test_a_smeared_winding_hardly_has_a_pitch(read: Read) -> None:
    data = grid(vary={PITCH: ["2 mm", "4 mm"], "actuator.wall": ["1 mm", "2 mm"]})
    (warning,) = hardly_seen(read(data))
    assert warning.startswith(f"{PITCH} varies, which model section hardly sees: its winding is")
    assert "model cell sees it" in warning
    assert warning.endswith("for 4")
    # the settings that it names make it true: four elements along half of the least pitch
    settings = ["model=cell", "effects.1.winding.as=discrete", "mesh.axial=0.25 mm"]
    named = warning.replace('"', "")
    assert all(f"--set {setting}" in named for setting in settings)
    assert hardly_seen(read(data, *settings)) == []


def test_a_body_is_named_where_no_cheaper_model_can(read: Read) -> None:
    data = {"case": str(ROOT / "cases" / "grasp.yaml"), "vary": {PITCH: ["2 mm", "3 mm"]}}
    (warning,) = hardly_seen(read(data))
    assert "model body sees it (--set model=body --set effects.1.winding.as=discrete" in warning
    assert '--set mesh.axial="1 mm"' in warning


@pytest.mark.parametrize(
    ("vary", "model", "remedy"),
    [
        ({"mesh.axial": ["1 mm", "2 mm"]}, "section", "model cell sees it"),
        ({"actuator.cap": ["10 mm", "15 mm"]}, "section", "model rod sees it"),
        ({"mesh.section": [1, 2]}, "analytic", "model section sees it"),
        ({PITCH: ["2 mm", "3 mm"]}, "analytic", "model cell sees it"),
        ({"effects.1.winding.fiber.modulus": ["5 GPa", "50 GPa"]}, "cell", "no model sees more"),
    ],
)
def test_models_answer_for_themselves(
    vary: dict[str, Any], model: str, remedy: str, read: Read
) -> None:
    thread = {"modulus": "5 GPa", "diameter": "0.2 mm"}
    data = grid(vary=vary)
    data["set"] |= {"model": model, "effects.1.winding.fiber": thread}
    (warning,) = hardly_seen(read(data))
    assert f"model {model} hardly sees" in warning
    assert remedy in warning


@pytest.mark.parametrize(
    "vary",
    [
        {"actuator.wall": ["1 mm", "2 mm"]},
        {PITCH: ["2 mm"], "actuator.wall": ["1 mm", "2 mm"]},
        # soft threads stretch in every model, and two models are compared on purpose
        {"effects.1.winding.fiber.modulus": ["100 MPa", "50 GPa"]},
        {"model": ["section", "cell"], "mesh.axial": ["0.5 mm", "1 mm"]},
    ],
)
def test_what_is_seen_is_no_warning(vary: dict[str, Any], read: Read) -> None:
    data = grid(vary=vary)
    data["set"] |= {"effects.1.winding.fiber": {"modulus": "5 GPa", "diameter": "0.2 mm"}}
    if "model" in vary:
        del data["set"]["model"]
    assert hardly_seen(read(data)) == []


# --- before anything runs ----------------------------------------------------------------------


def test_a_dry_run_writes_nothing(file: Callable[[dict[str, Any]], Path], tmp_path: Path) -> None:
    path, out = file(grid(report={"force_at": "10 kPa"})), tmp_path / "out"
    said: list[str] = []
    assert run_sweep(path, out, jobs=2, say=said.append, only=["radius=6mm"], dry=True) == 0
    assert not out.exists()
    assert said[0].split() == ["radius,", "mm", "wall,", "mm", "model", "time", "memory"]
    assert [line.split()[:3] for line in said[1:4]] == [["6", str(n), "section"] for n in (1, 2, 3)]
    assert (
        said[4]
        == "each point is solved again, kept straight under 10 kPa: the time is that of both"
    )
    assert said[5] == "3 points: 0 finished before, 3 to solve"
    assert said[6].startswith("time: about ")
    assert any(line.startswith("memory: about ") for line in said)
    assert said[-1] == "nothing was solved or written"
    out.mkdir()
    (out / "thesis.tex").touch()
    assert complaints(lambda: run_sweep(path, out, say=said.append, dry=True)) == [
        f"{out}: contains no sweep, expected a new folder or that of a sweep"
    ]

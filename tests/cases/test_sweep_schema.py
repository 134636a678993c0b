"""Sweep files: what they read, the points they make, and every wrong point at once."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import pytest
import yaml

from fiberbend.effects.table import PressureEffect, StraightEffect
from fiberbend.schema.problems import CaseError
from fiberbend.sweep.fields import labels, point_name
from fiberbend.sweep.points import Sweep, read_sweep

ROOT = Path(__file__).resolve().parents[2]
SWEEPS = sorted((ROOT / "cases" / "sweeps").glob("*.yaml"))
BASELINE = ROOT / "cases" / "free_bending_smeared.yaml"
GRID: dict[str, Any] = {
    "case": str(BASELINE),
    "set": {"output": {"pictures": False, "fields": False}},
    "vary": {"actuator.radius": ["6 mm", "0.8 cm"], "actuator.wall": ["1 mm", "2 mm", "3 mm"]},
}


@pytest.fixture
def read(tmp_path: Path) -> Any:
    """Read a sweep given as a mapping, through a file."""

    def reader(data: dict[str, Any], *settings: str) -> Sweep:
        path = tmp_path / "sweep.yaml"
        path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
        return read_sweep(path, settings)

    return reader


@pytest.fixture
def complaint(read: Any) -> Any:
    """What a wrong sweep is told, without the lines of its file."""

    def lines(data: dict[str, Any]) -> list[str]:
        with pytest.raises(CaseError) as error:
            read(data)
        return [f"{problem.path}: {problem.text}" for problem in error.value.problems]

    return lines


def grid(**changes: Any) -> dict[str, Any]:
    return copy.deepcopy(GRID) | changes


@pytest.mark.parametrize("path", SWEEPS, ids=lambda path: path.stem)
def test_example_sweeps_are_valid(path: Path) -> None:
    """10 points are those of Table I of Polygerinos et al. 2015, 36 the grid behind Fig. 8."""
    counts = {"radius_length_wall": 36, "floor_stiffness": 8, "angle_at_pressure": 9}
    counts |= {"fiber_angle": 15, "fig11_straight": 6, "fig11_body": 6}
    fields = {"floor_stiffness": 1, "angle_at_pressure": 2, "fiber_angle": 2}
    fields |= {"fig11_straight": 2, "fig11_body": 2}
    sweep = read_sweep(path)
    assert len(sweep.points) == counts.get(path.stem, 10)
    assert sum(column.numeric for column in sweep.columns) == fields.get(path.stem, 3)


def test_grid_has_every_combination_and_the_last_field_is_fastest(read: Any) -> None:
    sweep = read(grid())
    assert [point.name for point in sweep.points] == [
        f"radius-{radius}mm_wall-{wall}mm" for radius in (6, 8) for wall in (1, 2, 3)
    ]
    assert [point.case.actuator.radius for point in sweep.points] == [6.0] * 3 + [8.0] * 3
    assert sweep.columns[0].values == (6.0,) * 3 + (8.0,) * 3
    assert (sweep.columns[0].label, sweep.columns[0].unit) == ("radius", "mm")
    assert len({point.digest for point in sweep.points}) == 6


def test_zip_goes_in_step_and_multiplies_the_grid(read: Any) -> None:
    paired = {"actuator.floor": ["2 mm", "3 mm"], "effects.1.winding.pitch": ["3 mm", "4 mm"]}
    sweep = read(grid(zip=paired))
    assert len(sweep.points) == 2 * 6
    pairs = {
        (point.case.actuator.floor, point.case.effects[1].pitch)  # type: ignore[attr-defined]
        for point in sweep.points
    }
    assert pairs == {(2.0, 3.0), (3.0, 4.0)}


def test_points_can_name_different_fields(read: Any) -> None:
    """A field that a point leaves out has the base case's value, in the table too."""
    sweep = read(
        {
            "case": str(BASELINE),
            "points": [{"actuator.radius": "6 mm"}, {"actuator.wall": "1 mm"}],
        }
    )
    assert [column.values for column in sweep.columns] == [(6.0, 8.0), (2.0, 1.0)]
    assert sweep.points[1].name == "radius-8mm_wall-1mm"


def test_case_is_found_beside_the_sweep_or_in_it(tmp_path: Path, read: Any) -> None:
    data = yaml.safe_load(BASELINE.read_text(encoding="utf-8"))
    inline = read(grid(case=data))
    (tmp_path / "base.yaml").write_text(yaml.safe_dump(data), encoding="utf-8")
    beside = read(grid(case="base.yaml"))
    assert [p.digest for p in inline.points] == [p.digest for p in beside.points]


def test_settings_change_all_points(read: Any) -> None:
    sweep = read(grid(), "actuator.floor=3 mm")
    assert {point.case.actuator.floor for point in sweep.points} == {3.0}


def test_reported_angles_are_asked_of_every_point(read: Any) -> None:
    """An interpolated pressure would carry the steps' coarseness into the table."""
    sweep = read(grid(report={"angles": ["90 deg", "45 deg"]}))
    for point in sweep.points:
        assert point.case.output.at_angles == pytest.approx([math.pi / 2, math.pi / 4])


def test_blocked_force_is_a_second_case_of_uniform_models(read: Any) -> None:
    changes = {
        "set": {"model": "section", "effects.0": {"pressure": {"angle": "90 deg"}}, "output": {}},
        "report": {"force_at": "100 kPa"},
    }
    for point in read(grid(**changes)).points:
        assert point.blocked is not None
        assert point.blocked.find(StraightEffect) is not None
        pressure = point.blocked.find(PressureEffect)
        assert pressure is not None
        assert (pressure.to, pressure.angle) == (0.1, None)
        assert point.blocked.actuator == point.case.actuator
    assert all(p.blocked is None for p in read(grid(report={"force_at": "100 kPa"})).points)


def test_names_of_fields_are_short_and_apart() -> None:
    paths = ["actuator.wall", "materials.wall", "effects.0.pressure.to", "mesh.section", "model"]
    assert labels([*paths, "materials.floor.c1"]) == {
        "actuator.wall": "actuator.wall",
        "materials.wall": "materials.wall",
        "effects.0.pressure.to": "pressure.to",
        "mesh.section": "section",
        "model": "model",
        "materials.floor.c1": "floor.c1",
    }


def test_different_values_have_different_names() -> None:
    """Two points in one folder would overwrite each other."""
    values: list[Any] = ["8 mm", "8 cm", "-8 mm", "a b", "a-b", 1, True, None, {"law": "a"}]
    values += [{"law": "b"}, ["a"], "0.1 g/cm^3", "x" * 200, "x" * 201]
    names = [point_name({"value": value}) for value in values]
    assert len(set(names)) == len(values)
    assert all(len(name) < 130 and "/" not in name and " " not in name for name in names)


def test_every_wrong_value_once_where_it_stands(complaint: Any) -> None:
    """Each of them is in several points: one line each, not one a point."""
    data = grid()
    data["vary"] = {
        "actuator.radius": ["6 mm", 8, "-3 mm"],
        "actuator.wal": ["1 mm"],
        "actuator.floor": ["2 mm", "3 mm"],
    }
    data["set"] = {"actuator.sheath": "1 kPa"}
    expected = [
        f'{BASELINE}: actuator.sheath: "1 kPa", expected a length with its unit such as "8 mm"',
        "vary.actuator.wal.0: unknown key, expected one of section, radius, ",
        'vary.actuator.radius.1: 8, expected a length with its unit such as "8 mm"',
        'vary.actuator.radius.2: "-3 mm", expected a length above zero',
    ]
    found = complaint(data)
    assert len(found) == len(expected)
    assert all(line.startswith(start) for line, start in zip(found, expected, strict=True))


def test_wrong_combinations_name_their_points(complaint: Any) -> None:
    """A first step above the greatest: the value is right in the other points."""
    data = grid(vary={"solver.first_step": ["1 kPa", "5 kPa"]})
    data["zip"] = {"solver.max_step": ["10 kPa", "2 kPa"]}
    assert complaint(data) == [
        "point 4 (solver.max_step 2 kPa, solver.first_step 5 kPa): solver.first_step: "
        '"5 kPa", expected at most max_step, "2 kPa"'
    ]


def test_a_reported_angle_out_of_reach(complaint: Any) -> None:
    data = grid(report={"angles": ["90 deg", "400 deg"]})
    data["set"] = {}
    assert complaint(data) == [
        'report.angles.1: "400 deg", expected an angle up to stop_at_angle, "360 deg"'
    ]


BAD: list[tuple[dict[str, Any], list[str]]] = [
    ({"vary": {}}, ["vary: nothing varies, expected fields under vary, zip or points"]),
    ({"vary": {"actuator.radius": []}}, ["vary.actuator.radius: no value, expected at least one"]),
    ({"vary": {"actuator.radius": "6 mm"}}, ['vary.actuator.radius: "6 mm", expected a list']),
    (
        {"zip": {"actuator.radius": ["6 mm"]}},
        ["vary.actuator.radius: given under zip too, expected once"],
    ),
    (
        {"zip": {"actuator.floor": ["2 mm"], "actuator.cap": ["2 mm", "3 mm"]}},
        ["zip.actuator.cap: 2 values, expected 1 as zip.actuator.floor has"],
    ),
    ({"points": [{}]}, ["points.0: nothing set, expected paths with values"]),
    (
        {"vary": {"actuator.radius": ["8 mm", "0.8 cm"]}},
        ["point 2: the same as point 1, radius-8mm"],
    ),
    (
        {"vary": {"mesh.section": list(range(1, 102)), "mesh.axial": ["1 mm"] * 100}},
        ["vary: 10100 points, expected at most 10000"],
    ),
    ({"case": 3}, ["case: 3, expected the path of a case file, or a case"]),
    (
        {"vari": {}},
        [
            "vari: unknown key, expected one of title, case, set, vary, zip, points, report; "
            "did you mean vary?"
        ],
    ),
    (
        {"report": {"history": ["axis_strech"]}, "vary": {"actuator.wall": ["2 mm"]}},
        ['report.history.0: "axis_strech", no column of history.csv; did you mean axis_stretch?'],
    ),
    (
        {"report": {"angles": [90], "maps": ["colour"]}},
        [
            'report.angles.0: 90, expected an angle with its unit such as "90 deg"',
            'report.maps.0: "colour", expected pressure, angle, blocked-force, stretch or history',
        ],
    ),
    ({"set": {"effects.7.pressure": 1}}, ["set.effects.7: no such entry, the list has 2"]),
    (
        {"vary": {"effects.7.pressure": [1, 2]}},
        [
            "vary.effects.7.pressure.0: effects.7: no such entry, the list has 2",
            "vary.effects.7.pressure.1: effects.7: no such entry, the list has 2",
        ],
    ),
]


@pytest.mark.parametrize(("changes", "lines"), BAD, ids=[lines[0][:40] for _, lines in BAD])
def test_wrong_sweeps(changes: dict[str, Any], lines: list[str], complaint: Any) -> None:
    assert complaint(grid(**changes)) == lines


def test_missing_files(tmp_path: Path, complaint: Any) -> None:
    with pytest.raises(CaseError, match="no such file"):
        read_sweep(tmp_path / "none.yaml")
    assert complaint(grid(case="none.yaml")) == [
        f"{tmp_path / 'none.yaml'}: no such file, expected a case file"
    ]


def test_problems_name_the_line_of_their_file(tmp_path: Path) -> None:
    """Of the sweep file what stands there, of the base case what stands in that."""
    case = BASELINE.read_text(encoding="utf-8").replace("radius: 8 mm", "radius: 8")
    (tmp_path / "base.yaml").write_text(case, encoding="utf-8")
    radius = 1 + next(n for n, line in enumerate(case.splitlines()) if "radius: 8" in line)
    sweep = """\
case: base.yaml
set:
  actuator.floor: 3
vary:
  actuator.wall:
    - 2 mm
    - 3
report:
  angles: [90]
"""
    (tmp_path / "sweep.yaml").write_text(sweep, encoding="utf-8")

    def messages() -> list[str]:
        with pytest.raises(CaseError) as error:
            read_sweep(tmp_path / "sweep.yaml")
        return str(error.value).splitlines()

    reported = next(line for line in messages() if line.startswith("report.angles.0: 90"))
    assert reported.endswith(" (line 9)")
    (tmp_path / "sweep.yaml").write_text(sweep.partition("report")[0], encoding="utf-8")
    expected = 'expected a length with its unit such as "8 mm"'
    assert messages() == [
        f"base.yaml: actuator.radius: 8, {expected} (line {radius})",
        f"base.yaml: actuator.floor: 3, {expected}",
        f"vary.actuator.wall.1: 3, {expected} (line 7)",
    ]
    inner = "".join(f"  {line}\n" for line in case.splitlines())
    inline = sweep.partition("report")[0].replace("case: base.yaml\n", f"case:\n{inner}")
    (tmp_path / "sweep.yaml").write_text(inline, encoding="utf-8")
    assert f"case: actuator.radius: 8, {expected} (line {radius + 1})" in messages()

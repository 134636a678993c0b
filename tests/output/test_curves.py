"""Curves of kinds of runs: what is drawn, what leads, what is marked, and what nothing covers."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.compare.check import crosscheck
from fiberbend.drawing import curves
from fiberbend.drawing.curves import contact_forces, draw_plots, plot_contact_force
from fiberbend.drawing.style import Style
from fiberbend.drawing.tip_path import plot_tip_path
from fiberbend.models.choice import choose_model
from fiberbend.reader.reader import parse_case
from fiberbend.reader.yaml_file import load_yaml
from fiberbend.running.runner import run_case
from fiberbend.states.obstacles import Bar, Box, Shape, Sheet
from tests.conftest import ROOT
from tests.output.test_labels import box

PRESSURES = np.array([0.0, 10, 20, 30, 40, 50, 60])
TOUCH = np.array([0.0, 0, 0, 1, 2, 3.5, 6]) / 5


def into(folder: Path) -> Callable[[str, Callable[[Any], object]], None]:
    def write(name: str, fill: Callable[[Any], object]) -> None:
        with (folder / name).open("wb") as file:
            fill(file)

    return write


def contact_rows(**columns: Any) -> list[dict[str, float | None]]:
    """A run that bends and touches: forces by column beside pressure and path."""
    rows: list[dict[str, float | None]] = []
    for i, pressure in enumerate(PRESSURES):
        turn = max(pressure / 30, 1e-9)
        row = {
            col.STEP: float(i),
            col.PRESSURE: float(pressure),
            col.ANGLE: float(np.degrees(turn)),
            col.TIP_Y: float(-160 / turn * (1 - np.cos(turn))),
            col.TIP_Z: float(160 / turn * np.sin(turn)),
        }
        rows.append({**row, **{name: float(values[i]) for name, values in columns.items()}})
    return rows


def covered(axes: Any) -> list[str]:
    """Curves that the legend or a text covers."""
    found = []
    boxes = [box(text) for text in axes.texts if text.get_text()]
    boxes += [box(axes.get_legend())] if axes.get_legend() is not None else []
    frame = axes.get_window_extent()
    for line in axes.lines:
        way = axes.transData.transform(line.get_xydata())
        steps = [max(2, int(np.hypot(*(b - a)))) for a, b in itertools.pairwise(way)]
        pairs = zip(itertools.pairwise(way), steps, strict=True)
        fine = [np.linspace(*pair, n) for pair, n in pairs]
        points = np.concatenate([way, *fine])
        points = points[[bool(frame.contains(*p)) for p in points]]
        if any(one.contains(*point) for one in boxes for point in points):
            found.append(line.get_label())
    return found


def overlapping(axes: Any) -> int:
    """Pairs of texts, or of a text and the legend, that cover each other."""
    boxes = [box(text) for text in axes.texts if text.get_text()]
    boxes += [box(axes.get_legend())] if axes.get_legend() is not None else []
    return sum(one.overlaps(other) for i, one in enumerate(boxes) for other in boxes[i + 1 :])


def shapes(case: Any) -> dict[str, Shape]:
    actuator = convert.dimensions(case.actuator)
    found = [effect.obstacle_shapes(actuator) for effect in case.effects]
    return {name: shape for each in found for name, shape in each.items()}


@pytest.mark.parametrize("font_size", [13.0, 22.0])
@pytest.mark.parametrize("name", ["free_bending", "section", "cell", "blocked_tip", "straight"])
def test_texts_cover_no_curve_of_the_shipped_cases(
    name: str, font_size: float, drawn: list[Any], tmp_path: Path
) -> None:
    data = load_yaml(ROOT / "cases" / f"{name}.yaml") | {"model": "analytic"}
    for effect in data["effects"]:
        effect.get("winding", {})["as"] = "smeared"
    case = parse_case(data)
    rows = run_case(case, None).rows
    check = crosscheck(case, choose_model(case)[0], rows)
    names = draw_plots(
        rows,
        into(tmp_path),
        [float(np.rad2deg(angle)) for angle in case.output.at_angles],
        case.title,
        None,
        check.angles,
        check.forces,
        "analytic model",
        shapes(case),
        case.straight,
        Style(font_size=font_size),
    )
    assert names[0] == ("tip_force.png" if case.straight else "pressure_angle.png")
    assert len(drawn) == len(names)
    assert any(axes.get_legend() is not None for axes in drawn)
    for axes in drawn:
        assert covered(axes) == []
        assert overlapping(axes) == 0


BAR = {"contact_bar_y_N": TOUCH, "contact_bar_z_N": 2 * TOUCH}
PLANE = {"contact_table_y_N": TOUCH, "contact_table_z_N": 0 * TOUCH}
ROOF = {"contact_roof_y_N": -PRESSURES, "contact_roof_z_N": 0 * PRESSURES}
POST = {"contact_post_y_N": PRESSURES / 2, "contact_post_z_N": 0 * PRESSURES}


@pytest.mark.parametrize("columns", [BAR, PLANE, BAR | PLANE, ROOF | POST], ids=str)
def test_texts_cover_no_force_of_a_contact(
    columns: dict[str, Any], drawn: list[Any], tmp_path: Path
) -> None:
    plot_contact_force(contact_rows(**columns), tmp_path / "force.png", "Title")
    (axes,) = drawn
    assert covered(axes) == []
    assert overlapping(axes) == 0


def test_forces_of_contacts_by_size_direction_and_first_touch() -> None:
    bar, table, roof = contact_forces(contact_rows(**BAR, **PLANE, **ROOF))
    assert (bar.name, bar.direction, bar.touch) == ("bar", "", 3)
    assert bar.force == pytest.approx(5**0.5 * TOUCH)
    assert (table.name, table.direction, table.touch) == ("table", " along +y", 3)
    # pressed on from the first load step on, which follows the state at rest
    assert (roof.name, roof.direction, roof.touch) == ("roof", " along −y", 1)
    assert roof.force == pytest.approx(PRESSURES)


def test_a_body_in_touch_from_the_first_state_on_has_no_first_touch(
    drawn: list[Any], tmp_path: Path
) -> None:
    rows = contact_rows(**ROOF)
    # what is not known at rest is no force of zero
    rows[0] |= {"contact_roof_y_N": None, "contact_roof_z_N": None}
    (roof,) = contact_forces(rows)
    assert roof.touch is None
    assert list(roof.pressure) == list(PRESSURES[1:])
    plot_contact_force(rows, tmp_path / "force.png")
    assert [text.get_text() for text in drawn[0].texts] == ["60 N"]


def test_first_touch_is_marked_where_it_is(drawn: list[Any], tmp_path: Path) -> None:
    plot_contact_force(contact_rows(**BAR), tmp_path / "force.png")
    (axes,) = drawn
    texts = {text.get_text(): text.xy for text in axes.texts}
    assert texts["bar: touches by 30 kPa"] == (30.0, pytest.approx(5**0.5 * 0.2))
    labels = [line.get_label() for line in axes.lines if not line.get_label().startswith("_")]
    assert labels == ["bar, whole force", "bar along y", "bar along z"]


def test_strips_that_are_kept_in_place_have_forces_too() -> None:
    rows = [{**row, col.ROOF_FORCE: 2.0, col.TIP_FORCE: 1.0} for row in contact_rows()]
    roof, post = contact_forces(rows)
    assert (roof.name, roof.direction, roof.force[-1]) == ("roof", " along −y", 2.0)
    assert (post.name, post.direction, post.force[-1]) == ("post", " along +y", 1.0)
    # a section kept straight has neither roof nor post
    assert contact_forces([{**row, col.TIP_FORCE: 1.0} for row in contact_rows()]) == []


def test_no_touch_no_picture_of_it(tmp_path: Path) -> None:
    nothing = {name: 0 * values for name, values in BAR.items()}
    names = draw_plots(contact_rows(**nothing), into(tmp_path))
    assert names == ["pressure_angle.png", "tip_path.png"]


@pytest.mark.parametrize("blocked", [True, False])
def test_what_a_run_is_made_for_comes_first(blocked: bool, tmp_path: Path) -> None:
    rows = contact_rows(**POST, tip_force_N=PRESSURES / 2, twist_deg=PRESSURES / 9)
    names = draw_plots(rows, into(tmp_path), blocked=blocked)
    angles = ["pressure_angle.png", "pressure_twist.png"]
    forces = ["tip_force.png", "contact_force.png"]
    order = [*forces, *angles] if blocked else [*angles, *forces]
    assert names == [*order, "tip_path.png"]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 0.04])
def test_no_angle_no_picture_of_it(angle: float, tmp_path: Path) -> None:
    rows = [
        {**row, col.ANGLE: angle, col.TWIST: -angle, col.TIP_FORCE: row[col.PRESSURE]}
        for row in contact_rows()
    ]
    assert draw_plots(rows, into(tmp_path)) == ["tip_force.png", "tip_path.png"]


def test_loads_at_one_pressure_are_shown_by_their_steps(drawn: list[Any], tmp_path: Path) -> None:
    rows = [{**row, col.PRESSURE: 0.0, col.TWIST: row[col.ANGLE]} for row in contact_rows()]
    assert draw_plots(rows, into(tmp_path))[:2] == ["pressure_angle.png", "pressure_twist.png"]
    for axes in drawn[:2]:
        assert axes.get_xlabel() == "load step"
        assert list(axes.lines[0].get_xdata()) == [row[col.STEP] for row in rows]


def test_other_models_leave_the_axes_as_they_are(drawn: list[Any], tmp_path: Path) -> None:
    from fiberbend.drawing.overlay import Line, Overlay

    limits = []
    for factor in (1.0, 0.01, 1000.0):
        line = Line("section", "section model", factor * PRESSURES, 3 * factor * PRESSURES)
        curves.plot_pressure_angle(
            contact_rows(), tmp_path / "plot.png", overlay=Overlay((line,)), name="body model"
        )
        limits.append((drawn[-1].get_xlim(), drawn[-1].get_ylim()))
    assert limits[0] == limits[1] == limits[2]
    assert limits[0][0] == (0.0, pytest.approx(1.12 * 60))


KINKED = {
    "kink": [(175, 5), (174, -30), (171, -35), (146, -39.5)],
    "there and back": [(100, 0), (60, -40), (100, 0), (60, -40)],
    "one long step": [(175, 5), (174.9, 4.9), (-40, -120), (-40.1, -120)],
    "standing still": [(175, 5), (150, 0), (150, 0), (150, 0), (120, -30)],
}


@pytest.mark.parametrize("aside", [0.0, 10.0])
@pytest.mark.parametrize("points", KINKED.values(), ids=KINKED.keys())
def test_a_path_is_straight_between_load_steps(
    points: Sequence[tuple[float, float]],
    aside: float,
    monkeypatch: pytest.MonkeyPatch,
    drawn: list[Any],
    tmp_path: Path,
) -> None:
    rows: list[dict[str, float]] = [
        {col.PRESSURE: i, col.TIP_Z: z, col.TIP_Y: y, col.TIP_X: aside * i}
        for i, (z, y) in enumerate(points)
    ]
    plot_tip_path(rows, tmp_path / "path.png")
    (axes,) = drawn
    asked = np.array(points, dtype=float)
    if aside:
        lines = [np.column_stack([*line.get_data_3d()])[:, [0, 2]] for line in axes.lines]
        lines = [line for line in lines if np.allclose(line, asked) if len(line) == len(asked)]
        assert lines
    else:
        path = [line for line in axes.lines if line.get_linestyle() == "-"]
        (line,) = (line for line in path if len(line.get_xdata()) > 1)
        assert np.array_equal(line.get_xydata(), asked)
        assert line.get_drawstyle() == "default"


OBSTACLES: dict[str, Shape] = {
    "bar": Bar((-45.0, 60.0), 25.0),
    "table": Sheet((0.0, -60.0, 0.0), (0.0, 1.0, 0.0)),
    "post": Box((-9.0, -9.0, 173.0), (9.0, -1.0, 175.0)),
    "far": Box((-9.0, 900.0, 900.0), (9.0, 950.0, 950.0)),
    "wall beside": Sheet((30.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
}


def test_obstacles_stand_where_they_are_at_one_scale(drawn: list[Any], tmp_path: Path) -> None:
    plot_tip_path(contact_rows(), tmp_path / "path.png", obstacles=OBSTACLES)
    (axes,) = drawn
    found = {}
    for patch in axes.patches:
        outline = patch.get_path().transformed(patch.get_patch_transform()).get_extents()
        found[patch.get_label()] = outline.extents
    assert {*found} == {"bar", "table", "post"}
    assert found["bar"] == pytest.approx((35, -70, 85, -20))
    assert found["post"] == pytest.approx((173, -9, 175, -1))
    # a sheet goes on beyond the picture, and its face is at its place
    left, right = axes.get_xlim()
    x0, _, x1, y1 = found["table"]
    assert y1 == pytest.approx(-60)
    assert x0 < left
    assert x1 > right
    size = axes.get_window_extent()
    across, up = right - left, np.diff(axes.get_ylim())[0]
    assert size.width / across == pytest.approx(size.height / up)
    # the bar is in sight as a whole, and so is the path
    assert left < 35
    assert axes.get_legend() is not None
    assert covered(axes) == []
    assert overlapping(axes) == 0


@pytest.mark.parametrize("height", [-12.0, -17.0])
def test_a_table_under_the_tip_is_in_sight(height: float, drawn: list[Any], tmp_path: Path) -> None:
    rows = [{col.PRESSURE: p, col.TIP_Z: 75.0, col.TIP_Y: 5 - p} for p in (0.0, 6, 12)]
    table = {"table": Sheet((0.0, height, 0.0), (0.0, 1.0, 0.0))}
    plot_tip_path(rows, tmp_path / "path.png", obstacles=table)
    (axes,) = drawn
    assert axes.get_ylim()[0] < height
    assert [patch.get_label() for patch in axes.patches] == ["table"]


def test_a_slanted_sheet_is_cut_by_the_plane_of_bending() -> None:
    sheet = Sheet((7.0, -50.0, 20.0), (0.3, 2.0, 0.5))
    corners = sheet.cut(np.array([100.0, 100.0]))
    assert corners is not None
    for z, y in corners[:2]:
        offset = np.array([0.0, y, z]) - sheet.point
        assert offset @ sheet.normal == pytest.approx(0, abs=1e-9)
    # its thickness is on the far side of the face
    for z, y in corners[2:]:
        assert (np.array([0.0, y, z]) - sheet.point) @ sheet.normal < 0


def test_obstacles_in_space_are_lines_on_their_surfaces() -> None:
    limits = np.array([[-30.0, -150.0, -50.0], [30.0, 10.0, 180.0]])
    bar, sheet, post = (
        np.concatenate(OBSTACLES[name].wires(limits)) for name in ("bar", "table", "post")
    )
    assert np.hypot(bar[:, 1] + 45, bar[:, 2] - 60) == pytest.approx(25)
    assert sheet[:, 1] == pytest.approx(-60)
    assert post.min(axis=0) == pytest.approx((-9, -9, 173))
    assert post.max(axis=0) == pytest.approx((9, -1, 175))
    slanted = Sheet((7.0, -50.0, 20.0), (0.3, 2.0, 0.5))
    lines = np.concatenate(slanted.wires(limits))
    assert (lines - slanted.point) @ slanted.normal == pytest.approx(0, abs=1e-9)

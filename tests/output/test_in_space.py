"""What pictures in space say: colours, places, axes, obstacles and their forces, remarks."""

from __future__ import annotations

import dataclasses
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend.drawing.body import draw_pictures
from fiberbend.drawing.cell import Slices
from fiberbend.drawing.page import COLORS, SMEARED, WARN, colormap
from fiberbend.drawing.renderer import FROM_THE_SIDE, Drawable, Renderer, View, frame
from fiberbend.drawing.space.animation import Animation
from fiberbend.drawing.space.obstacles import Obstacles, Scenery, write_forces
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.space.panel import Panel, free_place
from fiberbend.drawing.space.rest import draw_rest
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.reader.reader import read_case
from fiberbend.results.scenery import scenery
from fiberbend.states.labels import short_number
from fiberbend.states.obstacles import Bar, Box, Shape, Sheet
from tests.output.bending import model_mesh, snapshot
from tests.output.space import WINDING, case, frames
from tests.output.uniform import cell
from tests.output.uniform import state as state_of

CASES = Path(__file__).resolve().parents[2] / "cases"

OBLIQUE = (-0.62, 0.42, -0.66)
SIZE_OF = (400, 300)


def block(value: float) -> Any:
    import pyvista as pv

    box = pv.Box((-3.0, 3.0, -2.0, 2.0, -4.0, 4.0), quads=True)
    box["value"] = np.full(box.n_points, value)
    return box


# --- colours ---------------------------------------------------------------------------------


@pytest.mark.parametrize("toward", [FROM_THE_SIDE, OBLIQUE, (0.3, -0.9, 0.4)])
@pytest.mark.parametrize("value", [0.0, 0.13, 0.5, 0.77, 1.0])
def test_colours_are_those_of_the_bar(
    renderer: Renderer, value: float, toward: tuple[float, float, float]
) -> None:
    box = block(value)
    view = frame(np.asarray(box.points), toward, 4 / 3, margin=0.1)
    image = renderer.draw([Drawable(box, "value", "value")], view, SIZE_OF, (0.0, 1.0), colormap())
    expected = np.rint(255 * np.array(colormap()(value)[:3]))
    drawn = image[(image < 250).any(axis=2)].astype(float)
    alike = np.abs(drawn - expected).max(axis=1) <= 2
    # all but the lines at the edges
    assert alike.mean() > 0.9
    assert alike.mean() < 1.0


# --- places ----------------------------------------------------------------------------------


@pytest.mark.parametrize("toward", [FROM_THE_SIDE, OBLIQUE])
def test_points_are_where_the_page_takes_them_for(
    renderer: Renderer, toward: tuple[float, float, float]
) -> None:
    import pyvista as pv

    points = np.array([[9.0, 2.0, 30.0], [-7.0, -12.0, 4.0], [1.0, 14.0, 17.0]])
    view = frame(points, toward, 4 / 3, margin=0.1)
    for point, place in zip(points, view.at(points, SIZE_OF), strict=True):
        ball = Drawable(pv.Sphere(radius=0.7, center=point), color="black", flat=True)
        image = renderer.draw([ball], view, SIZE_OF)
        rows, columns = np.nonzero((image < 128).all(axis=2))
        assert [columns.mean() + 0.5, rows.mean() + 0.5] == pytest.approx(place, abs=0.7)


def test_from_the_side_z_points_right_and_y_up() -> None:
    view = View(FROM_THE_SIDE, np.zeros(3), 10.0)
    assert view.axes == pytest.approx(np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]))
    assert np.linalg.det(View(OBLIQUE, np.zeros(3), 1.0).axes) == pytest.approx(1.0)


def panel_of(image: np.ndarray, view: View) -> Panel:
    size = (image.shape[1], image.shape[0])
    return Page(size, "").image(image, (0, 0, 1, 1), view)


def test_scale_is_that_of_the_image(renderer: Renderer) -> None:
    image = renderer.draw([], View(FROM_THE_SIDE, np.zeros(3), 50.0), SIZE_OF)
    panel = panel_of(image, View(FROM_THE_SIDE, np.zeros(3), 50.0))
    assert panel.per_mm == pytest.approx(SIZE_OF[0] / 50.0)
    panel.scale(10, 10, 12.5)
    drawn = panel.overlay
    bar = next(line for line in drawn.lines if line.get_linewidth() == 3)
    assert np.ptp(bar.get_xdata()) == pytest.approx(12.5 * SIZE_OF[0] / 50.0)
    assert {text.get_text() for text in drawn.texts} == {"x", "y", "z", "12.5 mm", ""}
    where = {text.get_text(): np.array(text.get_position()) for text in drawn.texts}
    assert where["z"][0] > where["y"][0] + 20
    assert where["y"][1] > where["z"][1] + 20


# --- texts -----------------------------------------------------------------------------------


def test_a_post_is_under_its_strip_wherever_that_moves() -> None:
    """A tip that is pressed on a post moves outward by a few hundredths of the length."""
    from fiberbend.case.convert import dimensions, obstacle_shapes

    for name in ("blocked_contact", "blocked_tip"):
        case = read_case(CASES / f"{name}.yaml")
        post, actuator = obstacle_shapes(case)["post"], dimensions(case.actuator)
        assert isinstance(post, Box)
        end = actuator.length + actuator.cap
        assert post.low[2] == pytest.approx(end - 2.0)
        assert post.high[2] > end + 0.04 * actuator.length
        assert post.high[1] == pytest.approx(actuator.outer_bottom)


def test_a_text_does_not_cross_the_outline_of_an_obstacle() -> None:
    taken, grey = np.zeros((100, 200), dtype=bool), np.zeros((100, 200), dtype=bool)
    grey[:, 100:] = True
    near, size = np.array([102.0, 50.0]), (40, 10)
    place = free_place(taken, near, size, grey)
    assert abs(place[0] - 100) > 18
    assert abs(place[0] - 100) < 26
    # half of it on either side where there is no other place
    assert free_place(taken, near, (190, 90), grey) == pytest.approx([105, 50], abs=6)


def test_a_text_finds_the_nearest_free_place() -> None:
    taken = np.zeros((200, 300), dtype=bool)
    assert free_place(taken, np.array([100.0, 60.0]), (40, 10)) == pytest.approx([100, 60])
    taken[40:80, 50:250] = True
    place = free_place(taken, np.array([100.0, 70.0]), (40, 10))
    assert 85 <= place[1] <= 90
    assert abs(place[0] - 100) < 6
    taken[:] = True
    assert free_place(taken, np.array([100.0, 70.0]), (40, 10)) == pytest.approx([100, 70])


def test_a_text_is_not_put_beyond_the_body() -> None:
    taken = np.zeros((200, 300), dtype=bool)
    taken[80:90] = True
    taken[90:140, :] = False
    # nearer above the body than below the block, and yet below
    taken[90:126, 60:240] = True
    place = free_place(taken, np.array([150.0, 128.0]), (40, 16))
    assert place[1] > 126


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (45.13, "45.1"),
        (90.0, "90"),
        (306.04, "306"),
        (8.5449, "8.54"),
        (9.999, "10"),
        (0.0414, "0.0414"),
        (1e-4, "0"),
        (-1e-9, "0"),
        (-20.0, "−20"),
        (-0.5, "−0.5"),
    ],
)
def test_digits_of_captions(value: float, text: str) -> None:
    assert short_number(value) == text


# --- obstacles -------------------------------------------------------------------------------


def test_obstacles_neither_hide_nor_tint_the_body(renderer: Renderer) -> None:
    box = block(0.5)
    points = np.asarray(box.points)
    shapes: dict[str, Shape] = {
        "plane": Sheet((-5.0, 0.0, 0.0), (1.0, 0.2, 0.0)),
        "bar": Bar((4.0, 3.0), 3.0),
    }
    obstacles = Obstacles(Scenery(shapes), points)
    view = obstacles.frame(points, FROM_THE_SIDE, 4 / 3)
    body = [Drawable(box, scalars="value")]
    alone = renderer.draw(body, view, SIZE_OF)
    both = renderer.draw(body + obstacles.behind(view), view, SIZE_OF)
    rows, columns = np.nonzero((alone < 250).all(axis=2))
    # its border is mixed with what is behind it
    inside = (slice(rows.min() + 1, rows.max()), slice(columns.min() + 1, columns.max()))
    assert (alone[inside] < 250).any(axis=2).all()
    assert (alone[inside] == both[inside]).all()
    outside = both[(alone == 255).all(axis=2)]
    assert (outside < 250).any(axis=1).mean() > 0.2


def test_a_plane_is_seen_from_its_edge(renderer: Renderer) -> None:
    points = np.asarray(block(0.0).points)
    obstacles = Obstacles(Scenery({"plane": Sheet((0.0, -2.0, 0.0), (0.0, 3.0, 0.0))}), points)
    solid = obstacles.solids["plane"]
    assert solid.bounds.y_max == pytest.approx(-2.0)
    assert solid.bounds.y_min < -2.05
    view = obstacles.frame(points, FROM_THE_SIDE, 4 / 3)
    assert renderer.draw(obstacles.behind(view), view, SIZE_OF).std() > 1


def test_touch_is_where_the_body_is_nearest() -> None:
    scene = model_mesh()
    points = BodySurfaces(scene).points(snapshot(scene, 60.0))
    low = points[points[:, 1].argmin()]
    shapes: dict[str, Shape] = {
        "plane": Sheet((0.0, low[1] - 1, 0.0), (0.0, 1.0, 0.0)),
        "roof": Box((-2.0, 20.0, -4.0), (2.0, 22.0, 4.0)),
    }
    obstacles = Obstacles(Scenery(shapes), points)
    place = obstacles.touch("plane", points)
    assert place[1:] == pytest.approx([low[1] - 1, low[2]], abs=0.3)
    # both halves: in the middle
    assert place[0] == pytest.approx(0.0, abs=1e-9)
    assert obstacles.touch("roof", points)[1] == pytest.approx(20.0)


def test_names_and_forces_are_written_beside_the_body(renderer: Renderer) -> None:
    scene = model_mesh()
    state = snapshot(scene, 90.0)
    surfaces = BodySurfaces(scene)
    points = surfaces.points(state)
    low = float(points[:, 1].min())
    shapes: dict[str, Shape] = {
        "plane": Sheet((0.0, low, 0.0), (0.0, 1.0, 0.0)),
        "cylinder": Bar((-8.0, 4.0), 3.0),
    }
    forces = {state.step: {"plane": (0.0, 1.25, 0.0), "cylinder": (0.0, 0.0, 0.0)}}
    obstacles = Obstacles(Scenery(shapes, forces), points)
    view = obstacles.frame(points, FROM_THE_SIDE, 4 / 3)
    size = (800, 600)
    body = surfaces.parts(surfaces.bare, state)
    panel = panel_of(renderer.draw(body + obstacles.behind(view), view, size), view)
    write_forces(panel, obstacles, points, state)
    texts = [text for text in panel.axes.texts if text.get_text()]
    assert [text.get_text() for text in texts] == ["plane 1.25 N", "cylinder 0 N"]
    arrow = next(text for text in panel.axes.texts if not text.get_text())
    # it ends on the plane, and comes from below; rows of pixels count downward
    y, tail = arrow.xy[1], arrow.xyann[1]
    assert tail > y + 20
    assert y == pytest.approx(view.at(np.array([[0.0, low, 0.0]]), size)[0, 1], abs=3)
    # the text is beyond its other end
    assert texts[0].get_position()[1] > tail + 8
    alone = renderer.draw(body, view, size)
    drawn = np.flipud((alone < 250).any(axis=2))
    for text in texts:
        box = text.get_window_extent()
        covered = drawn[round(box.y0) : round(box.y1), round(box.x0) : round(box.x1)]
        assert covered.mean() < 0.01, text.get_text()


def test_forces_of_roof_and_post_come_from_the_history() -> None:
    blocked = case(effects=[{"pressure": {"to": "9 kPa"}}, WINDING, {"blocked-tip": {}}])
    rows: list[dict[str, Any]] = [
        {"step": 0, "tip_force_N": None},
        {"step": 1, "tip_force_N": 0.5, "roof_force_N": 0.75},
    ]
    beside = scenery(blocked, rows)
    assert set(beside.shapes) == {"roof", "post"}
    assert beside.forces == {0: {}, 1: {"roof": (0.0, -0.75, 0.0), "post": (0.0, 0.5, 0.0)}}
    assert beside.tip_forces == {1: 0.5}
    assert beside.greatest() == 0.75


def test_forces_of_obstacles_come_from_the_history() -> None:
    contact = {"contact": {"cylinder": {"center": ["-30 mm", "10 mm"], "radius": "8 mm"}}}
    touched = case(effects=[{"pressure": {"to": "9 kPa"}}, WINDING, contact])
    rows: list[dict[str, Any]] = [
        {"step": 0},
        {"step": 1, "contact_cylinder_y_N": 0.3, "contact_cylinder_z_N": 0.4, "tip_force_N": None},
    ]
    beside = scenery(touched, rows)
    assert set(beside.shapes) == {"cylinder"}
    assert beside.forces == {0: {}, 1: {"cylinder": (0.0, 0.3, 0.4)}}
    assert beside.greatest() == pytest.approx(0.5)
    assert not beside.tip_forces
    assert not scenery(touched).forces


def test_a_blocked_run_leads_with_its_force() -> None:
    state = dataclasses.replace(snapshot(model_mesh(), 30.0), pressure_kpa=50.0, step=4)
    assert Scenery().caption(state) == "P = 50 kPa,  θ = 30°"
    blocked = Scenery(tip_forces={4: 1.2345})
    assert blocked.caption(state) == "P = 50 kPa,  F = 1.23 N,  θ = 30°"
    straight = dataclasses.replace(state, angle_deg=1e-7)
    assert blocked.caption(straight) == "P = 50 kPa,  F = 1.23 N"


# --- remarks and windings --------------------------------------------------------------------


def written(page: Any) -> dict[str, str]:
    """Texts of a page with their colours."""
    return {text.get_text(): text.get_color() for text in page._figure.texts}


def test_what_a_state_has_to_say_is_in_its_caption(renderer: Renderer) -> None:
    remark = "passes through itself from 306° on: not modelled"
    assert written(Page((800, 600), "Title", "P = 1 kPa", remark))[remark] == WARN
    view = View(FROM_THE_SIDE, np.zeros(3), 50.0)
    image = renderer.draw([Drawable(block(0.0), color="red")], view, SIZE_OF)
    page = Page.of_panels(1400, "", [image] * 4, ["a", "b", "c", "d"], [view] * 4, ["", remark] * 2)
    found = [text for text, color in written(page).items() if color == WARN and text]
    assert [text.replace("\n", " ") for text in found] == [remark]
    for text in page._figure.texts:
        assert text.get_window_extent().width < 0.97 * 350 or not text.get_text()


def test_a_smeared_winding_is_shown_as_a_surface() -> None:
    lines = model_mesh()
    spread = dataclasses.replace(lines, smeared=True)
    assert BodySurfaces(lines).names[-1] == "fiber"
    surfaces = BodySurfaces(spread)
    assert surfaces.names[-1] == "winding"
    assert surfaces.remark == f", {SMEARED}"
    assert not surfaces.fiber_tubes()

    def wound(surfaces: BodySurfaces) -> list[Drawable]:
        return [
            layer for layer in surfaces.parts(surfaces.peeled) if layer.color == COLORS["winding"]
        ]

    assert not wound(BodySurfaces(lines))
    (layer,) = wound(surfaces)
    # the winding lies at radius a + t = 10 over the chamber's length
    points = np.asarray(layer.data.points)
    assert np.abs(points[:, 0]).max() == pytest.approx(10.0)
    assert (points[:, 2].min(), points[:, 2].max()) == pytest.approx((0.0, 24.0))
    assert set(BodySurfaces(dataclasses.replace(lines, fibers=None)).names) == set(lines.materials)


def test_long_texts_fit(renderer: Renderer) -> None:
    page = Page((900, 600), "W" * 120)
    assert page._figure.texts[0].get_window_extent().width <= 0.97 * 900
    view = View(FROM_THE_SIDE, np.zeros(3), 50.0)
    image = renderer.draw([Drawable(block(0.0), color="red")], view, SIZE_OF)
    caption = "P = −123.4 kPa,  F = −12.3 N,  θ = −123.4°"
    page = Page.of_panels(1400, "", [image] * 4, [caption] * 4, [view] * 4)
    for text in page._figure.texts:
        assert not text.get_text() or text.get_window_extent().width <= 0.97 * 350


def test_every_panel_has_axes_and_scale(
    renderer: Renderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[Any] = []
    scaled: list[Any] = []
    place, scale = Page._place, Panel.scale

    def note_place(page: Page, *how: Any) -> Panel:
        shown.append(place(page, *how))
        return shown[-1]  # type: ignore[no-any-return]

    def note_scale(panel: Panel, *how: Any) -> None:
        scaled.append(panel)
        scale(panel, *how)

    monkeypatch.setattr(Page, "_place", note_place)
    monkeypatch.setattr(Panel, "scale", note_scale)

    def write(_: str, fill: Any) -> None:
        fill(io.BytesIO())

    scene, sliced = model_mesh(), cell()
    states = [snapshot(scene, angle) for angle in (30.0, 90.0)]
    draw_pictures(scene, states, write, renderer)
    draw_rest(scene, io.BytesIO(), renderer)
    Animation(scene, renderer).write(io.BytesIO(), frames(scene, states), lambda: states)
    Slices(sliced, [state_of(sliced, 60.0), state_of(sliced, 90.0)], renderer).bulge(io.BytesIO())
    # undeformed 2, cut, bent 2, montage 2, rest, animation, bulge 2
    assert len(shown) == 11
    assert [id(panel) for panel in shown] == [id(panel) for panel in scaled]

"""Pictures and plots: they exist, show something, and show it where it belongs."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fiberbend import columns as col
from fiberbend.drawing.body import SIZE, draw_pictures
from fiberbend.drawing.curves import draw_plots, plot_tip_force
from fiberbend.drawing.page import nice_above
from fiberbend.drawing.renderer import (
    FROM_THE_SIDE,
    Drawable,
    PictureError,
    Renderer,
    frame,
)
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation, boundary_facets
from fiberbend.states.snapshot import Write
from geometry.checks import region_volumes
from tests.output.bending import model_mesh, snapshot


def into(folder: Path) -> Write:
    def write(name: str, fill: Any) -> None:
        with (folder / name).open("wb") as file:
            fill(file)

    return write


def pixels(path: Path) -> np.ndarray:
    from matplotlib.image import imread

    image = imread(path, format="png")
    return np.asarray(image[..., :3])


def is_drawn(path: Path) -> bool:
    return bool(pixels(path).std() > 0.02)


@pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])
def test_surface_encloses_the_body(element: str) -> None:
    import pyvista as pv

    mesh = model_mesh(element=element).mesh
    pairs = boundary_facets(mesh, np.ones(len(mesh.cells), dtype=bool))
    skin = Tessellation(mesh, pairs, level=6)
    at_cells = mesh.nodes[mesh.cells]
    points, normals = skin.interpolate(at_cells), skin.normals(at_cells)
    surface = (
        pv.PolyData.from_regular_faces(points, skin.pieces)
        .clean(tolerance=1e-6, absolute=True)
        .triangulate()
    )
    assert surface.n_open_edges == 0
    assert surface.volume == pytest.approx(sum(region_volumes(mesh).values()), rel=1e-3)
    # outward: a closed surface has ∮ n dA = 0 and ∮ x·n dA = 3 V > 0
    corners = points[skin.pieces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (area * normals[skin.pieces].mean(axis=1)).sum(axis=1).min() > 0
    assert (area * corners.mean(axis=1)).sum() > 0


def test_mirror_image_doubles_the_body() -> None:
    scene = model_mesh()
    surfaces = BodySurfaces(scene)
    everything = np.ones(len(scene.mesh.cells), dtype=bool)
    skin = Tessellation(scene.mesh, surfaces.outside(everything), level=6)
    for state in (None, snapshot(scene, 40.0)):
        whole = (
            surfaces.surface(skin, state, mirror=True)
            .clean(tolerance=1e-6, absolute=True)
            .triangulate()
        )
        assert whole.n_open_edges == 0
        assert whole.bounds.x_min == pytest.approx(-whole.bounds.x_max)
        if state is None:
            twice = 2 * sum(region_volumes(scene.mesh).values())
            assert whole.volume == pytest.approx(twice, rel=1e-3)


def test_pictures(tmp_path: Path) -> None:
    scene = model_mesh()
    states = [snapshot(scene, angle) for angle in (30.0, 90.0)]
    with Renderer() as renderer:
        names = draw_pictures(scene, states, into(tmp_path), renderer)
    assert names == [
        "undeformed.png",
        "cut.png",
        "bent_30deg.png",
        "bent_90deg.png",
        "montage.png",
    ]
    assert all(is_drawn(tmp_path / name) for name in names)
    image = pixels(tmp_path / "bent_90deg.png")
    assert image.shape == (SIZE[1], SIZE[0], 3)
    # bent toward −y: above and to the right of the arc there is nothing
    body = image[80:780]
    colored = np.ptp(body, axis=2) > 0.15
    rows, columns = np.nonzero(colored)
    middle = (columns.min() + columns.max()) // 2
    assert rows[columns < middle].mean() < rows[columns > middle].mean()


@pytest.mark.parametrize(
    ("half", "element", "smeared"),
    [(False, "hexahedron", False), (True, "tetrahedron", False), (True, "hexahedron", True)],
)
def test_pictures_of_every_kind_of_body(
    half: bool, element: str, smeared: bool, tmp_path: Path
) -> None:
    scene = model_mesh(half=half, element=element)
    scene = dataclasses.replace(scene, smeared=smeared)
    with Renderer() as renderer:
        names = draw_pictures(scene, [snapshot(scene, 45.0)], into(tmp_path), renderer)
    assert names == ["undeformed.png", "cut.png", "bent_45deg.png"]
    assert all(is_drawn(tmp_path / name) for name in names)


def test_every_picture_is_drawn_anew() -> None:
    surfaces = BodySurfaces(model_mesh())
    parts = surfaces.parts(np.ones(len(surfaces.middle), dtype=bool))
    size = (200, 120)
    view = frame(surfaces.mesh.nodes, FROM_THE_SIDE, 200 / 120)
    with Renderer() as renderer:
        empty = renderer.draw([], view, size)
        image = renderer.draw(parts, view, size)
        red = renderer.draw([Drawable(layer.data, color="red") for layer in parts], view, size)
    assert empty.std() == 0
    assert image.std() > 10
    drawn = (red != 255).any(axis=2)
    assert red[drawn][:, 0].mean() > 2 * red[drawn][:, 1].mean()


def test_no_pyvista_is_said_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(PictureError, match="pictures need pyvista"):
        Renderer()


def history(angles: Sequence[float]) -> list[col.Row]:
    rows: list[col.Row] = []
    for step, angle in enumerate(angles):
        theta = np.radians(max(angle, 1e-6))
        radius = 160 / theta
        rows.append(
            {
                "step": step,
                "pressure_kPa": angle / 2,
                "angle_deg": angle,
                "tip_y_mm": float(-radius * (1 - np.cos(theta))),
                "tip_z_mm": float(radius * np.sin(theta)),
                "tip_force_N": angle / 100 if step % 2 else None,
            }
        )
    return rows


@pytest.mark.parametrize("angles", [[0.0, 30, 90, 90, 200, 360], [10.0, 25], [0.0]])
@pytest.mark.parametrize("reason", [None, "no convergence at 3 kPa " * 20])
def test_plots(angles: list[float], reason: str | None, tmp_path: Path) -> None:
    names = draw_plots(history(angles), into(tmp_path), [90, 180, 360], "Title", reason)
    # a state at rest alone is no curve
    expected = ["pressure_angle.png", "tip_force.png", "tip_path.png"] if len(angles) > 1 else []
    assert names == expected
    assert all(is_drawn(tmp_path / name) for name in names)


@pytest.mark.parametrize("reason", [None, "no convergence at 3 kPa"])
def test_a_path_that_leaves_its_plane_is_drawn_in_space(
    reason: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from matplotlib.projections import get_projection_class

    drawn: list[Any] = []
    in_space_axes: Any = get_projection_class("3d")
    plot = in_space_axes.plot

    def note(axes: Any, *points: Any, **how: Any) -> Any:
        drawn.append(points)
        return plot(axes, *points, **how)

    monkeypatch.setattr(in_space_axes, "plot", note)
    rows = history([0.0, 30, 90, 90, 200, 360])
    # round-off is no way out of the plane
    for aside, in_space in ((1e-9, False), (5.0, True)):
        path: list[col.Row] = [{**row, "tip_x_mm": aside * row["step"]} for row in rows]
        draw_plots(path, into(tmp_path), [], "Title", reason)
        assert is_drawn(tmp_path / "tip_path.png")
        assert bool(drawn) == in_space
    z, x, y = next(points[:3] for points in drawn if points[3:] == ("o-",))
    for values, axis in ((x, "x"), (y, "y"), (z, "z")):
        assert list(values) == [row[f"tip_{axis}_mm"] for row in path]


def test_nothing_converged_draws_nothing(tmp_path: Path) -> None:
    assert draw_plots([], into(tmp_path)) == []
    with pytest.raises(ValueError, match="tip_force_N"):
        plot_tip_force(history([0.0]), tmp_path / "force.png")


def test_round_numbers() -> None:
    assert [nice_above(x) for x in (0.0, 0.31, 0.4, 7.0, 9.0)] == pytest.approx(
        [0.001, 0.4, 0.4, 8.0, 10.0]
    )

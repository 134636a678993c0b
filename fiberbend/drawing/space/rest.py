"""An actuator at rest, cut open step by step, with its obstacles, axes and main dimensions."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence

import numpy as np

from fiberbend.drawing.page import COLORS
from fiberbend.drawing.renderer import Drawable, Image, Renderer, View, frame
from fiberbend.drawing.space.obstacles import Obstacles, Scenery, write_forces
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.space.panel import Panel
from fiberbend.drawing.surfaces import FIBER_RADIUS, BodySurfaces
from fiberbend.states.snapshot import ModelMesh, Target
from geometry.mesh.data import Floats

WIDTH = 1400
"""Width of the picture in pixels."""
_TALLEST = 760
_FROM = (-1.0, 0.38, -0.3)
_BARE, _OPEN = 0.3, 0.62
"""Parts of the chamber's length from which on the sheath, and then the near half, is left out."""
_APART = 0.03
"""Distance of a dimension from the body and from another one, as a part of the picture's width."""


@dataclasses.dataclass(frozen=True)
class Rest:
    """An actuator at rest as an image, and what can be written on it.

    Attributes:
        image: pixels, (height, width, 3).
        view: from where.
        names: the colours that it shows, as `Page.legend` takes them.
        lengths: the main dimensions: a text and its ends in mm, (2, 3).
        colors: of names that have none of their own.
    """

    image: Image
    view: View
    names: list[str]
    lengths: list[tuple[str, Floats]]
    colors: Mapping[str, str]


def rest_image(
    model_mesh: ModelMesh,
    renderer: Renderer,
    scenery: Scenery | None = None,
    threads: Sequence[Floats] = (),
    width: int = WIDTH,
    dimensions: bool = True,
) -> Rest:
    """Draw an actuator at rest: toward its tip without its sheath, then without its near half.

    Args:
        model_mesh: the body in space (of any model: `fiberbend.results.space.Space.model_mesh`).
        renderer: draws.
        scenery: has the obstacles.
        threads: polylines of a winding that the mesh does not have, (n, 3) each, mm.
        width: of the image, pixels; its height follows.
        dimensions: leave room for the main dimensions.

    Raises:
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    surfaces = BodySurfaces(model_mesh, scenery)
    points = surfaces.points(None)
    obstacles = Obstacles(scenery or Scenery(), points)
    right = View(_FROM, np.zeros(3), 1.0).axes[0]
    wide = float(np.ptp(np.concatenate([points, obstacles.points]) @ right))
    known = {} if scenery is None else scenery.lengths
    lengths = _lengths(surfaces, points, _APART * wide, known) if dimensions else []
    every = np.concatenate([points, obstacles.points, *(ends for _, ends in lengths)])
    view = frame(every, _FROM, 1.0, margin=0.0)
    right, up, _ = view.axes
    wide, tall = np.ptp(every @ right), np.ptp(every @ up)
    shape = min(tall / wide + 0.03, _TALLEST / WIDTH)
    view = frame(every, _FROM, 1 / shape, margin=0.04)
    size = (width, round(width * shape))
    layers = [*_layers(surfaces, threads), *obstacles.seen_through()]
    names = [*surfaces.names, *(["fiber"] if len(threads) else [])]
    image = renderer.draw(layers, view, size)
    return Rest(image, view, names, lengths, surfaces.family_colors)


def draw_rest(
    model_mesh: ModelMesh,
    target: Target,
    renderer: Renderer,
    scenery: Scenery | None = None,
    threads: Sequence[Floats] = (),
) -> None:
    """Write a picture of an actuator at rest with axes, scale, dimensions and obstacles.

    Args:
        model_mesh: the body in space.
        target: a path, or a file open for writing bytes.
        renderer: draws.
        scenery: has the obstacles.
        threads: polylines of a winding that the mesh does not have, (n, 3) each, mm.

    Raises:
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    rest = rest_image(model_mesh, renderer, scenery, threads)
    height = rest.image.shape[0]
    size = (WIDTH, height + 56 + 100)
    title = f"{model_mesh.title}: at rest" if model_mesh.title else "at rest"
    page = Page(size, title)
    panel = page.image(rest.image, (0.0, 100 / size[1], 1.0, height / size[1]), rest.view)
    write_on(panel, rest, model_mesh, scenery)
    lengths = {} if scenery is None else scenery.lengths
    page.legend(
        rest.names,
        {name: f"{lengths[name]:.6g} mm" for name in rest.names if name in lengths},
        rest.colors,
    )
    page.scale(panel)
    page.save(target)


def write_on(
    panel: Panel, rest: Rest, model_mesh: ModelMesh, scenery: Scenery | None = None
) -> None:
    """Write dimensions, and names of obstacles, on an image of an actuator at rest.

    Args:
        panel: shows `rest.image`.
        rest: of `rest_image`.
        model_mesh: the body in space.
        scenery: has the obstacles.
    """
    points = BodySurfaces(model_mesh).points(None)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    for text, ends in rest.lengths:
        panel.length(text, ends, middle)
    write_forces(panel, Obstacles(scenery or Scenery(), points), points)


def _layers(surfaces: BodySurfaces, threads: Sequence[Floats]) -> list[Drawable]:
    mesh, middle = surfaces.mesh, surfaces.middle
    z, length = middle[:, 2], _chamber(surfaces)[1]
    opened = z > _OPEN * length
    # the cut goes between elements
    end = float(mesh.nodes[mesh.cells[opened], 2].min()) if opened.any() else np.inf
    bare = ~surfaces.sheathed if len(threads) else surfaces.peeled
    shown = bare | (z < _BARE * length) | opened
    if mesh.half:
        layers = surfaces.parts(shown & ~opened)
        layers += surfaces.parts(opened, open_at_mirror=True)
    else:
        layers = surfaces.parts(shown & (~opened | (middle[:, 0] > 0)))
    layers += [line for thread in threads for line in _thread(thread, end)]
    layers += surfaces.winding_line() + surfaces.fiber_tubes(near=end)
    return layers + surfaces.fabric(near=end)


def _thread(points: Floats, near: float) -> list[Drawable]:
    """A thread, of which nothing is left at x < 0 beyond some z."""
    import pyvista as pv

    kept = np.flatnonzero((points[:, 2] < near) | (points[:, 0] > 0))
    runs = np.split(kept, np.flatnonzero(np.diff(kept) > 1) + 1)
    return [
        Drawable(pv.lines_from_points(points[run]), color=COLORS["fiber"], radius=FIBER_RADIUS)
        for run in runs
        if len(run) > 1
    ]


def _chamber(surfaces: BodySurfaces) -> tuple[float, float]:
    """Least and greatest z of the chamber, mm."""
    z = surfaces.mesh.nodes[np.unique(surfaces.mesh.facet_nodes("chamber")), 2]
    return float(z.min()), float(z.max())


def _lengths(
    surfaces: BodySurfaces, points: Floats, off: float, known: Mapping[str, float]
) -> list[tuple[str, Floats]]:
    """Length of the chamber, of the whole where it has caps, height and width, with their ends."""
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall, long = high - low
    start, end = _chamber(surfaces)
    side, below, front = low[0], low[1] - off, low[2] - off
    length = known.get("chamber", end - start)
    found = [(f"chamber {length:.6g} mm", [[side, below, start], [side, below, end]])]
    if long > (1 + 1e-6) * (end - start):
        lower, whole = below - off, known.get("whole", long)
        found.append((f"{whole:.6g} mm", [[side, lower, low[2]], [side, lower, high[2]]]))
    height, width = known.get("height", tall), known.get("width", wide)
    found.append((f"{height:.6g} mm", [[high[0], low[1], front], [high[0], high[1], front]]))
    found.append((f"{width:.6g} mm", [[low[0], low[1], front], [high[0], low[1], front]]))
    return [(text, np.array(ends)) for text, ends in found]

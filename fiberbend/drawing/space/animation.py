"""All load steps of a run as an animated GIF: one camera, one colour range, rest first."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np

from fiberbend.drawing.page import colormap, nice_above
from fiberbend.drawing.renderer import FROM_THE_SIDE, Drawable, Image, Renderer, View
from fiberbend.drawing.space.obstacles import Obstacles, Scenery, write_forces
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation, greatest_seen
from fiberbend.states.snapshot import ModelMesh, Snapshot, Target
from geometry.mesh.data import Floats

SIZE = (900, 680)
"""Width and height of a frame in pixels."""
_LOW, _BAND = 112, 470
_SECONDS = 5.0
_QUICK, _SLOW = 60, 500
"""Least and greatest time of a frame, ms."""
_REST, _STAYS = 2, 600
"""First and last frame stay so many times as long, and so long at least, ms."""
_MAPPED, _DARK, _GREYS, _REDS = 176, 16, 48, 16
"""Colours of the palette, 256 together: of the map, of lines, greys, and of what is in red."""


class Animation:
    """The frames of a run, in two passes, so that no two states are in memory at once.

    The first pass finds the range of the colours and of the body's places, the second draws.

    Args:
        model_mesh: the body in space.
        renderer: draws.
        scenery: obstacles and captions.
    """

    def __init__(
        self, model_mesh: ModelMesh, renderer: Renderer, scenery: Scenery | None = None
    ) -> None:
        self._title, self._mesh = model_mesh.title, model_mesh.mesh
        self._named = model_mesh.strain_named
        self._surfaces, self._renderer = BodySurfaces(model_mesh, scenery), renderer
        self._scenery = scenery or Scenery()
        self._skin = Tessellation(self._mesh, self._surfaces.outside(self._surfaces.bare, False), 2)

    def write(
        self,
        target: Target,
        strained: Iterable[tuple[Snapshot, Floats]],
        again: Callable[[], Iterable[Snapshot]],
        frame: float | None = None,
    ) -> None:
        """Write the GIF.

        Args:
            target: a path, or a file open for writing bytes.
            strained: every state in space, rest first, and its maximum principal logarithmic
                strain at the nodes of every cell, (m, k).
            again: gives the same states once more.
            frame: seconds from one state to the next where they are a motion; else all of them
                take the same time together.

        Raises:
            ValueError: no state.
        """
        values: list[Any] = []
        corners: list[Floats] = []
        for state, strain in strained:
            values.append(self._skin.interpolate(strain).astype(np.float32))
            corners.append(_extremes(self._surfaces.points(state)))
        if not values:
            raise ValueError("no state to draw")
        rest = self._mesh.nodes[self._mesh.cells]
        peaks = (greatest_seen(self._skin, rest, value, FROM_THE_SIDE) for value in values)
        high = nice_above(max(peaks))
        every = np.concatenate(corners)
        obstacles = Obstacles(self._scenery, every)
        view = obstacles.frame(every, FROM_THE_SIDE, SIZE[0] / _BAND)
        limits = (0.0, high)
        page = Page(SIZE, self._title)
        blank = np.full((_BAND, SIZE[0], 3), 255, dtype=np.uint8)
        page.scale(page.image(blank, (0.0, _LOW / SIZE[1], 1.0, _BAND / SIZE[1]), view), 14)
        page.color_bar(limits, self._named + self._surfaces.remark)

        def frames() -> Iterator[Image]:
            for state, value in zip(again(), values, strict=True):
                image = self._image(state, value, limits, obstacles, view)
                panel = page.renew(image, self._scenery.caption(state), state.remark)
                write_forces(panel, obstacles, self._surfaces.points(state), state, 10)
                yield page.pixels()

        save_gif(target, frames(), len(values), _palette(), frame)

    def _image(
        self,
        state: Snapshot,
        value: Floats,
        limits: tuple[float, float],
        obstacles: Obstacles,
        view: View,
    ) -> Image:
        surface = self._surfaces.surface(self._skin, state, self._mesh.half)
        surface["value"] = np.resize(value, surface.n_points)
        layers = [Drawable(surface, scalars="value"), *self._surfaces.fiber_tubes(state)]
        layers += self._surfaces.fabric(state)
        layers += obstacles.behind(view)
        return self._renderer.draw(layers, view, (SIZE[0], _BAND), limits, colormap())


def _extremes(points: Floats) -> Floats:
    """The points that are farthest along each axis, (6, 3), mm."""
    extremes: Floats = points[np.r_[points.argmin(axis=0), points.argmax(axis=0)]]
    return extremes


def save_gif(
    target: Target,
    frames: Iterable[Image],
    number: int,
    palette: Any = None,
    frame: float | None = None,
) -> None:
    """Write frames as an animation; the first and the last one stay.

    Args:
        target: a path, or a file open for writing bytes.
        frames: pixels of each.
        number: of frames.
        palette: a Pillow image that has the colours of all; by default those of the first frame.
        frame: seconds of each where they are a motion.
    """
    from PIL import Image as Pillow

    if palette is None:
        first = next(frames := iter(frames))
        frames = itertools.chain([first], frames)
        palette = Pillow.fromarray(first).quantize(256, dither=Pillow.Dither.NONE)
    pages = [
        Pillow.fromarray(frame).quantize(palette=palette, dither=Pillow.Dither.NONE)
        for frame in frames
    ]
    pace = int(np.clip(1000 * _SECONDS / number, _QUICK, _SLOW))
    if frame is not None:
        pace = round(1000 * frame)
    times = [pace] * number
    times[0] = times[-1] = max(_REST * pace, _STAYS)
    pages[0].save(
        target,
        format="GIF",
        save_all=True,
        append_images=pages[1:],
        duration=times,
        loop=0,
        optimize=False,
    )


def _palette() -> Any:
    """The colours of every frame: those of the map, greys, and reds of what is written in red."""
    from PIL import Image as Pillow

    colors = colormap()(np.linspace(0.0, 1.0, _MAPPED))[:, :3]
    # lines on a surface are its colour mixed with grey
    dark = 0.25 * colors[:: _MAPPED // _DARK] + 0.75 * 40 / 255
    # none next to white: Pillow would take it for white
    greys = np.append(np.linspace(0.0, 0.94, _GREYS - 1), 1.0)[:, None] * np.ones(3)
    shade = np.linspace(0.0, 1.0, _REDS)[:, None]
    reds = (1 - shade) * [0.69, 0.09, 0.09] + shade
    every = np.rint(255 * np.concatenate([colors, dark, greys, reds])).astype(np.uint8)
    image = Pillow.new("P", (1, 1))
    image.putpalette(every.ravel().tolist())
    return image

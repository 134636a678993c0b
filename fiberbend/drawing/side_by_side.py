"""States of a body in space side by side, at one scale and each in the middle of its panel."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import colormap
from fiberbend.drawing.renderer import (
    Drawable,
    Image,
    Renderer,
    View,
    frame,
)
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats

_ALONE, _BAND = (1400, 960), 730
_BOX = (0.0, 124 / _ALONE[1], 1.0, _BAND / _ALONE[1])
_PANEL = (700, 700)


class SideBySide:
    """Body and fibers in several states; a sheath that would hide fibers is left out.

    Args:
        model_mesh: the body in space.
        states: at least one.
        level: pieces along an element's edge.
        renderer: draws.
        open_ends: the viewer sees the chamber through the ends.
        scenery: has strips of fabric.

    Attributes:
        skin: the surface that is drawn.
        outside: the part of it that is seen from outside.
    """

    def __init__(
        self,
        model_mesh: ModelMesh,
        states: Sequence[Snapshot],
        level: int,
        renderer: Renderer,
        open_ends: bool = False,
        scenery: Scenery | None = None,
    ) -> None:
        self._mesh, self._states, self._renderer = model_mesh.mesh, states, renderer
        self._surfaces = BodySurfaces(model_mesh, scenery)
        self.skin = Tessellation(
            model_mesh.mesh, self._surfaces.outside(self._surfaces.bare, open_ends), level
        )
        name = "outer" if self._surfaces.bare.all() else "winding"
        self.outside = Tessellation(model_mesh.mesh, model_mesh.mesh.facets[name], level)

    def page(
        self,
        title: str,
        captions: Sequence[str],
        values: Sequence[Floats],
        limits: tuple[float, float],
        label: str,
        toward: tuple[float, float, float],
        colors: Any = None,
    ) -> Page:
        """Draw every state in colours.

        Args:
            title: text at the top.
            captions: of the states.
            values: of each state, at the points of `skin`.
            limits: values at the ends of the colour bar.
            label: what the colours show.
            toward: direction to the viewer.
            colors: a matplotlib colour map or its name.

        Raises:
            fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
        """
        is_alone = len(self._states) == 1
        size = (_ALONE[0], _BAND) if is_alone else _PANEL
        views = [self._view(state, toward, size[0] / size[1]) for state in self._states]
        width = max(view.width for view in views)
        views = [dataclasses.replace(view, width=width) for view in views]
        images: list[Image] = []
        for state, value, view in zip(self._states, values, views, strict=True):
            surface = self._surfaces.surface(self.skin, state, self._mesh.half)
            surface["value"] = np.tile(value, 2 if self._mesh.half else 1)
            layers = [Drawable(surface, scalars="value"), *self._surfaces.fiber_tubes(state)]
            layers += self._surfaces.fabric(state)
            images.append(self._renderer.draw(layers, view, size, limits, colors or colormap()))
        if is_alone:
            state = self._states[0]
            page = Page(_ALONE, title, captions[0].replace("\n", ",  "), state.remark)
            page.scale(page.image(images[0], _BOX, views[0]))
        else:
            remarks = [state.remark for state in self._states]
            page = Page.of_panels(_ALONE[0], title, images, captions, views, remarks)
        page.color_bar(limits, label + self._surfaces.remark, colors)
        return page

    def _view(self, state: Snapshot, toward: tuple[float, float, float], aspect: float) -> View:
        return frame(self._surfaces.points(state), toward, aspect)

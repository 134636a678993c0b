"""States of a body in space side by side, at one scale and each in the middle of its panel."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import Page, colormap
from fiberbend.drawing.renderer import (
    Drawable,
    Image,
    Renderer,
    View,
    frame,
)
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats

_ALONE, _BAND = (1400, 900), 730
_PANEL = (1000, 1000)
_MIRROR = np.array([-1.0, 1.0, 1.0])


class SideBySide:
    """Body and fibers in several states; a sheath that would hide fibers is left out.

    Args:
        model_mesh: the body in space.
        states: at least one.
        level: pieces along an element's edge.

    Attributes:
        skin: the surface that is drawn, the chamber's too.
        outside: the part of it that is seen from outside.
        sheathed: what to add to a label: whether a sheath was left out.
    """

    def __init__(self, model_mesh: ModelMesh, states: Sequence[Snapshot], level: int) -> None:
        self._mesh, self._states = model_mesh.mesh, states
        self._surfaces = BodySurfaces(model_mesh)
        self.skin = Tessellation(
            model_mesh.mesh, self._surfaces.outside(self._surfaces.bare), level
        )
        name = "outer" if self._surfaces.bare.all() else "winding"
        self.outside = Tessellation(model_mesh.mesh, model_mesh.mesh.facets[name], level)
        self.sheathed = "" if self._surfaces.bare.all() else ", sheath not drawn"

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
        renderer = Renderer(size)
        images: list[Image] = []
        try:
            for state, value, view in zip(self._states, values, views, strict=True):
                surface = self._surfaces.surface(self.skin, state, self._mesh.half)
                surface["value"] = np.tile(value, 2 if self._mesh.half else 1)
                layers = [Drawable(surface, scalars="value"), *self._surfaces.fiber_tubes(state)]
                view = dataclasses.replace(view, width=width)
                images.append(renderer.draw(layers, view, limits, colors or colormap()))
        finally:
            renderer.close()
        if is_alone:
            caption = captions[0].replace("\n", ",  ")
            page = Page(_ALONE, f"{title};  {caption}")
            page.image(images[0], (0.0, 0.115, 1.0, _BAND / _ALONE[1]))
        else:
            page = Page.of_panels(_ALONE[0], title, images, captions)
        page.color_bar(limits, label + self.sheathed, colors)
        return page

    def _view(self, state: Snapshot, toward: tuple[float, float, float], aspect: float) -> View:
        nodes = self._mesh.nodes + state.displacement
        if self._mesh.half:
            nodes = np.concatenate([nodes, nodes * _MIRROR])
        return frame(nodes, toward, aspect)

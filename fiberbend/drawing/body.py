"""Pictures of a run as in the paper's Fig. 6: undeformed, cut open, bent and coloured by strain."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import IO

import numpy as np

from fiberbend.drawing.page import colormap, nice_above
from fiberbend.drawing.renderer import (
    FROM_THE_SIDE,
    Drawable,
    Image,
    Renderer,
    frame,
)
from fiberbend.drawing.space.obstacles import Obstacles, Scenery, write_forces
from fiberbend.drawing.space.page import Page
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation, greatest_seen
from fiberbend.states.recovery import NodalFields, recover, split_nodes
from fiberbend.states.snapshot import (
    ModelMesh,
    Snapshot,
    Target,
    Write,
)
from geometry.mesh.data import Floats

SIZE = (1400, 960)
"""Width and height of a picture in pixels."""

_BAND = 730
_BOX = (0.0, 124 / SIZE[1], 1.0, _BAND / SIZE[1])
_WHOLE = (-1.0, 0.35, -0.25)
_OBLIQUE = (-0.62, 0.42, -0.66)
_PIECE = 500
_PEELED = 0.6
"""Fraction of the chamber over which the undeformed actuator shows its winding."""


class BodyPictures:
    """All pictures of a run; the window, the camera and the colour range are shared.

    Args:
        model_mesh: mesh, materials and fibers.
        snapshots: the states, at least one.
        renderer: draws.
        fields: their recovered fields, if at hand.
        scenery: obstacles and captions.

    Raises:
        ValueError: no state.
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """

    def __init__(
        self,
        model_mesh: ModelMesh,
        snapshots: Sequence[Snapshot],
        renderer: Renderer,
        fields: Sequence[NodalFields] | None = None,
        scenery: Scenery | None = None,
    ) -> None:
        if not snapshots:
            raise ValueError("no state to draw")
        self.model_mesh, self.snapshots = model_mesh, snapshots
        self._scenery = scenery or Scenery()
        self._surfaces = BodySurfaces(model_mesh, self._scenery)
        mesh = model_mesh.mesh
        self._nodes = split_nodes(mesh)
        fields = fields or [recover(model_mesh, state, self._nodes) for state in snapshots]
        self._strain = [field.log_strain[self._nodes.cells] for field in fields]
        self._skin = Tessellation(mesh, self._surfaces.outside(self._surfaces.bare, chamber=False))
        self._limits = (0.0, nice_above(max(self._peak(strain) for strain in self._strain)))
        moved = np.concatenate([self._surfaces.points(state) for state in (None, *snapshots)])
        self._renderer = renderer
        self._obstacles = Obstacles(self._scenery, moved)
        rest = self._surfaces.points(None)
        states = moved[len(rest) :]
        self._view = self._obstacles.frame(states, FROM_THE_SIDE, SIZE[0] / _BAND)
        self._images: dict[int, Image] = {}

    def undeformed(self, target: Target) -> None:
        """The actuator at rest: whole, its sheath partly removed, and a piece cut out of it."""
        mesh, surfaces = self.model_mesh.mesh, self._surfaces
        z = surfaces.middle[:, 2]
        length = float(mesh.nodes[mesh.facet_nodes("section_tip"), 2].mean())
        peeled = z > _PEELED * length
        rest = surfaces.points(None)
        view = self._obstacles.frame(rest, _WHOLE, SIZE[0] / _BAND)
        top = self._renderer.draw(
            surfaces.parts(surfaces.peeled | peeled)
            + surfaces.fiber_tubes()
            + surfaces.fabric()
            + self._obstacles.seen_through(),
            view,
            (SIZE[0], _BAND),
        )
        start, end = 0.45 * length, 0.45 * length + 32
        inside = (z > start) & (z < end)
        bare = z < start + 20
        points = mesh.nodes[mesh.cells[inside]].reshape(-1, 3)
        both = np.concatenate([points, points * [-1, 1, 1]])
        close = frame(both, _OBLIQUE, SIZE[0] / _BAND)
        piece = self._renderer.draw(
            surfaces.parts(inside & (surfaces.peeled | ~bare), level=6)
            + surfaces.fiber_tubes(low=start, high=float(points[:, 2].max()))
            + surfaces.fabric(low=start, high=float(points[:, 2].max())),
            close,
            (SIZE[0], _BAND),
        )
        page = Page.stacked(
            SIZE[0],
            f"{self.model_mesh.title}: undeformed",
            [(top, view, 560), (piece, close, _PIECE)],
        )
        write_forces(page.panels[0], self._obstacles, rest)
        page.legend(surfaces.names, colors=surfaces.family_colors)
        page.save(target)

    def cut(self, target: Target, snapshot: Snapshot | None = None) -> None:
        """A state cut open at x = 0: chamber, materials, and all fibers like a cage around it."""
        state = snapshot or self.snapshots[-1]
        surfaces = self._surfaces
        far = surfaces.middle[:, 0] > 0
        view = self._obstacles.frame(surfaces.points(state), FROM_THE_SIDE, SIZE[0] / _BAND)
        layers = surfaces.parts(far, state, open_at_mirror=True)
        layers += surfaces.fiber_tubes(state) + surfaces.winding_line(state)
        layers += surfaces.fabric(state, opened=True)
        image = self._renderer.draw(layers + self._obstacles.behind(view), view, (SIZE[0], _BAND))
        page = Page(
            SIZE,
            f"{self.model_mesh.title}: cut at x = 0",
            self._scenery.caption(state),
            state.remark,
        )
        panel = page.image(image, _BOX, view)
        write_forces(panel, self._obstacles, surfaces.points(state), state, tip=surfaces.tip(state))
        page.legend(surfaces.names, colors=surfaces.family_colors)
        page.scale(panel)
        page.save(target)

    def bent(self, target: Target, number: int) -> None:
        """One state coloured by maximum principal logarithmic strain.

        Args:
            target: a path, or a file open for writing bytes.
            number: place of the state within `snapshots`.
        """
        state = self.snapshots[number]
        page = Page(SIZE, self.model_mesh.title, self._scenery.caption(state), state.remark)
        panel = page.image(self._image(number), _BOX, self._view)
        points, tip = self._surfaces.points(state), self._surfaces.tip(state)
        write_forces(panel, self._obstacles, points, state, tip=tip)
        page.color_bar(self._limits, self._strain_label())
        page.scale(panel)
        page.save(target)

    def montage(self, target: Target) -> None:
        """All states side by side, in one colour range and at one scale."""
        states = self.snapshots
        page = Page.of_panels(
            SIZE[0],
            self.model_mesh.title,
            [self._image(i) for i in range(len(states))],
            [self._scenery.caption(state) for state in states],
            [self._view] * len(states),
            [state.remark for state in states],
            margins=self._obstacles.margins(SIZE[0]),
        )
        for panel, state in zip(page.panels, states, strict=True):
            points, tip = self._surfaces.points(state), self._surfaces.tip(state)
            write_forces(panel, self._obstacles, points, state, 9, tip)
        page.color_bar(self._limits, self._strain_label())
        page.save(target)

    # --- what is drawn -----------------------------------------------------------------------

    def _image(self, number: int) -> Image:
        if number not in self._images:
            state = self.snapshots[number]
            skin = self._surfaces.surface(self._skin, state, self.model_mesh.mesh.half)
            values = self._skin.interpolate(self._strain[number])
            skin["strain"] = np.resize(values, skin.n_points)
            layers = [Drawable(skin, scalars="strain"), *self._surfaces.fiber_tubes(state)]
            layers += self._surfaces.fabric(state)
            layers += self._obstacles.behind(self._view)
            self._images[number] = self._renderer.draw(
                layers, self._view, (SIZE[0], _BAND), self._limits, colormap()
            )
        return self._images[number]

    def _peak(self, strain: Floats) -> float:
        mesh, values = self.model_mesh.mesh, self._skin.interpolate(strain)
        return greatest_seen(self._skin, mesh.nodes[mesh.cells], values, FROM_THE_SIDE)

    def _strain_label(self) -> str:
        return self.model_mesh.strain_named + self._surfaces.remark


def draw_pictures(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    write: Write,
    renderer: Renderer,
    fields: Sequence[NodalFields] | None = None,
    scenery: Scenery | None = None,
) -> list[str]:
    """Draw undeformed.png, cut.png, bent_LABEL.png of every state, and montage.png of several.

    Args:
        model_mesh: mesh, materials and fibers.
        snapshots: the states; cut.png shows the last one.
        write: writes a file, such as `RunFolder.write`.
        renderer: draws.
        fields: recovered fields of the states, if at hand.
        scenery: obstacles and captions.

    Returns:
        The names written.

    Raises:
        ValueError: no state.
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    pictures = BodyPictures(model_mesh, snapshots, renderer, fields, scenery)
    jobs: dict[str, Callable[[IO[bytes]], object]] = {
        "undeformed.png": pictures.undeformed,
        "cut.png": pictures.cut,
    }
    for number, state in enumerate(snapshots):
        jobs[f"bent_{state.label}.png"] = functools.partial(pictures.bent, number=number)
    if len(snapshots) > 1:
        jobs["montage.png"] = pictures.montage
    for name, fill in jobs.items():
        write(name, fill)
    return list(jobs)

"""Pictures of a run as in the paper's Fig. 6: undeformed, cut open, bent and coloured by strain."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import IO

import numpy as np

from fiberbend.drawing.page import Page, colormap, nice_above
from fiberbend.drawing.renderer import (
    FROM_THE_SIDE,
    Drawable,
    Image,
    Renderer,
    frame,
)
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation
from fiberbend.states.recovery import NodalFields, recover, split_nodes
from fiberbend.states.snapshot import (
    ModelMesh,
    Snapshot,
    Target,
    Write,
)
from geometry.mesh.data import Floats

SIZE = (1400, 900)
"""Width and height of a picture in pixels."""

_BAND = 730
_OBLIQUE = (-0.62, 0.42, -0.66)
_PEELED = 0.6
"""Fraction of the chamber over which the undeformed actuator shows its fibers."""


class BodyPictures:
    """All pictures of a run; the window, the camera and the colour range are shared.

    Args:
        model_mesh: mesh, materials and fibers.
        snapshots: the states, at least one.
        fields: their recovered fields, if at hand.

    Raises:
        ValueError: no state.
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """

    def __init__(
        self,
        model_mesh: ModelMesh,
        snapshots: Sequence[Snapshot],
        fields: Sequence[NodalFields] | None = None,
    ) -> None:
        if not snapshots:
            raise ValueError("no state to draw")
        self.model_mesh, self.snapshots = model_mesh, snapshots
        self._surfaces = BodySurfaces(model_mesh)
        mesh = model_mesh.mesh
        self._nodes = split_nodes(mesh)
        fields = fields or [recover(model_mesh, state, self._nodes) for state in snapshots]
        self._strain = [field.log_strain[self._nodes.cells] for field in fields]
        self._skin = Tessellation(mesh, self._surfaces.outside(self._surfaces.bare))
        self._limits = (0.0, nice_above(max(self._peak(strain) for strain in self._strain)))
        moved = [mesh.nodes + state.displacement for state in snapshots]
        self._view = frame(np.concatenate(moved), FROM_THE_SIDE, SIZE[0] / _BAND)
        self._images: dict[int, Image] = {}
        self._renderer = Renderer((SIZE[0], _BAND))

    def undeformed(self, target: Target) -> None:
        """The actuator at rest: whole, its sheath partly removed, and a piece cut out of it."""
        mesh, surfaces = self.model_mesh.mesh, self._surfaces
        z = surfaces.middle[:, 2]
        length = float(mesh.nodes[mesh.facet_nodes("section_tip"), 2].mean())
        peeled = z > _PEELED * length
        whole = surfaces.parts(surfaces.bare | peeled) + surfaces.fiber_tubes()
        high = SIZE[0] / _BAND
        both = np.concatenate([mesh.nodes, mesh.nodes * [-1, 1, 1]])
        top = self._renderer.draw(whole, frame(both, (-1.0, 0.35, -0.25), high))
        start, end = 0.45 * length, 0.45 * length + 32
        inside = (z > start) & (z < end)
        shown = inside & (surfaces.bare | (z > start + 20))
        points = mesh.nodes[mesh.cells[inside]].reshape(-1, 3)
        both = np.concatenate([points, points * [-1, 1, 1]])
        piece = self._renderer.draw(
            surfaces.parts(shown, level=6)
            + surfaces.fiber_tubes(low=start, high=float(points[:, 2].max())),
            frame(both, _OBLIQUE, high),
        )
        page = Page(SIZE, f"{self.model_mesh.title}: undeformed")
        page.image(top, (0.0, 0.66, 1.0, 0.26), crop=True)
        page.image(piece, (0.12, 0.07, 0.76, 0.58), crop=True)
        page.legend(self._surfaces.names)
        page.save(target)

    def cut(self, target: Target, snapshot: Snapshot | None = None) -> None:
        """A state cut open at x = 0: chamber, materials, and all fibers like a cage around it."""
        state = snapshot or self.snapshots[-1]
        surfaces = self._surfaces
        far = surfaces.middle[:, 0] > 0
        layers = surfaces.parts(far, state, open_at_mirror=True) + surfaces.fiber_tubes(state)
        moved = self.model_mesh.mesh.nodes + state.displacement
        view = frame(moved, FROM_THE_SIDE, SIZE[0] / _BAND)
        image = self._renderer.draw(layers, view)
        page = Page(SIZE, f"{self.model_mesh.title}: cut at x = 0,  {state.caption}")
        page.image(image, (0.0, 0.09, 1.0, _BAND / SIZE[1]))
        page.legend(self._surfaces.names)
        page.scale_bar(view.width)
        page.save(target)

    def bent(self, target: Target, number: int) -> None:
        """One state coloured by maximum principal logarithmic strain.

        Args:
            target: a path, or a file open for writing bytes.
            number: place of the state within `snapshots`.
        """
        page = Page(SIZE, f"{self.model_mesh.title}:  {self.snapshots[number].caption}")
        page.image(self._image(number), (0.0, 0.115, 1.0, _BAND / SIZE[1]))
        page.color_bar(self._limits, self._strain_label())
        page.scale_bar(self._view.width)
        page.save(target)

    def montage(self, target: Target) -> None:
        """All states side by side, in one colour range and at one scale."""
        captions = [state.caption for state in self.snapshots]
        images = [self._image(i) for i in range(len(captions))]
        page = Page.of_panels(SIZE[0], self.model_mesh.title, images, captions)
        page.color_bar(self._limits, self._strain_label())
        page.save(target)

    def close(self) -> None:
        """Release the window."""
        self._renderer.close()

    # --- what is drawn -----------------------------------------------------------------------

    def _image(self, number: int) -> Image:
        if number not in self._images:
            state = self.snapshots[number]
            skin = self._surfaces.surface(self._skin, state, self.model_mesh.mesh.half)
            values = self._skin.interpolate(self._strain[number])
            skin["strain"] = np.resize(values, skin.n_points)
            layers = [Drawable(skin, scalars="strain"), *self._surfaces.fiber_tubes(state)]
            self._images[number] = self._renderer.draw(layers, self._view, self._limits, colormap())
        return self._images[number]

    def _peak(self, strain: Floats) -> float:
        """Strain at the upper end of the colours: the drawn surface's, short of single peaks."""
        return float(np.quantile(self._skin.interpolate(strain), 0.998))

    def _strain_label(self) -> str:
        label = "maximum principal logarithmic strain"
        return label if self._surfaces.bare.all() else f"{label}, sheath not drawn"


def draw_pictures(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    write: Write,
    fields: Sequence[NodalFields] | None = None,
) -> list[str]:
    """Draw undeformed.png, cut.png, bent_LABEL.png of every state, and montage.png of several.

    Args:
        model_mesh: mesh, materials and fibers.
        snapshots: the states; cut.png shows the last one.
        write: writes a file, such as `RunFolder.write`.
        fields: recovered fields of the states, if at hand.

    Returns:
        The names written.

    Raises:
        ValueError: no state.
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    pictures = BodyPictures(model_mesh, snapshots, fields)
    jobs: dict[str, Callable[[IO[bytes]], object]] = {
        "undeformed.png": pictures.undeformed,
        "cut.png": pictures.cut,
    }
    for number, state in enumerate(snapshots):
        jobs[f"bent_{state.label}.png"] = functools.partial(pictures.bent, number=number)
    if len(snapshots) > 1:
        jobs["montage.png"] = pictures.montage
    try:
        for name, fill in jobs.items():
            write(name, fill)
    finally:
        pictures.close()
    return list(jobs)

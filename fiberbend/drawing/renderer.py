"""Drawing of bodies and fibers off screen with pyvista, seen along a fixed direction.

pyvista is imported where it is used: a run without pictures does without it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from geometry.mesh.data import Floats

Image = NDArray[np.uint8]

FROM_THE_SIDE = (-1.0, 0.0, 0.0)
"""Where the viewer stands: z points to the right, y up."""


class PictureError(RuntimeError):
    """Nothing can be drawn on this machine."""


@dataclasses.dataclass(frozen=True)
class Drawable:
    """One thing to draw.

    Attributes:
        data: pyvista.PolyData: a surface, or lines that become tubes.
        color: colour, where `scalars` is None.
        scalars: name of the point data that colours it, or None.
        radius: radius in mm of tubes, for lines.
    """

    data: Any
    color: str = "white"
    scalars: str | None = None
    radius: float | None = None


@dataclasses.dataclass(frozen=True)
class View:
    """A parallel projection.

    Attributes:
        toward: direction from the scene to the viewer, (3,).
        center: point in mm that is drawn in the middle, (3,).
        width: width in mm of what is drawn.
    """

    toward: tuple[float, float, float]
    center: Floats
    width: float


def frame(points: Floats, toward: tuple[float, float, float], aspect: float) -> View:
    """The least view that contains some points.

    Args:
        points: (n, 3), mm.
        toward: direction to the viewer.
        aspect: width over height of the picture.
    """
    axes = _axes(toward)
    low, high = (points @ axes.T).min(axis=0), (points @ axes.T).max(axis=0)
    width = max(high[0] - low[0], (high[1] - low[1]) * aspect) * 1.04
    return View(toward, (low + high) / 2 @ axes, float(width))


class Renderer:
    """An off-screen window that is used again for every picture.

    Args:
        size: width and height in pixels.

    Raises:
        PictureError: pyvista cannot be imported.
    """

    def __init__(self, size: tuple[int, int]) -> None:
        try:
            import pyvista as pv
            from vtkmodules.vtkCommonCore import vtkLogger
        except ImportError as error:
            raise PictureError(f"pictures need pyvista and OpenGL: {error}") from error
        # VTK tries a display first and complains before it draws without one.
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
        self.size = size
        self._plotter = pv.Plotter(
            off_screen=True, window_size=size, lighting="none", theme=pv.themes.DocumentTheme()
        )
        self._plotter.enable_anti_aliasing("msaa", multi_samples=4)
        for position, strength in (((-0.5, 0.8, 0.9), 0.75), ((0.3, -0.2, 1.0), 0.35)):
            self._plotter.add_light(
                pv.Light(position=position, intensity=strength, light_type="camera light")
            )

    def draw(
        self,
        layers: Sequence[Drawable],
        view: View,
        limits: tuple[float, float] = (0.0, 1.0),
        colors: Any = "viridis",
    ) -> Image:
        """Draw layers on white.

        Args:
            layers: what to draw.
            view: from where.
            limits: values at the ends of the colour map.
            colors: a matplotlib colour map or its name.

        Returns:
            Pixels (height, width, 3).
        """
        plotter = self._plotter
        plotter.clear_actors()
        for layer in layers:
            data = layer.data
            if layer.radius is not None:
                data = data.tube(radius=layer.radius, n_sides=8)
            actor = plotter.add_mesh(
                data,
                color=None if layer.scalars else layer.color,
                scalars=layer.scalars,
                cmap=colors if layer.scalars else None,
                clim=limits if layer.scalars else None,
                n_colors=256,
                show_scalar_bar=False,
                reset_camera=False,
                render=False,
                copy_mesh=False,
                # colours that are read off a bar must not be shaded much
                ambient=0.7 if layer.scalars else 0.35,
                diffuse=0.3 if layer.scalars else 0.7,
            )
            actor.prop.interpolation = "Phong"
        self._look(view)
        # a screenshot alone would repeat the picture before
        plotter.render()
        return np.asarray(plotter.screenshot(None, return_img=True))

    def close(self) -> None:
        """Release the window."""
        self._plotter.close()

    def _look(self, view: View) -> None:
        _, up, toward = _axes(view.toward)
        camera = self._plotter.camera
        camera.focal_point = view.center
        camera.position = view.center + 1000 * toward
        camera.up = up
        camera.parallel_projection = True
        camera.parallel_scale = view.width * self.size[1] / self.size[0] / 2
        self._plotter.camera_set = True
        self._plotter.reset_camera_clipping_range()


def _axes(toward: tuple[float, float, float]) -> Floats:
    """Rows: right, up and toward the viewer; y is up."""
    backward = np.array(toward) / np.linalg.norm(toward)
    right = np.cross([0.0, 1.0, 0.0], backward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(backward, right), backward])

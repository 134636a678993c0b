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
_FAR = 1000.0
"""Distance of the camera from the middle of its view, mm, beside twice the width of that."""
_EDGE, _EDGE_GREY = 0.75, 40
"""How much of the grey of a line covers what is under it, and that grey."""
_CREASE, _STEP = 0.8, 6.0
"""Turn of a surface across a pixel that is drawn as a line, and depth of a step, in pixels."""

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
        opacity: 1 for what hides what lies behind it.
        flat: no light falls on it: it has its colour everywhere.
    """

    data: Any
    color: str = "white"
    scalars: str | None = None
    radius: float | None = None
    opacity: float = 1.0
    flat: bool = False


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

    @property
    def axes(self) -> Floats:
        """Rows: right, up and toward the viewer, (3, 3)."""
        return _axes(self.toward)

    def at(self, points: Floats, size: tuple[int, int]) -> Floats:
        """Where points are drawn, in pixels from the upper left corner, (n, 2).

        Args:
            points: (n, 3), mm.
            size: width and height of the picture in pixels.
        """
        right, up, _ = self.axes
        off = np.asarray(points) - self.center
        scale = size[0] / self.width
        return np.column_stack([size[0] / 2 + scale * off @ right, size[1] / 2 - scale * off @ up])


def frame(
    points: Floats, toward: tuple[float, float, float], aspect: float, margin: float = 0.02
) -> View:
    """The least view that contains some points.

    Args:
        points: (n, 3), mm.
        toward: direction to the viewer.
        aspect: width over height of the picture.
        margin: what is left free on every side, as a part of the view's width.
    """
    axes = _axes(toward)
    low, high = (points @ axes.T).min(axis=0), (points @ axes.T).max(axis=0)
    wide, tall = high[:2] - low[:2]
    width = max(wide / (1 - 2 * margin), tall * aspect / (1 - 2 * margin * aspect))
    return View(toward, (low + high) / 2 @ axes, float(width))


class Renderer:
    """An off-screen window that is used again for every picture.

    Raises:
        PictureError: pyvista cannot be imported.
    """

    def __init__(self) -> None:
        self._plotter = _window()

    def __enter__(self) -> Renderer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def draw(
        self,
        layers: Sequence[Drawable],
        view: View,
        size: tuple[int, int],
        limits: tuple[float, float] = (0.0, 1.0),
        colors: Any = "viridis",
    ) -> Image:
        """Draw layers on white, with thin lines where surfaces end or turn away.

        Scalars have the very colours of their map, whatever way their surface faces.

        Args:
            layers: what to draw.
            view: from where.
            size: width and height in pixels.
            limits: values at the ends of the colour map.
            colors: a matplotlib colour map or its name.

        Returns:
            Pixels (height, width, 3).
        """
        plotter = self._plotter
        plotter.clear_actors()
        if tuple(plotter.window_size) != size:
            plotter.window_size = size
        for layer in layers:
            data = layer.data
            if layer.radius is not None:
                data = data.tube(radius=layer.radius, n_sides=8)
            # colours that are read off a bar must not be shaded
            unlit = bool(layer.scalars) or layer.flat
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
                # their sum is what VTK multiplies a colour with, also without light
                ambient=1.0 if unlit else 0.35,
                diffuse=0.0 if unlit else 0.7,
                lighting=not unlit,
                opacity=layer.opacity,
            )
            actor.prop.interpolation = "Phong"
        self._look(view, size)
        # a screenshot alone would repeat the picture before
        plotter.render()
        image = np.array(plotter.screenshot(None, return_img=True))
        edges = _edges(self._depth(size), view.width / size[0])
        image[edges] = (1 - _EDGE) * image[edges] + _EDGE * _EDGE_GREY
        return image

    def close(self) -> None:
        """Release the window."""
        self._plotter.close()

    def _look(self, view: View, size: tuple[int, int]) -> None:
        _, up, toward = view.axes
        camera = self._plotter.camera
        camera.focal_point = view.center
        camera.position = view.center + (_FAR + 2 * view.width) * toward
        camera.up = up
        camera.parallel_projection = True
        camera.parallel_scale = view.width * size[1] / size[0] / 2
        self._plotter.camera_set = True
        self._plotter.reset_camera_clipping_range()

    def _depth(self, size: tuple[int, int]) -> Floats:
        """Distance of what is seen from the plane of the camera, mm, (height, width)."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkFloatArray

        buffer = vtkFloatArray()
        self._plotter.render_window.GetZbufferData(0, 0, size[0] - 1, size[1] - 1, buffer)
        near, far = self._plotter.camera.clipping_range
        share = vtk_to_numpy(buffer).reshape(size[1], size[0])[::-1]
        depth: Floats = near + share * (far - near)
        return depth


def _window() -> Any:
    """An empty pyvista.Plotter with two lights that go with the camera."""
    try:
        import pyvista as pv
        from vtkmodules.vtkCommonCore import vtkLogger
    except ImportError as error:
        raise PictureError(f"pictures need pyvista and OpenGL: {error}") from error
    # VTK tries a display first and complains before it draws without one.
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    plotter = pv.Plotter(
        off_screen=True, window_size=(400, 300), lighting="none", theme=pv.themes.DocumentTheme()
    )
    plotter.enable_anti_aliasing("msaa", multi_samples=4)
    for position, strength in (((-0.5, 0.8, 0.9), 0.75), ((0.3, -0.2, 1.0), 0.35)):
        plotter.add_light(
            pv.Light(position=position, intensity=strength, light_type="camera light")
        )
    return plotter


def _edges(depth: Floats, pixel: float) -> NDArray[np.bool_]:
    """Pixels at which a surface ends before what is behind it, or turns away from the viewer.

    Args:
        depth: of every pixel, mm.
        pixel: its width, mm.
    """
    edges = np.zeros(depth.shape, dtype=bool)
    inner = depth[1:-1, 1:-1]
    for one, other in (
        (depth[:-2, 1:-1], depth[2:, 1:-1]),
        (depth[1:-1, :-2], depth[1:-1, 2:]),
    ):
        bend, slope = (one + other - 2 * inner) / pixel, (other - one) / (2 * pixel)
        # by the turn of the surface: where it is steep, facets of a round one differ much in slope
        turns = np.abs(bend) > _CREASE * (1 + slope**2)
        edges[1:-1, 1:-1] |= (bend > _STEP) | (turns & (bend > -_STEP))
    return edges


def _axes(toward: tuple[float, float, float]) -> Floats:
    """Rows: right, up and toward the viewer; y is up."""
    backward = np.array(toward) / np.linalg.norm(toward)
    right = np.cross([0.0, 1.0, 0.0], backward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(backward, right), backward])

"""An actuator at rest with its dimensions: seen from the side, and its cross-section; no solution.

matplotlib is imported where it is used.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import COLORS, NAMES, figure, literal, nice_above, save
from fiberbend.drawing.renderer import Renderer
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.drawing.space.panel import Panel
from fiberbend.drawing.space.rest import rest_image, write_on
from fiberbend.states.obstacles import Bar, Box, Sheet
from fiberbend.states.snapshot import ModelMesh, Target
from geometry.mesh.data import Floats, MeshData, facet_positions

SIZE = (1400, 1000)
"""Width and height of the page in pixels."""
_OBSTACLE, _INK = "#b5651d", "#303030"
_THREAD: dict[str, Any] = {"color": COLORS["fiber"], "linewidth": 0.5, "alpha": 0.6}
_LINE: dict[str, Any] = {"color": _INK, "linewidth": 0.9}
_TEXT: dict[str, Any] = {"fontsize": 11, "color": _INK, "zorder": 8}
_MARGIN = 2.0
_TURNS = 40
"""So many turns at most are drawn; more would be a grey area."""


@dataclasses.dataclass(frozen=True)
class Blueprint:
    """What is drawn.

    Attributes:
        title: of the case.
        section: quadrilaterals of half the section, x ≥ 0, mm.
        length: of the chamber, mm.
        cap: length of each cap, mm.
        width: words on the width of the chamber, such as "radius 8 mm".
        curves: axes of the fibers, (n, 3) each, mm.
        winding: words on the winding, empty without one.
        pitch: of the winding, mm, or None.
        scenery: the obstacles.
        space: the body in space.
        threads: polylines of a winding that it does not have, (n, 3) each, mm.
    """

    title: str
    section: MeshData
    length: float
    cap: float
    width: str
    curves: Sequence[Floats]
    winding: str
    pitch: float | None
    scenery: Scenery
    space: ModelMesh
    threads: Sequence[Floats]

    def save(self, target: Target) -> None:
        """Draw the page as PNG into a path or a file open for writing bytes."""
        page = figure(SIZE)
        page.text(0.5, 0.972, literal(f"{self.title}: at rest"), ha="center", fontsize=17)
        self._side(page.add_axes((0.04, 0.56, 0.92, 0.38)))
        self._cut(page.add_axes((0.03, 0.08, 0.43, 0.45)))
        self._oblique(page, (0.48, 0.08, 0.50, 0.45))
        self._legend(page)
        save(page, target)

    @property
    def layers(self) -> list[tuple[str, float, float]]:
        """What lies over x = 0, from below: region, or "" for empty, least and greatest y in mm."""
        mesh = self.section
        pairs = mesh.facets["symmetry"]
        low, high = [], []
        for cell, side in pairs:
            ends = mesh.nodes[mesh.cells[cell][facet_positions(mesh.cell_type)[side]], 1]
            low.append(float(ends.min()))
            high.append(float(ends.max()))
        names = {number: name for name, number in mesh.regions.items()}
        found: list[tuple[str, float, float]] = []
        for i in np.argsort(low):
            name = names[int(mesh.cell_region[pairs[i, 0]])]
            if found and found[-1][2] < low[i] - 1e-6:
                found.append(("", found[-1][2], low[i]))
            if found and found[-1][0] == name:
                found[-1] = (name, found[-1][1], high[i])
            else:
                found.append((name, low[i], high[i]))
        return found

    def _oblique(self, page: Any, box: tuple[float, float, float, float]) -> None:
        """The body in space, cut open step by step, with axes and scale."""
        with Renderer() as renderer:
            width = 2 * round(box[2] * SIZE[0])
            rest = rest_image(self.space, renderer, self.scenery, self.threads, width)
        axes = page.add_axes(box)
        axes.imshow(rest.image)
        axes.set_axis_off()
        axes.autoscale(False)
        over = page.add_axes((0, 0, 1, 1))
        over.set(xlim=(0, SIZE[0]), ylim=(0, SIZE[1]))
        over.set_axis_off()
        size = (rest.image.shape[1], rest.image.shape[0])
        panel = Panel(page, over, axes, rest.image, rest.view, size, (0, 0))
        # the other drawings have the dimensions
        write_on(panel, dataclasses.replace(rest, lengths=[]), self.space, self.scenery)
        panel.scale(box[0] * SIZE[0], box[1] * SIZE[1] - 10, nice_above(70 / panel.per_mm))

    # --- from the side -------------------------------------------------------------------------

    def _side(self, axes: Any) -> None:
        from matplotlib.patches import Rectangle

        layers, start, end = self.layers, -self.cap, self.length + self.cap
        bottom, top = layers[0][1], layers[-1][2]
        for name, low, high in layers:
            body: dict[str, Any] = {
                "facecolor": COLORS.get(name or "wall", "#999999"),
                "edgecolor": "0.45",
            }
            axes.add_patch(Rectangle((start, low), end - start, high - low, linewidth=0.6, **body))
            if not name:
                hole: dict[str, Any] = {"facecolor": "white", "edgecolor": "0.45", "linewidth": 0.8}
                axes.add_patch(Rectangle((0.0, low), self.length, high - low, **hole))
        self._threads(axes)
        self._rigid(axes)
        high = top - bottom
        row = bottom - 0.45 * high
        _dimension(axes, (start, row), (0.0, row), f"cap {self.cap:g} mm")
        _dimension(axes, (0.0, row), (self.length, row), f"length {self.length:g} mm")
        _dimension(axes, (self.length, row), (end, row), f"cap {self.cap:g} mm")
        if self.pitch is not None and self.pitch < self.length:
            boxes = [
                shape.high[1] for shape in self.scenery.shapes.values() if isinstance(shape, Box)
            ]
            above, at = max([top, *boxes]) + 0.15 * high, 0.1 * self.length
            _arrow(axes, (at, above), (at + self.pitch, above))
            axes.text(at + 1.5 * self.pitch, above, f"pitch {self.pitch:g} mm", **_TEXT)
        curl = {"arrowstyle": "-|>", "connectionstyle": "arc3,rad=-0.45", "color": "#c0392b"}
        tip = end + 0.25 * high
        axes.annotate("", (tip, bottom - high), (tip, top), arrowprops=curl | {"linewidth": 1.6})
        axes.text(tip + 0.9 * high, bottom, "θ > 0", **_TEXT | {"color": "#c0392b"}, va="center")
        root = {"color": _INK, "linewidth": 2.0}
        axes.plot([start, start], [bottom - 0.15 * high, top + 0.15 * high], **root)
        axes.text(start, top + 0.2 * high, "clamped", ha="center", va="bottom", **_TEXT)
        origin = (start - 1.3 * high, bottom)
        for name, tip_of in (("z", (0.8 * high, 0.0)), ("y", (0.0, 0.8 * high))):
            axes.annotate(
                "",
                (origin[0] + tip_of[0], origin[1] + tip_of[1]),
                origin,
                arrowprops={"arrowstyle": "-|>", "color": "black", "shrinkA": 0},
            )
            place = (origin[0] + 1.15 * tip_of[0], origin[1] + 1.15 * tip_of[1])
            axes.text(*place, name, ha="center", va="center", **_TEXT | {"style": "italic"})
        axes.set_aspect("equal")
        ends = self._extent()
        axes.set_xlim(min(origin[0], ends[0][0]) - 0.3 * high, max(tip + 2.2 * high, ends[1][0]))
        axes.set_ylim(min(row - 0.6 * high, ends[0][1]), max(top + 0.9 * high, ends[1][1]))
        axes.set_axis_off()

    def _extent(self) -> tuple[Floats, Floats]:
        """Least and greatest z and y of the obstacles that have an end of their own, mm."""
        points = [np.zeros((1, 3))]
        for shape in self.scenery.shapes.values():
            if not isinstance(shape, Sheet):
                points.append(np.asarray(shape.surface(np.zeros((1, 3))).points))
            else:
                points.append(np.array([[0.0, shape.point[1] - 3.0, self.length / 2]]))
        every = np.concatenate(points)[:, [2, 1]]
        return every.min(axis=0) - _MARGIN, every.max(axis=0) + _MARGIN

    def _threads(self, axes: Any) -> None:
        """The half of every fiber that faces the viewer, x ≤ 0."""
        turns = self.length / self.pitch if self.pitch else 0.0
        every = _TURNS / turns if turns > _TURNS else 1.0
        for curve in self.curves:
            z, y = curve[:, 2].copy(), curve[:, 1].copy()
            hidden = curve[:, 0] > 1e-9
            if every < 1.0:
                # of many turns the first and the last ones
                hidden |= np.abs(z / self.length - 0.5) < 0.5 * (1 - every)
            y[hidden] = np.nan
            axes.plot(z, y, **_THREAD)

    def _rigid(self, axes: Any) -> None:
        from matplotlib.patches import Circle, Rectangle

        look: dict[str, Any] = {"facecolor": _OBSTACLE, "edgecolor": _OBSTACLE, "alpha": 0.55}
        for name, shape in self.scenery.shapes.items():
            label: dict[str, Any] = {"color": _OBSTACLE, "fontsize": 12, "ha": "center"}
            if isinstance(shape, Box):
                (_, y0, z0), (_, y1, z1) = shape.low, shape.high
                axes.add_patch(Rectangle((z0, y0), z1 - z0, y1 - y0, **look))
                if y0 >= 0:
                    axes.text((z0 + z1) / 2, y1, name, **label, va="bottom")
                else:
                    axes.text(z1, y0, f" {name}", **label | {"ha": "left"}, va="bottom")
            elif isinstance(shape, Bar):
                y, z = shape.center
                axes.add_patch(Circle((z, y), shape.radius, **look))
                axes.text(z, y, name, **label, va="center")
            elif isinstance(shape, Sheet):
                y, z = shape.point[1], shape.point[2]
                along = np.array([-shape.normal[1], shape.normal[2]])
                if np.linalg.norm(along) > 0:
                    along = along / np.linalg.norm(along) * (self.length / 2 + self.cap)
                    middle = np.array([self.length / 2, y + _rise(shape, self.length / 2 - z)])
                    ends = np.stack([middle - along, middle + along])
                    axes.plot(*ends.T, color=_OBSTACLE, linewidth=3, alpha=0.7)
                    left = ends[np.argmin(ends[:, 0])]
                    axes.text(*left, name, **label | {"ha": "left"}, va="bottom")

    # --- the cross-section ---------------------------------------------------------------------

    def _cut(self, axes: Any) -> None:
        from matplotlib.collections import PolyCollection

        mesh = self.section
        names = {number: name for name, number in mesh.regions.items()}
        corner = [0, 1, 2, 5, 8, 7, 6, 3]
        shown = mesh.nodes[mesh.cells[:, corner]]
        colors = [COLORS.get(names[int(n)], "#999999") for n in mesh.cell_region]
        for side in (1.0, -1.0):
            pieces = PolyCollection(
                list(shown * [side, 1.0]), facecolors=colors, edgecolors=colors, linewidths=0.6
            )
            axes.add_collection(pieces)
        half, high = float(mesh.nodes[:, 0].max()), float(np.ptp(mesh.nodes[:, 1]))
        row = half + 0.12 * high
        last = -np.inf
        for name, y0, y1 in self.layers:
            text = f"{NAMES.get(name, name) or 'chamber'} {y1 - y0:.4g} mm"
            for y in (y0, y1):
                axes.plot([0.0, row], [y, y], color="0.75", linewidth=0.6, zorder=0)
            _arrow(axes, (row, y0), (row, y1))
            at = max((y0 + y1) / 2, last + 0.085 * high)
            axes.text(row + 0.05 * high, at, text, va="center", **_TEXT)
            last = at
        bottom = float(mesh.nodes[:, 1].min())
        below = bottom - 0.18 * high
        _dimension(axes, (-half, below), (half, below), f"{2 * half:.4g} mm")
        _, y0, y1 = next(layer for layer in self.layers if not layer[0])
        axes.text(0.0, (y0 + y1) / 2, self.width, ha="center", va="center", **_TEXT)
        for name, tip in (("x", (0.3 * high, 0.0)), ("y", (0.0, 0.3 * high))):
            origin = np.array([-half - 0.35 * high, bottom])
            arrow = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0}
            axes.annotate("", origin + tip, origin, arrowprops=arrow)
            place = origin + 1.2 * np.array(tip)
            axes.text(*place, name, ha="center", va="center", **_TEXT | {"style": "italic"})
        axes.set_aspect("equal")
        axes.set_xlim(-half - 0.5 * high, half + 0.95 * high)
        axes.set_ylim(below - 0.2 * high, float(mesh.nodes[:, 1].max()) + 0.1 * high)
        axes.set_axis_off()

    def _legend(self, page: Any) -> None:
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        regions = [name for name, _, _ in self.layers if name]
        handles: list[Any] = [
            Patch(facecolor=COLORS.get(n, "#999999"), edgecolor="0.45", label=NAMES.get(n, n))
            for n in dict.fromkeys(regions)
        ]
        if self.winding:
            handles.append(Line2D([], [], label=self.winding, **_THREAD))
        if self.scenery.shapes:
            handles.append(Patch(facecolor=_OBSTACLE, alpha=0.55, label="rigid obstacles"))
        page.legend(
            handles=handles, loc="lower center", ncols=len(handles), frameon=False, fontsize=12
        )


def _rise(sheet: Sheet, along: float) -> float:
    """Change of a sheet's y over a length along z, in the plane x = 0."""
    return -sheet.normal[2] / sheet.normal[1] * along if sheet.normal[1] else 0.0


def _arrow(axes: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    both = {"arrowstyle": "<|-|>", "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7} | _LINE
    axes.annotate("", start, end, arrowprops=both)


def _dimension(axes: Any, start: tuple[float, float], end: tuple[float, float], text: str) -> None:
    """An arrow between two points of one height, and its text below."""
    _arrow(axes, start, end)
    middle = ((start[0] + end[0]) / 2, start[1])
    axes.annotate(text, middle, (0, -4), textcoords="offset points", ha="center", va="top", **_TEXT)

"""An actuator at rest with its dimensions: seen from the side, and its cross-section; no solution.

matplotlib is imported where it is used.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import COLORS, NAMES, color_of, figure, heading, nice_above, save
from fiberbend.drawing.renderer import Renderer
from fiberbend.drawing.space.obstacles import COLOR, Scenery
from fiberbend.drawing.space.panel import STRIP, Panel
from fiberbend.drawing.space.rest import Rest, rest_image, write_on
from fiberbend.states.obstacles import Bar, Box, Sheet
from fiberbend.states.snapshot import ModelMesh, Target
from geometry.mesh.data import Floats, MeshData, facet_positions

WIDTH = 1400
"""Of the page, pixels; its height follows from what is drawn."""
_TITLE, _LEGEND, _GAP, _EDGE = 50, 48, 16, 36
"""Heights of title and legend, room between drawings, and beside them, pixels."""
_SIDE_TALLEST, _CUT_WIDTH, _CUT_TALLEST = 560, 500, 400
_INK = "#303030"
_RIGID: dict[str, Any] = {"facecolor": COLOR, "edgecolor": "#707070", "hatch": "////"}
_SHEET = 3.0
"""Thickness in mm of the strip that stands for a plane."""
_THREAD: dict[str, Any] = {"color": COLORS["fiber"], "linewidth": 0.5, "alpha": 0.6}
_LINE: dict[str, Any] = {"color": _INK, "linewidth": 0.9}
_TEXT: dict[str, Any] = {"fontsize": 11, "color": _INK, "zorder": 8}
_MARGIN = 2.0
Limits = tuple[tuple[float, float], tuple[float, float]]
"""Least and greatest of two coordinates."""
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
        with Renderer() as renderer:
            width = WIDTH - _CUT_WIDTH - 3 * _EDGE
            rest = rest_image(
                self.space, renderer, self.scenery, self.threads, 2 * width, dimensions=False
            )
        oblique = round(width * rest.image.shape[0] / rest.image.shape[1]) + STRIP
        side, cut = self._side_limits(), self._cut_limits()
        heights = [
            _tall(side, WIDTH - 2 * _EDGE, _SIDE_TALLEST),
            max(_tall(cut, _CUT_WIDTH, _CUT_TALLEST), oblique),
        ]
        size = (WIDTH, _TITLE + sum(heights) + 2 * _GAP + _LEGEND)
        page = figure(size)
        heading(page, f"{self.title}: at rest")
        lower, upper = _LEGEND, _LEGEND + heights[1] + _GAP

        def axes(left: float, bottom: float, width: float, height: float) -> Any:
            box = (left / WIDTH, bottom / size[1], width / WIDTH, height / size[1])
            return page.add_axes(box)

        self._side(axes(_EDGE, upper, WIDTH - 2 * _EDGE, heights[0]), side)
        self._cut(axes(_EDGE, lower, _CUT_WIDTH, heights[1]), cut)
        left, bottom = _CUT_WIDTH + 2 * _EDGE, lower + (heights[1] - oblique) / 2
        self._oblique(page, size, rest, axes(left, bottom + STRIP, width, oblique - STRIP))
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

    def _oblique(self, page: Any, size: tuple[int, int], rest: Rest, axes: Any) -> None:
        """The body in space, cut open step by step, with axes and scale."""
        axes.imshow(rest.image)
        axes.set_axis_off()
        axes.autoscale(False)
        over = page.add_axes((0, 0, 1, 1))
        over.set(xlim=(0, size[0]), ylim=(0, size[1]))
        over.set_axis_off()
        seen = (rest.image.shape[1], rest.image.shape[0])
        panel = Panel(page, over, axes, rest.image, rest.view, seen, (0, 0))
        write_on(panel, rest, self.space, self.scenery)
        box = axes.get_position()
        left, bottom = box.x0 * size[0], box.y0 * size[1] - STRIP
        panel.scale(left, bottom, nice_above(70 / panel.per_mm))

    # --- from the side -------------------------------------------------------------------------

    def _side_limits(self) -> Limits:
        """Least and greatest z and y that the view from the side shows, mm."""
        bottom, top = self.layers[0][1], self.layers[-1][2]
        high = top - bottom
        ends = self._extent()
        return (
            (
                min(-self.cap - 1.9 * high, ends[0][0]),
                min(self._row - 0.4 * high, bottom - 1.1 * high, ends[0][1]),
            ),
            (
                max(self._tip + 2.6 * high, ends[1][0]),
                max(self._over + 0.35 * high, top + 0.55 * high, ends[1][1]),
            ),
        )

    @property
    def _boxes(self) -> list[Box]:
        return [shape for shape in self.scenery.shapes.values() if isinstance(shape, Box)]

    @property
    def _tip(self) -> float:
        """End of the body and of what stands under it, along z."""
        return max([self.length + self.cap, *(box.high[2] for box in self._boxes)])

    @property
    def _row(self) -> float:
        """Height of the lengths, below the body and what stands under it."""
        bottom, top = self.layers[0][1], self.layers[-1][2]
        return min([bottom, *(box.low[1] for box in self._boxes)]) - 0.3 * (top - bottom)

    @property
    def _over(self) -> float:
        """Height of the pitch, above the body and what lies on it."""
        bottom, top = self.layers[0][1], self.layers[-1][2]
        return max([top, *(box.high[1] for box in self._boxes)]) + 0.15 * (top - bottom)

    def _side(self, axes: Any, limits: Limits) -> None:
        from matplotlib.patches import Rectangle

        layers, start, end = self.layers, -self.cap, self.length + self.cap
        bottom, top = layers[0][1], layers[-1][2]
        for name, low, high in layers:
            body: dict[str, Any] = {
                "facecolor": color_of(name or "wall"),
                "edgecolor": "0.45",
            }
            axes.add_patch(Rectangle((start, low), end - start, high - low, linewidth=0.6, **body))
            if not name:
                hole: dict[str, Any] = {"facecolor": "white", "edgecolor": "0.45", "linewidth": 0.8}
                axes.add_patch(Rectangle((0.0, low), self.length, high - low, **hole))
        self._threads(axes)
        self._rigid(axes)
        high = top - bottom
        row = self._row
        _dimension(axes, (start, row), (0.0, row), f"cap {self.cap:g} mm")
        _dimension(axes, (0.0, row), (self.length, row), f"length {self.length:g} mm")
        _dimension(axes, (self.length, row), (end, row), f"cap {self.cap:g} mm")
        if self.pitch is not None and self.pitch < self.length:
            above, at = self._over, 0.1 * self.length
            _arrow(axes, (at, above), (at + self.pitch, above))
            axes.text(at + 1.5 * self.pitch, above, f"pitch {self.pitch:g} mm", **_TEXT)
        curl = {"arrowstyle": "-|>", "connectionstyle": "arc3,rad=-0.45", "color": "#c0392b"}
        tip = self._tip + 0.25 * high
        axes.annotate("", (tip, bottom - high), (tip, top), arrowprops=curl | {"linewidth": 1.6})
        axes.text(tip + 0.7 * high, bottom, "θ > 0", **_TEXT | {"color": "#c0392b"}, va="center")
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
        _show(axes, limits)
        axes.set_axis_off()

    def _extent(self) -> tuple[Floats, Floats]:
        """Least and greatest z and y of the obstacles that have an end of their own, mm."""
        points = [np.zeros((1, 3))]
        for shape in self.scenery.shapes.values():
            if not isinstance(shape, Sheet):
                points.append(np.asarray(shape.surface(np.zeros((1, 3))).points))
            else:
                points.append(self._strip(shape))
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

    def _strip(self, sheet: Sheet) -> Floats:
        """Corners of the strip that stands for a plane, (4, 3), mm; none for one seen face on."""
        along = np.array([-sheet.normal[2], sheet.normal[1]])
        size = float(np.linalg.norm(along))
        if size == 0:
            return np.zeros((0, 3))
        along, reach = along / size, self.length / 2 + self.cap
        down = np.array([-along[1], along[0]])
        if down @ sheet.normal[1:] > 0:
            down = -down
        # nearest to the middle of the body
        point = np.array(sheet.point[1:])
        middle = point + along * (along @ (np.array([0.0, self.length / 2]) - point))
        ends = [middle - reach * along, middle + reach * along]
        corners = np.array([*ends, ends[1] + _SHEET * down, ends[0] + _SHEET * down])
        return np.column_stack([np.zeros(4), corners])

    def _rigid(self, axes: Any) -> None:
        from matplotlib.patches import Circle, Polygon, Rectangle

        label: dict[str, Any] = _TEXT | {"fontsize": 12}
        for name, shape in self.scenery.shapes.items():
            if isinstance(shape, Box):
                (_, y0, z0), (_, y1, z1) = shape.low, shape.high
                axes.add_patch(Rectangle((z0, y0), z1 - z0, y1 - y0, **_RIGID))
                if y0 >= 0:
                    axes.text((z0 + z1) / 2, y1, name, **label, ha="center", va="bottom")
                else:
                    axes.text(z0, y0, f"{name}  ", **label, ha="right", va="bottom")
            elif isinstance(shape, Bar):
                y, z = shape.center
                axes.add_patch(Circle((z, y), shape.radius, **_RIGID))
                text = f"{name}, radius {shape.radius:g} mm"
                ground = {"facecolor": COLOR, "edgecolor": "none", "pad": 2.0}
                axes.text(z, y, text, **label, ha="center", va="center", bbox=ground)
            elif isinstance(shape, Sheet) and len(strip := self._strip(shape)):
                corners = strip[:, [2, 1]]
                axes.add_patch(Polygon(corners, **_RIGID))
                left = corners[np.argmin(corners[:, 0])]
                axes.text(left[0], corners[:2, 1].max(), name, **label, ha="left", va="bottom")

    # --- the cross-section ---------------------------------------------------------------------

    def _cut_limits(self) -> Limits:
        """Least and greatest x and y that the cross-section's drawing shows, mm."""
        mesh = self.section
        half, high = float(mesh.nodes[:, 0].max()), float(np.ptp(mesh.nodes[:, 1]))
        low, top = float(mesh.nodes[:, 1].min()), float(mesh.nodes[:, 1].max())
        return (-half - 0.62 * high, low - 0.36 * high), (half + 0.8 * high, top + 0.08 * high)

    def _cut(self, axes: Any, limits: Limits) -> None:
        from matplotlib.collections import PolyCollection

        mesh = self.section
        names = {number: name for name, number in mesh.regions.items()}
        corner = [0, 1, 2, 5, 8, 7, 6, 3]
        shown = mesh.nodes[mesh.cells[:, corner]]
        colors = [color_of(names[int(n)]) for n in mesh.cell_region]
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
            origin = np.array([-half - 0.5 * high, bottom])
            arrow = {"arrowstyle": "-|>", "color": "black", "shrinkA": 0}
            axes.annotate("", origin + tip, origin, arrowprops=arrow)
            place = origin + 1.2 * np.array(tip)
            axes.text(*place, name, ha="center", va="center", **_TEXT | {"style": "italic"})
        _show(axes, limits)
        axes.set_axis_off()

    def _legend(self, page: Any) -> None:
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        regions = [name for name, _, _ in self.layers if name]
        handles: list[Any] = [
            Patch(facecolor=color_of(n), edgecolor="0.45", label=NAMES.get(n, n))
            for n in dict.fromkeys(regions)
        ]
        if self.winding:
            size, _, how = self.winding.rpartition(", ")
            handles.append(Line2D([], [], label=size, **_THREAD | {"linewidth": 1.5}))
            if self.space.smeared:
                handles.append(Patch(facecolor=COLORS["winding"], edgecolor="0.45", label=how))
            else:
                handles[-1].set_label(self.winding)
        if self.scenery.shapes:
            handles.append(Patch(**_RIGID, label="rigid obstacles"))
        page.legend(
            handles=handles, loc="lower center", ncols=len(handles), frameon=False, fontsize=12
        )


def _tall(limits: Limits, width: float, most: float) -> int:
    """Height in pixels of a drawing of a width, at one scale; at most so many."""
    (left, low), (right, high) = limits
    return round(min(width * (high - low) / (right - left), most))


def _show(axes: Any, limits: Limits) -> None:
    (left, low), (right, high) = limits
    axes.set(xlim=(left, right), ylim=(low, high), aspect="equal")


def _arrow(axes: Any, start: tuple[float, float], end: tuple[float, float]) -> None:
    both = {"arrowstyle": "<|-|>", "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7} | _LINE
    axes.annotate("", start, end, arrowprops=both)


def _dimension(axes: Any, start: tuple[float, float], end: tuple[float, float], text: str) -> None:
    """An arrow between two points of one height, and its text below."""
    _arrow(axes, start, end)
    middle = ((start[0] + end[0]) / 2, start[1])
    axes.annotate(text, middle, (0, -4), textcoords="offset points", ha="center", va="top", **_TEXT)

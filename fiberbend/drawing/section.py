"""Pictures of a section in its own plane: its shape, and stress and strain over it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import IO, Any

import numpy as np

from fiberbend.drawing.crosscut import Crosscut
from fiberbend.drawing.page import (
    COLORS,
    NAMES,
    SMEARED,
    WARN,
    colormap,
    columns_of,
    figure,
    fit,
    heading,
    nice_above,
    save,
    wrap,
)
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.states.recovery import NodalFields, recover
from fiberbend.states.snapshot import (
    ModelMesh,
    Snapshot,
    Target,
    Write,
)
from fiberbend.states.stack import split_alike
from geometry.mesh.data import Floats

_WIDTH = 1400
_TALLEST = 640
_ABOVE, _TEXT_LINE, _NOTE_LINE, _BELOW = 60, 26, 19, 96
_SMALL = 11.5
_MARGIN = 0.06
_LINE = "#303030"
_WINDING: dict[str, Any] = {"color": COLORS["winding"], "linewidth": 2.4}
_FABRIC: dict[str, Any] = {"color": COLORS["fabric"], "linewidth": 5.0}
_AT_REST: dict[str, Any] = {"color": "#777777", "linewidth": 0.9, "linestyle": (0, (4, 3))}


class SectionPage:
    """Panels of one scale, each with one state of a section, and room below for a key.

    Args:
        title: text at the top.
        clouds: points that each panel has to show, (n, 2), mm.
        captions: text above each panel.
        remarks: what has to be said of each, in red below its caption.

    Attributes:
        panels: matplotlib axes in mm.
        height: height of the page in pixels.
    """

    def __init__(
        self,
        title: str,
        clouds: Sequence[Floats],
        captions: Sequence[str],
        remarks: Sequence[str] = (),
    ) -> None:
        every = np.concatenate(clouds)
        low, high = every.min(axis=0), every.max(axis=0)
        size = (high - low).max() * _MARGIN
        low, high = low - size, high + size
        columns = columns_of(len(clouds))
        rows = math.ceil(len(clouds) / columns)
        slope = (high[1] - low[1]) / (high[0] - low[0])
        across = min(_WIDTH / columns, _TALLEST / slope)
        tall = across * slope
        notes = [wrap(remark, max(across, 240), _SMALL) for remark in remarks]
        notes = notes or [""] * len(captions)
        lines = 1 + max(caption.count("\n") for caption in captions)
        noted = max(note.count("\n") + 1 if note else 0 for note in notes)
        head = 14 + _TEXT_LINE * lines + _NOTE_LINE * noted
        self.height = round(_ABOVE + rows * (tall + head) + _BELOW)
        self._figure = figure((_WIDTH, self.height))
        heading(self._figure, title)
        self.panels = []
        self._mm = across / (high[0] - low[0])
        for i, caption in enumerate(captions):
            row, column = divmod(i, columns)
            here = min(columns, len(captions) - row * columns)
            left = _WIDTH / 2 + (column - here / 2) * across
            top = self.height - _ABOVE - row * (tall + head)
            centre = {"x": (left + across / 2) / _WIDTH, "ha": "center", "va": "top"}
            words = self._figure.text(
                y=(top - 7) / self.height, s=caption, fontsize=13, linespacing=1.5, **centre
            )
            fit(words, max(0.96 * across, _WIDTH / 5))
            below = top - 7 - _TEXT_LINE * lines
            self._figure.text(
                y=below / self.height, s=notes[i], fontsize=_SMALL, color=WARN, **centre
            )
            box = (left, top - head - tall, across, tall)
            axes = self._figure.add_axes(self._share(box))
            axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
            axes.set_axis_off()
            self.panels.append(axes)

    def _share(self, box: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
        left, bottom, width, height = box
        return left / _WIDTH, bottom / self.height, width / _WIDTH, height / self.height

    def scale(self) -> None:
        """A bar of a round length at the lower left."""
        length = nice_above(80 / self._mm)
        axes = self._figure.add_axes(self._share((0, 0, _WIDTH, self.height)))
        axes.set(xlim=(0, _WIDTH), ylim=(0, self.height))
        axes.set_axis_off()
        end = 40 + length * self._mm
        axes.plot([40, end], [54, 54], color="black", linewidth=3, solid_capstyle="butt")
        axes.text((40 + end) / 2, 34, f"{length:g} mm", ha="center", va="center", fontsize=12)

    def legend(self, handles: Sequence[Any]) -> None:
        """Names of colours and lines, below the panels."""
        self._figure.legend(
            handles=handles,
            loc="lower center",
            ncols=len(handles),
            frameon=False,
            fontsize=13,
            bbox_to_anchor=(0.5, 24 / self.height),
        )

    def color_bar(self, scale: Any, label: str, extend: str) -> None:
        """A colour bar below the panels.

        Args:
            scale: matplotlib norm.
            label: what it shows.
            extend: "max" or "both": values beyond its ends exist.
        """
        from matplotlib.cm import ScalarMappable

        axes = self._figure.add_axes(self._share((0.28 * _WIDTH, 62, 0.44 * _WIDTH, 16)))
        bar = self._figure.colorbar(
            ScalarMappable(scale, colormap()), cax=axes, orientation="horizontal", extend=extend
        )
        bar.ax.tick_params(labelsize=12)
        bar.set_label(label, fontsize=13)
        if scale.vmin:
            bar.ax.xaxis.set_major_formatter(lambda value, _: f"{value:g}")

    def save(self, target: Target) -> None:
        """Write the page as PNG to a path or to a file open for writing bytes."""
        save(self._figure, target)


class Sections:
    """The pictures of a run's sections.

    Args:
        model_mesh: mesh and materials of a section or cell.
        snapshots: the states, at least one.
        fields: their recovered fields, if at hand.
        name: what the section is, for the titles.
        scenery: captions.

    Raises:
        ValueError: no state.
    """

    def __init__(
        self,
        model_mesh: ModelMesh,
        snapshots: Sequence[Snapshot],
        fields: Sequence[NodalFields] | None = None,
        name: str = "section",
        scenery: Scenery | None = None,
    ) -> None:
        if not snapshots:
            raise ValueError("no state to draw")
        self._cut, self._snapshots = Crosscut(model_mesh), snapshots
        self._smeared = model_mesh.smeared
        self._scenery = scenery or Scenery()
        self._remarks = [state.remark for state in snapshots]
        self._nodes = split_alike(model_mesh.mesh)
        self._fields = fields or [recover(model_mesh, state, self._nodes) for state in snapshots]
        self._title = f"{model_mesh.title}: {name}" if model_mesh.title else name

    def shape(self, target: Target) -> None:
        """Every state over the outlines at rest, regions coloured, with the floor's bulge.

        A flat floor is drawn with its edges where they were at rest.
        """
        from matplotlib.colors import ListedColormap, Normalize
        from matplotlib.lines import Line2D
        from matplotlib.patches import Patch

        cut = self._cut
        rest = cut.outlines(None)
        shifts = [self._shift(state) for state in self._snapshots]
        points = [cut.points(s) + up for s, up in zip(self._snapshots, shifts, strict=True)]
        clouds = [np.concatenate([moved, cut.points(None)]) for moved in points]
        captions = [self._caption(state) for state in self._snapshots]
        page = SectionPage(self._title, clouds, captions, self._remarks)
        names = sorted(cut.mesh.regions, key=cut.mesh.regions.__getitem__)
        colors = [COLORS.get(name, "#999999") for name in names]
        place = np.searchsorted([cut.mesh.regions[name] for name in names], cut.region) * 1.0
        for axes, state, moved, up in zip(
            page.panels, self._snapshots, points, shifts, strict=True
        ):
            scale = Normalize(0, max(len(names) - 1, 1))
            self._paint(axes, moved, place, scale, ListedColormap(colors))
            _draw_lines(axes, cut.outlines(state) + up, color=_LINE, linewidth=1.0)
            _draw_lines(axes, rest, **_AT_REST)
            if self._smeared:
                _draw_lines(axes, cut.winding(state) + up, **_WINDING)
            for lines in self._fabric(state):
                _draw_lines(axes, lines + up, **_FABRIC)
            self._mark_bulge(axes, state, up)
        handles: list[Any] = [
            Patch(facecolor=color, edgecolor="0.4", label=NAMES.get(name, name))
            for name, color in zip(names, colors, strict=True)
        ]
        if self._smeared:
            handles.append(Line2D([], [], label=SMEARED, **_WINDING))
        if self._scenery.strips:
            handles.append(Line2D([], [], label="fabric", **_FABRIC))
        page.legend([*handles, Line2D([], [], label="at rest", **_AT_REST)])
        page.scale()
        page.save(target)

    def stress(self, target: Target) -> None:
        """Von Mises stress over every state, on a logarithmic scale."""
        from matplotlib.colors import LogNorm

        values = self._values("von_mises")
        every = np.concatenate(values)
        low, high = np.quantile(every, [0.02, 0.998])
        high = nice_above(float(high))
        # floor and sheath differ by a factor of a thousand
        low = max(10.0 ** math.floor(math.log10(max(low, 1e-9))), high * 1e-4)
        self._map(target, values, LogNorm(low, high), "von Mises stress (MPa)", "both")

    def strain(self, target: Target) -> None:
        """Maximum principal logarithmic strain over every state."""
        from matplotlib.colors import Normalize

        values = self._values("log_strain")
        high = nice_above(float(np.quantile(np.concatenate(values), 0.998)))
        label = "maximum principal logarithmic strain"
        self._map(target, values, Normalize(0.0, high), label, "max")

    # --- what is drawn -----------------------------------------------------------------------

    def _values(self, name: str) -> list[Floats]:
        return [self._cut.values(self._nodes, getattr(field, name)) for field in self._fields]

    def _map(
        self, target: Target, values: Sequence[Floats], scale: Any, label: str, extend: str
    ) -> None:
        cut = self._cut
        points = [cut.points(state) for state in self._snapshots]
        captions = [self._scenery.caption(state) for state in self._snapshots]
        page = SectionPage(self._title, points, captions, self._remarks)
        for axes, state, moved, value in zip(
            page.panels, self._snapshots, points, values, strict=True
        ):
            clipped = np.clip(value, scale.vmin, scale.vmax)
            self._paint(axes, moved, clipped, scale, colormap())
            _draw_lines(axes, cut.outlines(state), color=_LINE, linewidth=0.8)
        page.color_bar(scale, f"{label}, {SMEARED}" if self._smeared else label, extend)
        page.scale()
        page.save(target)

    def _paint(self, axes: Any, points: Floats, values: Floats, scale: Any, colors: Any) -> None:
        """Fill the section with colours that vary linearly within its pieces."""
        from matplotlib.collections import TriMesh
        from matplotlib.tri import Triangulation

        mesh = TriMesh(Triangulation(*points.T, self._cut.triangles), norm=scale, cmap=colors)
        mesh.set_array(values)
        # the limits are set: finding them again takes longer than drawing
        axes.add_collection(mesh, autolim=False)

    def _fabric(self, state: Snapshot) -> list[Floats]:
        """Polylines of each strip of fabric."""
        actuator, strips = self._scenery.actuator, self._scenery.strips
        if actuator is None:
            return []
        return [self._cut.fabric(state, actuator, window) for window in strips]

    def _shift(self, state: Snapshot) -> Floats:
        if self._cut.bulge(state) is None:
            return np.zeros(2)
        return np.array([0.0, self._cut.chord(None)[0][1] - self._cut.chord(state)[0][1]])

    def _caption(self, state: Snapshot) -> str:
        bulge, caption = self._cut.bulge(state), self._scenery.caption(state)
        if bulge is not None:
            return f"{caption}\nfloor bulge {bulge:.2f} mm"
        change = np.round(np.subtract(self._cut.size(state), self._cut.size(None)), 2) + 0.0
        wider, higher = (f"{value:+.2f}".replace("-", "−") for value in change)
        return f"{caption}\nwidth {wider},  height {higher} mm"

    def _mark_bulge(self, axes: Any, state: Snapshot, up: Floats) -> None:
        if self._cut.bulge(state) is None:
            return
        edge, middle = (point + up for point in self._cut.chord(state))
        axes.plot([-edge[0], edge[0]], [edge[1], edge[1]], color="black", linewidth=0.9)
        style = {"arrowstyle": "<->", "color": "black", "shrinkA": 0, "shrinkB": 0, "lw": 1.0}
        axes.annotate("", (0.0, edge[1]), (0.0, middle[1]), arrowprops=style)


def _draw_lines(axes: Any, lines: Floats, **style: Any) -> None:
    from matplotlib.collections import LineCollection

    names = {"color": "colors", "linewidth": "linewidths", "linestyle": "linestyles"}
    collection = LineCollection(list(lines), **{names[key]: value for key, value in style.items()})
    axes.add_collection(collection, autolim=False)


def draw_sections(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    write: Write,
    fields: Sequence[NodalFields] | None = None,
    name: str = "section",
    scenery: Scenery | None = None,
) -> list[str]:
    """Draw section_shape.png, section_stress.png and section_strain.png.

    Args:
        model_mesh: mesh and materials of a section or cell.
        snapshots: the states.
        write: writes a file, such as `RunFolder.write`.
        fields: recovered fields of the states, if at hand.
        name: what the section is, for the titles.
        scenery: captions.

    Returns:
        The names written.

    Raises:
        ValueError: no state.
    """
    sections = Sections(model_mesh, snapshots, fields, name, scenery)
    jobs: dict[str, Callable[[IO[bytes]], object]] = {
        "section_shape.png": sections.shape,
        "section_stress.png": sections.stress,
        "section_strain.png": sections.strain,
    }
    for file, fill in jobs.items():
        write(file, fill)
    return list(jobs)

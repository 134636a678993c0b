"""What only a cell shows: the rubber that bulges between the fibers, and the fiber's tension."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.page import WARN, figure, heading, nice_above, save
from fiberbend.drawing.renderer import Renderer
from fiberbend.drawing.side_by_side import SideBySide
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.states.bend import in_frame
from fiberbend.states.snapshot import (
    ModelMesh,
    Snapshot,
    Target,
    Write,
)
from fiberbend.states.stack import Stack, repeated, root_section
from geometry.actuator import Actuator
from geometry.mesh.data import Floats
from geometry.winding.outline import pieces

_PITCHES = 5
_VIEW = (-0.62, 0.62, -0.48)
_PLOT = (1000, 640)
_BAND: dict[str, Any] = {"alpha": 0.16, "linewidth": 0.0}
_WINDOW = 2.0
"""Length in mm over which a tension is averaged, about that of an element."""


class Slices:
    """A few slices of a cell put together and bent.

    Args:
        model_mesh: of the cell, with fibers that form lines.
        snapshots: the states, at least one.
        renderer: draws.
        scenery: captions.

    Raises:
        ValueError: no state.
    """

    def __init__(
        self,
        model_mesh: ModelMesh,
        snapshots: Sequence[Snapshot],
        renderer: Renderer,
        scenery: Scenery | None = None,
    ) -> None:
        if not snapshots:
            raise ValueError("no state to draw")
        self._cell, self._snapshots = model_mesh, snapshots
        self._scenery = scenery or Scenery()
        self._section = len(root_section(model_mesh.mesh).nodes)
        self._stack: Stack = repeated(model_mesh, (2 if model_mesh.mesh.half else 1) * _PITCHES)
        moved = [self._stack.snapshot(model_mesh, state) for state in snapshots]
        self._side_by_side = SideBySide(self._stack.model_mesh, moved, 5, renderer, True, scenery)

    def bulge(self, target: Target) -> None:
        """Every state in space, coloured by how far its surface lies outside its own mean.

        The mean is taken along z; shapes are true to scale.

        Raises:
            fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
        """
        values = [self._outward(state) for state in self._snapshots]
        high = nice_above(max(float(np.quantile(np.abs(v), 0.995)) for v in values))
        captions = [
            f"{self._scenery.caption(state)}\n"
            f"bulge at the crown {float(np.ptp(self.crown(state)[1])):.2f} mm"
            for state in self._snapshots
        ]
        page = self._side_by_side.page(
            title=f"{self._cell.title}: rubber between the fibers, {_PITCHES} pitches",
            captions=captions,
            values=values,
            limits=(-high, high),
            label="surface outside its mean along the axis (mm); true to scale",
            toward=_VIEW,
            colors="coolwarm",
        )
        page.save(target)

    def crown(self, state: Snapshot) -> tuple[Floats, Floats]:
        """Height of the winding's surface at the crown over one slice.

        Returns:
            z at rest and height in the turning frame, mm, both (planes,).
        """
        mesh = self._cell.mesh
        height = in_frame(mesh.nodes, state.displacement)[:, 1]
        line = slice(mesh.points["crown"], None, self._section)
        return mesh.nodes[line, 2], height[line]

    def _outward(self, state: Snapshot) -> Floats:
        """Outward distance of the drawn points from their mean along z, mm."""
        stack = self._stack
        position = in_frame(self._cell.mesh.nodes, state.displacement)
        planes = position.reshape(-1, self._section, 3)
        # Simpson's rule: the planes are the ends and middles of quadratic layers
        weights = np.ones(len(planes))
        weights[1:-1] = 2.0
        weights[1::2] = 4.0
        mean = np.einsum("p,pni->ni", weights / weights.sum(), planes)
        off = (planes - mean).reshape(-1, 3)[stack.node] * stack.sign
        cells = stack.model_mesh.mesh.cells
        normals = self._side_by_side.skin.normals(stack.model_mesh.mesh.nodes[cells])
        outward: Floats = (self._side_by_side.skin.interpolate(off[cells]) * normals).sum(axis=1)
        return outward


def plot_tension(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    target: Target,
    actuator: Actuator,
    stiffness: float,
    scenery: Scenery | None = None,
) -> None:
    """Tension of the fiber along the outline, once around or, by symmetry, half of that.

    Lines are means over the lines of a ribbon, bands their range.

    Args:
        model_mesh: of the cell, with fibers that form lines.
        snapshots: the states, at least one.
        target: a path, or a file open for writing bytes.
        actuator: dimensions.
        stiffness: axial stiffness EA of a fiber, N.
        scenery: captions.

    Raises:
        ValueError: no state, or one without fiber forces.
    """
    from matplotlib import colormaps
    from matplotlib.patches import Patch

    if not snapshots:
        raise ValueError("no state to draw")
    scenery = scenery or Scenery()
    page = figure(_PLOT)
    rows = (len(snapshots) + 4) // 4
    remarks = dict.fromkeys(state.remark for state in snapshots if state.remark)
    top = 0.925 - 0.035 * len(remarks)
    axes = page.add_axes((0.09, 0.12, 0.81, top - 0.155 - 0.04 * rows))
    for number, remark in enumerate(remarks):
        place = {"x": 0.5, "y": 0.905 - 0.035 * number, "ha": "center", "va": "center"}
        page.text(s=remark, fontsize=11.5, color=WARN, **place)
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(snapshots)))
    is_ribbon = False
    for state, color in zip(snapshots, shades, strict=True):
        s, tension = tension_along(model_mesh, state, actuator)
        label = scenery.caption(state)
        is_ribbon = len(tension) > 1
        axes.fill_between(s, tension.min(axis=0), tension.max(axis=0), color=color, **_BAND)
        axes.plot(s, tension.mean(axis=0), color=color, linewidth=2.2, label=label)
    axes.set_xlim(0.0, float(s[-1]))
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), high + 0.06 * (high - low))
    axes.axhline(0.0, color="0.5", linewidth=0.8)
    _name_pieces(axes, actuator, model_mesh.mesh.half)
    extent = "to the middle of the floor" if model_mesh.mesh.half else "once around"
    heading(page, f"{model_mesh.title}: tension of the fiber")
    axes.set_xlabel(f"distance along the outline from the crown {extent} (mm)", fontsize=13)
    axes.set_ylabel("axial force (N)", fontsize=13)
    strain = axes.secondary_yaxis(
        "right", functions=(lambda n: 100 * n / stiffness, lambda e: e * stiffness / 100)
    )
    strain.set_ylabel("strain (%)", fontsize=13)
    for one in (axes, strain):
        one.tick_params(labelsize=11)
    axes.spines["top"].set_visible(False)
    handles, _ = axes.get_legend_handles_labels()
    if is_ribbon:
        handles.append(Patch(color="0.3", label="across its width", **_BAND))
    above = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}
    axes.legend(handles=handles, ncols=min(4, len(handles)), frameon=False, fontsize=11, **above)
    save(page, target)


def _name_pieces(axes: Any, actuator: Actuator, half: bool) -> None:
    """Lines where the outline's pieces meet, and their names where there is room."""
    outline = pieces(actuator)
    names = tuple(piece.name for piece in outline)
    lengths = [piece.length for piece in outline]
    if not half:
        # the last piece goes on into its own mirror image
        names = (*names, *names[-2::-1])
        lengths = [*lengths[:-1], 2 * lengths[-1], *lengths[-2::-1]]
    ends = np.cumsum(lengths)
    for end in ends[:-1]:
        axes.axvline(end, color="0.6", linewidth=0.9, linestyle=(0, (4, 3)), zorder=0)
    for name, end, length in zip(names, ends, lengths, strict=True):
        if length > 0.045 * ends[-1]:
            axes.text(
                end - length / 2,
                0.985,
                name,
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="top",
                color="0.35",
                fontsize=11,
            )


def tension_along(
    model_mesh: ModelMesh, state: Snapshot, actuator: Actuator
) -> tuple[Floats, Floats]:
    """Tension of a whole fiber by each line of its ribbon, as a running mean.

    The force of a segment that an element's face cuts short is no mean by itself.

    Args:
        model_mesh: of a cell, with fibers that form lines.
        state: its state.
        actuator: dimensions.

    Returns:
        Arc lengths s on the outline from the crown, (n,), mm, and tensions (lines, n), N.

    Raises:
        ValueError: no fiber forces.
    """
    fibers, force = model_mesh.lines, state.fiber_force
    if fibers is None or force is None:
        raise ValueError("no fiber forces to draw")
    lines = round(1 / float(fibers.share[0]))
    helix, line = np.divmod(fibers.curve, lines)
    perimeter = actuator.winding_perimeter
    if model_mesh.mesh.half:
        # what lies beyond a mirror plane is the image of the other helix's opposite line
        line, end = np.where(helix == 0, lines - 1 - line, line), perimeter / 2
        kept = np.ones(len(line), dtype=bool)
    else:
        kept, end = helix == 0, perimeter
    s = np.linspace(0.0, end, 301)
    low, high = np.clip(s - _WINDOW / 2, 0.0, end), np.clip(s + _WINDOW / 2, 0.0, end)
    rows = []
    for number in range(lines):
        own = np.flatnonzero(kept & (line == number))
        own = own[np.argsort(fibers.s[own], kind="stable")]
        ends = np.r_[0.0, np.cumsum(fibers.length[own])]
        ends *= end / ends[-1]
        total = np.r_[0.0, np.cumsum(np.diff(ends) * force[own] / fibers.share[own])]
        rows.append((np.interp(high, ends, total) - np.interp(low, ends, total)) / (high - low))
    return s, np.array(rows)


def draw_cell(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    write: Write,
    actuator: Actuator,
    stiffness: float | None,
    renderer: Renderer,
    scenery: Scenery | None = None,
) -> list[str]:
    """Draw fiber_stretch.png, where one thread goes around, and cell_bulge.png.

    Args:
        model_mesh: of the cell, with fibers that form lines.
        snapshots: the states.
        write: writes a file, such as `RunFolder.write`.
        actuator: dimensions.
        stiffness: axial stiffness EA of a fiber, N; None draws no fiber_stretch.png.
        renderer: draws.
        scenery: captions.

    Returns:
        The names written.

    Raises:
        ValueError: no state, or one without fiber forces.
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    names = []
    if stiffness is not None:
        thread = stiffness
        write(
            "fiber_stretch.png",
            lambda file: plot_tension(model_mesh, snapshots, file, actuator, thread, scenery),
        )
        names.append("fiber_stretch.png")
    write("cell_bulge.png", Slices(model_mesh, snapshots, renderer, scenery).bulge)
    return [*names, "cell_bulge.png"]

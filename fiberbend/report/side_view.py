"""The actuator in the plane of bending at several steps, with the path of its tip: an SVG picture.

matplotlib is imported where it is used: a run without a report does without it.
"""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.drawing.page import colormap, figure, literal
from fiberbend.drawing.tessellation import on_mirror
from fiberbend.report.captions import in_short
from fiberbend.report.places import Places
from fiberbend.report.scene import thinned
from fiberbend.results.space import Space
from fiberbend.results.states import Kept, States
from geometry.mesh.data import (
    FACET_VERTICES,
    Floats,
    Ints,
    MeshData,
    reference_nodes,
    vertex_positions,
)

_WIDTH = 900
"""Of the picture, pixels."""
_UNSEEN = 0.02
"""By how much of a millimetre an outline may be off."""
_DRAWN = 5
"""States of the actuator that are drawn."""
_LEFT, _RIGHT = 75, 12
"""Margins in pixels; that above is the right one."""
_FLATTEST, _TALLEST = 0.22, 1.2
"""Height over width of the frame."""
_TIP = "#c0392b"
_ROOM = 0.06
_ENTRY, _LINE = 165, 24
"""Width and height in pixels of an entry of the legend."""
_GAP = 46
"""Pixels between the frame and the legend: ticks and their label."""


def side_view(
    case: Case, rows: Sequence[Mapping[str, Any]], states: States | None, space: Space | None
) -> bytes | None:
    """The path of the tip, with the actuator where its states were kept.

    Args:
        case: the case.
        rows: of the history.
        states: what the run has kept, or None.
        space: body in space, or None without states.

    Returns:
        An SVG file; None where no step has a place of the tip.
    """
    keys = (col.TIP_Z, col.TIP_Y)
    path = np.array(
        [[row[key] for key in keys] for row in rows if all(row.get(k) is not None for k in keys)]
    ).reshape(-1, 2)
    if not len(path):
        return None
    shapes = convert.obstacle_shapes(case)
    drawn: list[tuple[Kept, list[Floats]]] = []
    polygons: dict[str, list[Floats]] = {}
    if states is not None and space is not None:
        drawn, around = _outlines(states, space, everything=bool(shapes))
        polygons = {name: _faces(shape.surface(around)) for name, shape in shapes.items()}
    colors = [colormap()(0.85 * i / max(1, len(drawn) - 1)) for i in range(len(drawn))]
    names = [*(in_short(kept) for kept, _ in drawn), "path of the tip"]
    columns = (_WIDTH - _LEFT) // _ENTRY
    lines = -(-len(names) // columns)
    columns = -(-len(names) // lines)
    page, axes, (low, high) = _frame([path, *(loop for _, loops in drawn for loop in loops)], lines)
    for name, faces in polygons.items():
        _draw_obstacle(axes, name, faces, (low, high))
    for (_, loops), color in zip(drawn, colors, strict=True):
        _draw_outline(axes, loops, color)
    axes.plot(*path.T, ".-", color=_TIP, linewidth=1.2, markersize=5, zorder=4)
    stacked = space is not None and space.stack is not None
    aside = any(row.get(col.TIP_X) for row in rows)
    cap = case.actuator.cap if stacked and not aside else 0.0
    _draw_tips(axes, rows, [kept.step for kept, _ in drawn], colors, cap)
    _legend(page, names, [*colors, _TIP], columns)
    content = io.BytesIO()
    page.savefig(content, format="svg", metadata={"Date": None}, transparent=False)
    return content.getvalue()


def plane_edges(mesh: MeshData) -> Ints:
    """Edges of what a body shows when it is cut at x = 0, where facets of elements lie there.

    Returns:
        First, middle and last node of every edge, the body to one side of all of them, (k, 3);
        none where no facet lies in the plane.
    """
    vertices = vertex_positions(mesh.cell_type)
    local = np.array(FACET_VERTICES[mesh.cell_type])
    every = np.stack(np.meshgrid(np.arange(len(mesh.cells)), np.arange(len(local)), indexing="ij"))
    pairs = every.reshape(2, -1).T
    pairs = pairs[on_mirror(mesh, pairs)]
    # of a whole body each facet once, that of the side x > 0
    side = mesh.nodes[mesh.cells[pairs[:, 0]], 0].mean(axis=1) > 0
    pairs = pairs[side]
    found = []
    places = reference_nodes(mesh.cell_type)
    for facet, corners in enumerate(local):
        some = pairs[pairs[:, 1] == facet, 0]
        ring = corners[[0, 1, 3, 2]] if len(corners) == 4 else corners
        for a, b in zip(ring, np.roll(ring, -1), strict=True):
            a, b = vertices[a], vertices[b]
            middle = np.flatnonzero((np.abs(places - (places[a] + places[b]) / 2) < 1e-9).all(1))[0]
            found.append(mesh.cells[some][:, [a, middle, b]])
    edges = np.concatenate(found)
    key = np.sort(edges[:, [0, 2]], axis=1)
    _, place, count = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    return np.asarray(edges[count[place.ravel()] == 1])


def loops_of(edges: Ints) -> list[Ints]:
    """Edges put together to closed lines.

    Args:
        edges: first, middle and last node of each, (k, 3), in any order and direction.

    Returns:
        Node numbers along each line.
    """
    at: dict[int, list[int]] = {}
    for number, (first, _, last) in enumerate(edges.tolist()):
        at.setdefault(first, []).append(number)
        at.setdefault(last, []).append(number)
    left = set(range(len(edges)))
    loops = []
    while left:
        number = min(left)
        node = int(edges[number, 0])
        loop: list[int] = []
        while True:
            left.discard(number)
            first, middle, last = edges[number].tolist()
            loop += [node, middle]
            node = last if node == first else first
            following = [other for other in at[node] if other in left]
            if not following:
                break
            number = following[0]
        loops.append(np.array(loop))
    return loops


def _frame(clouds: Sequence[Floats], lines: int) -> tuple[Any, Any, tuple[Floats, Floats]]:
    """Figure, axes of one scale, and their least and greatest z and y.

    Args:
        clouds: points (z, y) that are seen; obstacles without an end are cut off.
        lines: of the legend.
    """
    cloud = np.concatenate(clouds)
    low, high = cloud.min(axis=0), cloud.max(axis=0)
    room = _ROOM * float((high - low).max()) + 1.0
    low, high = low - room, high + room
    # neither a strip nor a tower
    size = np.maximum(high - low, [(high - low)[1] / _TALLEST, _FLATTEST * (high - low)[0]])
    low, high = (low + high - size) / 2, (low + high + size) / 2
    inner = _WIDTH - _LEFT - _RIGHT
    tall = inner * size[1] / size[0]
    below = _GAP + _LINE * lines
    height = below + tall + _RIGHT
    page = figure((_WIDTH, round(height)))
    axes = page.add_axes((_LEFT / _WIDTH, below / height, inner / _WIDTH, tall / height))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="z (mm)", ylabel="y (mm)")
    axes.grid(color="0.92")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    return page, axes, (low, high)


def _outlines(
    states: States, space: Space, everything: bool
) -> tuple[list[tuple[Kept, list[Floats]]], Floats]:
    """Closed lines (z, y) of some states, and points of the body in them, (n, 3), mm.

    Args:
        states: what the run has kept.
        space: body in space.
        everything: the points are those of the whole body, not of the lines alone.
    """
    places = Places(space)
    loops = loops_of(plane_edges(places.mesh))
    ends = np.cumsum([len(loop) for loop in loops])[:-1]
    node = np.concatenate(loops) if loops else np.zeros(0, dtype=np.int64)
    drawn, around = [], []
    for each in thinned(states.kept, _DRAWN):
        shot = states.read(each)
        if shot is None:
            continue
        lines = places.at(shot, node)
        drawn.append((each, np.split(lines[:, [2, 1]], ends) if loops else []))
        around.append(places.at(shot) if everything else lines)
    points = np.concatenate(around)
    if places.mesh.half:
        points = np.concatenate([points, points * [-1.0, 1.0, 1.0]])
    return drawn, points


def _faces(surface: Any) -> list[Floats]:
    """Faces (z, y) of a pyvista.PolyData."""
    faces = [surface.get_cell(i).points for i in range(surface.n_cells)]
    return [np.asarray(points)[:, [2, 1]] for points in faces]


def _draw_outline(axes: Any, loops: Sequence[Floats], color: Any) -> None:
    """The body cut at x = 0: filled between its outline and the chamber's."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    loops = [_simpler(loop) for loop in loops]
    ordered = sorted(loops, key=lambda loop: -float(np.ptp(loop, axis=0).max()))
    parts = []
    for number, loop in enumerate(ordered):
        # a hole is a line in the other direction
        turned = _area(loop) > 0
        points = loop if turned == (number == 0) else loop[::-1]
        codes = [Path.MOVETO, *[Path.LINETO] * (len(points) - 2), Path.CLOSEPOLY]
        parts.append(Path(points, codes))
    if parts:
        whole = Path.make_compound_path(*parts)
        light = (*color[:3], 0.28)
        axes.add_patch(PathPatch(whole, facecolor=light, edgecolor=color, linewidth=0.9, zorder=2))


def _draw_obstacle(
    axes: Any, name: str, faces: Sequence[Floats], frame: tuple[Floats, Floats]
) -> None:
    from matplotlib.collections import PolyCollection

    look: dict[str, Any] = {
        "facecolor": "#c9ccd1",
        "edgecolor": "#7b8088",
        "linewidth": 0.8,
        "zorder": 1,
    }
    axes.add_collection(PolyCollection(faces, **look), autolim=False)
    points = np.clip(np.concatenate(faces), *frame)
    low, high = points.min(axis=0), points.max(axis=0)
    text: dict[str, Any] = {"ha": "center", "color": "#3c4046", "zorder": 1.5, "fontsize": 10.5}
    place, size = (low + high) / 2, frame[1] - frame[0]
    if ((high - low) > [0.12 * size[0], 0.06 * size[1]]).all():
        axes.text(*place, literal(name), va="center", **text)
        return
    # too small to be written in: beside it, away from the middle of the picture
    up = place[1] > (frame[0][1] + frame[1][1]) / 2
    at = (place[0], high[1] if up else low[1])
    side = {"va": "bottom" if up else "top", "textcoords": "offset points"}
    axes.annotate(literal(name), at, (0, 3 if up else -3), **side, **text)


def _draw_tips(
    axes: Any,
    rows: Sequence[Mapping[str, Any]],
    steps: Sequence[int],
    colors: Sequence[Any],
    cap: float,
) -> None:
    """Mark the tips of the states that are drawn, in their colours.

    Args:
        axes: in mm.
        rows: of the history.
        steps: numbers of the states.
        colors: of the states.
        cap: length in mm of a cap that the outlines do not have; 0 where they have it.
    """
    by_step = {int(row[col.STEP]): row for row in rows}
    for step, color in zip(steps, colors, strict=True):
        row = by_step.get(step, {})
        if row.get(col.TIP_Z) is None or row.get(col.TIP_Y) is None:
            continue
        tip = np.array([row[col.TIP_Z], row[col.TIP_Y]])
        if cap:
            angle = np.radians(row[col.ANGLE])
            start = tip - cap * np.array([np.cos(angle), -np.sin(angle)])
            axes.plot(*np.stack([start, tip]).T, "--", color=color, linewidth=1.2, zorder=3)
        look = {"markerfacecolor": color, "markeredgecolor": _TIP, "zorder": 5}
        axes.plot(*tip, "o", markersize=6, **look)


def _legend(page: Any, names: Sequence[str], colors: Sequence[Any], columns: int) -> None:
    """What each colour is, below the frame, where it covers nothing; the path's comes last."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [
        Patch(facecolor=(*color[:3], 0.28), edgecolor=color, label=name)
        for name, color in zip(names[:-1], colors[:-1], strict=True)
    ]
    handles.append(Line2D([], [], marker=".", color=colors[-1], label=names[-1]))
    page.legend(
        handles=handles,
        loc="lower center",
        ncols=min(columns, len(handles)),
        frameon=False,
        fontsize=10.5,
        borderaxespad=0.1,
    )


def _simpler(loop: Floats) -> Floats:
    """A closed line without points that nobody would see to be left out."""
    kept = [0]
    for number in range(2, len(loop)):
        between = loop[kept[-1] + 1 : number] - loop[kept[-1]]
        chord = loop[number] - loop[kept[-1]]
        length = max(float(np.hypot(*chord)), 1e-12)
        off = np.abs(between @ [-chord[1], chord[0]]) / length
        if off.max() > _UNSEEN:
            kept.append(number - 1)
    return np.asarray(loop[[*kept, len(loop) - 1]])


def _area(loop: Floats) -> float:
    """Twice the area within a closed line, above zero counterclockwise."""
    x, y = loop.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1))

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
from fiberbend.report.scene import Places, thinned
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
_LEFT, _RIGHT, _BELOW = 75, 12, 60
"""Margins in pixels; that above is the right one."""
_FLATTEST, _TALLEST = 0.3, 1.2
"""Height over width of the frame."""
_TIP = "#c0392b"
_ROOM = 0.06
_TEXT = (0.18, 0.035)
"""Width and height of a text, as parts of the frame's."""


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
    page, axes, (low, high) = _frame([path, *(loop for _, loops in drawn for loop in loops)])
    for name, faces in polygons.items():
        _draw_obstacle(axes, name, faces, (low, high))
    for number, (_, loops) in enumerate(drawn):
        share = number / max(1, len(drawn) - 1)
        _draw_outline(axes, loops, colormap()(0.85 * share))
    axes.plot(*path.T, ".-", color=_TIP, linewidth=1.2, markersize=5, zorder=4)
    steps = [kept.step for kept, _ in drawn] or [int(rows[-1][col.STEP])]
    _name_tips(axes, rows, steps, low, high)
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


def _frame(clouds: Sequence[Floats]) -> tuple[Any, Any, tuple[Floats, Floats]]:
    """Figure, axes of one scale, and their least and greatest z and y.

    Args:
        clouds: points (z, y) that are seen; obstacles without an end are cut off.
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
    height = _BELOW + tall + _RIGHT
    page = figure((_WIDTH, round(height)))
    axes = page.add_axes((_LEFT / _WIDTH, _BELOW / height, inner / _WIDTH, tall / height))
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
    points = np.concatenate(faces)
    seen = points[((points >= frame[0]) & (points <= frame[1])).all(axis=1)]
    place = (seen if len(seen) else np.clip(points, *frame)).mean(axis=0)
    axes.text(*place, literal(name), ha="center", va="center", color="#3c4046", zorder=1.5)


def _name_tips(
    axes: Any, rows: Sequence[Mapping[str, Any]], steps: Sequence[int], low: Floats, high: Floats
) -> None:
    """Pressure and angle at the tips of the states that are drawn, none over another."""
    from matplotlib.patheffects import withStroke

    by_step = {int(row[col.STEP]): row for row in rows}
    size = high - low
    taken: list[Floats] = []
    for step in reversed(steps):
        row = by_step.get(step)
        if row is None or row.get(col.TIP_Z) is None or row.get(col.TIP_Y) is None:
            continue
        place = np.array([row[col.TIP_Z], row[col.TIP_Y]])
        if any((np.abs(place - other) < size * _TEXT).all() for other in taken):
            continue
        taken.append(place)
        axes.plot(*place, "o", color=_TIP, markersize=6, zorder=5)
        # a zero has no sign
        pressure, angle = round(row[col.PRESSURE], 1) + 0.0, round(row[col.ANGLE]) + 0.0
        text = f"{pressure:.1f} kPa, {angle:.0f}°".replace("-", "−")
        # at the right edge to the left of its point
        inside = place[0] + _TEXT[0] * size[0] < high[0]
        shift, side = ((7, 4), "left") if inside else ((-7, 6), "right")
        look = {"ha": side, "zorder": 6, "fontsize": 10, "color": "#222222"}
        label = axes.annotate(text, place, shift, textcoords="offset points", **look)
        label.set_path_effects([withStroke(linewidth=3, foreground="white")])


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

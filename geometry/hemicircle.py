"""Block layout of the hemicircular section."""

from __future__ import annotations

import math

from geometry.blocks import Layout, Point
from geometry.dimensions import Actuator
from geometry.size import MeshSize, Strips, check_size, elements_through

_CORE = 2 / 3
_CORE_CORNER = 0.72


def hemicircle(actuator: Actuator, size: MeshSize, strips: Strips | None = None) -> Layout:
    """Lay out the section, with the blocks that fill the chamber in the caps.

    The point "pin" is (0, 0), on the floor's lower face. Regions are "wall", "floor", "layer",
    "sheath"; named sides "chamber", "winding", "outer",
    "symmetry" (half only), and with `strips` "roof" and "post". Curved regions have one block per
    quad through the thickness, so that every mesh line along an arc is an exact arc in gmsh too.

    Raises:
        ValueError: dimensions that this mesh cannot hold.
    """
    check_size(actuator, size, strips)
    half = _half(actuator, size, strips)
    return half if size.half else half.mirrored()


def _half(actuator: Actuator, size: MeshSize, strips: Strips | None) -> Layout:
    layout = Layout(half=True)
    angles, pieces = _arc(actuator, size, strips)
    core = _core_columns(actuator, size, pieces)
    _add_arcs(layout, actuator, size, "wall", angles, pieces, strips)
    _add_base(layout, actuator, size, core, strips, sheath=False)
    if actuator.sheath is not None:
        _add_arcs(layout, actuator, size, "sheath", angles, pieces, strips)
        _add_base(layout, actuator, size, core, strips, sheath=True)
    _add_fill(layout, actuator, size, core, angles, pieces)
    layout.name_point("pin", (0.0, 0.0))
    return layout


def _arc(
    actuator: Actuator, size: MeshSize, strips: Strips | None
) -> tuple[list[float], list[int]]:
    """Angles between the pieces of the quarter arc, from the floor up, and their divisions."""
    n = size.section
    if strips is None:
        return [0.0, math.pi / 4, math.pi / 2], [2 * n, 2 * n]
    edge = math.acos(strips.roof_half_width / actuator.outer_radius)
    roof = min(max(1, round(4 * n * (1 - edge / (math.pi / 2)))), 2 * n - 1)
    middle = 2 * n - roof
    return [0.0, edge * 2 * n / (2 * n + middle), edge, math.pi / 2], [2 * n, middle, roof]


def _polar(actuator: Actuator, radius: float, angle: float) -> Point:
    if angle == math.pi / 2:
        return (0.0, actuator.floor + radius)
    return (radius * math.cos(angle), actuator.floor + radius * math.sin(angle))


def _core_columns(actuator: Actuator, size: MeshSize, pieces: list[int]) -> list[tuple[float, int]]:
    """Right ends and divisions of the columns under the chamber's core, from x = 0."""
    columns, done = [], 0
    for number in reversed(pieces[1:]):
        done += number
        columns.append((_CORE * actuator.radius * done / (2 * size.section), number))
    return columns


def _levels(start: float, end: float, number: int) -> list[float]:
    return [start + (end - start) * i / number for i in range(number)] + [end]


def _add_arcs(
    layout: Layout,
    actuator: Actuator,
    size: MeshSize,
    region: str,
    angles: list[float],
    pieces: list[int],
    strips: Strips | None,
) -> None:
    inner = actuator.radius if region == "wall" else actuator.outline_radius
    end = actuator.outline_radius if region == "wall" else actuator.outer_radius
    radii = _levels(inner, end, elements_through(region, size))
    center = (0.0, actuator.floor)
    for i in range(len(radii) - 1):
        for j, number in enumerate(pieces):
            last = j == len(pieces) - 1
            inside = ("chamber",) if region == "wall" and i == 0 else ()
            outside: tuple[str, ...] = ()
            if i == len(radii) - 2:
                outside += ("winding",) if region == "wall" else ()
                if end == actuator.outer_radius:
                    outside += ("outer", "roof") if strips and last else ("outer",)
            low, high = angles[j], angles[j + 1]
            layout.add(
                region,
                (
                    _polar(actuator, radii[i], low),
                    _polar(actuator, radii[i + 1], low),
                    _polar(actuator, radii[i], high),
                    _polar(actuator, radii[i + 1], high),
                ),
                (1, number),
                {1: center, 2: center},
                {1: inside, 2: outside, 3: ("symmetry",) if last else ()},
            )


def _add_base(
    layout: Layout,
    actuator: Actuator,
    size: MeshSize,
    core: list[tuple[float, int]],
    strips: Strips | None,
    sheath: bool,
) -> None:
    """Add everything below y = b: floor and layer, or the sheath beside and under them."""
    a, r = actuator.radius, actuator.outline_radius
    walls = _levels(a, r, elements_through("wall", size))[1:]
    columns = core + [(a, size.section)] + [(x, 1) for x in walls]
    inner = len(columns)
    rows = [("floor", actuator.floor, 0.0, size.section)]
    if actuator.layer is not None:
        rows.append(("layer", 0.0, actuator.outline_bottom, 1))
    kept = len(rows)
    if actuator.sheath is not None:
        sides = _levels(r, actuator.outer_radius, elements_through("sheath", size))[1:]
        columns += [(x, 1) for x in sides]
        rows.append(("sheath", actuator.outline_bottom, actuator.outer_bottom, size.section))
    below = ("outer", "post") if strips else ("outer",)
    for row, (region, top, bottom, high) in enumerate(rows):
        left = 0.0
        for column, (right, wide) in enumerate(columns):
            in_sheath = row >= kept or column >= inner
            if in_sheath == sheath:
                names: dict[int, tuple[str, ...]] = dict.fromkeys(range(4), ())
                if column == 0:
                    names[1] = ("symmetry",)
                if row == 0 and column <= len(core):
                    names[3] = ("chamber",)
                if not in_sheath and column == inner - 1:
                    names[2] += ("winding",)
                if not in_sheath and row == kept - 1:
                    names[0] += ("winding",)
                if column == len(columns) - 1:
                    names[2] += ("outer",)
                if row == len(rows) - 1:
                    names[0] += below
                layout.add(
                    "sheath" if in_sheath else region,
                    ((left, bottom), (right, bottom), (left, top), (right, top)),
                    (wide, high),
                    {},
                    names,
                )
            left = right


def _add_fill(
    layout: Layout,
    actuator: Actuator,
    size: MeshSize,
    core: list[tuple[float, int]],
    angles: list[float],
    pieces: list[int],
) -> None:
    """Add the O-grid of the chamber's half disk: a core, one block right of it, the rest above."""
    a, b, n = actuator.radius, actuator.floor, size.section
    center = (0.0, b)
    corner = _polar(actuator, _CORE_CORNER * a, angles[1])
    width, crown = _CORE * a, b + _CORE * a
    floor: Point = (0.0, b)
    lid: Point = (0.0, crown)
    for column, (x, number) in enumerate(core):
        part = x / width
        next_floor = (x, b)
        next_lid = (part * corner[0], (1 - part) * crown + part * corner[1])
        symmetry: dict[int, tuple[str, ...]] = {1: ("symmetry",)} if column == 0 else {}
        high, low = angles[len(angles) - 1 - column], angles[len(angles) - 2 - column]
        layout.add(
            "wall", (floor, next_floor, lid, next_lid), (number, pieces[0]), {}, symmetry, True
        )
        layout.add(
            "wall",
            (lid, next_lid, _polar(actuator, a, high), _polar(actuator, a, low)),
            (number, n),
            {3: center},
            symmetry,
            True,
        )
        floor, lid = next_floor, next_lid
    layout.add(
        "wall",
        ((width, b), (a, b), corner, _polar(actuator, a, angles[1])),
        (n, pieces[0]),
        {2: center},
        {},
        True,
    )

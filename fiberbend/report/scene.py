"""The body in space at every load step, as numbers that the page of a run draws."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.drawing.page import color_of, name_of
from fiberbend.drawing.renderer import FROM_THE_SIDE
from fiberbend.drawing.surfaces import BodySurfaces
from fiberbend.drawing.tessellation import Tessellation, boundary_facets, on_mirror
from fiberbend.report.fields import Fields
from fiberbend.report.laid import Threads, strips
from fiberbend.report.packing import base64_of, packed
from fiberbend.report.places import Places
from fiberbend.results.scenery import scenery
from fiberbend.results.space import Space
from fiberbend.results.states import Kept, States
from fiberbend.states.recovery import SplitNodes, split_nodes
from fiberbend.states.snapshot import ModelMesh
from fiberbend.states.stack import split_alike
from geometry.mesh.data import Floats, Ints, MeshData

MOST_NUMBERS = 12_000_000
"""Bytes of all steps before they are compressed; beyond, surfaces get coarser, then steps fewer."""
_FINE, _COARSE = 2, 1
"""Pieces along an element's edge: its three nodes, or its two ends."""
_BYTES = 8
"""Of a point in a step: three coordinates of two, and two quantities of one."""
_BESIDE = 0.15
"""So far from the body obstacles are within the view, as a part of the body's extent."""
_EDGE_ON = 0.2
"""A surface is hardly seen from the side whose normal has less than this along the view."""


@dataclasses.dataclass(frozen=True)
class Skin:
    """A surface that the page draws: points that are nodes of the mesh, and triangles.

    Attributes:
        part: the part that it belongs to: "body" or "sheath".
        cut: it lies in the mirror plane, and is seen where the body is cut open.
        node: node in space of every point, (n,).
        value: place of every point among the recovered fields, (n,).
        region: region of every point, (n,).
        triangles: counterclockwise seen from outside, (k, 3).
        seen: places among the recovered fields that are seen from the side, not empty.
    """

    part: str
    cut: bool
    node: Ints
    value: Ints
    region: Ints
    triangles: Ints
    seen: Ints


@dataclasses.dataclass(frozen=True)
class SceneData:
    """What the page draws, and what else is to be said of it.

    Attributes:
        content: for the script of the page; arrays are compressed and in base64.
        notes: sentences for the reader.
        steps: load steps that can be seen.
    """

    content: dict[str, Any]
    notes: tuple[str, ...]
    steps: int


def scene_data(
    case: Case,
    states: States,
    space: Space | None = None,
    forces: Mapping[int, str] | None = None,
) -> SceneData:
    """The 3-D view of a run.

    Args:
        case: the case.
        states: what the run has kept.
        space: of the same model mesh, if at hand.
        forces: by the number of a step, what its line says of forces.

    Raises:
        ValueError: no state but that at rest.
    """
    if len(states) < 2:
        raise ValueError("no load step was kept: nothing to see in space")
    space, forces = space or Space(case, states.model_mesh), forces or {}
    notes = []
    skins = _skins(space, _FINE)
    if _size(skins) * len(states) > MOST_NUMBERS:
        skins = _skins(space, _COARSE)
        notes.append("The surface is drawn with straight edges between the corners of elements.")
    most = max(2, MOST_NUMBERS // _size(skins))
    kept = states.kept
    if len(kept) > most:
        kept = thinned(kept, most)
        notes.append(
            f"{len(kept)} of {len(states)} load steps are shown: this file would be too large."
        )
    shown = [(each, shot) for each in kept if (shot := states.read(each)) is not None]
    if len(shown) < len(kept):
        notes.append("Steps whose files are damaged are left out.")
    places = Places(space)
    surfaces = BodySurfaces(space.model_mesh, scenery(case))
    threads = Threads(surfaces, places)
    fields = Fields(space.own, _own_nodes(space.own), [(skin.value, skin.seen) for skin in skins])
    skin_nodes = np.concatenate([skin.node for skin in skins])
    positions = np.stack([places.at(shot, skin_nodes) for _, shot in shown])
    lines = np.stack([threads.at(shot) for _, shot in shown])
    cloth, fabric = strips(surfaces, [places.at(shot) for _, shot in shown])
    values = [fields.at(shot) for _, shot in shown]
    tops = fields.tops(values)
    if space.stack is not None:
        slices = space.in_slices
        notes.append(f"The length between the end caps{slices}; this model has no caps.")
    if space.model_mesh.smeared:
        notes.append("The winding is spread over its surface: there are no single fibers to draw.")
    drawn = (positions, lines, fabric)
    everything = np.concatenate([each.reshape(-1, 3) for each in drawn])
    corner, scale = everything.min(axis=0), float(np.ptp(everything, axis=0).max()) / 65535
    ends = np.cumsum([len(skin.node) for skin in skins])[:-1]
    around = _mirrored(everything) if places.mesh.half else everything

    def placed(points: Floats) -> str:
        return packed(np.rint((points - corner) / scale).astype("<u2"))

    content = {
        "half": places.mesh.half,
        "corner": corner.tolist(),
        "scale": scale,
        "steps": [
            {
                "step": each.step,
                "pressure": round(each.pressure_kpa, 4),
                "angle": round(each.angle_deg, 4),
                "asked": each.asked,
                "forces": forces.get(each.step, ""),
            }
            for each, _ in shown
        ],
        "skins": [
            {
                "part": skin.part,
                "cut": skin.cut,
                "points": len(skin.node),
                "triangles": packed(skin.triangles.astype("<u4")),
                "positions": placed(position),
                "region": packed(skin.region.astype("u1")),
                "values": [packed(value) for value in fields.scaled(values, number, tops[number])],
                "tops": tops[number],
            }
            for number, (skin, position) in enumerate(
                zip(skins, np.split(positions, ends, axis=1), strict=True)
            )
        ],
        "regions": [
            {"number": number, "name": name_of(name), "color": color_of(name)}
            for name, number in space.model_mesh.mesh.regions.items()
        ],
        "quantities": [
            {"name": name, "label": label, "powers": powers}
            for name, label, powers in fields.quantities
        ],
        "colors": _colors(),
        "fibers": threads.content | {"positions": placed(lines)},
        "fabric": cloth | {"positions": placed(fabric)},
        "obstacles": _obstacles(case, around),
        "bounds": [around.min(axis=0).tolist(), around.max(axis=0).tolist()],
        "around": _BESIDE * float(np.ptp(around, axis=0).max()),
    }
    return SceneData(content, tuple(notes), len(shown))


def thinned(kept: Sequence[Kept], most: int) -> tuple[Kept, ...]:
    """So many states at most: first, last, those that were asked for, others evenly.

    Args:
        kept: at least one.
        most: at least two.
    """
    ends = {0, len(kept) - 1}
    asked = [number for number, each in enumerate(kept) if each.asked and number not in ends]
    chosen = ends | {asked[i] for i in _evenly(len(asked), most - len(ends))}
    others = [number for number in range(len(kept)) if number not in chosen]
    chosen |= {others[i] for i in _evenly(len(others), most - len(chosen))}
    return tuple(kept[number] for number in sorted(chosen))


def _evenly(count: int, most: int) -> list[int]:
    """So many places at most of a list, evenly over it."""
    if count <= most:
        return list(range(count))
    return [int((i + 0.5) * count / most) for i in range(most)]


def _size(skins: Sequence[Skin]) -> int:
    """Bytes of a step."""
    return _BYTES * sum(len(skin.node) for skin in skins)


def _skins(space: Space, level: int) -> list[Skin]:
    """The surfaces of the body's parts: without the sheath, of the sheath, and both cut open."""
    mesh = space.model_mesh.mesh
    bare = mesh.cell_region != mesh.regions.get("sheath", -1)
    copies = _own_copies(space)
    around = boundary_facets(mesh, np.ones(len(mesh.cells), dtype=bool))
    skins = []
    for part, cells in (("body", bare), ("sheath", ~bare)):
        if not cells.any():
            continue
        # a sheath's inner face is that of the wall, and would be drawn twice in one place
        pairs = boundary_facets(mesh, cells) if part == "body" else around[cells[around[:, 0]]]
        cut = on_mirror(mesh, pairs) if mesh.half else np.zeros(len(pairs), dtype=bool)
        for some in (False, True):
            if (cut == some).any():
                skins.append(_skin(mesh, pairs[cut == some], copies, level, part, some))
    return skins


def _own_copies(space: Space) -> Ints:
    """The copy of a node of the model's own mesh behind every node of a cell in space, (m, k)."""
    copies: Ints = _own_nodes(space.own).cells
    if space.stack is None:
        return copies
    return copies[space.stack.cell[:, None], space.stack.order]


def _own_nodes(own: ModelMesh) -> SplitNodes:
    return split_alike(own.mesh) if own.uniform else split_nodes(own.mesh)


def _skin(mesh: MeshData, pairs: Ints, copies: Ints, level: int, part: str, cut: bool) -> Skin:
    drawn = Tessellation(mesh, pairs, level)

    def at_points(numbers: Ints) -> Ints:
        # the points are nodes: interpolation gives back the numbers of nodes
        found: Ints = np.rint(drawn.interpolate(numbers.astype(float))).astype(np.int64)
        return found

    node, copy = at_points(mesh.cells), at_points(copies)
    first, place = np.unique(
        node * (int(copy.max()) + 1) + copy, return_index=True, return_inverse=True
    )[1:]
    region = at_points(np.broadcast_to(mesh.cell_region[:, None], mesh.cells.shape))
    pieces = place[drawn.pieces]
    if pieces.shape[1] == 4:
        pieces = np.concatenate([pieces[:, [0, 1, 2]], pieces[:, [0, 2, 3]]])
    return Skin(
        part, cut, node[first], copy[first], region[first], pieces, _seen(mesh, drawn, node, copy)
    )


def _seen(mesh: MeshData, drawn: Tessellation, node: Ints, copy: Ints) -> Ints:
    """Copies of the nodes at points that a viewer sees from the side: none of the chamber's."""
    faces = drawn.normals(mesh.nodes[mesh.cells]) @ np.array(FROM_THE_SIDE)
    inner = np.isin(node, mesh.facet_nodes("chamber"))
    for seen in ((np.abs(faces) > _EDGE_ON) & ~inner, ~inner):
        if seen.any():
            return np.unique(copy[seen])
    return np.unique(copy)


def _mirrored(points: Floats) -> Floats:
    return np.concatenate([points, points * [-1.0, 1.0, 1.0]])


def _obstacles(case: Case, around: Floats) -> list[dict[str, Any]]:
    found = []
    for name, shape in convert.obstacle_shapes(case).items():
        surface = shape.surface(around).triangulate()
        found.append(
            {
                "name": name,
                "points": packed(np.asarray(surface.points, dtype="<f4")),
                "triangles": packed(np.asarray(surface.regular_faces, dtype="<u4")),
            }
        )
    return found


@functools.cache
def _colors() -> str:
    """The colour map of all pictures, 256 times red, green and blue."""
    from fiberbend.drawing.page import colormap

    return base64_of(np.rint(255 * colormap()(np.arange(256))[:, :3]).astype(np.uint8).tobytes())

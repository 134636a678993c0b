"""Fields and pictures of a section or a cell: in its own plane, and put together in space."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.running.folder import RunFolder
from fiberbend.states.recovery import NodalFields, recover
from fiberbend.states.snapshot import Scenery, Snapshot, Write
from fiberbend.states.stack import (
    Stack,
    extruded,
    repeated,
    split_alike,
)

_LAYER = 4.0
"""Length in mm of the elements of an extruded section."""


def draw_states(
    folder: RunFolder,
    case: Case,
    scenery: Scenery,
    snapshots: Sequence[Snapshot],
    say: Callable[[str], None],
) -> None:
    """Write fields/*.vtu and pictures/*.png of a section or cell, as the case wants them.

    Fields are those of the whole length of a section, and of one pitch of a cell.

    Args:
        folder: where to write.
        case: the case.
        scenery: of the section or cell.
        snapshots: the states, at least one.
        say: takes a line for the user where nothing can be drawn.
    """

    def into(sub: str) -> Write:
        return lambda name, fill: folder.write(f"{sub}/{name}", fill)

    nodes = split_alike(scenery.mesh)
    fields = [recover(scenery, state, nodes) for state in snapshots]
    whole = functools.cache(lambda: _whole(case, scenery, snapshots))
    if case.output.fields:
        from fiberbend.states.paraview import write_fields

        stack = whole() if _is_section(scenery) else repeated(scenery, _slices_a_pitch(scenery))
        moved, spread = _in_space(stack, scenery, snapshots, fields)
        write_fields(stack.scenery, moved, into("fields"), spread)
    if case.output.pictures:
        _draw(case, scenery, snapshots, fields, whole, into("pictures"), say)


def _draw(
    case: Case,
    scenery: Scenery,
    snapshots: Sequence[Snapshot],
    fields: Sequence[NodalFields],
    whole: Callable[[], Stack],
    write: Write,
    say: Callable[[str], None],
) -> None:
    from fiberbend.drawing.section import draw_sections
    from fiberbend.drawing.stage import PictureError

    name = "section" if _is_section(scenery) else "section where a fiber passes the crown"
    draw_sections(scenery, snapshots, write, fields, name)
    try:
        draw_bent(whole(), scenery, snapshots, write, fields)
        turns = case.turns
        if turns is not None and scenery.lines is not None:
            from fiberbend.drawing.cell import draw_cell

            actuator = convert.dimensions(case.actuator)
            draw_cell(scenery, snapshots, write, actuator, turns.stiffness)
    except PictureError as error:
        say(f"no pictures in space: {error}")


def draw_bent(
    stack: Stack,
    scenery: Scenery,
    snapshots: Sequence[Snapshot],
    write: Write,
    fields: Sequence[NodalFields],
) -> None:
    """Draw bent.png: the length between the caps in space in every state.

    Args:
        stack: the sections or slices of the whole length.
        scenery: of the section or cell.
        snapshots: the states, at least one.
        write: writes a file, such as `RunFolder.write`.
        fields: recovered fields of the states.

    Raises:
        fiberbend.drawing.stage.PictureError: nothing can be drawn on this machine.
    """
    from fiberbend.drawing.gallery import Gallery
    from fiberbend.drawing.page import nice_above
    from fiberbend.drawing.stage import FROM_THE_SIDE

    nodes = split_alike(scenery.mesh)
    gallery = Gallery(stack.scenery, [stack.snapshot(scenery, s) for s in snapshots], level=3)
    strains = [stack.at_cells(field.log_strain[nodes.cells]) for field in fields]
    high = max(float(np.quantile(gallery.outside.interpolate(s), 0.998)) for s in strains)
    model = "section" if _is_section(scenery) else "cell"
    page = gallery.page(
        title=f"{scenery.title}: {model} model, caps not modelled",
        captions=[_caption(state, stack) for state in snapshots],
        values=[gallery.skin.interpolate(strain) for strain in strains],
        limits=(0.0, nice_above(high)),
        label="maximum principal logarithmic strain",
        toward=FROM_THE_SIDE,
    )
    write("bent.png", page.save)


def _caption(state: Snapshot, stack: Stack) -> str:
    if state.twist == 0:
        return state.caption
    twist = np.rad2deg(state.twist * stack.scenery.mesh.nodes[-1, 2])
    return f"{state.caption},  twist {twist:.0f}°".replace("-", "−")


def _is_section(scenery: Scenery) -> bool:
    return scenery.mesh.cell_type == "quadrilateral"


def _whole(case: Case, scenery: Scenery, snapshots: Sequence[Snapshot]) -> Stack:
    """The whole length; a cell's as near as whole slices come."""
    length = case.actuator.length
    if not _is_section(scenery):
        return repeated(scenery, max(1, round(length / scenery.mesh.nodes[-1, 2])))
    warps = snapshots[0].displacement.shape[1] == 3
    return extruded(scenery, length, math.ceil(length / _LAYER), turned=warps)


def _slices_a_pitch(scenery: Scenery) -> int:
    return 2 if scenery.mesh.half else 1


def _in_space(
    stack: Stack,
    scenery: Scenery,
    snapshots: Sequence[Snapshot],
    fields: Sequence[NodalFields],
) -> tuple[list[Snapshot], list[NodalFields]]:
    """States and fields of a stack."""
    nodes = split_alike(scenery.mesh)
    return (
        [stack.snapshot(scenery, state) for state in snapshots],
        [stack.fields(nodes, *pair) for pair in zip(fields, snapshots, strict=True)],
    )

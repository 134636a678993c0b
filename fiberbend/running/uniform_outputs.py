"""Pictures of a section or a cell: in its own plane, and put together in space."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.results.folder import RunFolder
from fiberbend.results.space import Space, is_section
from fiberbend.states.bend import Bend
from fiberbend.states.recovery import NodalFields
from fiberbend.states.snapshot import ModelMesh, Snapshot, Write
from fiberbend.states.stack import (
    Stack,
    split_alike,
)


def draw_states(
    folder: RunFolder,
    case: Case,
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    say: Callable[[str], None],
) -> None:
    """Write pictures/*.png of a section or cell.

    Args:
        folder: where to write.
        case: the case.
        model_mesh: of the section or cell.
        snapshots: the states, at least one.
        say: takes a line for the user where nothing can be drawn.
    """

    def into(sub: str) -> Write:
        return lambda name, fill: folder.write(f"{sub}/{name}", fill)

    space = Space(case, model_mesh)
    fields = [space.recovered(state) for state in snapshots]
    _draw(case, model_mesh, snapshots, fields, space, into("pictures"), say)


def _draw(
    case: Case,
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    fields: Sequence[NodalFields],
    space: Space,
    write: Write,
    say: Callable[[str], None],
) -> None:
    from fiberbend.drawing.section import draw_sections
    from fiberbend.running.outputs import pictures

    name = "section" if is_section(model_mesh) else "section where a fiber passes the crown"
    with pictures(say):
        draw_sections(model_mesh, snapshots, write, fields, name)
    with pictures(say, "no pictures in space"):
        assert space.stack is not None
        draw_bent(space.stack, model_mesh, snapshots, write, fields)
        turns = case.turns
        if turns is not None and model_mesh.lines is not None:
            from fiberbend.drawing.cell import draw_cell

            actuator = convert.dimensions(case.actuator)
            draw_cell(model_mesh, snapshots, write, actuator, turns.stiffness)


def draw_bent(
    stack: Stack,
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    write: Write,
    fields: Sequence[NodalFields],
) -> None:
    """Draw bent.png: the length between the caps in space in every state.

    Args:
        stack: the sections or slices of the whole length.
        model_mesh: of the section or cell.
        snapshots: the states, at least one.
        write: writes a file, such as `RunFolder.write`.
        fields: recovered fields of the states.

    Raises:
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    from fiberbend.drawing.page import nice_above
    from fiberbend.drawing.renderer import FROM_THE_SIDE
    from fiberbend.drawing.side_by_side import SideBySide

    nodes = split_alike(model_mesh.mesh)
    side_by_side = SideBySide(
        stack.model_mesh, [stack.snapshot(model_mesh, s) for s in snapshots], level=3
    )
    strains = [stack.at_cells(field.log_strain[nodes.cells]) for field in fields]
    high = max(float(np.quantile(side_by_side.outside.interpolate(s), 0.998)) for s in strains)
    model = "section" if is_section(model_mesh) else "cell"
    page = side_by_side.page(
        title=f"{model_mesh.title}: {model} model, caps not modelled",
        captions=[_caption(state, model_mesh, stack) for state in snapshots],
        values=[side_by_side.skin.interpolate(strain) for strain in strains],
        limits=(0.0, nice_above(high)),
        label="maximum principal logarithmic strain",
        toward=FROM_THE_SIDE,
    )
    write("bent.png", page.save)


def _caption(state: Snapshot, model_mesh: ModelMesh, stack: Stack) -> str:
    if state.twist == 0:
        return state.caption
    rate = Bend.of(state, model_mesh.mesh).line.rates[2]
    twist = np.rad2deg(rate * stack.model_mesh.mesh.nodes[-1, 2])
    return f"{state.caption},  twist {twist:.0f}°".replace("-", "−")


def _slices_a_pitch(model_mesh: ModelMesh) -> int:
    return 2 if model_mesh.mesh.half else 1

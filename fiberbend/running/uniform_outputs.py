"""Pictures of a section or a cell: in its own plane, and put together in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.results.space import Space, is_section
from fiberbend.states.recovery import NodalFields
from fiberbend.states.snapshot import ModelMesh, Snapshot, Write

if TYPE_CHECKING:
    from fiberbend.drawing.renderer import Renderer
    from fiberbend.drawing.space.obstacles import Scenery


def draw_in_plane(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    fields: Sequence[NodalFields],
    write: Write,
    beside: Scenery,
) -> None:
    """Draw section_*.png: shape, stress and strain of the section.

    Args:
        model_mesh: of the section or cell.
        snapshots: the states, at least one.
        fields: recovered fields of the states.
        write: writes a picture.
        beside: captions.
    """
    from fiberbend.drawing.section import draw_sections

    name = "section" if is_section(model_mesh) else "section where a fiber passes the crown"
    draw_sections(model_mesh, snapshots, write, fields, name, beside)


def draw_in_space(
    case: Case,
    space: Space,
    snapshots: Sequence[Snapshot],
    fields: Sequence[NodalFields],
    write: Write,
    renderer: Renderer,
    beside: Scenery,
) -> None:
    """Draw bent.png, the length between the caps in every state, and what only a cell shows.

    Args:
        case: the case.
        space: the section or cell in space.
        snapshots: the states, at least one.
        fields: recovered fields of the states.
        write: writes a picture.
        renderer: draws.
        beside: captions.

    Raises:
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    draw_bent(space, snapshots, fields, write, renderer, beside)
    turns = case.turns
    if turns is not None and space.own.lines is not None:
        from fiberbend.drawing.cell import draw_cell

        actuator = convert.dimensions(case.actuator)
        # of families no single thread goes once around
        stiffness = None if turns.pitch is None else turns.stiffness
        draw_cell(space.own, snapshots, write, actuator, stiffness, renderer, beside)


def draw_bent(
    space: Space,
    snapshots: Sequence[Snapshot],
    fields: Sequence[NodalFields],
    write: Write,
    renderer: Renderer,
    beside: Scenery,
) -> None:
    """Draw bent.png: the length between the caps in space in every state.

    Args:
        space: the section or cell in space.
        snapshots: the states, at least one.
        fields: recovered fields of the states.
        write: writes a picture.
        renderer: draws.
        beside: captions.

    Raises:
        fiberbend.drawing.renderer.PictureError: nothing can be drawn on this machine.
    """
    from fiberbend.drawing.page import nice_above
    from fiberbend.drawing.renderer import FROM_THE_SIDE
    from fiberbend.drawing.side_by_side import SideBySide

    moved = [space.snapshot(state) for state in snapshots]
    side_by_side = SideBySide(space.model_mesh, moved, 3, renderer, scenery=beside)
    strains = [space.at_cells(s, own) for s, own in zip(snapshots, fields, strict=True)]
    high = max(float(np.quantile(side_by_side.outside.interpolate(s), 0.998)) for s in strains)
    model = "section" if is_section(space.own) else "cell"
    page = side_by_side.page(
        title=f"{space.own.title}: {model} model, caps not modelled",
        captions=[beside.caption(state) for state in snapshots],
        values=[side_by_side.skin.interpolate(strain) for strain in strains],
        limits=(0.0, nice_above(high)),
        label=f"maximum principal logarithmic strain{space.in_slices}",
        toward=FROM_THE_SIDE,
    )
    write("bent.png", page.save)

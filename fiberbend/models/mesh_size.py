"""What the mesh settings of a case come to in each model: one case file is for several."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fiberbend.case import convert
from fiberbend.case.case import Actuator, Case
from fiberbend.effects.table import BlockedTipEffect, ContactEffect, WindingEffect
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from geometry.sections.size import MeshSize

_FLAT = 1e-9


def mesh_size(case: Case, model: str, half: bool) -> MeshSize:
    """Fineness of a model's mesh.

    Args:
        case: the case.
        model: "section", "cell" or "body"; the elements of a section have no length along the
            axis, those of a cell are never longer than its slice.
        half: mesh x ≥ 0 only.
    """
    size = convert.mesh_size(case.mesh, half)
    if model == "body":
        return size
    extent, layers = cell_slice(case, half)
    return dataclasses.replace(size, axial=_FLAT if model == "section" else extent / layers)


def cell_slice(case: Case, half: bool) -> tuple[float, int]:
    """Length in mm of the slice that repeats, and its number of layers.

    Half a pitch between mirror planes, a whole one without; without a winding any length does.
    """
    from geometry.sections.size import divisions

    winding = case.find(WindingEffect)
    pitch = winding.pitch if winding is not None else 2 * case.mesh.axial
    extent = pitch / 2 if half else pitch
    return extent, divisions(extent, case.mesh.axial)


def misfits(case: Case) -> Iterator[Problem]:
    """Why the mesh of a case's model cannot hold its dimensions; a closed form has no mesh.

    Args:
        case: a checked and completed case.
    """
    model, _ = choose_model(case)
    if model == "analytic":
        return
    tip = convert.tip_support(case)
    path = f"effects.{case.effects.index(tip)}.{tip.name}" if tip is not None else ""
    yield from misfitting(case.actuator, mesh_size(case, model, half=True), path, tip)


def misfitting(
    actuator: Actuator, size: MeshSize, path: str, tip: BlockedTipEffect | ContactEffect | None
) -> Iterator[Problem]:
    """Why a mesh cannot hold the dimensions of an actuator.

    Args:
        actuator: its dimensions.
        size: fineness of the mesh.
        path: of the tip's support in the case.
        tip: what may have a roof and a post, if there is such an effect.
    """
    from geometry.sections.size import check_size, too_thin

    if size.axial > actuator.length:
        yield Problem(
            "mesh.axial",
            f'"{show(size.axial, "length")}", expected elements not longer than the chamber, '
            f'"{show(actuator.length, "length")}"',
        )
    dimensions = convert.dimensions(actuator)
    thin = list(too_thin(dimensions, size))
    for part, text in thin:
        yield Problem(f"actuator.{part}", text)
    if tip is not None and not thin:
        try:
            check_size(dimensions, size, convert.strips(tip))
        except ValueError as error:
            yield Problem(path, str(error))

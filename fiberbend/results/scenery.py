"""What pictures of a run show beside the body: obstacles, their forces, and what a caption says."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Mapping, Sequence
from typing import Any

from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.zones import bounds, effects_of
from fiberbend.drawing.space.obstacles import Scenery
from fiberbend.states.labels import short_number
from geometry.winding.strip import Window

_TURNS = {"side": col.SIDE_ANGLE, "twist": col.TWIST}
"""Turns beside the bending angle, by what captions call them."""


def scenery(case: Case, rows: Sequence[Mapping[str, Any]] = ()) -> Scenery:
    """Obstacles of a case with their forces in every load step.

    Args:
        case: the case.
        rows: of its history; none for a case that has not been run.
    """
    actuator = convert.dimensions(case.actuator)
    forces, tips, at_tip, turned = {}, {}, {}, {}
    for row in rows:
        step = int(row[col.STEP])
        forces[step] = {
            name: force
            for effect in case.effects
            for name, force in effect.obstacle_forces(row).items()
        }
        at_tip[step] = {k: v for effect in case.effects for k, v in effect.at_tip(row).items()}
        turns = {name: float(row.get(key) or 0.0) for name, key in _TURNS.items()}
        turned[step] = {name: value for name, value in turns.items() if short_number(value) != "0"}
        if case.straight and row.get(col.TIP_FORCE) is not None:
            tips[step] = float(row[col.TIP_FORCE])
    lengths = {
        "chamber": actuator.length,
        "whole": actuator.total_length,
        "height": actuator.outer_top - actuator.outer_bottom,
        "width": 2 * actuator.outer_half_width,
    }
    for region in convert.site(case).materials:
        thickness = getattr(actuator, region, None)
        if thickness is not None:
            lengths[region] = thickness
    shapes = convert.obstacle_shapes(case)
    times = {int(row[col.STEP]): t for row in rows if (t := row.get(col.TIME)) is not None}
    strips = _strips(case)
    return Scenery(shapes, forces, tips, lengths, actuator, strips, at_tip, turned, times)


def _strips(case: Case) -> tuple[Window, ...]:
    """Fabric on the whole length, or of zones from one border to the next."""
    actuator = convert.dimensions(case.actuator)
    if case.zones is None:
        return tuple(window for effect in case.effects for window in effect.windows(actuator))
    return tuple(
        dataclasses.replace(window, ends=ends)
        for number, ends in enumerate(itertools.pairwise(bounds(case)))
        for effect in effects_of(case, number).values()
        for window in effect.windows(actuator)
    )

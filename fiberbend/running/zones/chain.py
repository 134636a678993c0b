"""States of zones at one pressure, chained: the end section of each is the root of the next.

What is left out is how a section that one zone deforms fits onto the next: near a border both bend
as neither does far from it.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from analytic.path import chained
from fem.march.selfcontact import Pose, Rod, clearance
from fiberbend import columns as col
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.running.zones.march import Kept
from geometry.mesh.data import Floats

Frame = tuple[Floats, Floats]
"""Rotation (3, 3) of a section, and place (3,) of its centroid from the root's at rest, mm."""

_MEANS = (col.AXIS_STRETCH, col.FLOOR_STRETCH, col.CROWN_STRETCH, col.VOLUME_ERROR)
_SUMS = (col.ANGLE, col.VOLUME, col.ITERATIONS, col.STORED)
_LEAST = (col.DET_F, col.FIBER_MIN)
_GREATEST = (col.VOLUME_ERROR_ELEMENT, col.FIBER_MAX)
WITHIN = 2e-8
"""Radians within which an angle is hit, as a march does."""
_TRIES = 40
_IF_ANY = (col.SIDE_ANGLE, col.TWIST, col.MODES)
"""Sums in which a zone without the column has none of it."""


@dataclasses.dataclass(frozen=True)
class Link:
    """One state of the whole: every zone at the same pressure.

    Attributes:
        pressure: MPa.
        parts: of the zones from root to tip.
        frames: of the root of every zone, and of the end of the last one.
    """

    pressure: float
    parts: tuple[Kept, ...]
    frames: tuple[Frame, ...]

    @classmethod
    def of(cls, pressure: float, parts: Sequence[Kept], lengths: Sequence[float]) -> Link:
        """Chain states of zones, whose lengths are in mm."""
        ends = []
        for kept, length in zip(parts, lengths, strict=True):
            rotation, place = kept.bend.line.sections(np.array([length]))
            ends.append((rotation[0], place[0]))
        return cls(pressure, tuple(parts), tuple(chained(ends)))

    @property
    def angle(self) -> float:
        """The whole bending angle, rad.

        The turns of the tangent from station to station add up; where sections are not across the
        line, what it turns to a border it turns back behind it.
        """
        return float(sum(np.deg2rad(kept.row[col.ANGLE]) for kept in self.parts))


def row_of(case: Case, link: Link, lengths: Sequence[float]) -> dict[str, Any]:
    """The row of history.csv of a state, but for its number and the work of the loads.

    Args:
        case: of the whole.
        link: the state.
        lengths: of the zones, mm.
    """
    rows = [kept.row for kept in link.parts]
    weights = np.asarray(lengths) / sum(lengths)
    actuator, last = convert.dimensions(case.actuator), link.parts[-1].bend
    rotation, place = link.frames[-1]
    x, y, z = place + rotation @ [0.0, actuator.face_height - last.height, actuator.cap]
    row: dict[str, Any] = {
        col.STEP: 0,
        col.PRESSURE: 1e3 * link.pressure,
        col.ANGLE: 0.0,
        col.TIP_Y: last.height + float(y),
        col.TIP_Z: float(z),
        col.VOLUME: 0.0,
        col.TIP_X: float(x),
    }
    known = dict.fromkeys(key for each in rows for key in each)
    for key in known:
        values = [each[key] for each in rows if key in each]
        if key in _MEANS and len(values) == len(rows):
            row[key] = float(weights @ values)
        elif key in _SUMS or key in _IF_ANY or key.startswith("energy_"):
            row[key] = type(values[0])(sum(values))
        elif key in (*_LEAST, *_GREATEST):
            row[key] = min(values) if key in _LEAST else max(values)
    row[col.WORK] = 0.0
    for number, each in enumerate(rows):
        row[col.zone(number, "angle_deg")] = each[col.ANGLE]
        if col.TWIST in row:
            row[col.zone(number, "twist_deg")] = each.get(col.TWIST, 0.0)
        row[col.zone(number, "stretch")] = each[col.AXIS_STRETCH]
    return row


def find_angle(
    goal: float, below: Link, above: Link, solve: Callable[[float], Link | None]
) -> Link | None:
    """The state between two at which the whole angle is a given one, by false position.

    The end that stays counts half each time (Dowell and Jarratt 1971, doi 10.1007/BF01934364).

    Args:
        goal: rad.
        below: a state with an angle on one side of it.
        above: one with an angle on the other.
        solve: the state at a pressure, MPa; None where a zone has none.

    Returns:
        The state; None where a zone has none on the way, or where it is not met.
    """
    (p, f), (q, g) = ((link.pressure, link.angle - goal) for link in (below, above))
    for _ in range(_TRIES):
        link = solve(q - g * (q - p) / (g - f))
        if link is None:
            return None
        miss = link.angle - goal
        if abs(miss) <= WITHIN:
            return link
        if miss * g < 0:
            p, f = q, g
        else:
            f /= 2
        q, g = link.pressure, miss
    return None


def passes_itself(link: Link, rods: Sequence[Rod], lengths: Sequence[float]) -> bool:
    """Whether the whole, with its caps, passes through itself.

    Args:
        link: the state.
        rods: of the zones, each with caps at both ends.
        lengths: of the zones, mm.
    """
    poses, start, last = [], 0.0, len(rods) - 1
    for number, (kept, rod) in enumerate(zip(link.parts, rods, strict=True)):
        pose, length = rod.pose(kept.state, kept.state, 1.0), lengths[number]
        rotation, place = link.frames[number]
        here = np.full(len(pose.z), True)
        if number > 0:
            # a border is a section of the zone before it
            here &= pose.z > 0
        if number < last:
            here &= pose.z <= length
        poses.append(
            Pose(
                pose.z[here] + start,
                place + pose.centre[here] @ rotation.T,
                rotation @ pose.rotation[here],
                pose.reach[here],
            )
        )
        start += length
    parts = {
        field.name: np.concatenate([getattr(pose, field.name) for pose in poses])
        for field in dataclasses.fields(Pose)
    }
    return clearance(Pose(**parts), 0.0) < 0

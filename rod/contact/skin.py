"""Points of a rod's surface that may touch something, with the areas that they stand for."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from rod.functions import Floats, Ints
from rod.layout import Layout

_RINGS = 3
"""Rings of points on an end face, the edge among them, and one in its middle."""
_SAME = 1e-9
"""Part of a piece that round-off may put a station beyond its end."""


@dataclasses.dataclass(frozen=True)
class Outline:
    """Points on the outline of a section, or on a strip of it.

    Attributes:
        places: x, y of each in the section's own axes, from the rod's line, (k, 2), mm.
        widths: of the outline for which each stands, (k,), mm.
    """

    places: Floats
    widths: Floats

    def __post_init__(self) -> None:
        shape = np.shape(self.places)
        if len(shape) != 2 or shape[1] != 2 or np.shape(self.widths) != shape[:1] or not shape[0]:
            raise ValueError("outline: x and y of points and a width of each expected")


def ring(corners: Sequence[Sequence[float]], spacing: float) -> Outline:
    """A closed outline: corners, and points between them.

    Args:
        corners: x, y in turn around the section, mm; of an arc, points close to each other.
        spacing: greatest distance of neighbours, mm.
    """
    ends = np.asarray(corners, dtype=float)
    return _line(np.concatenate([ends, ends[:1]]), spacing, closed=True)


def strip(corners: Sequence[Sequence[float]], spacing: float) -> Outline:
    """A line of an outline, from its first to its last corner; see `ring`."""
    return _line(np.asarray(corners, dtype=float), spacing, closed=False)


def _line(ends: Floats, spacing: float, closed: bool) -> Outline:
    if ends.ndim != 2 or ends.shape[1] != 2 or len(ends) < 2 or not spacing > 0:
        raise ValueError("outline: corners and a positive spacing expected")
    places = []
    for first, last in zip(ends[:-1], ends[1:], strict=True):
        count = max(1, math.ceil(float(np.linalg.norm(last - first)) / spacing - _SAME))
        places.append(first + np.arange(count)[:, None] / count * (last - first))
    points = np.concatenate([*places, ends[-1:]])
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    widths = np.zeros(len(points))
    widths[:-1] += steps / 2
    widths[1:] += steps / 2
    if closed:
        widths[0] += widths[-1]
        points, widths = points[:-1], widths[:-1]
    return Outline(points, widths)


@dataclasses.dataclass(frozen=True)
class Skin:
    """Points at stations along a rod.

    Attributes:
        pieces: piece of each station, (s,).
        parts: of that piece before the station, over 0 to 1, (s,).
        lengths: of the rod at rest for which each station stands, (s,), mm.
        station: of each point, (p,), in their order.
        places: x, y of each point in the section's own axes, (p, 2), mm.
        areas: of the surface at rest for which each stands, (p,), mm².
    """

    pieces: Ints
    parts: Floats
    lengths: Floats
    station: Ints
    places: Floats
    areas: Floats

    @property
    def reach(self) -> float:
        """Greatest distance of a point from the rod's line, mm."""
        return float(np.linalg.norm(self.places, axis=1).max())

    def joined(self, *others: Skin) -> Skin:
        """With others of the same rod."""
        skins = (self, *others)
        before = np.cumsum([0, *(len(skin.pieces) for skin in skins[:-1])])
        return Skin(
            np.concatenate([skin.pieces for skin in skins]),
            np.concatenate([skin.parts for skin in skins]),
            np.concatenate([skin.lengths for skin in skins]),
            np.concatenate([skin.station + b for skin, b in zip(skins, before, strict=True)]),
            np.concatenate([skin.places for skin in skins]),
            np.concatenate([skin.areas for skin in skins]),
        )


def side(
    layout: Layout, outline: Outline, spacing: float, span: tuple[float, float] | None = None
) -> Skin:
    """The sides of a rod, or of a part of it.

    Args:
        layout: of the rod.
        outline: of its sections there.
        spacing: greatest distance of stations, mm; sections at both ends are among them, but the
            clamped root, which nothing moves.
        span: from where to where along the axis at rest, mm from the root; None: the whole rod.

    Raises:
        ValueError: a span that is not on the rod, or a spacing that is not positive.
    """
    total = float(np.sum(layout.lengths))
    first, last = (0.0, total) if span is None else span
    slack = _SAME * total
    if not (-slack <= first < last <= total + slack and spacing > 0):
        raise ValueError(f"span {span} mm of a rod of {total:g} mm, spacing {spacing:g} mm")
    count = max(1, math.ceil((last - first) / spacing - _SAME))
    at = np.linspace(first, last, count + 1)
    lengths = np.full(count + 1, (last - first) / count)
    lengths[[0, -1]] /= 2
    moves = at > slack
    pieces, parts = _located(layout, at[moves])
    return _skin(pieces, parts, lengths[moves], outline.places, outline.widths)


def face(layout: Layout, outline: Outline) -> Skin:
    """The outer face of the last section: rings like its outline, and one point in the middle."""
    middle = outline.places.mean(axis=0)
    after = np.roll(outline.places, -1, axis=0)
    x, y = outline.places.T
    across = abs(float(np.sum(x * after[:, 1] - y * after[:, 0]))) / 2
    share = outline.widths / outline.widths.sum()
    places, areas = [middle[None]], [np.array([across / (2 * _RINGS) ** 2])]
    for number in range(1, _RINGS + 1):
        size = number / _RINGS
        inner, outer = size - 0.5 / _RINGS, min(size + 0.5 / _RINGS, 1.0)
        places.append(middle + size * (outline.places - middle))
        areas.append(across * (outer**2 - inner**2) * share)
    count = len(layout.lengths)
    station = np.zeros(1 + _RINGS * len(share), dtype=np.intp)
    return Skin(
        np.array([count - 1]),
        np.ones(1),
        np.zeros(1),
        station,
        np.concatenate(places),
        np.concatenate(areas),
    )


def _located(layout: Layout, at: Floats) -> tuple[Ints, Floats]:
    """Piece and part of places along the axis, in mm from the root."""
    ends = np.cumsum(layout.lengths)
    slack = _SAME * layout.lengths.min()
    pieces = np.minimum(np.searchsorted(ends, at - slack), len(ends) - 1)
    parts = 1 - (ends[pieces] - at) / layout.lengths[pieces]
    # a station at an end of a piece is a frame: no piece is split for it
    return pieces, np.where(np.abs(parts - 1) < _SAME, 1.0, parts)


def _skin(pieces: Ints, parts: Floats, lengths: Floats, places: Floats, widths: Floats) -> Skin:
    """The same points at all stations."""
    count, each = len(pieces), len(widths)
    return Skin(
        pieces,
        parts,
        lengths,
        np.repeat(np.arange(count), each),
        np.tile(places, (count, 1)),
        np.outer(lengths, widths).ravel(),
    )

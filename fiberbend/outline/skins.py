"""The outer surface of an actuator as points of a rod, by the names of a body's surfaces."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from geometry.actuator import Actuator
from geometry.sections.size import Strips
from rod.contact.skin import Outline, Skin, face, ring, side, strip
from rod.functions import Floats
from rod.layout import Layout

ALONG, AROUND = 1.0, 2.0
"""Greatest distances of points along the axis and around a section, mm: the first is what turns the
force of a round bar, by half of it over the radius."""
_FINE = 0.05
"""Of an outline from which strips are cut, mm."""
_LEVEL = 1e-9


class Sited(Protocol):
    """An actuator and the pieces that it has as a rod."""

    @property
    def actuator(self) -> Actuator:
        """Its dimensions."""

    @property
    def layout(self) -> Layout:
        """Its pieces."""


def skin(site: Sited, surfaces: tuple[str, ...], strips: Strips | None) -> Skin:
    """Points of named surfaces.

    A rod that stays in the plane of its root meets only what is prismatic across that plane: there
    the points of a section that have the same height are one.

    Args:
        site: the actuator as a rod.
        surfaces: 'outer', 'tip', 'roof', 'post', as a body calls them; 'crown' and 'sole' are roof
            and post as lines with the strips' widths, whose points keep one height.
        strips: of roof and post.

    Raises:
        KeyError: a surface without points.
    """
    makers = {"outer": _outer, "tip": _tip, "roof": _roof, "post": _post}
    makers |= {"crown": _crown, "sole": _sole}
    first, *others = (makers[name](site, strips) for name in surfaces)
    return first.joined(*others)


def _centred(site: Sited, places: Floats) -> Floats:
    """Places of a section from the rod's line."""
    return places - [0.0, float(site.layout.place[1])]


def _seen(site: Sited, outline: Outline) -> Outline:
    """By a rod that stays in its plane: points of one height are one."""
    outline = Outline(_centred(site, outline.places), outline.widths)
    if not site.layout.plane:
        return outline
    size = float(np.abs(outline.places).max())
    heights, row = np.unique(np.round(outline.places[:, 1] / (_LEVEL * size)), return_inverse=True)
    widths: Floats = np.bincount(row, outline.widths).astype(float)
    places = np.zeros((len(heights), 2))
    places[row, 1] = outline.places[:, 1]
    return Outline(places, widths)


def _corners(actuator: Actuator, spacing: float) -> Floats:
    return np.array(actuator.outer_outline(spacing))


def _outer(site: Sited, strips: Strips | None) -> Skin:
    """The sides, caps and all."""
    outline = _seen(site, ring(_corners(site.actuator, AROUND), AROUND))
    return side(site.layout, outline, ALONG)


def _tip(site: Sited, strips: Strips | None) -> Skin:
    """The tip cap's outer face."""
    whole = ring(_corners(site.actuator, AROUND), AROUND)
    return face(site.layout, Outline(_centred(site, whole.places), whole.widths))


def _roof(site: Sited, strips: Strips | None) -> Skin:
    """The strip along the crown, over the chamber."""
    assert strips is not None, "a roof is a strip"
    actuator = site.actuator
    outline = _seen(site, _strip(actuator, strips.roof_half_width, top=True))
    return side(site.layout, outline, ALONG, (actuator.cap, actuator.cap + actuator.length))


def _crown(site: Sited, strips: Strips | None) -> Skin:
    """The highest line, as wide as the roof."""
    assert strips is not None, "a roof is a strip"
    actuator = site.actuator
    outline = _line(site, actuator.outer_top, strips.roof_half_width)
    return side(site.layout, outline, ALONG, (actuator.cap, actuator.cap + actuator.length))


def _line(site: Sited, height: float, half: float) -> Outline:
    places = np.array([[0.0, height]])
    return Outline(_centred(site, places), np.array([2 * half]))


def _post(site: Sited, strips: Strips | None) -> Skin:
    """The strip at the end of the tip cap's underside; of a round body as wide as the roof."""
    assert strips is not None, "a post is a strip"
    outline = _seen(site, _strip(site.actuator, _sole_half(site.actuator, strips), top=False))
    return _at_end(site, outline, strips)


def _sole(site: Sited, strips: Strips | None) -> Skin:
    """The lowest line of the post's strip, as wide as that."""
    assert strips is not None, "a post is a strip"
    actuator = site.actuator
    outline = _line(site, actuator.outer_bottom, _sole_half(actuator, strips))
    return _at_end(site, outline, strips)


def _at_end(site: Sited, outline: Outline, strips: Strips) -> Skin:
    end = site.actuator.total_length
    return side(site.layout, outline, ALONG / 2, (end - strips.post_length, end))


def _sole_half(actuator: Actuator, strips: Strips) -> float:
    """Half the width of the post's strip."""
    corners = _corners(actuator, _FINE)
    flat = corners[np.abs(corners[:, 1] - actuator.outer_bottom) < _LEVEL * actuator.total_length]
    return max(strips.roof_half_width * (len(flat) < 2), float(np.abs(flat[:, 0]).max()))


def _strip(actuator: Actuator, half: float, top: bool) -> Outline:
    """The line |x| ≤ half on the top or the bottom of a section."""
    corners = ring(_corners(actuator, _FINE), _FINE).places
    middle = (actuator.outer_top + actuator.outer_bottom) / 2
    there = corners[(corners[:, 1] > middle) == top]
    # of a vertical side only its end belongs to the line
    end = actuator.outer_top if top else actuator.outer_bottom
    beside = np.abs(there[:, 0]) > actuator.outer_half_width * (1 - _LEVEL)
    there = there[~beside | (np.abs(there[:, 1] - end) < _LEVEL * actuator.total_length)]
    there = there[np.argsort(there[:, 0], kind="stable")]
    x = np.linspace(-half, half, max(3, 2 * round(half / (AROUND / 2)) + 1))
    return strip(np.column_stack([x, np.interp(x, there[:, 0], there[:, 1])]), AROUND)

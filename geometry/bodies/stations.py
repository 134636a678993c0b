"""Planes between which a section is extruded along z, and the names of its faces there."""

from __future__ import annotations

import dataclasses
import itertools

from geometry.actuator import Actuator
from geometry.sections.size import MeshSize, Strips, divisions


@dataclasses.dataclass(frozen=True)
class Segment:
    """A stretch of z with one section.

    Attributes:
        start: z of its first plane in mm.
        end: z of its last plane in mm.
        divisions: number of elements along z.
        names: named sides of the section that are named surfaces here.
        filled: True where the chamber's blocks are present.
    """

    start: float
    end: float
    divisions: int
    names: frozenset[str]
    filled: bool


@dataclasses.dataclass(frozen=True)
class Stations:
    """Segments in order of z and the planes between and around them.

    Attributes:
        segments: the segments, each starting where the last one ended.
        planes: for each of the segments + 1 planes the surface's name on blocks that are there on
            both sides or belong to the ring, and its name on the chamber's blocks; None: unnamed.
        origin: number of the plane whose nodes take the names of the section's named points.
    """

    segments: tuple[Segment, ...]
    planes: tuple[tuple[str | None, str | None], ...]
    origin: int = 0


_BESIDE_POST = 3.0
"""Greatest length of the cap's elements over that of a post beside them: twice as long, they bend
with its edge and raise the tip force of a blocked baseline by up to 0.7 % (docs/decisions.md)."""
_EVERYWHERE = frozenset({"symmetry", "outer"})
_CHAMBER = _EVERYWHERE | {"chamber", "winding", "roof"}


def body_stations(actuator: Actuator, size: MeshSize, strips: Strips | None = None) -> Stations:
    """Stations of the whole body: root cap, chamber, tip cap, and the post's strip at its end.

    The chamber is divided at the borders that the fineness names.

    Surfaces: "clamp" and "tip" (end faces), "section_root" and "section_tip" (the ring of material
    at z = 0 and z = L), "chamber" with its end planes, "winding" and "roof" for 0 ≤ z ≤ L,
    "post", and everywhere "outer" and "symmetry".

    Args:
        actuator: dimensions.
        size: length of the elements along z; beside a post they may be shorter.
        strips: length of the post; without it there is none.
    """
    length, cap = actuator.length, actuator.cap
    end = length + cap
    post, beside = end, size.axial
    if strips:
        post = end - strips.post_length
        beside = min(beside, _BESIDE_POST * strips.post_length)
    chamber = [
        Segment(a, b, divisions(b - a, size.axial), _CHAMBER, False)
        for a, b in itertools.pairwise((0.0, *size.borders, length))
    ]
    segments = [
        Segment(-cap, 0.0, divisions(cap, size.axial), _EVERYWHERE, True),
        *chamber,
        Segment(length, post, divisions(post - length, beside), _EVERYWHERE, True),
    ]
    planes: list[tuple[str | None, str | None]] = [
        ("clamp", "clamp"),
        ("section_root", "chamber"),
        *[(None, None)] * len(size.borders),
        ("section_tip", "chamber"),
        ("tip", "tip"),
    ]
    if strips:
        with_post = _EVERYWHERE | {"post"}
        segments.append(Segment(post, end, divisions(end - post, size.axial), with_post, True))
        planes.insert(-1, (None, None))
    return Stations(tuple(segments), tuple(planes), origin=1)


def slice_stations(length: float, number: int) -> Stations:
    """Stations of a slice 0 ≤ z ≤ `length` (mm) of the body between its caps.

    Surfaces: the section's, with "section_root" and "section_tip" at its ends.
    """
    segment = Segment(0.0, length, number, _CHAMBER, False)
    return Stations((segment,), (("section_root", None), ("section_tip", None)))

"""How large problems are, before anything is meshed."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

from fiberbend.case.case import Case

_POINTS = 9
"""Quadrature points of a facet, of each a piece of every helix of a winding that is spread."""
_SEGMENT_MB = 0.025
"""Measured on bodies of 14 000 and 60 000 unknowns with pitches from 6 to 0.5 mm."""


@dataclasses.dataclass(frozen=True)
class ProblemSize:
    """How large a problem is.

    Attributes:
        elements: number of elements.
        kind: what they are.
        unknowns: displacements and pressures, before any are fixed.
        scalars: global unknowns beside them.
        layers: elements along the axis.
        segments: pieces of thread, each within an element.
        exact: elements and unknowns are those of the run; else about as many.
    """

    elements: int
    kind: str
    unknowns: int
    scalars: tuple[str, ...]
    layers: float
    segments: float
    exact: bool = True


def summed(sizes: Iterable[ProblemSize]) -> ProblemSize:
    """Of problems that are kept side by side."""
    first, *others = sizes
    for other in others:
        first = dataclasses.replace(
            first,
            elements=first.elements + other.elements,
            unknowns=first.unknowns + other.unknowns,
            scalars=tuple(dict.fromkeys((*first.scalars, *other.scalars))),
            layers=first.layers + other.layers,
            segments=first.segments + other.segments,
        )
    return first


def pieces(case: Case, half: bool, around: int, length: float, layers: float) -> float:
    """Pieces of thread, each within an element: one for each facet that a curve crosses.

    Args:
        case: has the thread, or none.
        half: half the section is modelled.
        around: facets around what is modelled of the section.
        length: of the wound part, mm.
        layers: facets along it.
    """
    turns = case.turns
    if turns is None:
        return 0.0
    if not turns.discrete:
        return float(turns.curves * _POINTS * around * layers)
    part = 0.5 if half else 1.0
    return length * turns.around * around + part * turns.curves * layers


def thread_mb(segments: float) -> float:
    """Memory of pieces of thread with their matrices, MB."""
    return _SEGMENT_MB * segments

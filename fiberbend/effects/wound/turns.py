"""What the rest of the program asks of the thread around a body."""

from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class Turns:
    """Thread wound around the body.

    Attributes:
        pitch: length along the axis of one turn of a pattern, mm; None of families, of which no
            table of errors knows.
        spacing: distance along the axis of neighbouring turns of one family, the least of all, mm;
            of a pattern its pitch; inf where all is alike along the axis.
        period: length along the axis after which all repeats, mm; None where there is none of a
            few turns.
        origin: z of a line along y half a turn about which maps all onto itself, mm; None where
            there is none, so that it bends sideways.
        discrete: every turn by itself, not spread over its surface.
        twists: the winding is not its own mirror image, so that the body may twist.
        stiffness: axial stiffness EA of the thread, of several the greatest, N.
        modulus: Young's modulus of the thread, of several the least, MPa.
        curves: lines that stand for the thread and go on along the axis: helices, times the lines
            of a ribbon.
        around: times that lines go around the body, over a length along the axis, 1/mm.
        bulges: spread over its surface, with rubber that bulges between the turns.
        tight: threads lie all around and so nearly across that they fix the circumference.
        misfit: why there is no period, with what would have one.
    """

    pitch: float | None
    spacing: float
    period: float | None
    origin: float | None
    discrete: bool
    twists: bool
    stiffness: float
    modulus: float
    curves: int
    around: float
    bulges: bool = False
    tight: bool = True
    misfit: str = ""

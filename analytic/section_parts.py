"""Quadrature of bending moments over the parts of a cross-section. mm, N, MPa.

In uniform bending about the inextensible line y = 0 the stretch depends on the height alone,
λ = 1 + y θ/L, eqs. (15) and (17) of Polygerinos et al. 2015 (doi 10.1109/TRO.2015.2428504), so a
part of the section is no more than its Gauss points: heights, and areas as weights.
"""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np

from analytic.stress import Floats, Stress

_STRAIGHT = 6
_AROUND = 14


def _gauss(low: float, high: float, count: int) -> tuple[Floats, Floats]:
    nodes, weights = np.polynomial.legendre.leggauss(count)
    half = (high - low) / 2
    return np.asarray(low + half * (nodes + 1)), np.asarray(half * weights)


@dataclasses.dataclass(frozen=True, eq=False)
class SectionPart:
    """Part of a cross-section.

    Attributes:
        height: heights y of the Gauss points above the inextensible line, (n,), mm.
        area: their areas, (n,), mm².
    """

    height: Floats
    area: Floats

    def __add__(self, other: SectionPart) -> SectionPart:
        """Both parts as one."""
        return SectionPart(
            np.concatenate([self.height, other.height]), np.concatenate([self.area, other.area])
        )

    @functools.cached_property
    def lever(self) -> Floats:
        """y dA of the Gauss points, (n,), mm³: their moments about y = 0 under a unit stress."""
        return self.height * self.area

    def moment(self, angle: Floats, length: float, stress: Stress) -> Floats:
        """∫ s(1 + y θ/L) y dA.

        Args:
            angle: bending angles θ of any shape, rad.
            length: length L of the inextensible line, mm.
            stress: nominal axial stress of the part.

        Returns:
            Moments about y = 0 in the shape of `angle`, N mm.
        """
        stretch = 1 + (angle / length)[..., None] * self.height
        result: Floats = stress(stretch) @ self.lever
        return result


def rectangle(width: float, low: float, high: float) -> SectionPart:
    """Rectangle that is symmetric about the y axis.

    Args:
        width: its width, mm.
        low: y of its lower side, mm.
        high: y of its upper side, mm.
    """
    height, weight = _gauss(low, high, _STRAIGHT)
    return SectionPart(height, width * weight)


def ring(
    centre: float,
    inner: float,
    outer: float,
    start: float = -math.pi / 2,
    stop: float = math.pi / 2,
) -> SectionPart:
    """Part of a ring that is symmetric about the y axis.

    Args:
        centre: height of its centre, mm.
        inner: inner radius, mm; 0 for a sector of a disk.
        outer: outer radius, mm.
        start: polar angle of the right half above the horizontal, from here, rad.
        stop: to here, rad; −π/2 to π/2 is the full ring, 0 to π/2 its upper half.
    """
    radius, across = _gauss(inner, outer, _STRAIGHT)
    polar, around = _gauss(start, stop, _AROUND)
    height = centre + radius[:, None] * np.sin(polar)
    area = 2 * (radius * across)[:, None] * around
    return SectionPart(height.ravel(), area.ravel())

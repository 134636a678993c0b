"""Masses on the frames of a rod: spread along it, and at its tip."""

from __future__ import annotations

import dataclasses

import numpy as np

from rod.functions import Floats
from rod.layout import Layout


@dataclasses.dataclass(frozen=True)
class SectionMass:
    """Mass of a section per length at rest, by its own axes.

    Attributes:
        mass: ∫ ρ dA, t/mm.
        centre: x, y of its centre from the rod's line, mm.
        second: ∫ ρ X² dA, ∫ ρ Y² dA and ∫ ρ X Y dA about its centre, t mm: rotary inertia.

    Raises:
        ValueError: a mass or a second moment below zero.
    """

    mass: float
    centre: tuple[float, float] = (0.0, 0.0)
    second: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        moments = self.matrix()
        if np.linalg.eigvalsh(moments).min() < -1e-12 * np.abs(moments).max():
            raise ValueError(f"{self}: no distribution of mass has these moments")

    def matrix(self) -> Floats:
        """∫ ρ (y, 1) ⊗ (y, 1) dA about the line, (4, 4)."""
        arm = np.array([*self.centre, 0.0, 1.0])
        out: Floats = self.mass * np.outer(arm, arm)
        xx, yy, xy = self.second
        out[:2, :2] += [[xx, xy], [xy, yy]]
        return out


def spread(layout: Layout, sections: list[SectionMass]) -> Floats:
    """Masses of pieces on their frames, half of each at either end.

    Args:
        layout: of the rod.
        sections: one for each piece, or one for all.

    Returns:
        ∫ (y, 1) ⊗ (y, 1) dm of each frame, (n + 1, 4, 4); t mm², t mm and t.

    Raises:
        ValueError: another number of sections.
    """
    n = len(layout.lengths)
    if len(sections) not in (1, n):
        raise ValueError(f"one section for each of {n} pieces expected, or one for all")
    along = np.array([section.matrix() for section in sections])
    pieces = layout.lengths[:, None, None] * along
    out = np.zeros((n + 1, 4, 4))
    out[:-1] += pieces / 2
    out[1:] += pieces / 2
    return out


def lump(mass: float, place: tuple[float, float, float], second: Floats | None = None) -> Floats:
    """Inertia of a body that is fixed to a frame, (4, 4).

    Args:
        mass: t.
        place: of its centre in the frame's own axes, mm.
        second: ∫ y ⊗ y dm about its centre, (3, 3), t mm²; None: a point.
    """
    arm = np.array([*place, 1.0])
    out: Floats = mass * np.outer(arm, arm)
    if second is not None:
        out[:3, :3] += second
    return out

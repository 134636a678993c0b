"""Natural frequencies and modes of a rod about a state."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from scipy.linalg import eigh

from rod.functions import Floats
from rod.rod import Level, Rod
from rod.shape import Shape

_SYMMETRIC = 1e-9


@dataclasses.dataclass(frozen=True)
class Modes:
    """The lowest modes, by frequency.

    Attributes:
        frequencies: f, (k,), Hz; below zero where a mode is unstable and grows at 2π |f| 1/s.
        strains: shapes in the strains, (k, n, m), of one t mm² each: δεᵀ M δε = 1.
    """

    frequencies: Floats
    strains: Floats


def modes(rod: Rod, shape: Shape, level: Level, count: int) -> Modes:
    """Small undamped vibrations: K δε = (2π f)² M δε with the tangent K and the mass matrix M.

    Args:
        rod: with its inertia.
        shape: an equilibrium.
        level: what acts there.
        count: number of modes, the lowest ones.

    Returns:
        The modes.

    Raises:
        ValueError: no inertia, or loads without a potential: their tangent is not symmetric.
    """
    if not rod.inertia.any():
        raise ValueError("a rod without inertia does not vibrate")
    tangent = rod.tangent(shape, level)
    if np.abs(tangent - tangent.T).max() > _SYMMETRIC * np.abs(tangent).max():
        raise ValueError("a load on the tip has no potential: modes with one that has are known")
    mass = shape.mass(rod.inertia)
    values, vectors = eigh(
        (tangent + tangent.T) / 2, mass, subset_by_index=(0, min(count, len(mass)) - 1)
    )
    frequencies = np.sign(values) * np.sqrt(np.abs(values)) / (2 * math.pi)
    return Modes(frequencies, vectors.T.reshape(-1, *shape.layout.shape))

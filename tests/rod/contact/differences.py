"""Residual, tangent and growth of a term beside central differences."""

from __future__ import annotations

import numpy as np

from rod.functions import Floats
from rod.layout import Layout
from rod.shape import Shape
from rod.term import Term

STEP = 1e-6


def errors(term: Term, layout: Layout, strains: Floats, amount: float) -> tuple[float, ...]:
    """Of residual, tangent and growth in parts of their greatest entries; and asymmetry."""
    turning = np.array(["curv" in name or name == "twist" for name in layout.strains])
    sizes = np.where(turning, 0.1, 1.0)
    shape = Shape(layout, strains)
    residual, tangent = term.residual(shape, amount), term.tangent(shape, amount)
    slope, second = np.zeros(strains.shape), np.zeros((strains.size, strains.size))
    for place in np.ndindex(strains.shape):
        change = np.zeros_like(strains)
        change[place] = STEP * sizes[place[1]]
        after, before = Shape(layout, strains + change), Shape(layout, strains - change)
        potentials = term.potential(after, amount), term.potential(before, amount)
        slope[place] = (potentials[0] - potentials[1]) / (2 * change[place])
        column = np.ravel_multi_index(place, strains.shape)
        difference = term.residual(after, amount) - term.residual(before, amount)
        second[:, column] = difference.ravel() / (2 * change[place])
    scale = np.outer(np.tile(sizes, len(strains)), np.tile(sizes, len(strains)))
    ahead, behind = (term.residual(shape, amount + way * STEP) for way in (1, -1))
    growth = (ahead - behind) / (2 * STEP)
    pairs = ((residual * sizes, slope * sizes), (tangent * scale, second * scale))
    pairs = (*pairs, (term.growth(shape, amount) * sizes, growth * sizes))
    pairs = (*pairs, (tangent * scale, tangent.T * scale))
    return tuple(float(np.abs(a - b).max() / np.abs(a).max()) for a, b in pairs)

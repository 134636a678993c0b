"""What shear costs beside the other strains of a section, by its flexibility."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rod.functions import Floats
from rod.layout import STRAINS


def shear_form(flexibility: Floats, strains: Sequence[str]) -> Floats:
    """Q of `rod.sheared.Sheared`: what shear costs beside the other strains, (m, m).

    Of all energy σ·F σ/2 it is the part that a law of the other strains ε at V = 0 has not:
    ½ (γ − B ε)·C (γ − B ε), B = F_γε F_εε⁻¹ and C = (F_γγ − B F_εγ)⁻¹.

    Args:
        flexibility: F of a section, (6, 6).
        strains: of the rod, out of `rod.layout.STRAINS`.
    """
    free = [name for name in STRAINS[:2] if name in strains]
    others = [name for name in strains if name not in free]
    first, second = ([STRAINS.index(name) for name in names] for names in (free, others))
    mixed = flexibility[np.ix_(first, second)]
    carried = np.linalg.solve(flexibility[np.ix_(second, second)], mixed.T).T
    stiffness = np.linalg.inv(flexibility[np.ix_(first, first)] - carried @ mixed.T)
    turn = np.zeros((len(free), len(strains)))
    turn[:, [strains.index(name) for name in free]] = np.eye(len(free))
    turn[:, [strains.index(name) for name in others]] = -carried
    out: Floats = turn.T @ stiffness @ turn
    return (out + out.T) / 2

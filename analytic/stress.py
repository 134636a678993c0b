"""Axial stress of rubber inside a winding: circumference fixed, thickness free. MPa.

Polygerinos et al. 2015, doi 10.1109/TRO.2015.2428504, eqs. (6)–(11): λ1 = λ, λ2 = 1, λ3 = 1/λ and
s3 = 0. For any W(I1) they give the nominal stress

    s1 = 2 W'(I1) (λ − λ⁻³),   I1 = 1 + λ² + λ⁻²,

of which (8) is the case 2 W' = μ̄.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Stress = Callable[[Floats], Floats]
"""Nominal axial stress s in MPa, elementwise, as a function of the axial stretch λ > 0."""
PrincipalStresses = Callable[[Floats, Floats, Floats], tuple[Floats, Floats, Floats]]
"""λi ∂W/∂λi in MPa of principal stretches with the product 1, elementwise: the principal Cauchy
stresses but for a pressure that they share."""

CALIBRATED_MODULUS = 0.314
"""μ̄ in MPa that the paper's section IV-B calibrated on (a, b, t, L) = (8, 2, 2, 160) mm."""


def effective(modulus: float = CALIBRATED_MODULUS) -> Stress:
    """Eqs. (8), (16), (18): s = μ̄ (λ − λ⁻³).

    Args:
        modulus: effective initial shear modulus μ̄, MPa.

    Raises:
        ValueError: the modulus is not positive and finite.
    """
    if not 0 < modulus < np.inf:
        raise ValueError(f"effective shear modulus: positive MPa expected, not {modulus}")

    def stress(stretch: Floats) -> Floats:
        # λ**-3 calls pow, which is ten times slower than three products
        return modulus * (stretch - 1 / (stretch * stretch * stretch))

    return stress


def wound(law: PrincipalStresses) -> Stress:
    """Eqs. (6)–(11) for any law, so that measured materials replace the fitted μ̄.

    The stretches λ, 1, 1/λ with s3 = 0 leave s1 = (σ1 − σ3)/λ.

    Args:
        law: λi ∂W/∂λi of the rubber, MPa.
    """

    def stress(stretch: Floats) -> Floats:
        along, _, across = law(stretch, np.ones_like(stretch), 1 / stretch)
        return (along - across) / stretch

    return stress

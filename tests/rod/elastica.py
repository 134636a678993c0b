"""The cantilever elastica under a dead force across it, by elliptic integrals.

Bisshopp and Drucker 1945, Large deflection of cantilever beams, doi 10.1090/qam/13360. With
α = L √(F/EI) and the tip's angle θ

    p² = (1 + sin θ)/2,   sin φ = 1/(p √2),   α = K(p) − F(p, φ),
    y/L = 1 − 2/α [E(p) − E(p, φ)],   z/L = √(2 sin θ)/α.
"""

from __future__ import annotations

import math

from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc


def elastica(force: float, bending: float, length: float) -> tuple[float, float, float]:
    """Angle, deflection and place along the root's axis of the tip.

    Args:
        force: F, N, across the root's axis.
        bending: EI, N mm².
        length: L, mm.

    Returns:
        θ in rad, deflection and place, mm.
    """
    alpha = length * math.sqrt(force / bending)

    def amplitude(p2: float) -> float:
        return math.asin(min(1.0, 1 / math.sqrt(2 * p2)))

    p2 = brentq(
        lambda p2: ellipk(p2) - ellipkinc(amplitude(p2), p2) - alpha, 0.5, 1 - 1e-14, xtol=1e-16
    )
    phi, angle = amplitude(p2), math.asin(2 * p2 - 1)
    down = length * (1 - 2 / alpha * (ellipe(p2) - ellipeinc(phi, p2)))
    return angle, down, length * math.sqrt(2 * math.sin(angle)) / alpha

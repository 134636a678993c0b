"""Yeoh's law; MPa."""

from __future__ import annotations

from typing import Any

from materials.laws.law import Deformation, Law, Parameter


def energy(state: Deformation, c1: Any, c2: Any, c3: Any) -> Any:
    """W = C1 (I1 − 3) + C2 (I1 − 3)² + C3 (I1 − 3)³."""
    i1 = state.i1
    return c1 * (i1 - 3) + c2 * (i1 - 3) ** 2 + c3 * (i1 - 3) ** 3


LAW = Law(
    "yeoh",
    energy,
    (
        Parameter("c1", "Coefficient of I1 - 3", allowed="above zero"),
        Parameter("c2", "Coefficient of (I1 - 3)^2", default=0.0),
        Parameter("c3", "Coefficient of (I1 - 3)^3", default=0.0),
    ),
)

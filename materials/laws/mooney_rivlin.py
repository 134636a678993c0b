"""The law of Mooney and Rivlin; MPa."""

from __future__ import annotations

from typing import Any

from materials.laws.law import Deformation, Law, Parameter


def energy(state: Deformation, c10: Any, c01: Any) -> Any:
    """W = C10 (I1 − 3) + C01 (I2 − 3)."""
    return c10 * (state.i1 - 3) + c01 * (state.i2 - 3)


LAW = Law(
    "mooney-rivlin",
    energy,
    (
        Parameter("c10", "Coefficient of I1 - 3"),
        Parameter("c01", "Coefficient of I2 - 3", default=0.0),
    ),
)

"""Strain energies of arrays of stretches, and their slopes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from materials.invariants import Invariants

Floats = NDArray[np.float64]
_STEP = 1e-30


class Stretches(Invariants):
    """A deformation by its principal stretches: a `materials.laws.law.Deformation` in numpy."""

    def ln(self, x: Any) -> Any:
        """Natural logarithm; NaN where the real part is not positive."""
        good = np.real(x) > 0
        # of a complex number both parts: the imaginary one carries a derivative
        none = np.nan if np.isrealobj(x) else complex(np.nan, np.nan)
        return np.where(good, np.log(np.where(good, x, 1.0)), none)

    def exp(self, x: Any) -> Any:
        """Exponential function."""
        return np.exp(x)


def slopes(
    energy: Callable[..., Any], stretches: Sequence[Floats]
) -> tuple[Floats, Floats, Floats]:
    """λi ∂W/∂λi in MPa, by a complex step: nothing is subtracted.

    Args:
        energy: W in MPa of three arrays of principal stretches.
        stretches: λ1, λ2, λ3, arrays of one shape.

    Returns:
        Three arrays of this shape; NaN where the law has no value.
    """

    def slope(i: int) -> Floats:
        moved = [np.asarray(s, dtype=complex) for s in stretches]
        moved[i] = moved[i] * (1 + 1j * _STEP)
        return np.asarray(np.imag(energy(*moved)) / _STEP, dtype=float)

    return slope(0), slope(1), slope(2)

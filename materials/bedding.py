"""Rubber that yields under threads: a bed of springs below each of them."""

from __future__ import annotations

import dataclasses
import math


@dataclasses.dataclass(frozen=True)
class Bedding:
    """Stiffness per length of a thread against the rubber around it, across the surface and along.

    A thread of the curvature κ under the tension T presses with T κ per length. Rubber between
    threads bulges, and the thread sinks by b = T κ/k below the mean surface. Where T changes along
    the thread it pulls with T' at the rubber, and slips by s = T'/k_s against the mean surface. Of
    a line load at equal distances on a half space or a layer both are a number times the shear
    modulus, on which distance and thickness have little influence. The tension of the wall between
    threads stiffens it against bulges: k = k0 exp[a (λ_n − 1) + c p/k0], λ_n the stretch of the
    surface across the thread and p the pressure in the chamber, which is positive whatever they
    are.

    Attributes:
        normal: k0, MPa.
        along: k_s, MPa.
        across: a.
        pressure: c.

    Raises:
        ValueError: a stiffness that is not positive, a number that is none.
    """

    normal: float
    along: float
    across: float = 0.0
    pressure: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not math.isfinite(value):
                raise ValueError(f"{name} = {value!r}, expected a finite number")
        for name in ("normal", "along"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} {getattr(self, name)} MPa, expected a value above zero")

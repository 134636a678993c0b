"""Tests of rubber: how a specimen is loaded, and what was measured; MPa."""

from __future__ import annotations

import dataclasses

import numpy as np

from materials.stretches import Floats


@dataclasses.dataclass(frozen=True)
class Mode:
    """A way to load an incompressible specimen whose third principal stress is zero.

    Attributes:
        name: in options and tables.
        across: b of the logarithmic strains h, b h, −(1 + b) h.
    """

    name: str
    across: float

    def strains(self, stretch: Floats) -> tuple[Floats, Floats, Floats]:
        """Principal logarithmic strains; the last one is that of the free direction."""
        h = np.log(stretch)
        return h, self.across * h, -(1 + self.across) * h

    def stretches(self, stretch: Floats) -> tuple[Floats, Floats, Floats]:
        """Principal stretches; the last one is that of the free direction."""
        first, second, third = self.strains(stretch)
        return np.exp(first), np.exp(second), np.exp(third)


UNIAXIAL = Mode("uniaxial", -0.5)
PURE_SHEAR = Mode("pure-shear", 0.0)
EQUIBIAXIAL = Mode("equibiaxial", 1.0)
MODES = {mode.name: mode for mode in (UNIAXIAL, PURE_SHEAR, EQUIBIAXIAL)}
"""Every mode by its name."""


@dataclasses.dataclass(frozen=True, eq=False)
class Measurement:
    """A test of one specimen.

    Attributes:
        mode: how it was loaded.
        stretch: stretches along the load, (n,).
        stress: nominal stresses, force per area at rest, MPa, (n,).
        name: where they come from.

    Raises:
        ValueError: arrays of different shapes, no points, or values that are no stretches.
    """

    mode: Mode
    stretch: Floats
    stress: Floats
    name: str = ""

    def __post_init__(self) -> None:
        if self.stretch.shape != self.stress.shape or self.stretch.ndim != 1:
            raise ValueError("expected as many stresses as stretches")
        if not self.stretch.size:
            raise ValueError("no points, expected at least one")
        if not (np.isfinite(self.stress).all() and np.isfinite(self.stretch).all()):
            raise ValueError("expected finite stretches and stresses")
        if not (self.stretch > 0).all():
            raise ValueError(f"stretch {self.stretch.min():g}, expected numbers above zero")

    def sorted(self) -> Measurement:
        """The same points by growing stretch."""
        order = np.lexsort((self.stress, self.stretch))
        return dataclasses.replace(self, stretch=self.stretch[order], stress=self.stress[order])

    @property
    def greatest(self) -> float:
        """The greatest of all principal stretches that the specimen has seen."""
        return float(max(part.max() for part in self.mode.stretches(self.stretch)))

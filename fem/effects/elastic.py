"""Isochoric hyperelastic energy of the regions that follow one law."""

from __future__ import annotations

from typing import Any

import ufl

from fem.effects.effect import Effect
from fem.kinematics.kinematics import Kinematics
from materials.laws import LAWS


class Elastic(Effect):
    """Π = ∫ ψ(Ī1, Ī2) dX with Ī1 = J^(−2/3) tr C, Ī2 = J^(−4/3) (tr² C − tr C²)/2.

    Args:
        law: name in `materials.laws.LAWS`.
        regions: for each region that follows the law, its parameters in MPa.

    Raises:
        ValueError: unknown law or parameter.
    """

    def __init__(self, law: str, regions: dict[str, dict[str, float]]) -> None:
        if law not in LAWS:
            raise ValueError(f"unknown law {law!r}, expected one of {sorted(LAWS)}")
        self.law = LAWS[law]
        for region, parameters in regions.items():
            unknown = set(parameters) - set(self.law.parameters)
            if unknown:
                raise ValueError(f"{region}: {law} has no parameter {sorted(unknown)}")
        self.regions = {
            region: {**self.law.defaults, **parameters} for region, parameters in regions.items()
        }

    @property
    def key(self) -> str:
        """Elastic energy is labelled by its law."""
        return f"Elastic[{self.law.name}]"

    def potential(self, body: Kinematics) -> Any:
        """The energy as a form; parameters are piecewise constant fields."""
        c = body.F.T * body.F
        j = ufl.det(body.F)
        i1 = ufl.tr(c)
        i2 = (i1**2 - ufl.tr(c * c)) / 2
        values = [
            body.coefficient({region: row[name] for region, row in self.regions.items()})
            for name in self.law.parameters
        ]
        density = self.law.energy(j ** (-2 / 3) * i1, j ** (-4 / 3) * i2, *values)
        return density * body.dx()

"""Isochoric hyperelastic energy of the regions that follow one law."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from fem.effects.effect import Effect
from fem.effects.isochoric import Isochoric
from fem.kinematics.kinematics import Kinematics
from materials.laws.table import LAWS


class Elastic(Effect):
    """Π = ∫ ψ dX of a law that takes the isochoric part of the deformation.

    Args:
        law: name in `materials.laws.table.LAWS`.
        regions: for each region that follows the law, its parameters in their units.

    Raises:
        ValueError: unknown law or parameter, or a parameter that is missing.
    """

    def __init__(self, law: str, regions: dict[str, dict[str, float]]) -> None:
        if law not in LAWS:
            raise ValueError(f"unknown law {law!r}, expected one of {sorted(LAWS)}")
        self.law = LAWS[law]
        for region, parameters in regions.items():
            unknown, missing = self.law.unknown(parameters), self.law.missing(parameters)
            if unknown:
                raise ValueError(f"{region}: {law} has no parameter {sorted(unknown)}")
            if missing:
                raise ValueError(f"{region}: {law} needs {missing}")
        self.regions = {region: self.law.complete(row) for region, row in regions.items()}

    @property
    def key(self) -> str:
        """Elastic energy is labelled by its law."""
        return f"Elastic[{self.law.name}]"

    def structure(self) -> Hashable:
        """The law, and which of its terms any region has."""
        return self.law.name, tuple(sorted(self.law.used(self.regions.values())))

    def potential(self, body: Kinematics) -> Any:
        """The energy as a form; parameters are piecewise constant fields.

        A term that no region has is not in it.
        """
        used = self.law.used(self.regions.values())
        values = {
            parameter.name: body.coefficient(
                dict.fromkeys(body.domain.data.regions, parameter.neutral)
                | {region: row[parameter.name] for region, row in self.regions.items()}
            )
            for parameter in self.law.parameters
            if parameter.name in used
        }
        return self.law.energy(Isochoric(body), **values) * body.dx()

"""Numbers within forms that are no code: other ones in the same forms need no other kernels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import dolfinx.fem as dfem
import ufl

from fem import compat
from fem.kinematics.domain import Domain


class Numbers:
    """What effects ask for while they make their forms, kept in the order in which they ask.

    After `again` the same requests, in the same order, put their values into what is there.

    Args:
        domain: the mesh.
    """

    def __init__(self, domain: Domain) -> None:
        self._domain = domain
        self._made: list[Any] = []
        self._next: int | None = None

    def again(self) -> None:
        """Start over: what is asked for from now on are other values of what is there."""
        self._next = 0

    def field(self, by_region: dict[str, float]) -> Any:
        """A piecewise constant field, one value per region."""
        values = self._domain.cell_values(by_region)
        old = self._old()
        if old is not None:
            compat.set_cell_field(old, values)
            return old
        return self._new(compat.cell_field(self._domain.mesh, values))

    def constants(self, values: Sequence[float]) -> Any:
        """A vector of constants."""
        old = self._old()
        if old is not None:
            old.value[:] = values
            return old
        return self._new(dfem.Constant(self._domain.mesh, [float(value) for value in values]))

    def stand_in(self) -> tuple[Any, bool]:
        """A constant that stands for something, and whether it is new."""
        old = self._old()
        return (self._new(ufl.Constant(self._domain.mesh)), True) if old is None else (old, False)

    def _old(self) -> Any:
        if self._next is None:
            return None
        self._next += 1
        return self._made[self._next - 1]

    def _new(self, made: Any) -> Any:
        self._made.append(made)
        return made

"""The law of a section by a table: what a rod asks of it."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np

from fiberbend.sectionlaw.chart import Chart
from rod.functions import Floats
from rod.table import Table

STRAINS = ("stretch", "curvature")
"""Of the line of centroids: λ, and k in rad a mm of z at rest, as `rod.layout` names them."""
_STEPS, _CLOSE = 50, 1e-10
_FURTHEST = 0.2
"""Part of the range by which a step to a free state may go."""


class Free(NamedTuple):
    """A section on which no force acts.

    Attributes:
        stretch: of the line of centroids.
        curvature: rad/mm.
    """

    stretch: float
    curvature: float


@dataclasses.dataclass(frozen=True)
class SectionLaw:
    """Φ(λ, k; P) of the line of centroids; a `rod.law.Law`.

    Attributes:
        table: by e, u and P in MPa.
        chart: what e and u are.
    """

    table: Table
    chart: Chart

    def _slopes(self, strains: Floats, pressure: float) -> tuple[Floats, Floats]:
        """Places in the table, and ∂Φ there by its own variables, (n, 3)."""
        place = self.chart.place(strains, pressure)
        area = self.table.chamber(place, pressure)
        return place, np.column_stack([self.table.gradient(place, pressure), -area])

    def _first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by λ, k and P, (n, 3)."""
        place, slopes = self._slopes(strains, pressure)
        found: Floats = np.einsum("ni,nij->nj", slopes, self.chart.first(place, pressure))
        return found

    def _second(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ by λ, k and P, (n, 3, 3)."""
        place, slopes = self._slopes(strains, pressure)
        own = np.empty((len(place), 3, 3))
        own[:, :2, :2] = self.table.hessian(place, pressure)
        own[:, 2, :2] = own[:, :2, 2] = -self.table.chamber_gradient(place, pressure)
        own[:, 2, 2] = -self.table.chamber_slope(place, pressure)
        turn = self.chart.first(place, pressure)
        bent = slopes[:, 1, None, None] * self.chart.second(place, pressure)
        found: Floats = turn.transpose(0, 2, 1) @ own @ turn + bent
        return found

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.table.value(self.chart.place(strains, pressure), pressure)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`: N in N, M in N mm."""
        return self._first(strains, pressure)[:, :2]

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self._second(strains, pressure)[:, :2, :2]

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self._first(strains, pressure)[:, 2]

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self._second(strains, pressure)[:, :2, 2]

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self._second(strains, pressure)[:, 2, 2]

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`."""
        found = self.table.outside(self.chart.place(strains, pressure), pressure)
        if found.startswith("strain 1"):
            return f"stretch {self.chart.lever:.3g} mm from the centroids:{found[8:]}"
        if found.startswith("strain 2"):
            return f"curvature, in parts of its range at this pressure:{found[8:]}"
        return found

    def free(self, pressure: float, near: Free) -> Free:
        """Where no force acts, N = M = 0.

        Args:
            pressure: MPa.
            near: where Newton's method begins.

        Raises:
            ValueError: no such state is in the table.
        """
        at = np.array([near])
        stretch, share, _ = self.table.axes
        widths = np.array([np.ptp(stretch.lines), np.ptp(share.lines)])
        for _ in range(_STEPS):
            step = np.linalg.solve(self.hessian(at, pressure)[0], self.gradient(at, pressure)[0])
            turn = self.chart.first(self.chart.place(at, pressure), pressure)[0, :2, :2]
            size = float(np.abs(turn @ step / widths).max())
            at = at - step * min(1.0, _FURTHEST / max(size, _CLOSE))
            if size < _CLOSE:
                break
        else:
            raise ValueError(f"no free state of the table at {1e3 * pressure:.6g} kPa")
        if beyond := self.outside(at, pressure):
            raise ValueError(f"the free state at {1e3 * pressure:.6g} kPa is outside: {beyond}")
        return Free(float(at[0, 0]), float(at[0, 1]))

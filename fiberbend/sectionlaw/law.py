"""The law of a section by a table: what a rod asks of it."""

from __future__ import annotations

import dataclasses
from typing import NamedTuple

import numpy as np

from fiberbend.sectionlaw.chart import Chart
from rod.functions import Floats
from rod.law import Sections
from rod.table import Table

PLANE = ("stretch", "curvature")
"""Of the line of centroids: λ, and k in rad a mm of z at rest, as `rod.layout` names them."""
_STEPS, _CLOSE = 50, 1e-10
_FURTHEST, _OUTSIDE = 0.2, 1e-9
"""Parts of the range: by which a step to a free state may go, and beyond which it is another."""


_PLACES, _KEPT = 3, 1000
"""Places that a law remembers, of no more sections."""


class Free(NamedTuple):
    """A section on which no force acts.

    Attributes:
        stretch: of the line of centroids.
        curvature: rad/mm, toward −y.
        side_curvature: rad/mm, toward x.
        twist: rad/mm.
    """

    stretch: float
    curvature: float
    side_curvature: float = 0.0
    twist: float = 0.0


class _Known(NamedTuple):
    """Φ, (n,), and its derivatives by strains and P at strains, (n, m), and a pressure."""

    pressure: float
    strains: Floats
    value: Floats
    first: Floats
    second: Floats


class Derived:
    """A law by value, first and second derivatives by strains and pressure: a `rod.law.Law`."""

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by strains and P, (n, m + 1)."""
        raise NotImplementedError

    def second(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ by strains and P, (n, m + 1, m + 1)."""
        raise NotImplementedError

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`: N in N, moments in N mm."""
        return self.first(strains, pressure)[:, :-1]

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self.second(strains, pressure)[:, :-1, :-1]

    def chamber(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self.first(strains, pressure)[:, -1]

    def chamber_gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self.second(strains, pressure)[:, :-1, -1]

    def chamber_slope(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return -self.second(strains, pressure)[:, -1, -1]


@dataclasses.dataclass(frozen=True)
class SectionLaw(Derived):
    """Φ of the line of centroids by strains and pressure; a `rod.law.Law`.

    Attributes:
        table: by u and P in MPa.
        chart: what u are.
        strains: names of λ and c, of `rod.layout.STRAINS`.
    """

    table: Table
    chart: Chart
    strains: tuple[str, ...] = PLANE
    _known: list[_Known] = dataclasses.field(
        default_factory=list, init=False, repr=False, compare=False
    )

    def _at(self, strains: Floats, pressure: float) -> _Known:
        """All of Φ somewhere. A step of a motion asks for its parts one by one at a few places."""
        for known in self._known:
            if known.pressure == pressure and np.array_equal(known.strains, strains):
                return known
        value, first, second = self.whole(strains[None], np.array([pressure]))
        found = _Known(pressure, strains.copy(), value[0], first[0], second[0])
        if len(strains) <= _KEPT:
            self._known[:] = [found, *self._known[: _PLACES - 1]]
        return found

    def whole(self, strains: Floats, pressures: Floats) -> Sections:
        """See `rod.law.whole`."""
        k, n, m = strains.shape
        each = np.repeat(pressures, n)
        place, turn, bent = self.chart.placed(strains.reshape(k * n, m), each)
        value, slopes, own = self.table.whole(place.reshape(k, n, m), pressures)
        turn = turn.reshape(k, n, m + 1, m + 1)
        first = (slopes[..., None, :] @ turn)[..., 0, :]
        second = np.swapaxes(turn, -1, -2) @ own @ turn
        second += bent(slopes.reshape(k * n, m + 1)[:, :-1]).reshape(turn.shape)
        return Sections(value, first, second)

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by strains and P, (n, m + 1)."""
        return self._at(strains, pressure).first.copy()

    def second(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ by strains and P, (n, m + 1, m + 1)."""
        return self._at(strains, pressure).second.copy()

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self._at(strains, pressure).value.copy()

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`."""
        low, high = self.table.axes[-1].lines[[0, -1]].tolist()
        slack = _OUTSIDE * (high - low)
        if not low - slack <= pressure <= high + slack:
            return f"{1e3 * pressure:.6g} kPa in a table from {1e3 * low:.6g} to {1e3 * high:.6g}"
        place = self.chart.place(strains, pressure)
        beyond = np.maximum(place - 1.0, -place)
        worst = np.unravel_index(np.argmax(beyond), place.shape)
        if not beyond[worst] > _OUTSIDE:
            return ""
        piece, number = (int(index) for index in worst)
        ends = np.tile(place[piece], (2, 1))
        ends[:, number] = 0.0, 1.0
        pressures = np.full((2, 1), pressure)
        reach = self.chart.strains(np.column_stack([ends, pressures]))[:, number].tolist()
        value = float(strains[piece, number])
        factor, unit = (1.0, "") if number == 0 else (1e3, " 1/m")
        return (
            f"{self.strains[number].replace('_', ' ')} {factor * value:.6g}{unit} at "
            f"{1e3 * pressure:.6g} kPa, in a table from {factor * reach[0]:.6g} to "
            f"{factor * reach[1]:.6g}{unit}"
        )

    def free(self, pressure: float, near: Free) -> Free:
        """Where no force acts.

        Args:
            pressure: MPa.
            near: where Newton's method begins.

        Raises:
            ValueError: no such state is in the table.
        """
        at = np.array([[getattr(near, name) for name in self.strains]])
        for _ in range(_STEPS):
            step = np.linalg.solve(self.hessian(at, pressure)[0], self.gradient(at, pressure)[0])
            turn = self.chart.first(at, pressure)[0, :-1, :-1]
            size = float(np.abs(turn @ step).max())
            at = at - step * min(1.0, _FURTHEST / max(size, _CLOSE))
            if size < _CLOSE:
                break
        else:
            raise ValueError(f"no free state of the table at {1e3 * pressure:.6g} kPa")
        if beyond := self.outside(at, pressure):
            raise ValueError(f"the free state at {1e3 * pressure:.6g} kPa is outside: {beyond}")
        return Free(**dict(zip(self.strains, at[0].tolist(), strict=True)))

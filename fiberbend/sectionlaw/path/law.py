"""The law of a section about its free states, as a rod takes it."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import numpy.typing as npt

from fiberbend.sectionlaw.law import Derived, Free
from fiberbend.sectionlaw.path.chart import PathChart
from fiberbend.sectionlaw.path.curve import Curve
from fiberbend.sectionlaw.path.terms import VARIABLES, lowered, monomials, powers_of
from rod.functions import Floats

SPACE = ("stretch", "curvature", "side_curvature", "twist")
_OUTSIDE = 1e-9
_PLACES, _KEPT = 3, 1000
"""Places that a law remembers, of no more sections."""
_STEPS, _CLOSE, _ROUND_OFF = 50, 1e-11, 1e-13
_PAIRS = [(i, j) for i in range(VARIABLES) for j in range(i, VARIABLES)]


@dataclasses.dataclass(frozen=True)
class _Known:
    """Φ, (n,), and its derivatives by strains and P at strains, (n, 4), and a pressure."""

    pressure: float
    strains: Floats
    value: Floats
    first: Floats
    second: Floats


@dataclasses.dataclass(frozen=True)
class PathLaw(Derived):
    """Φ(ε; P) = Σ_k c_k(P) u^p_k, u about the free state at P; a `rod.law.Law`.

    Forces, stiffnesses and the area of the chamber are exact derivatives of it.

    Attributes:
        chart: what u are.
        degree: of the polynomials in u.
        coefficients: c by P, (k,), N.
        alike: bent alike in all directions, so that both curvatures share a range.
    """

    chart: PathChart
    degree: int
    coefficients: Curve
    alike: bool = False
    _known: list[_Known] = dataclasses.field(
        default_factory=list, init=False, repr=False, compare=False
    )

    @property
    def strains(self) -> tuple[str, ...]:
        """Names of the strains."""
        return SPACE

    @property
    def pressures(self) -> tuple[float, float]:
        """Least and greatest, MPa."""
        low, high = self.coefficients.lines[[0, -1]].tolist()
        return low, high

    @functools.cached_property
    def powers(self) -> npt.NDArray[np.intp]:
        """Of the monomials, (k, 4)."""
        return np.array(powers_of(self.degree), dtype=np.intp)

    def by_place(self, u: Floats, pressure: float) -> tuple[Floats, Floats, Floats]:
        """Φ, ∂Φ and ∂²Φ by u and P: (n,), (n, 5) and (n, 5, 5).

        Args:
            u: (n, 4).
            pressure: P, MPa.
        """
        c = np.array(self.coefficients.at(pressure))
        slopes = [lowered(c[:2], self.powers, i) for i in range(VARIABLES)]
        bent = [lowered(slopes[i][0], self.powers, j) for i, j in _PAIRS]
        rows = [*c, *(each for pair in slopes for each in pair), *bent]
        found = monomials(u, self.powers) @ np.array(rows).T
        first, second = np.empty((len(u), 5)), np.empty((len(u), 5, 5))
        first[:, 4], second[:, 4, 4] = found[:, 1], found[:, 2]
        for i in range(VARIABLES):
            first[:, i] = found[:, 3 + 2 * i]
            second[:, i, 4] = second[:, 4, i] = found[:, 4 + 2 * i]
        for number, (i, j) in enumerate(_PAIRS, 3 + 2 * VARIABLES):
            second[:, i, j] = second[:, j, i] = found[:, number]
        return found[:, 0], first, second

    def _at(self, strains: Floats, pressure: float) -> _Known:
        """All of Φ somewhere. A state asks for its parts one by one at the same place."""
        for known in self._known:
            if known.pressure == pressure and np.array_equal(known.strains, strains):
                return known
        u, turn, mixed, bent = self.chart.placed(strains, pressure)
        value, slopes, own = self.by_place(u, pressure)
        first = (slopes[:, None] @ turn)[:, 0]
        second = turn.transpose(0, 2, 1) @ own @ turn
        more = slopes[:, :4] @ mixed
        second[:, :4, 4] += more
        second[:, 4, :4] += more
        second[:, 4, 4] += np.sum(slopes[:, :4] * bent, axis=1)
        found = _Known(pressure, strains.copy(), value, first, second)
        if len(strains) <= _KEPT:
            self._known[:] = [found, *self._known[: _PLACES - 1]]
        return found

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        return self._at(strains, pressure).value.copy()

    def first(self, strains: Floats, pressure: float) -> Floats:
        """∂Φ by strains and P, (n, 5)."""
        return self._at(strains, pressure).first.copy()

    def second(self, strains: Floats, pressure: float) -> Floats:
        """∂²Φ by strains and P, (n, 5, 5)."""
        return self._at(strains, pressure).second.copy()

    def outside(self, strains: Floats, pressure: float) -> str:
        """See `rod.law.Law`."""
        low, high = self.pressures
        slack = _OUTSIDE * (high - low)
        if not low - slack <= pressure <= high + slack:
            return f"{1e3 * pressure:.6g} kPa in a law from {1e3 * low:.6g} to {1e3 * high:.6g}"
        u = self.chart.place(strains, pressure)
        size = np.abs(u)
        if self.alike:
            size[:, 1] = size[:, 2] = np.hypot(u[:, 1], u[:, 2])
        worst = np.unravel_index(np.argmax(size), size.shape)
        if not size[worst] > 1.0 + _OUTSIDE:
            return ""
        piece, number = (int(index) for index in worst)
        sizes = self.chart.at(pressure)
        free, name = self.chart.free(pressure), SPACE[number].replace("_", " ")
        if number == 0:
            reach = sizes[0]
            own = abs(float(u[piece, 0])) * reach
            return (
                f"stretch by forces {own:.6g} at {1e3 * pressure:.6g} kPa, in a law up to "
                f"{reach:.6g} of them"
            )
        value, reach = float(strains[piece, number]), sizes[number]
        if self.alike and number == 1:
            value = float(np.hypot(*(strains[piece, 1:3] - free[1:3]))) + float(free[1])
        return (
            f"{name} {1e3 * value:.6g} 1/m at {1e3 * pressure:.6g} kPa, in a law from "
            f"{1e3 * (free[number] - reach):.6g} to {1e3 * (free[number] + reach):.6g} 1/m"
        )

    def free_at(self, pressure: float) -> Free:
        """Where no force acts.

        Args:
            pressure: MPa.

        Raises:
            ValueError: no such state is in the range.
        """
        at = self.chart.free(pressure)[None].copy()
        sizes = self.chart.at(pressure)
        for _ in range(_STEPS):
            step = np.linalg.solve(self.hessian(at, pressure)[0], self.gradient(at, pressure)[0])
            at = at - step
            if np.all(np.abs(step) < _CLOSE * sizes + _ROUND_OFF):
                break
        else:
            raise ValueError(f"no free state of the law at {1e3 * pressure:.6g} kPa")
        if beyond := self.outside(at, pressure):
            raise ValueError(f"the free state at {1e3 * pressure:.6g} kPa is outside: {beyond}")
        return Free(*at[0].tolist())

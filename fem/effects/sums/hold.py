"""Uniform bending with stretch, bend or twist of the centre-line held at given values."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from analytic.path import centre_line
from fem.effects.effect import Effect, Natural
from fem.effects.sums.functionals import Functionals, Linked
from fem.kinematics.kinematics import Kinematics
from fem.kinematics.uniform import AXES, STRETCH, Uniform
from geometry.mesh.centroid import section_fit

Floats = npt.NDArray[np.float64]

HOLD = "hold"
LENGTHENED, BEND, SIDE_BEND, TWISTED = (f"{HOLD} {n}" for n in ("stretch", "bend", "side", "twist"))
"""Names of what can be held, and of the forces that hold it."""
_RATES = {BEND: 0, SIDE_BEND: 1, TWISTED: 2}
_PUSH = 1e-30
_DIFFERENCE = 1e-5
"""Part of their size by which variables are moved for second derivatives; the error, 1e-10, makes
the tangent no worse."""


class Hold(Effect):
    """Π = −f·(c − b) + Σ μ_i (Ḡ_i − G_i(q, b)), G of the centroids' line: its length, its turns.

    c is the centroid of all inside the winding, with the images of its axes where the body bends to
    the side and the section may turn in its frame; q are the scalars of uniform bending, Ḡ grows
    from its value at rest with the share h. Each μ_i is the work-conjugate of what it holds: the
    axial force in N, the moments about d1 and d2 and the torque about the line in N mm. What is not
    held is free, and its force zero. Where a force or moment could not be in balance along a line
    that bends or twists, the rest is borne along it by f, which is spread over the section by the
    weights of the centroid: as a guide without friction does.

    Args:
        targets: by name, the stretch, or the angle over the whole length in rad.
    """

    shares: ClassVar = (HOLD,)

    def __init__(self, targets: Mapping[str, float]) -> None:
        self.targets = dict(targets)

    def discrete(self, body: Kinematics) -> Held:
        """The potential of the forces that hold it."""
        assert isinstance(body, Uniform), "only uniform bending is held"
        return Held(body, self.targets)


class Held(Linked):
    """The potential of `Hold` on what is modelled, a part of the whole."""

    def __init__(self, body: Uniform, targets: Mapping[str, float]) -> None:
        rows, kept, rest = section_fit(body.domain.data)
        # centroid, and images of the axes where no symmetry keeps them
        self._start: Floats = np.array([[*rest, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
        sums, components = range(3 if body.sideways else 1), range(body.components)
        self._places = [(k, i) for k in sums for i in components if kept[k, i]]
        start = np.array([self._start[place] for place in self._places])
        functionals = Functionals.of_nodes(body, rows, self._places, start)
        self._uniform, self._part = body, 1 / body.symmetry_factor
        # a turn that its symmetry keeps from it is held already
        turns = {name for name, axis in _RATES.items() if axis in self._axes(body)}
        self.names = [name for name in targets if name in turns or name == LENGTHENED]
        away = [name for name in targets if name not in self.names and targets[name]]
        if away:
            raise ValueError(f"{', '.join(away)}: the kinematics has no such turn")
        length = body.length
        self._from = np.array([length * (name == LENGTHENED) for name in self.names])
        self.aim(targets)
        levers = {n: self._part * (length if n == LENGTHENED else 1.0) for n in self.names}
        more = {name: Natural(0.0, lever, False, True) for name, lever in levers.items()}
        number = np.array([k for k, _ in self._places])
        lengths = np.where(number == 0, body.span, 1.0)
        moments = np.where(number > 0, body.span, 1.0)
        super().__init__(body, functionals, "hold section", lengths, moments, more)
        self._variables = [*body.natural, *self.at]
        self._plane = self._places == [(0, 1)] and not (body.twisted or body.sideways)
        height = 1 / body.size_of(body.natural[0])
        kinds = {STRETCH: 1.0} | dict.fromkeys(AXES, 1 / height)
        kinds |= {n: 1.0 if k else height for n, k in zip(self.at, number, strict=True)}
        self._steps = np.array([_DIFFERENCE * kinds[name] for name in self._variables])
        self._known_at: tuple[float, ...] = ()
        self._first_known: Floats | None = None
        self._second_known: Floats | None = None
        body.scalar(HOLD)
        self.pair_units = {n: ("N", "mm") if n == LENGTHENED else ("Nmm", "rad") for n in targets}
        self._targets = dict(targets)

    def aim(self, targets: Mapping[str, float]) -> None:
        """Hold the same at other values.

        Args:
            targets: by name, as `Hold` has them.
        """
        length = self._uniform.length
        ends = [targets[n] * (length if n == LENGTHENED else 1.0) for n in self.names]
        self._way: Floats = np.array(ends) - self._from

    @staticmethod
    def _axes(body: Uniform) -> set[int]:
        """Axes about which its sections turn."""
        return {AXES[name] for name in body.natural if name in AXES}

    # --- the line -------------------------------------------------------------------------------

    def _line(self, values: Any) -> Any:
        """G of all variables, (..., n) of (..., v); analytic. In a plane |g| = λ + k c."""
        if self._plane:
            k, stretch, y = values
            found = {LENGTHENED: abs(stretch + k * y), BEND: k}
            return self._uniform.length * np.array([found[name] for name in self.names])
        shape = values.shape[:-1]
        spin = np.zeros((*shape, 3), dtype=values.dtype)
        section = np.tile(self._start.astype(values.dtype), (*shape, 1, 1))
        stretch = values[..., self._variables.index(STRETCH)]
        for name, value in zip(self._variables, np.moveaxis(values, -1, 0), strict=True):
            if name in AXES:
                spin[..., AXES[name]] = value
        for name, place in zip(self.at, self._places, strict=True):
            section[(..., *place)] = values[..., self._variables.index(name)]
        centre, a_x, a_y = np.moveaxis(section, -2, 0)
        across = (a_x, a_y) if self._uniform.sideways else None
        length, rates, _ = centre_line(spin, stretch, centre, across)
        lines = [length if n == LENGTHENED else rates[..., _RATES[n]] for n in self.names]
        return self._uniform.length * np.stack(lines, axis=-1)

    def _gradient(self, values: Floats) -> Floats:
        """∂G/∂(variables), (..., n, v), by complex steps; of a bend in its plane by hand."""
        if self._plane:
            k, stretch, y = np.moveaxis(values, -1, 0)
            sign, none = np.copysign(1.0, stretch + k * y), np.zeros_like(k)
            rows = {LENGTHENED: [sign * y, sign, sign * k], BEND: [none + 1.0, none, none]}
            found = [np.stack(rows[name], axis=-1) for name in self.names]
            return self._uniform.length * np.stack(found, axis=-2)
        moved = values[..., None, :] + 1j * _PUSH * np.eye(values.shape[-1])
        slopes: Floats = self._line(moved).imag / _PUSH
        return np.swapaxes(slopes, -1, -2)

    def _at(self) -> tuple[float, ...]:
        """Values of all variables; what was found at others is forgotten."""
        values = tuple(self.own(self._variables).tolist())
        if values != self._known_at:
            self._known_at = values
            self._first_known = self._second_known = None
        return values

    @property
    def _first(self) -> Floats:
        """∂G/∂(variables) at the present state, (n, v)."""
        values = np.array(self._at())
        if self._first_known is None:
            self._first_known = self._gradient(values)
        return self._first_known

    @property
    def _second(self) -> Floats:
        """∂²G/∂(variables)² at the present state, (n, v, v)."""
        values = np.array(self._at())
        if self._second_known is None:
            moves = np.diag(self._steps)
            # all at once: numpy's calls cost more than what they do
            change = self._gradient(values + moves) - self._gradient(values - moves)
            second = np.moveaxis(change / (2 * self._steps[:, None, None]), 0, -1)
            self._second_known = (second + second.transpose(0, 2, 1)) / 2
        return self._second_known

    def _goals(self) -> Floats:
        """Ḡ at the present share."""
        goals: Floats = self._from + self.scalar(HOLD) * self._way
        return goals

    # --- what a scene asks ----------------------------------------------------------------------

    def value(self) -> float:
        """Nothing where the equations hold."""
        return 0.0

    def pairs(self) -> dict[str, tuple[float, float]]:
        """What holds it and what is held; what symmetry keeps costs nothing."""
        held = zip(self.own(self.names).tolist(), self._goals().tolist(), strict=True)
        return dict.fromkeys(self._targets, (0.0, 0.0)) | dict(zip(self.names, held, strict=True))

    def law(self) -> Floats:
        """Σ μ_i ∂G_i/∂b."""
        slopes = self._first[:, len(self._uniform.natural) :]
        found: Floats = self._part * (self.own(self.names) @ slopes)
        return found

    def law_rate(self, name: str) -> Floats:
        """By places and scalars, and by μ."""
        first = len(self._uniform.natural)
        if name in self.names:
            return self._part * self._first[self.names.index(name), first:]
        if name in self._variables:
            column = self._second[:, first:, self._variables.index(name)]
            found: Floats = self._part * (self.own(self.names) @ column)
            return found
        return np.zeros(len(self.at))

    def others(self, name: str) -> float:
        """Of μ G − Ḡ; of a scalar Σ μ_i ∂G_i/∂q; none of the share, whose work is in pairs."""
        if name in self.names:
            number = self.names.index(name)
            return self._part * float(
                self._line(self.own(self._variables))[number] - self._goals()[number]
            )
        if name in self._uniform.natural:
            column = self._first[:, self._variables.index(name)]
            return self._part * float(self.own(self.names) @ column)
        return 0.0

    def others_rate(self, first: str, second: str) -> float:
        """∂²U of scalars, μ, places and the share."""
        if second in self.names:
            first, second = second, first
        if first in self.names:
            number = self.names.index(first)
            if second == HOLD:
                return self._part * float(self._way[number])
            if second in self._variables:
                slope = self._first[number, self._variables.index(second)]
                return -self._part * float(slope)
            return 0.0
        if first in self._variables and second in self._variables:
            i, j = self._variables.index(first), self._variables.index(second)
            return -self._part * float(self.own(self.names) @ self._second[:, i, j])
        return 0.0

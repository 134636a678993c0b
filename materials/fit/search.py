"""The numbers of a form that come nearest to tests: moduli in closed form, pure numbers by search.

Variable projection (G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432): stresses
are linear in moduli, which follow from the pure numbers by least squares; only these are searched
for, from many starts.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import least_squares

from materials.fit import cone, drucker
from materials.fit.form import Form, Numbers
from materials.fit.modes import Measurement
from materials.laws.law import Parameter
from materials.stretches import Floats

LEAST, MOST = 0.02, 1e4
"""Magnitudes of pure numbers: beyond these a law has turned into another one."""
_STARTS = {1: (0.3, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 512.0), 2: (1.0, 2.0, 4.0, 8.0)}
_MANY = (1.3, 3.0, 7.0)
_POLISHED = 5
_SAME, _EXACT = 1e-9, 1e-12
"""Parts of a sum of squares by which two are the same, and of the tests' own that are nothing."""


@dataclasses.dataclass(frozen=True, eq=False)
class Found:
    """The best numbers.

    Attributes:
        moduli: in MPa, (k,).
        shape: pure numbers, (q,).
        cost: sum of the squares of the weighted residuals.
        active: gradients of conditions that hold the fit back, by all parameters, (a, k + q).
    """

    moduli: Floats
    shape: Floats
    cost: float
    active: Floats


class Problem:
    """Least squares of a form against weighted tests.

    Args:
        form: the form.
        tests: what was measured.
        weights: of each test a weight per point, 1/MPa.
        reach: greatest stretch of the states that have to be stable; None: not asked for.
    """

    def __init__(
        self,
        form: Form,
        tests: Sequence[Measurement],
        weights: Sequence[Floats],
        reach: float | None,
    ) -> None:
        self.form, self.tests, self.weights = form, tests, weights
        self.right = np.concatenate([w * t.stress for t, w in zip(tests, weights, strict=True)])
        self._states = None if reach is None else drucker.states(reach)
        self._rest = np.zeros((1, 3))

    def matrix(self, shape: Numbers) -> Floats:
        """Weighted stress of each modulus at 1 MPa, (n, k); NaN where there is none."""
        parts = zip(self.tests, self.weights, strict=True)
        return np.concatenate(
            [w[:, None] * self.form.stress(t.mode, t.stretch, shape) for t, w in parts]
        )

    def solve(self, shape: Numbers) -> cone.Answer | None:
        """The best moduli for pure numbers; None where a test has no stress."""
        matrix = self.matrix(shape)
        if not np.isfinite(matrix).all():
            return None
        rest = drucker.tangents(self.form, shape, self._rest)
        signs = [p.allowed == "above zero" for p in self.form.moduli]
        rows = np.vstack([rest[:, 0, 0, 0], np.eye(len(signs))[signs]])
        tangents = np.zeros((len(signs), 0, 2, 2))
        if self._states is not None:
            tangents = drucker.tangents(self.form, shape, self._states) - drucker.MARGIN * rest
        try:
            return cone.solve(matrix, self.right, tangents, rows)
        except ValueError:
            return None

    def residuals(self, shape: Numbers) -> Floats:
        """Weighted residuals with the best moduli; large ones where there are none."""
        answer = self.solve(shape)
        if answer is None:
            return 10 * self.right
        return np.asarray(self.matrix(shape) @ answer.moduli - self.right)

    def found(self, shape: Floats) -> Found:
        """The best moduli for pure numbers, and what holds them back.

        Raises:
            ValueError: there are none.
        """
        answer = self.solve(shape)
        if answer is None:
            raise ValueError(f"{self.form.name} has no stable numbers that fit")
        residuals = self.matrix(shape) @ answer.moduli - self.right
        slopes = np.zeros((len(answer.active), len(shape)))
        for j in range(len(shape)):
            step = 1e-6 * abs(shape[j])
            sides = []
            for sign in (1, -1):
                moved = shape.copy()
                moved[j] += sign * step
                sides.append(self._conditions(answer, moved) @ answer.moduli)
            slopes[:, j] = (sides[0] - sides[1]) / (2 * step)
        active = np.hstack([answer.active, slopes])
        return Found(answer.moduli, shape, float(residuals @ residuals), active)

    def _conditions(self, answer: cone.Answer, shape: Floats) -> Floats:
        """Rows of the active conditions at other pure numbers."""
        rows = answer.active.copy()
        places = [i for i, state in enumerate(answer.states) if state >= 0]
        if places and self._states is not None:
            rest = drucker.tangents(self.form, shape, self._rest)
            at = self._states[[answer.states[i] for i in places]]
            tangents = drucker.tangents(self.form, shape, at) - drucker.MARGIN * rest
            v = answer.directions[places]
            rows[places] = np.einsum("ksab,sa,sb->sk", tangents, v, v)
        return rows


def search(problem: Problem, starts: Sequence[Floats] | None = None) -> Found:
    """The best numbers of a problem.

    Args:
        problem: the problem.
        starts: pure numbers to begin from; by default many.

    Raises:
        ValueError: none fit.
    """
    shape = problem.form.shape
    if not shape:
        return problem.found(np.zeros(0))
    if starts is None:
        starts = _screened(problem.residuals, _grid(shape))
    best: Floats | None = None
    least = math.inf
    for start in starts:
        point, cost = _polished(problem, start)
        if cost < least * (1 - _SAME):
            best, least = point, cost
    if best is None:
        raise ValueError(f"{problem.form.name} has no stable numbers that fit")
    return problem.found(_ordered(problem, best, least))


def _ordered(problem: Problem, point: Floats, cost: float) -> Floats:
    """The same numbers with terms that may change places in the order of their magnitudes."""
    least = max(cost, _EXACT * float(problem.right @ problem.right))
    for other in map(np.array, itertools.permutations(sorted(point.tolist(), key=abs))):
        rest = problem.residuals(other)
        if abs(float(rest @ rest) - cost) <= _SAME * least:
            return np.asarray(other)
    return point


def limits(shape: Sequence[Parameter]) -> tuple[Floats, Floats]:
    """Least and greatest magnitudes of pure numbers."""
    return np.full(len(shape), LEAST), np.array([min(p.most, MOST) for p in shape])


def _polished(problem: Problem, start: Floats) -> tuple[Floats, float]:
    """From a start to the nearest minimum, each number with its sign."""
    least, most = (np.log(edge) for edge in limits(problem.form.shape))
    sign = np.sign(start)
    done = least_squares(
        lambda x: problem.residuals(sign * np.exp(x)),
        np.clip(np.log(np.abs(start)), least + 1e-6, most - 1e-6),
        bounds=(least, most),
        xtol=1e-12,
        ftol=1e-14,
        gtol=1e-14,
        max_nfev=200,
    )
    return sign * np.exp(done.x), 2 * float(done.cost)


def _grid(shape: Sequence[Parameter]) -> list[Floats]:
    """Starts: magnitudes apart by factors of two to three, with both signs where they may be."""
    sizes = _STARTS.get(len(shape), _MANY)
    every = []
    for parameter in shape:
        there = [size for size in sizes if size <= parameter.most]
        both = parameter.allowed != "above zero"
        every.append([*there, *(-size for size in there)] if both else there)
    return [np.array(point) for point in itertools.product(*every)]


def _screened(residuals: Callable[[Floats], Floats], grid: Sequence[Floats]) -> list[Floats]:
    """The best of a grid, no two of which have the same residuals."""
    costs = []
    for point in grid:
        rest = residuals(point)
        costs.append(float(rest @ rest))
    kept: list[int] = []
    for i in np.argsort(costs):
        if all(abs(costs[i] - costs[j]) > _SAME * costs[i] for j in kept):
            kept.append(int(i))
        if len(kept) == _POLISHED:
            break
    return [grid[i] for i in kept]

"""A law fitted to tests of rubber: its numbers, their errors, and what they say of other tests."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Literal

import numpy as np

from materials.fit import drucker
from materials.fit.form import Form, form_of
from materials.fit.modes import MODES, Measurement, Mode
from materials.fit.noise import Noise, noise_of
from materials.fit.search import Found, Problem, limits, search
from materials.material import Material
from materials.stretches import Floats

Weights = Literal["plain", "relative"]
_LOOSE = 10.0
_FLOOR = 0.05
"""Part of a mode's greatest stress below which relative errors are not asked for."""


@dataclasses.dataclass(frozen=True, eq=False)
class Fit:
    """A law with numbers from tests.

    Attributes:
        form: what was fitted.
        tests: the tests, their points in the order of stretch.
        weights: how they were weighted.
        reach: greatest stretch up to which all states were to be stable; None: not asked for.
        moduli: in MPa, (k,).
        shape: pure numbers, (q,).
        covariance: of moduli and pure numbers, (k + q, k + q).
        noise: what the residuals are taken for.
        held: stability, or the sign of a modulus, holds the fit back from the nearest numbers.
        free_rms: root mean square of the weighted residuals of those nearest numbers, over that of
            this fit; 1 where the fit is not held.
        stability: how far the law is stable.
        unsettled: parameters that the tests do not settle: at the end of what was searched, or with
            an error above their value.
    """

    form: Form
    tests: tuple[Measurement, ...]
    weights: Weights
    reach: float | None
    moduli: Floats
    shape: Floats
    covariance: Floats
    noise: Noise
    held: bool
    free_rms: float
    stability: drucker.Stability
    unsettled: tuple[str, ...]

    @property
    def parameters(self) -> dict[str, float]:
        """Values by name, MPa and pure numbers."""
        return self.form.named(self.moduli, self.shape)

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors by name, in the units of the parameters."""
        return self.form.named(*np.split(np.sqrt(np.diag(self.covariance)), [len(self.moduli)]))

    @property
    def values(self) -> Floats:
        """Moduli and pure numbers, in the order of the covariance."""
        return np.concatenate([self.moduli, self.shape])

    @property
    def material(self) -> Material:
        """The law with its numbers.

        Raises:
            ValueError: the law does not take them.
        """
        return self.with_values(self.values)

    def with_values(self, values: Floats) -> Material:
        """The law with other numbers, in the order of the covariance."""
        return Material(self.form.law.name, self.form.named(*self._split(values)))

    def stress(self, mode: Mode, stretch: Floats) -> Floats:
        """Nominal stress in MPa, (n,); NaN beyond the law's limit."""
        return np.asarray(self.form.stress(mode, stretch, self.shape) @ self.moduli)

    def stress_error(self, mode: Mode, stretch: Floats) -> Floats:
        """Standard error of the stress by that of the parameters, MPa, (n,)."""
        slopes = _slopes(self.form, self.moduli, self.shape, mode, stretch)
        return np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", slopes, self.covariance, slopes), 0.0))

    def residuals(self, test: Measurement) -> Floats:
        """Stress of the law less that of a test, MPa."""
        return self.stress(test.mode, test.stretch) - test.stress

    @property
    def rms(self) -> float:
        """Root mean square of all residuals, in parts of the greatest stress of their mode."""
        most = _greatest(self.tests)
        rest = [self.residuals(t) / most[t.mode.name] for t in self.tests]
        return float(np.sqrt(np.mean(np.concatenate(rest) ** 2)))

    @property
    def cancelling(self) -> float:
        """How many times the stiffness at rest its terms are, whose signs then differ; 1 or more.

        Where two terms have become nearly one, their difference alone is settled by tests.
        """
        rest = drucker.tangents(self.form, self.shape, np.zeros((1, 3)))[:, 0, 0, 0] * self.moduli
        return float(np.abs(rest).sum() / max(abs(rest.sum()), 1e-300))

    @property
    def loose(self) -> bool:
        """Whether its numbers say little: terms that cancel, or errors ten times a number."""
        wide = np.sqrt(np.diag(self.covariance)) > _LOOSE * np.abs(self.values)
        return self.cancelling > _LOOSE or bool(wide.any())

    @property
    def criterion(self) -> float:
        """Akaike's, corrected for few points, of correlated residuals; less is better.

        It compares laws fitted to the same tests: what a parameter gains against what it costs.
        """
        points = sum(self.noise.lengths)
        modes = len({test.mode.name for test in self.tests})
        # φ and the variance of each mode are fitted too
        count = len(self.values) + 1 + modes
        few = 2 * count * (count + 1) / (points - count - 1) if points > count + 1 else np.inf
        return float(self.noise.deviance + 2 * count + few)

    def resampled(self, source: np.random.Generator) -> Floats:
        """Values fitted to another draw of the tests: the law's stresses with such residuals."""
        lengths = [len(t.stretch) for t in self.tests]
        weights = _weights(self.tests, self.weights)
        drawn = np.split(self.noise.draw(source), np.cumsum(lengths)[:-1])
        tests = [
            dataclasses.replace(t, stress=self.stress(t.mode, t.stretch) + e / w)
            for t, e, w in zip(self.tests, drawn, weights, strict=True)
        ]
        starts = [self.shape] if len(self.shape) else None
        _, _, found = _nearest(self.form, tests, weights, self.reach, starts)
        return np.concatenate([found.moduli, found.shape])

    def _split(self, values: Floats) -> tuple[Floats, Floats]:
        return values[: len(self.moduli)], values[len(self.moduli) :]


def fit_law(
    law: str | Form,
    tests: Sequence[Measurement],
    weights: Weights = "plain",
    reach: float | None = None,
    stable: bool = True,
) -> Fit:
    """Fit a law to tests.

    All modes weigh alike: residuals of stress are divided by the greatest stress of their mode and
    by the root of its points. Within a mode plain weights are the same for all points, so that one
    test is fitted by ordinary least squares; relative ones are one over the stress, from 5 % of
    the greatest on.

    Args:
        law: name of a law, with all its terms, or with a number of them such as "yeoh-2".
        tests: at least one.
        weights: how points of a mode weigh.
        reach: greatest stretch of the states that have to be stable; by default that of the tests.
        stable: ask for stability at all.

    Raises:
        ValueError: an unknown law, too few points, or no numbers that fit.
    """
    form = law if isinstance(law, Form) else form_of(law)
    ordered = [test.sorted() for test in tests]
    points = {(t.mode.name, s) for t in ordered for s in t.stretch if s != 1}
    if len(points) <= len(form.parameters):
        raise ValueError(
            f"{form.name} has {len(form.parameters)} parameters, expected more points at different "
            f"stretches than that, found {len(points)}"
        )
    if not any(np.abs(test.stress).max() > 0 for test in ordered):
        raise ValueError("all stresses are zero")
    limit = max(reach or 1.0, *(test.greatest for test in ordered), 1.0 + 1e-6)
    return _fitted(form, ordered, weights, limit if stable else None)


def _nearest(
    form: Form,
    tests: Sequence[Measurement],
    weights: Sequence[Floats],
    reach: float | None,
    starts: Sequence[Floats] | None,
) -> tuple[Problem, Found, Found]:
    """The nearest numbers of all, and where these are not stable the nearest of the stable ones."""
    problem = Problem(form, tests, weights, None)
    free = search(problem, starts)
    if reach is None:
        return problem, free, free
    bounded = Problem(form, tests, weights, reach)
    answer = bounded.solve(free.shape)
    if answer is not None and not len(answer.active):
        return problem, free, free
    return bounded, free, search(bounded, starts)


def _fitted(form: Form, tests: Sequence[Measurement], kind: Weights, reach: float | None) -> Fit:
    weights = _weights(tests, kind)
    problem, free, found = _nearest(form, tests, weights, reach, None)
    jacobian = np.concatenate(
        [
            w[:, None] * _slopes(form, found.moduli, found.shape, t.mode, t.stretch)
            for t, w in zip(tests, weights, strict=True)
        ]
    )
    residuals = problem.matrix(found.shape) @ found.moduli - problem.right
    bound = _at_limit(form, found)
    covariance, noise = _errors(jacobian, residuals, found.active, bound, tests)
    values = np.concatenate([found.moduli, found.shape])
    wide = np.sqrt(np.diag(covariance)) > np.abs(values)
    return Fit(
        form,
        tuple(tests),
        kind,
        reach,
        found.moduli,
        found.shape,
        covariance,
        noise,
        bool(len(found.active)),
        float(np.sqrt(free.cost / found.cost)) if found.cost > 0 else 1.0,
        drucker.stability(form, found.moduli, found.shape),
        tuple(p.name for p, b, w in zip(form.parameters, bound, wide, strict=True) if b or w),
    )


def _errors(
    jacobian: Floats,
    residuals: Floats,
    active: Floats,
    bound: Sequence[bool],
    tests: Sequence[Measurement],
) -> tuple[Floats, Noise]:
    """Covariance of the parameters that are free to move, and the noise it comes from."""
    size = np.linalg.norm(jacobian, axis=0)
    size[size == 0] = 1.0
    fixed = np.vstack([active * (1 / size), np.eye(len(size))[list(bound)]])
    ways = np.eye(len(size))
    if len(fixed):
        fixed = fixed / np.maximum(np.linalg.norm(fixed, axis=1, keepdims=True), 1e-300)
        _, values, basis = np.linalg.svd(fixed)
        ways = basis[int((values > 1e-9).sum()) :].T
    modes = list(MODES)
    groups = [modes.index(test.mode.name) for test in tests]
    lengths = [len(test.stretch) for test in tests]
    free = (jacobian / size) @ ways
    noise = noise_of(residuals, free, groups, lengths)
    left, values, turn = np.linalg.svd(free, full_matrices=False)
    # what the tests say nothing of has an error without end, but a finite one
    values = np.maximum(values, 1e-12 * values.max(initial=1e-300))
    inverse = (ways @ (turn.T / values)) / size[:, None]
    return inverse @ noise.spread(left) @ inverse.T, noise


def _at_limit(form: Form, found: Found) -> list[bool]:
    least, most = limits(form.shape)
    at = (np.abs(found.shape) < 1.001 * least) | (np.abs(found.shape) > 0.999 * most)
    return [False] * len(form.moduli) + [bool(b) for b in at]


def _slopes(form: Form, moduli: Floats, shape: Floats, mode: Mode, stretch: Floats) -> Floats:
    """Derivatives of the stress by moduli and pure numbers, (n, k + q)."""
    parts = [form.stress(mode, stretch, shape)]
    for j, value in enumerate(shape):
        step = 1e-5 * abs(value)
        sides = []
        for sign in (1, -1):
            moved = shape.copy()
            moved[j] += sign * step
            sides.append(form.stress(mode, stretch, moved) @ moduli)
        parts.append(((sides[0] - sides[1]) / (2 * step))[:, None])
    return np.hstack(parts)


def _greatest(tests: Sequence[Measurement]) -> dict[str, float]:
    """Greatest stress of each mode."""
    most: dict[str, float] = {}
    for test in tests:
        most[test.mode.name] = max(most.get(test.mode.name, 0.0), float(np.abs(test.stress).max()))
    return {name: value or 1.0 for name, value in most.items()}


def _weights(tests: Sequence[Measurement], kind: Weights) -> list[Floats]:
    most = _greatest(tests)
    count = {name: sum(len(t.stress) for t in tests if t.mode.name == name) for name in most}
    every = []
    for test in tests:
        scale = most[test.mode.name]
        size = np.full(len(test.stress), scale)
        if kind == "relative":
            size = np.maximum(np.abs(test.stress), _FLOOR * scale)
        every.append(1 / (size * np.sqrt(count[test.mode.name])))
    return every

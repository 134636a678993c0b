"""The softest mode of an equilibrium: the eigenvector of the Hessian nearest to zero."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from fem.ranks import total
from fem.solver.bordered import SideCondition
from fem.solver.newton import Newton

Floats = npt.NDArray[np.float64]

ITERATIONS = 40
SETTLED = 1e-4
"""Relative change of the stiffness in an iteration at which the mode is found."""


@dataclasses.dataclass(frozen=True)
class Mode:
    """An eigenvector of the Hessian, (H − μ M) φ = 0, M one on displacements and zero elsewhere.

    Attributes:
        stiffness: μ, N/mm; negative where the equilibrium is unstable.
        w: its fields, owned part, (owned,); their displacements have unit norm over all ranks.
        scalars: its natural scalars, by name.
    """

    stiffness: float
    w: Floats
    scalars: dict[str, float]


def softest_mode(
    newton: Newton,
    natural: Sequence[str],
    conditions: Sequence[SideCondition],
    displacements: npt.NDArray[np.bool_],
    start: Floats,
) -> Mode:
    """Inverse iteration with the tangent at the present state; collective.

    Pressures and natural scalars have no mass: H is the Hessian in all fields and natural scalars,
    and its mode nearest to zero is that which loses stability next, or has lost it. Wriggers and
    Simo 1990, A general procedure for the direct computation of turning and bifurcation points,
    Int. J. Numer. Meth. Engng 30, pp. 155–176, doi 10.1002/nme.1620300110.

    Args:
        newton: solver; its problem is at the equilibrium.
        natural: names of the natural scalars.
        conditions: an equation for each of them.
        displacements: owned dofs of the displacement, (owned,).
        start: a displacement that no symmetry makes orthogonal to the mode, (owned,).

    Raises:
        ZeroDivisionError: the tangent is singular to the last digit.
    """
    newton.problem.predict(None)
    newton.assemble()
    system = newton.factorise(natural, conditions)
    none = np.zeros(len(natural))

    def solve(w: Floats) -> tuple[Floats, Floats]:
        return system.eliminate(newton.solve_linear(w), none)

    mass = displacements & newton.problem.free[: newton.owned]
    stiffness, w, scalars = _iterate(newton, mass, start, solve)
    return Mode(stiffness, w, dict(zip(natural, scalars.tolist(), strict=True)))


def opposite_modes(newton: Newton) -> int:
    """Negative eigenvalues of the tangent for displacements of the opposite symmetry; collective.

    Half a body does not know them. The factor of its own tangent is lost.
    """
    newton.problem.predict(None)
    newton.assemble(opposite=True)
    newton.factor.renew()
    return newton.factor.negative_pivots


def softest_opposite(newton: Newton, displacements: npt.NDArray[np.bool_], start: Floats) -> float:
    """Stiffness of the softest mode of the opposite symmetry, as `softest_mode` has it, N/mm."""
    opposite_modes(newton)
    free = newton.problem.free_opposite
    assert free is not None, "no symmetry halves the body"
    none = np.zeros(0)
    mass = displacements & free[: newton.owned]
    return _iterate(newton, mass, start, lambda w: (newton.solve_linear(w), none))[0]


def _iterate(
    newton: Newton,
    mass: npt.NDArray[np.bool_],
    start: Floats,
    solve: Callable[[Floats], tuple[Floats, Floats]],
) -> tuple[float, Floats, Floats]:
    """Inverse iteration: stiffness, fields and scalars of the softest mode."""

    def dot(a: Floats, b: Floats) -> float:
        return float(total(newton.comm, float(a[mass] @ b[mass])))

    w = np.where(mass, start, 0.0)
    w, scalars = w / np.sqrt(dot(w, w)), np.zeros(0)
    stiffness = np.inf
    for _ in range(ITERATIONS):
        a, scalars = solve(np.where(mass, w, 0.0))
        before, stiffness = stiffness, 1 / dot(w, a)
        size = np.sqrt(dot(a, a))
        w, scalars = a / size, scalars / size
        if abs(stiffness - before) < SETTLED * abs(stiffness):
            break
    return stiffness, w, scalars

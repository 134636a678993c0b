"""What round-off makes of the forces of a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
import numpy.typing as npt

from fem.effects.effect import Discrete
from fem.kinematics.kinematics import Kinematics
from fem.ranks import total

Floats = npt.NDArray[np.float64]

PROBE = 1e-6
"""Part of an element by which nodes are moved to see what a move in their last digit does."""


def probed(body: Kinematics, forces: Callable[[Floats], Floats]) -> Floats:
    """Forces where nodes are moved in their last digit, N, (owned,).

    Args:
        body: the kinematics, at rest.
        forces: sets owned coefficients of the fields, (owned,), and gives their forces, N.
    """
    rest: Floats = body.w.x.array[: body.owned].copy()
    moved = rest.copy()
    moved[body.node_dofs[body.owned_nodes]] += PROBE * body.astray()
    noise = np.finfo(float).eps / PROBE * forces(moved)
    forces(rest)
    return noise


def summed_noise(body: Kinematics, discretes: Iterable[Discrete]) -> float:
    """Norm of the forces that round-off in potentials with code of their own makes, N; collective.

    Args:
        body: the kinematics.
        discretes: the potentials.
    """
    noise = np.zeros(body.local)
    for discrete in discretes:
        discrete.update(body.w.x.array)
        discrete.add_noise(noise)
    return float(np.sqrt(total(body.domain.comm, float(noise @ noise))))


def noise_along(
    body: Kinematics, discretes: Iterable[Discrete], names: Iterable[str]
) -> dict[str, float]:
    """What round-off makes of ∂Π/∂q of global scalars at rest, by name; collective.

    Args:
        body: the kinematics, at rest.
        discretes: the potentials with code of their own.
        names: of the scalars.
    """
    potentials = list(discretes)
    for each in potentials:
        each.update(body.w.x.array)
    squares = {name: sum(each.noise_along(name) for each in potentials) for name in names}
    return {name: float(np.sqrt(total(body.domain.comm, s))) for name, s in squares.items()}

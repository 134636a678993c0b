"""What Newton's method needs of a scene, and of a linear solver."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from fem.kinematics.place import Place

Floats = npt.NDArray[np.float64]


class Problem(Protocol):
    """What Newton needs of a scene.

    Attributes:
        matrix: storage of K.
        free: local dofs that no constraint fixes, (local,).
        free_opposite: the same for displacements of the symmetry opposite to that of half a body;
            None of a whole one.
        volumetric: owned dofs whose residual is a volume, not a force, (owned,).
        volume_scale: what those are measured by, mm³.
        force_noise: norm of the forces that round-off makes, N.
        solid_noise: the part of it that is in the conditions on natural scalars too, N.
    """

    matrix: PETSc.Mat
    free: npt.NDArray[np.bool_]
    free_opposite: npt.NDArray[np.bool_] | None
    volumetric: npt.NDArray[np.bool_]
    volume_scale: float
    force_noise: float
    solid_noise: float

    def set(self, w: Floats) -> None:
        """Take the owned coefficients as the state."""

    def set_scalar(self, name: str, value: float) -> None:
        """Set a global scalar."""

    def scalar(self, name: str) -> float:
        """Value of a global scalar."""

    def residual(self) -> tuple[Floats, float]:
        """R, owned part, (owned,), and a scale of the forces in it, N."""

    def assemble_tangent(self, opposite: bool = False) -> PETSc.Mat:
        """K at the present state; on request for displacements of the opposite symmetry."""

    def load(self, name: str) -> Floats:
        """∂R/∂q of a scalar, owned part, (owned,)."""

    def det_f(self) -> float:
        """Least det F over all ranks."""

    def norm(self, values: Floats) -> float:
        """Euclidean norm over all ranks."""

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Take the last correction, owned part, which the next tangent may use; None: none yet."""

    def place(self) -> Place:
        """Where the unknowns lie, at the present state."""

    @property
    def mixed(self) -> bool:
        """Whether steps with an old tangent lack nothing but `lag`."""

    def lag(self) -> Floats:
        """What a step with the last tangent lacks of the forces, owned part, (owned,), N.

        Forces that a correction has not predicted act along the fibers of that tangent there.
        """

    @property
    def predicted(self) -> Floats:
        """Forces that the last correction has predicted, this rank's, (n,)."""

    @predicted.setter
    def predicted(self, forces: Floats) -> None: ...

    def raise_force_floor(self, floor: float) -> None:
        """Measure forces by no less than this from now on, N."""


class RefusedError(Exception):
    """An iterative solver cannot answer; a direct one may."""


class LinearSolver(Protocol):
    """Solves K x = b with the matrix as it was when last renewed; all calls are collective.

    Attributes:
        seconds: wall time spent in "factor" and in "solve".
        counts: whether it tells negative pivots, and with them stability.
        left: why it goes on as another solver than it began; empty: it does not.
        iterations: of an iterative solver, in all solves; 0 of a direct one.
    """

    seconds: dict[str, float]
    counts: bool
    left: str
    iterations: int

    def renew(self) -> None:
        """Take the matrix as it is now."""

    @property
    def negative_pivots(self) -> int:
        """Number of negative eigenvalues of the matrix (Sylvester's inertia)."""

    def solve(self, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve K x = b."""

    def solve_many(self, columns: Sequence[Floats]) -> list[Floats]:
        """Solve K x = b for owned parts of several right sides."""

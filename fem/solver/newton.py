"""Newton's method on PETSc SNES for the fields and a few global scalars."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem.solver.bordered import BorderedSystem, SideCondition
from fem.solver.factor import Factor
from fem.solver.problem import LinearSolver, Problem
from fem.solver.reuse import Reuse
from fem.solver.slabs import Slabs
from machine.factors import LARGE

Floats = npt.NDArray[np.float64]

INVERTED = "an element turned inside out (least det F {:.3g})"
VALUELESS = "a law has no value at some point: its rubber is beyond its limiting stretch"
FADED = 1e-3
"""Forces count no less than so much of the greatest before: unloaded, nothing else is left."""
PATIENCE = 6
"""Iterations after which a residual that grows makes Newton take the true tangent."""


@dataclasses.dataclass(frozen=True)
class Settings:
    """Limits of one Newton solve.

    Attributes:
        tolerance: of forces, relative to reactions and fiber forces (a thousandth of the greatest
            so far at least) but no finer than round-off, and of volumes, relative to the volume of
            an element; each for itself.
        iterations: most iterations.
        hybrid: use the predicted fiber force in the geometric stiffness.
        reuse: take the last factor again where it converges fast; a solve costs a twentieth of
            a factorisation.
        large: unknowns from which on the first factor is to serve the whole solve.
        iterative: solve linear systems by iteration, without a count of negative pivots.
    """

    tolerance: float = 1e-8
    iterations: int = 11
    hybrid: bool = True
    reuse: bool = True
    large: int = LARGE
    iterative: bool = False


@dataclasses.dataclass(frozen=True)
class Outcome:
    """How a Newton solve ended.

    Attributes:
        converged: True when every residual is below its tolerance.
        iterations: linear solves.
        factorisations: tangents assembled and factorised for them.
        reason: why not, in words; empty when converged.
        history: residuals of forces, volumes and side conditions of every iterate, relative.
        least_det_f: least det F of the last iterate.
        spared: of the iterations, those with an old factor in a solve that one is to serve.
    """

    converged: bool
    iterations: int
    factorisations: int
    reason: str
    history: list[tuple[float, float, float]]
    least_det_f: float
    spared: int = 0

    @property
    def effort(self) -> float:
        """Iterations with a factor each that do as much: two with an old one count as one."""
        return self.iterations - self.spared / 2


class Newton:
    """Full Newton steps on the bordered vector (w, q), K factorised once an iteration.

    The scalars are eliminated: K a = r, K B = columns, then a small dense system. Rows and
    columns of the bordered system may differ.

    Args:
        problem: residual, tangent and scalars.
        comm: communicator.
        settings: limits.

    Attributes:
        seconds: wall time by phase, s.
        owned: number of dofs of the fields that this rank owns.
        spares: one factor is to serve a whole solve.
    """

    def __init__(self, problem: Problem, comm: MPI.Comm, settings: Settings) -> None:
        self.problem = problem
        self.comm = comm
        self.settings = settings
        self.begin()
        owned = len(problem.volumetric)
        free = problem.free[:owned]
        self.factor: LinearSolver
        if settings.iterative:
            self.factor = Slabs(problem.matrix, problem.volumetric, free, problem.place)
        else:
            self.factor = Factor(problem.matrix, volumetric=problem.volumetric, free=free)
        self._assembly = {"residual": 0.0, "tangent": 0.0}
        self._b = problem.matrix.createVecRight()
        self._x = problem.matrix.createVecRight()
        self.owned = self._b.getLocalSize()
        self.spares = problem.mixed and problem.matrix.getSize()[0] >= settings.large
        self.schur: Floats = np.zeros((0, 0))
        """Schur complement of the unknown scalars at the last tangent, in the order given."""

    def begin(self) -> None:
        """Begin with the problem as it is, at rest: what was met before counts no more."""
        # under a load too small to be told from round-off, all is as good as converged
        self.problem.raise_force_floor(self.problem.solid_noise / self.settings.tolerance)

    def spend(self, phase: str, seconds: float) -> None:
        """Add to the wall time of a phase."""
        self._assembly[phase] += seconds

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time by phase."""
        return {**self._assembly, **self.factor.seconds}

    def solve(
        self, w: Floats, unknown: Sequence[str] = (), conditions: Sequence[SideCondition] = ()
    ) -> Outcome:
        """Find w and the unknown scalars from a starting guess.

        Args:
            w: owned coefficients to start from, (owned,).
            unknown: names of the scalars that are found; they start from their present values.
            conditions: as many equations.

        Returns:
            The outcome; when converged the problem holds the solution.

        Raises:
            ValueError: numbers of unknown scalars and conditions differ.
        """
        if len(unknown) != len(conditions):
            raise ValueError("every unknown scalar needs one side condition")
        return _Solve(self, list(unknown), list(conditions)).run(w)

    def negative_pivots(self, natural: Sequence[str] = ()) -> int:
        """Number of negative eigenvalues of the last tangent (Sylvester's inertia).

        Args:
            natural: names of the scalars, the first of the unknown ones, that count as fields.
        """
        block = self.schur[: len(natural), : len(natural)]
        # scaled rows are similar to a symmetric matrix, so that the eigenvalues are real
        bad = int(np.sum(np.linalg.eigvals(block).real < 0)) if len(natural) else 0
        return self.factor.negative_pivots + bad

    def assemble(self, opposite: bool = False) -> None:
        """Assemble the tangent at the present state; see `Problem.assemble_tangent`."""
        start = time.perf_counter()
        self.problem.assemble_tangent(opposite)
        self.spend("tangent", time.perf_counter() - start)

    def factorise(
        self, unknown: Sequence[str], conditions: Sequence[SideCondition]
    ) -> BorderedSystem:
        """Factorise the assembled tangent, and take its rows and columns of scalars.

        Args:
            unknown: names of m scalars that are found.
            conditions: as many side conditions.
        """
        self.factor.renew()
        columns = [self.problem.load(name) for name in unknown]
        free = self.problem.free[: self.owned]
        solve = self.factor.solve_many
        system = BorderedSystem(columns, unknown, conditions, free, solve, self.comm)
        self.schur = system.schur
        return system

    def response(
        self, scalar: str, unknown: Sequence[str] = (), conditions: Sequence[SideCondition] = ()
    ) -> tuple[Floats, dict[str, float]]:
        """Rates of the fields and of unknown scalars with a given one, along the equilibrium.

        The tangent at the present state is assembled and factorised for it.
        """
        self.assemble()
        system = self.factorise(unknown, conditions)
        a = self.solve_linear(self.problem.load(scalar))
        sides = np.array([condition.slope(scalar) for condition in conditions])
        a, q = system.eliminate(a, sides)
        return -a, dict(zip(unknown, -q, strict=True))

    def solve_linear(self, r: Floats) -> Floats:
        """K⁻¹ r with the present factor, owned parts, (owned,)."""
        self._b.array_w[:] = r
        self.factor.solve(self._b, self._x)
        return self._x.array_r.copy()


class _Solve:
    """One SNES solve: the callbacks share its state."""

    def __init__(self, newton: Newton, unknown: list[str], conditions: list[SideCondition]) -> None:
        self.newton = newton
        self.problem = newton.problem
        self.comm = newton.comm
        self.unknown = unknown
        self.conditions = conditions
        self.last = self.comm.rank == self.comm.size - 1
        self.owned = newton.owned
        self.history: list[tuple[float, float, float]] = []
        self.scale = 0.0
        self.least = np.inf
        self.reuse = Reuse(self.comm, newton.settings.reuse, newton.spares)
        self.sizing = newton.problem.free[: self.owned] & ~newton.problem.volumetric
        """Owned dofs by which the size of a step is taken, (owned,)."""
        self.reason = ""

    # --- vectors -------------------------------------------------------------------------------

    def split(self, x: PETSc.Vec) -> tuple[Floats, Floats]:
        """Fields (owned part) and scalars (on every rank) of a bordered vector."""
        array = x.array_r
        scalars = array[self.owned :].copy()
        if self.unknown and self.comm.size > 1:
            scalars = self.comm.bcast(scalars if self.last else None, root=self.comm.size - 1)
        return array[: self.owned].copy(), scalars

    def join(self, x: PETSc.Vec, w: Floats, scalars: Floats) -> None:
        """Write fields and scalars into a bordered vector."""
        array = x.array_w
        array[: self.owned] = w
        if self.last and self.unknown:
            array[self.owned :] = scalars

    # --- callbacks -----------------------------------------------------------------------------

    def function(self, _snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        """Bordered residual; NaN where an element is turned inside out."""
        start = time.perf_counter()
        problem = self.problem
        w, scalars = self.split(x)
        self.at = np.concatenate([w, scalars])
        for name, value in zip(self.unknown, scalars, strict=True):
            problem.set_scalar(name, float(value))
        problem.set(w)
        self.least = problem.det_f()
        if not self.least > 0:
            self.join(f, np.full(self.owned, np.nan), np.full(len(self.unknown), np.nan))
            self.history.append((np.nan, np.nan, np.nan))
            self.newton.spend("residual", time.perf_counter() - start)
            return
        r, scale = problem.residual()
        self.scale = max(scale, 1e-30)
        r[~problem.free[: self.owned]] = 0.0
        g = np.array([condition.value() for condition in self.conditions])
        volumetric = problem.volumetric
        self.history.append(
            (
                problem.norm(r[~volumetric]) / self.scale,
                problem.norm(r[volumetric]) / problem.volume_scale,
                float(np.max(np.abs(g), initial=0.0)),
            )
        )
        self.join(f, r, g)
        self.newton.spend("residual", time.perf_counter() - start)

    def jacobian(self, _snes: PETSc.SNES, _x: PETSc.Vec, _a: PETSc.Mat, _p: PETSc.Mat) -> None:
        """Tangent, its factor, and the bordered system; or the last ones again."""
        if not self.reuse.renews(self.history):
            return
        if self.reuse.effort >= PATIENCE and max(self.history[-1]) > max(self.history[-2]):
            # predicted fiber forces can cycle where fibers are very stiff
            self.problem.predict(None)
        self.newton.assemble()
        self.system = self.newton.factorise(self.unknown, self.conditions)

    def apply(self, _pc: PETSc.PC, r: PETSc.Vec, y: PETSc.Vec) -> None:
        """Solve the bordered system with the factor of K."""
        r_w, r_q = self.split(r)
        hybrid = self.newton.settings.hybrid
        if hybrid and not self.reuse.fresh:
            r_w += self.problem.lag()
            r_q += np.array([condition.lag() for condition in self.conditions])
        a = self.newton.solve_linear(r_w)
        a, q = self.system.eliminate(a, r_q)
        # SNES takes the step x − y, so the correction is −(a, q)
        if hybrid:
            self.problem.predict(-a, dict(zip(self.unknown, -q, strict=True)))
        image = np.concatenate([self.at - np.concatenate([a, q]), self.problem.predicted])
        image = self.reuse.next(image, a[self.sizing])
        if hybrid:
            self.problem.predicted = image[len(self.at) :]
        step = self.at - image[: len(self.at)]
        self.join(y, step[: self.owned], step[self.owned :])

    def _not_a_number(self) -> str:
        """Why the residual has no value."""
        return VALUELESS if self.least > 0 else INVERTED.format(self.least)

    def test(self, _snes: PETSc.SNES, iteration: int, _norms: tuple[float, ...]) -> int:
        """Force, volume and side conditions, each for itself."""
        reasons = PETSc.SNES.ConvergedReason
        force, volume, side = self.history[-1]
        tolerance = self.newton.settings.tolerance
        if not np.isfinite(force):
            self.reason = self._not_a_number()
            return int(reasons.DIVERGED_FUNCTION_DOMAIN)
        resolved = max(tolerance, self.problem.force_noise / self.scale)
        if force <= resolved and volume <= tolerance and side <= tolerance:
            return int(reasons.CONVERGED_FNORM_RELATIVE)
        if self.reuse.effort >= self.newton.settings.iterations:
            self.reason = f"no convergence in {iteration} iterations"
            return int(reasons.DIVERGED_MAX_IT)
        if iteration >= 4:
            size = [max(row) for row in self.history]
            if size[-1] > 1e3 * min(size[:-1]) and size[-1] > 1:
                self.reason = "the residual grows"
                return int(reasons.DIVERGED_DTOL)
        return int(reasons.CONVERGED_ITERATING)

    # --- run -----------------------------------------------------------------------------------

    def run(self, w: Floats) -> Outcome:
        """Set up SNES on the bordered vector and solve."""
        size = self.owned + (len(self.unknown) if self.last else 0)
        x = PETSc.Vec().createMPI((size, PETSc.DETERMINE), comm=self.comm)
        f = x.duplicate()
        shell = PETSc.Mat().createPython(((size, PETSc.DETERMINE),) * 2, comm=self.comm)
        shell.setPythonContext(object())
        shell.setUp()
        snes = PETSc.SNES().create(self.comm)
        snes.setType(PETSc.SNES.Type.NEWTONLS)
        prefix = "fiberbend_newton_"
        snes.setOptionsPrefix(prefix)
        PETSc.Options().setValue(f"{prefix}snes_linesearch_type", "basic")
        snes.setFromOptions()
        snes.setFunction(self.function, f)
        snes.setJacobian(self.jacobian, shell, shell)
        snes.setConvergenceTest(self.test)
        snes.setTolerances(max_it=2 * self.newton.settings.iterations + 1)
        ksp = snes.getKSP()
        ksp.setType(PETSc.KSP.Type.PREONLY)
        pc = ksp.getPC()
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(self)
        if not self.newton.settings.hybrid:
            self.problem.predict(None)  # the march may have extrapolated forces
        self.join(x, w, np.array([self.problem.scalar(name) for name in self.unknown]))
        try:
            snes.solve(None, x)
            converged = snes.getConvergedReason() > 0 and not self.reason
            if not converged and not self.reason:
                # SNES stops at a starting guess that is not a number without asking the test
                self.reason = self._not_a_number()
            if converged:
                self.problem.raise_force_floor(FADED * self.scale)
        except (PETSc.Error, ZeroDivisionError, np.linalg.LinAlgError) as error:
            self.reason = f"the linear solve failed ({error})"
            converged = False
        finally:
            # left to Python, PETSc keeps them, and pc holds this and with it the whole problem
            for item in (pc, ksp, snes, shell, x, f):
                item.destroy()
        return Outcome(
            converged,
            self.reuse.solves,
            len(self.reuse.tangents),
            self.reason,
            self.history,
            float(self.least),
            self.reuse.spared,
        )

"""States of a scene at equilibrium: captured, put back, found under a load, stable or not."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from fem.march.predictor import Predictor
from fem.march.records import MODES, TURN, State, measure
from fem.ranks import total
from fem.scene import Scene
from fem.solver.bordered import SideCondition
from fem.solver.modes import opposite_modes, softest_opposite
from fem.solver.newton import Newton, Outcome
from fem.solver.problem import RefusedError
from fem.solver.side_conditions import Functional, GivenConjugate, GivenFunctional, Stationary

Floats = npt.NDArray[np.float64]

TINY = 1e-5
"""Strain of a perturbed state that shows a slope: its square is lost, round-off is not seen."""
STILL = 1e-6 * TINY
"""Angle of a perturbed state, rad, that is none: a thousand times round-off of fitted angles, and a
millionth of what the strain would turn."""
NOWHERE = 1e-30
"""Part of a response that shows its direction, and adds nothing to a tangent."""
NEUTRAL = 1e-3
"""Stiffness of a mode over that at rest, or the negative of it, that is none on any mesh."""


class Equilibrium:
    """A scene and what finds its equilibria.

    Args:
        scene: the scene.
        newton: its solver.
        predictor: what a solve starts from.
        control: the quantity that requests refer to (the bending angle), or None.

    Attributes:
        displacements: owned dofs of the displacement, (owned,).
    """

    def __init__(
        self, scene: Scene, newton: Newton, predictor: Predictor, control: Functional | None
    ) -> None:
        self.scene, self.newton = scene, newton
        self._predictor, self._control = predictor, control
        comm, volumetric = scene.domain.comm, int(np.count_nonzero(scene.volumetric))
        self._start = scene.w.copy()
        self._opposite_at_rest: float | None = None
        self._volumetric = int(total(comm, volumetric))
        body = scene.body
        dofs = body.node_dofs[body.owned_nodes].ravel()
        self.displacements = np.zeros(body.owned, dtype=bool)
        self.displacements[dofs[dofs < body.owned]] = True

    @property
    def tells_stability(self) -> bool:
        """Whether negative pivots tell unstable modes: solver and loads must let them."""
        return self.newton.factor.counts and self.scene.conservative

    def capture(self) -> State:
        """The present state of the scene."""
        scene = self.scene
        scalars = {name: scene.scalar(name) for name in scene.body.scalars}
        measures = {measure("value", name): value for name, value in scalars.items()}
        for name in scalars:
            if name not in scene.natural:  # there it is zero
                measures[measure("conjugate", name)] = scene.conjugate(name)
        if self._control is not None:
            measures["control"] = self._control.value()
        turned = scene.body.turned()
        if turned is not None:
            measures[TURN] = turned
        return State(
            w=scene.w.copy(),
            scalars=scalars,
            measures=measures,
            shape=self._predictor.describe(),
            discrete=scene.memory(),
        )

    def restore(self, state: State) -> None:
        """Put the scene back to a captured state, exactly."""
        for name, value in state.scalars.items():
            self.scene.set_scalar(name, value)
        self.scene.set(state.w)

    def order(self, rest: State) -> None:
        """Let the solver order its unknowns as a march does that begins at rest.

        MUMPS orders them once, by the values of its first matrix too; another order is another
        round-off.
        """
        self.restore(rest)
        self.scene.predict(None)
        self.scene.assemble_tangent()
        self.newton.factor.renew()

    def natural_conditions(self) -> list[Stationary]:
        """One equation for each natural scalar."""
        return [Stationary(self.scene, name) for name in self.scene.natural]

    def perturbed(self, base: State, scalar: str, sign: float = 1.0) -> State:
        """A state perturbed along its linear response to a scalar; the scene is left at that.

        Args:
            base: the state.
            scalar: the load.
            sign: where it goes: what is taut or slack hangs on that.
        """
        scene, body = self.scene, self.scene.body
        self.restore(base)
        scene.predict(None)
        rate, natural = self.newton.response(scalar, scene.natural, self.natural_conditions())
        if scene.undecided:
            # forces without geometric stiffness: the motion may be as small as one likes
            way = {name: sign * NOWHERE * value for name, value in natural.items()}
            scene.predict(sign * NOWHERE * rate, way)
            rate, natural = self.newton.response(scalar, scene.natural, self.natural_conditions())
            scene.predict(None)
        nodal = body.with_ghosts(rate)[body.node_dofs[body.owned_nodes]]
        top = float(np.max(np.abs(nodal), initial=0.0))
        largest = max(scene.domain.comm.allgather(top)) / body.span
        for name, value in natural.items():
            largest = max(largest, abs(value) / scene.size_of(name))
        step = sign * TINY / max(largest, 1e-300)
        scene.set_scalar(scalar, base.scalars[scalar] + step)
        for name, value in natural.items():
            scene.set_scalar(name, base.scalars[name] + step * value)
        scene.set(base.w + step * rate)
        state = self.capture()
        self.restore(base)
        return state

    def find(
        self, scalar: str, kind: str, target: float, along: tuple[list[State], str, float]
    ) -> Outcome:
        """Predict and solve for one equilibrium.

        Args:
            scalar: the load that is driven.
            kind: what is given: its 'value', its 'conjugate' or the 'control' quantity.
            target: what that is to be.
            along: states from which the start is extrapolated, a measure and its value there.
        """
        start = self._start = self._predictor.start(*along)
        unknown: list[str] = list(self.scene.natural)
        conditions: list[SideCondition] = list(self.natural_conditions())
        if kind == "value":
            self.scene.set_scalar(scalar, target)
            return self.newton.solve(start, unknown, conditions)
        if kind == "conjugate":
            conditions.append(GivenConjugate(self.scene, scalar, target))
        else:
            assert self._control is not None
            conditions.append(GivenFunctional(self._control, target))
        return self.newton.solve(start, [*unknown, scalar], conditions)

    def strayed(self, state: State, before: Sequence[State]) -> float:
        """How far Newton's method went from the start of the last solve, in steps to that start.

        A step that is shorter than the one before counts as long as that: the chord from which it
        is extrapolated is no tangent.

        Args:
            state: what was found.
            before: the states before it.
        """
        mass, norm = self.displacements, self.scene.norm
        steps = [norm((self._start - before[-1].w)[mass])]
        steps += [norm((b.w - a.w)[mass]) for a, b in itertools.pairwise(before[-2:])]
        return norm((state.w - self._start)[mass]) / max(*steps, 1e-300)

    def assess_stability(
        self, state: State, before: State, scalar: str, exactly: bool = False
    ) -> None:
        """Write the stability of the state just found into its measures.

        Unstable modes are the negative eigenvalues of the Hessian of the potential in all fields
        and natural scalars, with the loads at given values, whatever was given when the state
        was found. d conjugate / d value is negative beyond a limit point; there, one of the modes
        is gone where the conjugate is given instead. A solver that counts no negative pivots
        leaves no count of modes.

        Args:
            state: the present state, found by the last solve.
            before: the state before it.
            scalar: the load that is driven.
            exactly: by the tangent at the state; else by the last one of Newton's method, unless
                that tells a change.

        Raises:
            RefusedError: the load has turned, and the solver counts no negative pivots.
        """
        rate, kinds = measure("rate", scalar), [measure(k, scalar) for k in ("conjugate", "value")]
        state.measures[rate] = before.measures.get(rate, 1.0)
        conjugate, value = (state.measures[name] - before.measures[name] for name in kinds)
        # where the load has turned and another mode is lost, the count stays as it is
        turned = conjugate * value * state.measures[rate] < 0
        if not self.tells_stability:
            if turned:
                raise RefusedError(f"a limit point of {scalar}, where negative pivots must be told")
            return
        modes = self.modes()
        if exactly or turned or modes != before.measures.get(MODES, 0):
            # not by an old factor, nor with forces that were predicted
            near = self.perturbed(state, scalar)
            modes = self.modes()
            change = [near.measures[name] - state.measures[name] for name in kinds]
            state.measures[rate] = change[0] / change[1]
        state.measures[MODES] = modes

    def opposite_modes(self, state: State, rest: State) -> int:
        """Unstable modes that half a body does not know; of a whole one none. Collective.

        None too where the solver tells no modes: such a run says that nobody has looked.
        Those of the opposite symmetry, with the loads at given values. A round body may turn its
        buckles about its axis at no cost: what costs less than the mesh knows is no instability.
        """
        if self.scene.free_opposite is None or not self.tells_stability:
            return 0
        self.restore(state)
        modes = opposite_modes(self.newton) - self._volumetric
        if modes > 0 and self._opposite_at_rest is None:
            self.restore(rest)
            self._opposite_at_rest = softest_opposite(
                self.newton, self.displacements, self.anyhow()
            )
            self.restore(state)
        if modes > 0:
            softest = softest_opposite(self.newton, self.displacements, self.anyhow())
            if abs(softest) < NEUTRAL * abs(self._opposite_at_rest or 0.0):
                modes -= 1
        return modes

    def roughness(self, w: Floats) -> float:
        """Part of the square of a displacement that varies within elements; collective.

        Of a wave of length l along elements of length h it is 1 − (sin(πh/l)/(πh/l))²: 0.6 where
        that spans two elements, 0.3 of three, 0.1 of six.

        Args:
            w: owned coefficients, (owned,).
        """
        body, domain = self.scene.body, self.scene.domain
        u = body.with_ghosts(w)[body.cell_dofs[: domain.owned]]
        within = u - u.mean(axis=1, keepdims=True)
        parts = np.array([np.sum(within**2), np.sum(u**2)])
        varying, whole = total(domain.comm, parts)
        return float(varying / max(whole, 1e-300))

    def anyhow(self) -> Floats:
        """A displacement without any symmetry, the same on any number of ranks, (owned,)."""
        body = self.scene.body
        nodes = body.owned_nodes
        values = np.random.default_rng(1).standard_normal(body.node_dofs.shape)
        start = np.zeros(body.owned)
        start[body.node_dofs[nodes]] = values[nodes]
        return start

    def modes(self) -> int:
        """Unstable modes by the last tangent, with the loads at given values."""
        pivots = self.newton.negative_pivots(self.scene.natural)
        return pivots - self._volumetric - self.scene.multipliers

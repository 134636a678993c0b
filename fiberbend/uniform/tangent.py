"""The tangent at a state, kept: what other numbers do to the state, to first order."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from fem.march.records import State
from fem.solver.bordered import BorderedSystem
from fem.solver.factor import Mumps
from fiberbend.uniform.small import Small


class Tangent:
    """The bordered tangent at a state, with a factor of its own.

    A step with it, from the state, under numbers that differ by h misses the state there by a term
    in h²: what is read off two such steps, there and back, gives derivatives with an error in h².

    Args:
        small: the scene.
        state: an equilibrium of it.
        kind: what is given there: 'control' or 'value'.
    """

    def __init__(self, small: Small, state: State, kind: str) -> None:
        self._state, self._kind = state, kind
        scene = small.scene
        self._unknown, conditions = small.conditions(state, kind)
        scene.residual()  # whose forces scale the conditions
        matrix = scene.assemble_tangent()
        free = scene.free[: len(scene.volumetric)]
        # the factor of a long body may refine by its matrix, which the next tangent changes
        self._factor = Mumps(matrix, volumetric=scene.volumetric, free=free)
        self._factor.renew()
        columns = [scene.load(name) for name in self._unknown]
        solve, names = self._factor.solve_many, self._unknown
        self._system = BorderedSystem(columns, names, conditions, free, solve, MPI.COMM_SELF)

    def step(self, small: Small, goal: float) -> State:
        """One step of Newton's method with this tangent, from the state.

        Args:
            small: the same scene under slightly other numbers, the last that took it.
            goal: the angle or pressure that is given, as the state has it.
        """
        scene = small.scene
        unknown, conditions = small.conditions(self._state, self._kind, goal)
        forces, _ = scene.residual()
        left = np.array([condition.value() for condition in conditions])
        step = self._factor.solve_many([np.where(scene.free[: len(forces)], forces, 0.0)])[0]
        step, change = self._system.eliminate(step, left)
        for name, value in zip(unknown, change, strict=True):
            scene.set_scalar(name, scene.scalar(name) - float(value))
        scene.set(scene.w - step)
        return small.capture()

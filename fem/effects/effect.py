"""What an effect may give to a scene."""

from __future__ import annotations

import dataclasses
from collections.abc import Hashable, Iterable, Mapping
from typing import Any, ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from fem.kinematics.kinematics import Kinematics

Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Constraint:
    """A displacement component fixed at a value on a named surface.

    Attributes:
        name: what fixes it; reactions are reported under this name.
        surface: named surface of the mesh.
        component: 0, 1 or 2.
        value: mm.
    """

    name: str
    surface: str
    component: int
    value: float = 0.0


@dataclasses.dataclass(frozen=True)
class Natural:
    """A global unknown that an effect brings: at an equilibrium the potential is stationary in it.

    Attributes:
        rest: its value at rest.
        lever: scale of its equation −∂Π/∂q = 0, mm or 1; of a force, what it is to be multiplied
            with by the scale of forces.
        force: its equation is one of forces or moments, not of places.
        multiplier: it forces an equation, which costs one negative eigenvalue of the Hessian.
    """

    rest: float
    lever: float
    force: bool
    multiplier: bool


class Discrete(Protocol):
    """A potential with its own energy, vector and matrix instead of a UFL density.

    Attributes:
        natural: global unknowns that it brings, by name.
        conservative: it has a potential. Of one that has none `conjugate` and `second_derivative`
            give the equations of its unknowns all the same, which are not symmetric.
        pair_units: units of force and place of each of `pairs`.
        index: global number of every piece that this rank holds, (n,); what it remembers of a
            step is one value a piece.
        block_dofs: local dofs of the fields that each piece couples, (n, k), always the same; those
            of a piece belong to one cell.
        mixed: `add_lag` has all that a step with an old tangent lacks, so that such steps converge.
    """

    natural: Mapping[str, Natural]
    conservative: bool
    pair_units: Mapping[str, tuple[str, str]]
    index: npt.NDArray[np.int64]
    block_dofs: npt.NDArray[np.int32]
    mixed: bool

    @property
    def undecided(self) -> bool:
        """Whether the tangent at the present state hangs on the motion that is predicted."""

    def update(self, w: Floats) -> None:
        """Take local coefficients of the fields (owned, then ghosts), (local,), as the state."""

    def energy(self) -> float:
        """This rank's energy, N mm."""

    def add_residual(self, b: Floats) -> None:
        """Add ∂Π/∂w to local coefficients, (local,), N."""

    def add_noise(self, b: Floats) -> None:
        """Add the least forces that double precision resolves, at rest, to local coefficients."""

    def tangent_blocks(self) -> Floats:
        """∂²Π/∂w² of every piece, dense and symmetric, in the dofs `block_dofs`, (n, k, k)."""

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Take Newton's last correction, (local,), for the next tangent to use; None: none yet."""

    @property
    def predicted(self) -> Floats:
        """What that correction predicts of every piece's force, (n,), N."""

    @predicted.setter
    def predicted(self, forces: Floats) -> None: ...

    def add_lag(self, b: Floats) -> None:
        """Add what a step with the last tangent lacks, to local coefficients, (local,), N.

        Forces that the correction has not predicted act along that tangent's gradients there.
        """

    def lag_along(self, name: str) -> float:
        """This rank's part of the same of ∂Π/∂q of a global scalar."""

    def conjugate(self, name: str) -> float:
        """This rank's work-conjugate −∂Π/∂q of a global scalar; zero where it does not enter."""

    def add_load(self, name: str, b: Floats) -> None:
        """Add ∂²Π/∂w∂q of a global scalar to local coefficients, (local,)."""

    def second_derivative(self, first: str, second: str) -> float:
        """This rank's ∂²Π/∂q∂r of two global scalars."""

    def pairs(self) -> dict[str, tuple[float, float]]:
        """Forces and the places on which they do work, by name: where Π tells no work."""

    def state(self) -> dict[str, Floats]:
        """What a converged step must remember, this rank's part."""

    def extrapolate(self, states: list[dict[str, Floats]], weights: Floats) -> None:
        """Start a step from a weighted sum of remembered states."""


class Effect:
    """One summand Π_e of the scene's potential; a subclass gives only the parts it has.

    Attributes:
        fields: names of the fields it needs.
        outside: its forces act from outside, as a support's do; they have a resultant.
        shares: global scalars that it brings whose work its `Discrete.pairs` do.
        units: by global scalar that it brings, the units of its value and of its work-conjugate.
    """

    fields: ClassVar[tuple[str, ...]] = ("u",)
    shares: ClassVar[tuple[str, ...]] = ()
    outside: ClassVar[bool] = False
    units: ClassVar[Mapping[str, tuple[str, str]]] = {}

    @property
    def key(self) -> str:
        """Name that sorts it within the scene and labels its energy."""
        return type(self).__name__

    def potential(self, body: Kinematics) -> Any:
        """Its signed potential as a UFL form in N mm, or None."""
        return None

    def discrete(self, body: Kinematics) -> Discrete | None:
        """Its signed potential as own code, or None."""
        return None

    def structure(self) -> Hashable:
        """What its form, its constraints and its own code hang on beside numbers.

        Numbers within forms are those of `body.coefficient` and `body.constants`; own code may
        have any. Effects of one key and one structure differ by numbers alone: a compiled scene
        takes those of one in place of the other's. None: not known, it is compiled anew. Empty:
        there is nothing but scalars that are held.
        """
        return None

    def constraints(self) -> tuple[Constraint, ...]:
        """Displacement components that it fixes."""
        return ()

    def opposite(self) -> tuple[Constraint, ...] | None:
        """What it fixes of modes of the opposite symmetry, where it halves the body.

        None where it does not: those modes obey its own constraints.
        """
        return None

    def fixed_scalars(self) -> dict[str, float]:
        """Natural unknowns of the kinematics, such as the curvature, that it fixes at a value."""
        return {}


def structures(effects: Iterable[Effect]) -> dict[str, Hashable]:
    """By key, what effects hang on beside numbers; without those that hold scalars alone."""
    found = {effect.key: effect.structure() for effect in effects}
    return {key: structure for key, structure in found.items() if structure != ()}


def fixed_dofs(
    body: Kinematics, constraints: Iterable[Constraint]
) -> tuple[npt.NDArray[np.bool_], dict[str, npt.NDArray[np.int32]], Floats]:
    """Local dofs that constraints and pins leave free, what each name fixes, and at which values.

    Args:
        body: the kinematics.
        constraints: of all effects.

    Returns:
        (local,), by name (n,), and (local,) in mm.
    """
    free, values = np.ones(body.local, dtype=bool), np.zeros(body.local)
    fixed: dict[str, npt.NDArray[np.int32]] = {}
    for constraint in constraints:
        nodes = body.domain.surface_nodes(constraint.surface)
        dofs = body.node_dofs[nodes, constraint.component]
        dofs = dofs[dofs >= 0]
        free[dofs] = False
        values[dofs] = constraint.value
        old = fixed.get(constraint.name, np.zeros(0, dtype=np.int32))
        fixed[constraint.name] = np.union1d(old, dofs).astype(np.int32)
    if body.pins:
        dofs = np.array([body.node_dofs[pin] for pin in body.pins], dtype=np.int32)
        free[dofs] = False
        fixed["pin"] = dofs
    follow, lead = body.ties
    free[follow] = free[lead]
    return free, fixed, values


def opposite_free(effects: Iterable[Effect], body: Kinematics) -> npt.NDArray[np.bool_] | None:
    """Local dofs that modes of the symmetry opposite to that of half a body may move, (local,).

    None of a whole body; and with tetrahedra, whose pressure is continuous and would have to vanish
    on the plane.

    Args:
        effects: of the scene.
        body: its kinematics.
    """
    effects = list(effects)
    domain = body.domain
    tetrahedra = domain.data.cell_type == "tetrahedron"
    if tetrahedra or all(effect.opposite() is None for effect in effects):
        return None
    free = np.ones(body.local, dtype=bool)
    for effect in effects:
        other = effect.opposite()
        for constraint in effect.constraints() if other is None else other:
            if constraint.component < body.components:
                nodes = domain.surface_nodes(constraint.surface)
                dofs = body.node_dofs[nodes, constraint.component]
                free[dofs[dofs >= 0]] = False
    for pin in (*body.pins, *body.opposite_pins):
        free[body.node_dofs[pin]] = False
    return free

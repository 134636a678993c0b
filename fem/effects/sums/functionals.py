"""Potentials that see the fields through a few linear functionals only, such as a mean."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem.effects.effect import Natural
from fem.kinematics.kinematics import Kinematics
from fem.ranks import total

Floats = npt.NDArray[np.float64]


class Functionals:
    """Places a_j that are linear in the fields, a = a⁰ + A w.

    Args:
        body: the kinematics.
        rest: a⁰, (m,).
        rows: A, this rank's part, (m, owned).
    """

    def __init__(self, body: Kinematics, rest: Floats, rows: Floats) -> None:
        self._comm = body.domain.comm
        self.rest, self.rows = rest, rows

    @classmethod
    def of_nodes(
        cls, body: Kinematics, weights: Floats, parts: list[tuple[int, int]], rest: Floats
    ) -> Functionals:
        """Weighted sums of the displacements of nodes.

        Args:
            body: the kinematics.
            weights: of sums by input nodes, (k, n).
            parts: of each functional, the number of the sum and the component.
            rest: a⁰, (m,).
        """
        nodes = body.owned_nodes
        rows = np.zeros((len(parts), body.owned))
        for row, (number, component) in zip(rows, parts, strict=True):
            row[body.node_dofs[nodes, component]] = weights[number, nodes]
        follow, lead = body.ties
        for row in rows:
            np.add.at(row, lead, row[follow])
            row[follow] = 0.0
        return cls(body, rest, rows)

    def read(self, w: Floats) -> Floats:
        """a at local coefficients of the fields, (m,); collective."""
        moved: Floats = total(self._comm, self.rows @ w[: self.rows.shape[1]])
        return self.rest + moved

    @property
    def counts(self) -> bool:
        """Whether this rank is the one that counts what all ranks know alike."""
        return bool(self._comm.rank == 0)


class Reduced:
    """A potential with own code that has no pieces and adds nothing to K.

    Args:
        body: the kinematics.
        functionals: what it sees of the fields.

    Attributes:
        places: a at the present state, (m,).
    """

    natural: Mapping[str, Natural] = {}
    conservative: bool = True
    pair_units: Mapping[str, tuple[str, str]] = {}
    mixed: bool = True
    undecided: bool = False

    def __init__(self, body: Kinematics, functionals: Functionals) -> None:
        self._body, self._functionals = body, functionals
        self.index = np.zeros(0, dtype=np.int64)
        self.block_dofs = np.zeros((0, 1), dtype=np.int32)
        self.predicted: Floats = np.zeros(0)
        self.places = functionals.rest

    def scalar(self, name: str) -> float:
        """Present value of a global scalar."""
        return float(self._body.scalars[name].value)

    # --- what a subclass gives, the same on all ranks -----------------------------------------

    def forces(self) -> Floats:
        """Generalised forces on the places, −∂Π/∂a, (m,)."""
        raise NotImplementedError

    def value(self) -> float:
        """Π, N mm."""
        raise NotImplementedError

    def equation(self, name: str) -> float:
        """−∂Π/∂q of a global scalar, at given places."""
        raise NotImplementedError

    def force_rate(self, name: str) -> Floats:
        """∂(forces)/∂q of a global scalar, (m,)."""
        raise NotImplementedError

    def second(self, first: str, second: str) -> float:
        """∂²Π/∂q∂r of two global scalars."""
        raise NotImplementedError

    def pairs(self) -> dict[str, tuple[float, float]]:
        """None: it has a potential."""
        return {}

    # --- what a scene asks --------------------------------------------------------------------

    def update(self, w: Floats) -> None:
        """Take local coefficients as the state."""
        self.places = self._functionals.read(w)

    def energy(self) -> float:
        """Π, on one rank."""
        return self.value() if self._functionals.counts else 0.0

    def add_residual(self, b: Floats) -> None:
        """Its forces on the fields, as a residual."""
        rows = self._functionals.rows
        b[: rows.shape[1]] -= self.forces() @ rows

    def add_noise(self, b: Floats) -> None:
        """None: a sum of displacements is as exact as these."""

    def noise_along(self, name: str) -> float:
        """None likewise."""
        return 0.0

    def tangent_blocks(self) -> Floats:
        """None."""
        return np.zeros((0, 1, 1))

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Nothing is predicted."""

    def add_lag(self, b: Floats) -> None:
        """Nothing lags."""

    def lag_along(self, name: str) -> float:
        """Nothing lags."""
        return 0.0

    def conjugate(self, name: str) -> float:
        """−∂Π/∂q, on one rank."""
        return self.equation(name) if self._functionals.counts else 0.0

    def add_load(self, name: str, b: Floats) -> None:
        """∂²Π/∂w∂q of a global scalar."""
        rows = self._functionals.rows
        b[: rows.shape[1]] -= self.force_rate(name) @ rows

    def second_derivative(self, first: str, second: str) -> float:
        """∂²Π/∂q∂r, on one rank."""
        return self.second(first, second) if self._functionals.counts else 0.0

    def state(self) -> dict[str, Floats]:
        """Nothing is to be remembered."""
        return {}

    def extrapolate(self, states: list[dict[str, Floats]], weights: Floats) -> None:
        """Nothing is remembered."""


class Linear(Reduced):
    """Π = −q Σ g_j a_j: a dead load g on the places, scaled by a global scalar q.

    Args:
        body: the kinematics.
        functionals: the places a, zero at rest.
        scalar: name of q.
        load: g, (m,).
    """

    def __init__(
        self, body: Kinematics, functionals: Functionals, scalar: str, load: Floats
    ) -> None:
        super().__init__(body, functionals)
        self._scalar, self._load = scalar, load
        body.scalar(scalar)

    def forces(self) -> Floats:
        """q g."""
        return self.scalar(self._scalar) * self._load

    def value(self) -> float:
        """−q g · a."""
        return -float(self.forces() @ self.places)

    def equation(self, name: str) -> float:
        """g · a."""
        return float(self._load @ self.places) if name == self._scalar else 0.0

    def force_rate(self, name: str) -> Floats:
        """g."""
        return self._load * (name == self._scalar)

    def second(self, first: str, second: str) -> float:
        """It is linear."""
        return 0.0


class Linked(Reduced):
    """Π = −Σ f_j (a_j − b_j) + U(b, r): own unknowns b_j for the places a_j of the fields.

    The forces f on the fields, the places b and further unknowns r are global unknowns; the
    stationarity of Π in f makes b = a, that in b makes f = −∂U/∂b. Whatever U is, K is that of the
    rest of the scene, and Newton's method on the bordered system has the exact tangent. A subclass
    gives f = g(b, r) in place of −∂U/∂b, which need not have a potential.

    Args:
        body: the kinematics.
        functionals: the places a.
        key: begins the names of the unknowns.
        levers: of each place, its scale in mm, or in 1 where it is a number, (m,).
        moments: of each, the scale of forces on it, 1 or mm, (m,).
        more: further unknowns r by their names.
    """

    def __init__(
        self,
        body: Kinematics,
        functionals: Functionals,
        key: str,
        levers: Floats,
        moments: Floats,
        more: Mapping[str, Natural],
    ) -> None:
        super().__init__(body, functionals)
        count = range(len(functionals.rest))
        self.held = [f"{key} force {j}" for j in count]
        self.at = [f"{key} place {j}" for j in count]
        rest = functionals.rest
        self.natural = {
            **{self.held[j]: Natural(0.0, float(levers[j]), False, True) for j in count},
            **{self.at[j]: Natural(float(rest[j]), float(moments[j]), True, False) for j in count},
            **more,
        }

    def own(self, names: list[str]) -> Floats:
        """Values of scalars, (n,)."""
        return np.array([self.scalar(name) for name in names])

    # --- what a subclass gives ------------------------------------------------------------------

    def law(self) -> Floats:
        """g at the present unknowns, (m,)."""
        raise NotImplementedError

    def law_rate(self, name: str) -> Floats:
        """∂g/∂(a place b_j, an unknown r, or a load), (m,)."""
        raise NotImplementedError

    def others(self, name: str) -> float:
        """Equation of another scalar, −∂U/∂q."""
        return 0.0

    def others_rate(self, first: str, second: str) -> float:
        """Derivative of ∂U/∂first, of no place, by a scalar."""
        return 0.0

    # --- what a scene asks ----------------------------------------------------------------------

    def forces(self) -> Floats:
        """f."""
        return self.own(self.held)

    def equation(self, name: str) -> float:
        """a − b of a force, g − f of a place."""
        if name in self.held:
            j = self.held.index(name)
            return float(self.places[j]) - self.scalar(self.at[j])
        if name in self.at:
            j = self.at.index(name)
            return float(self.law()[j]) - self.scalar(self.held[j])
        return self.others(name)

    def force_rate(self, name: str) -> Floats:
        """One of the own force."""
        return np.array([float(name == held) for held in self.held])

    def second(self, first: str, second: str) -> float:
        """∂(f − g)/∂q of a place, ∂(b − a)/∂q of a force."""
        if first in self.held:
            return float(second == self.at[self.held.index(first)])
        if first in self.at:
            j = self.at.index(first)
            if second in self.held:
                return float(second == self.held[j])
            return -float(self.law_rate(second)[j])
        return self.others_rate(first, second)

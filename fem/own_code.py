"""What a scene asks of those of its potentials that have code of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from fem.effects.effect import Discrete, Natural
from fem.kinematics.kinematics import Kinematics
from fem.ranks import total

Floats = npt.NDArray[np.float64]


class OwnCode:
    """What the potentials with own code foresee and remember, all together.

    Attributes:
        body: kinematics with the unknowns.
        discrete: the potentials, by key.
        force_scale: scale of the forces in the last residual, N.
        added: global unknowns that they bring, by name.
    """

    body: Kinematics
    discrete: dict[str, Discrete]
    force_scale: float
    added: dict[str, Natural]

    def take_in(self) -> None:
        """Put the unknowns that they bring beside those of the kinematics, at rest."""
        self.added = {k: v for item in self.discrete.values() for k, v in item.natural.items()}
        for name, item in self.added.items():
            self.body.scalar(name)
            self.body.scalars[name].value = item.rest

    def size_of(self, name: str) -> float:
        """A change of a natural scalar that strains like a stretch of one; ∞: none does."""
        return np.inf if name in self.added else self.body.size_of(name)

    def equation_scale(self, name: str) -> float:
        """What ∂Π/∂q of a natural scalar q is measured by.

        A force is as fine as those on the fields are: the lever is the size of what is modelled
        over the change of q that strains it by one.
        """
        item = self.added.get(name)
        if item is None:
            return self.force_scale * (self.body.span / self.body.size_of(name))
        return item.lever * (self.force_scale if item.force else 1.0)

    @property
    def multipliers(self) -> int:
        """Negative eigenvalues of the Hessian that are equations, and no instability."""
        return sum(item.multiplier for item in self.added.values())

    @property
    def conservative(self) -> bool:
        """Whether all loads have a potential, whose Hessian tells stability."""
        return all(item.conservative for item in self.discrete.values())

    def predict(
        self, correction: Floats | None, scalars: Mapping[str, float] | None = None
    ) -> None:
        """Take Newton's last correction, which the next tangent may use; None: none yet.

        Args:
            correction: of the fields, owned part, (owned,).
            scalars: of the global scalars, by name.
        """
        if not self.discrete:
            return
        full = None if correction is None else self.body.with_ghosts(correction)
        for discrete in self.discrete.values():
            discrete.predict(full, scalars)

    @property
    def predicted(self) -> Floats:
        """Forces that the last correction has predicted, this rank's, (n,)."""
        return np.concatenate([[], *(item.predicted for item in self.discrete.values())])

    @predicted.setter
    def predicted(self, forces: Floats) -> None:
        for item in self.discrete.values():
            item.predicted, forces = np.split(forces, [len(item.index)])

    def lag_along(self, name: str) -> float:
        """What a step with the last tangent lacks of ∂Π/∂q of a global scalar."""
        mine = sum(item.lag_along(name) for item in self.discrete.values())
        return float(total(self.body.domain.comm, mine))

    @property
    def mixed(self) -> bool:
        """Whether steps with an old tangent lack nothing but `lag`."""
        return all(item.mixed for item in self.discrete.values())

    @property
    def undecided(self) -> bool:
        """Whether the tangent hangs on the motion that is predicted, on any rank."""
        mine = sum(discrete.undecided for discrete in self.discrete.values())
        return bool(total(self.body.domain.comm, mine))

    def memory(self) -> dict[str, dict[str, Floats]]:
        """What a converged step must remember beside the unknowns, by effect; this rank's part."""
        return {key: discrete.state() for key, discrete in self.discrete.items()}

    def extrapolate(
        self, memories: Sequence[dict[str, dict[str, Floats]]], weights: Floats
    ) -> None:
        """Start a step from a weighted sum of what earlier ones remembered."""
        for key, discrete in self.discrete.items():
            discrete.extrapolate([memory[key] for memory in memories], weights)

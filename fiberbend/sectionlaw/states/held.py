"""States of uniform bending whose strains and pressure are given, with exact second derivatives.

Φ, the energy per length of section and air, is stationary in all that is free. So its slopes by the
strains and the pressure are the forces that hold them, and how those change follows from the
tangent at the state: a solve for each of them with one factor.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from fem.effects.sums.hold import BEND, LENGTHENED, SIDE_BEND, TWISTED
from fem.march.records import State
from fiberbend.case.case import Case
from fiberbend.effects.hold import HoldEffect
from fiberbend.trial import loads
from fiberbend.uniform.small import PRESSURE, Small

Floats = npt.NDArray[np.float64]

HELD = {
    "stretch": LENGTHENED,
    "curvature": BEND,
    "side_curvature": SIDE_BEND,
    "twist": TWISTED,
}
"""By the name of a strain of the centroids' line, as `rod.layout` has them, what holds it."""
_SOME, _TOKEN = 1e-3, 1e-300
"""A pressure and a turn that are there, as far as symmetry goes."""
_COUNTS = (2, 5, 12, 30)
"""Steps along a way, tried in turn."""


@dataclasses.dataclass(frozen=True)
class HeldState:
    """A section at given strains ε and pressure P; x = (ε, P).

    Attributes:
        at: x, (m + 1,): stretch in 1, curvatures and twist in rad/mm, P in MPa.
        state: of the scene.
        energy: Φ, N mm/mm.
        slopes: ∂Φ/∂x, (m + 1,): N, moments in N mm, and minus the area of the chamber in mm².
        second: ∂²Φ/∂x², (m + 1, m + 1).
        rates: ∂w/∂x, (m + 1, dofs).
        scalar_rates: ∂q/∂x of the global scalars that are found, by name, (m + 1,).
    """

    at: Floats
    state: State
    energy: float
    slopes: Floats
    second: Floats
    rates: Floats
    scalar_rates: Mapping[str, Floats]


class Held:
    """A section in one compiled scene, its strains held.

    Args:
        case: of model section or cell, whose winding waits for nothing; its own loads do not count.
        strains: names out of HELD, the stretch first.

    Attributes:
        rest: the state at rest.
        solved: states that were solved.
    """

    def __init__(self, case: Case, strains: tuple[str, ...]) -> None:
        loaded = loads.inflated(case, (_SOME,))
        token = HoldEffect.model_construct(
            stretch=1.0,
            bend=0.0 if "curvature" in strains else None,
            side_bend=_TOKEN if "side_curvature" in strains else None,
            twist=_TOKEN if "twist" in strains else None,
        )
        self._small = Small(loaded.model_copy(update={"effects": (*loaded.effects, token)}))
        self._length = case.actuator.length
        self._share = self._small.scene.body.symmetry_factor / self._length
        self._names = [HELD[name] for name in strains]
        self.solved = 0
        at_rest = np.zeros(len(strains) + 1)
        at_rest[0] = 1.0
        found = self.solve(at_rest, self._small.rest)
        assert found is not None, "rest is an equilibrium"
        self.rest = found

    @property
    def small(self) -> Small:
        """The scene in which they are found."""
        return self._small

    @property
    def length(self) -> float:
        """L of the actuator for which the scene stands, mm."""
        return self._length

    def near(self, known: HeldState, at: Floats) -> HeldState | None:
        """A stable state near another one; None: none found.

        Args:
            known: from which its tangent leads there.
            at: strains and pressure, (m + 1,).
        """
        away = at - known.at
        moved = {name: float(rate @ away) for name, rate in known.scalar_rates.items()}
        state = dataclasses.replace(
            known.state,
            w=known.state.w + away @ known.rates,
            scalars={k: v + moved.get(k, 0.0) for k, v in known.state.scalars.items()},
        )
        return self.solve(at, state)

    def along(self, known: HeldState, at: Floats) -> HeldState | None:
        """The state to which a straight way leads, by as few steps as it takes; None: none does."""
        for count in _COUNTS:
            state: HeldState | None = known
            for number in range(1, count + 1):
                assert state is not None
                state = self.near(state, known.at + (at - known.at) * (number / count))
                if state is None:
                    break
            if state is not None:
                return state
        return None

    def solve(self, at: Floats, start: State) -> HeldState | None:
        """A stable state from a start; None: none found.

        Args:
            at: strains and pressure, (m + 1,).
            start: from which Newton's method begins.
        """
        targets = at[:-1].copy()
        targets[1:] *= self._length
        self.solved += 1
        holding = dict(zip(self._names, targets.tolist(), strict=True))
        state = self._small.held(start, holding, float(at[-1]))
        return None if state is None else self._with_tangent(at, state)

    def _with_tangent(self, at: Floats, state: State) -> HeldState:
        small, share, m = self._small, self._share, len(self._names)
        scene = small.scene
        found = small.responses(self._names, PRESSURE)
        # Ḡ are the stretch and the turns over the whole length
        scale = np.array([self._length] * m + [1.0])
        rates = scale[:, None] * np.array([rate for rate, _ in found])
        names = list(found[0][1])
        table = scale[:, None] * np.array([[q[name] for name in names] for _, q in found])
        by_name = dict(zip(names, table.T, strict=True))
        second = np.empty((m + 1, m + 1))
        for row, name in enumerate(self._names):
            second[row] = by_name[name]
        second[m, :m] = second[:m, m]
        area = -scene.second_derivative(PRESSURE, PRESSURE) - float(scene.load(PRESSURE) @ rates[m])
        area -= sum(scene.second_derivative(PRESSURE, n) * by_name[n][m] for n in names)
        second[m, m] = -share * area
        slopes = [scene.scalar(name) for name in self._names]
        slopes.append(-share * scene.conjugate(PRESSURE))
        return HeldState(
            at=at.copy(),
            state=state,
            energy=share * sum(scene.energies().values()),
            slopes=np.array(slopes),
            second=(second + second.T) / 2,
            rates=rates,
            scalar_rates=by_name,
        )

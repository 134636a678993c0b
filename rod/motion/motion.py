"""Motion of a rod by a scheme that keeps its energy.

With the frames X = [R | r] of all sections the kinetic energy ½ Σ tr(V P Vᵀ), V = Ẋ, has constant
masses P. Velocities of the frames are unknowns beside the strains ε, which place the frames. A step
from ε₀, V₀ to ε₁, V₁ is the midpoint rule

    X₁ − X₀ = Δt (V₀ + V₁)/2,      ∇̄G(ε₀, ε₁) + C Δε/Δt = 0,
    G(ε) = ∫ Φ(ε) ds + Π(ε) + Σ A : X(ε),     A = (V₁ − V₀) P/Δt,

with the potential Π of all terms that have one and the discrete gradient
∇̄G = ∇G(ε̄) + [G₁ − G₀ − ∇G(ε̄)·Δε] W Δε/(Δε·W Δε) at the mean strains ε̄ (Gonzalez 1996,
doi 10.1007/BF02440162). As ∇̄G·Δε = G₁ − G₀, what is undamped keeps ½ Σ tr(V P Vᵀ) + ∫ Φ ds + Π to
the last digits of Newton's method, whatever the terms are. Terms without a potential do their
virtual work at ε̄. It is the method of Betsch 2005 (doi 10.1016/j.cma.2005.01.004) with strains as
the reduced unknowns; of second order, and stable at any Δt. ΔX is exact: no rotation drifts.

Damping: `viscosity` is Kelvin's and Voigt's, forces and moments η ε̇ of the sections (N s of
stretch, N mm² s of curvatures); `drag` is Rayleigh's part of the mass, 1/s. Both take energy out in
every step, never in.

Velocities of frames that are no rates of strains, of the order Δt², change their sign from step to
step. Undamped they are kept, as energy is in them; where anything is damped they are dropped after
every step, which takes energy of the order Δt⁴ too, so that a rod comes to rest. As by every
midpoint rule, a motion that damping would end within a small part of Δt changes the sign of its
velocity from step to step instead; the strains hardly see it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs, dposv

from rod.functions import Floats
from rod.motion.air import Air
from rod.motion.equations import Equations
from rod.motion.moving import Energy, Moving, Work
from rod.rod import Level, Rod
from rod.shape import Shape
from rod.statics import NoEquilibriumError, size
from rod.term import Dead, Struck

_CLOSE = 1e-12
_LOOSE, _LOOSE_KINKED = 1e-7, 1e-11
_MOST = 30
_FAR = 1e3
_KINKED = 12
"""Most iterations where something is touched: two steps of half the time are quicker then."""
_SHORTEST = 2.0**-6
_SLOW = 0.05
"""An old factor that reduces a correction by less is made anew."""
_NEGATIVE = 1e-12
"""Part of the greatest viscosity that round-off makes of none."""


class Motion:
    """Steps in time of a rod.

    Args:
        rod: with its inertia.
        level: what acts at a time in s.
        viscosity: η of the sections: of each free strain, (n, m) or (m,), or symmetric matrices of
            them, (n, m, m); N s and N mm² s. `retarded` makes them of a time.
        drag: of the mass, 1/s.
        air: what makes the pressure; None: it is that of the level.
        touching: retardation time of what touches something, s; see `rod.contact.impact`.

    Attributes:
        rod: as given.
        level: as given.
        viscous: η of each piece times its length, (n, m, m).
        viscid: it is not zero.
        drag: as given.
        air: as given.
        touching: as given.
        damped: anything takes energy.
        dead: loads of terms that never change, by the terms' identities.
        struck: terms that the rod may run into, by their identities.
        inertia: of the rod.
        sizes: changes of strains that count as one, (n, m).
        weights: W of the discrete gradient, (n, m).

    Raises:
        ValueError: no inertia, or damping below zero.
    """

    def __init__(
        self,
        rod: Rod,
        level: Callable[[float], Level],
        viscosity: Floats | float = 0.0,
        drag: float = 0.0,
        air: Air | None = None,
        touching: float = 0.0,
    ) -> None:
        if not rod.inertia.any():
            raise ValueError("a rod without inertia does not move by itself")
        matrices = _matrices(viscosity, rod.layout.shape)
        least = np.linalg.eigvalsh(matrices).min()
        if least < -_NEGATIVE * np.abs(matrices).max() or min(drag, touching) < 0:
            raise ValueError("damping: zero or more expected")
        self.rod, self.level, self.drag, self.air = rod, level, drag, air
        self.viscous = rod.layout.lengths[:, None, None] * matrices
        self.viscid = bool(np.any(matrices))
        self.touching = touching
        self.damped = bool(drag) or self.viscid or bool(touching)
        self.dead = {id(term): term.loads for term in rod.terms if isinstance(term, Dead)}
        self.struck = {id(term): term for term in rod.terms if isinstance(term, Struck)}
        self.inertia = rod.inertia
        self.sizes = size(rod)
        # any positive weights: by those of lengths and of sizes a stretch and an angle count alike
        self.weights = rod.layout.lengths[:, None] / self.sizes**2

    def at(
        self,
        strains: Floats,
        rates: Floats | None = None,
        time: float = 0.0,
        pressure: float | None = None,
    ) -> Moving:
        """A rod that begins to move.

        Args:
            strains: ε, (n, m).
            rates: ε̇, (n, m), 1/s and 1/(mm s); None: it is at rest.
            time: t, s.
            pressure: P of the chamber, MPa; that of the level unless given.
        """
        shape = self.rod.shape(strains)
        rates = np.zeros_like(strains) if rates is None else rates
        velocity, level = shape.moved(rates), self.level(time)
        pressure = level.pressure if pressure is None else pressure
        stored, volume = self.stored(strains, pressure)
        energy = Energy(self.kinetic(velocity), stored, self.held(shape, level.amounts), volume)
        return Moving(time, shape, velocity, rates, rates, pressure, energy, Work())

    # --- energy ----------------------------------------------------------------------------------

    def kinetic(self, velocity: Floats) -> float:
        """Of the frames' velocity, N mm."""
        return float(np.vdot(velocity @ self.inertia, velocity)) / 2

    def stored(self, strains: Floats, pressure: float) -> tuple[float, float]:
        """Elastic energy of the sections without the work of the air, and the chamber's volume.

        Returns:
            ∫ Φ ds + P V, N mm, and V, mm³.
        """
        volume = self.rod.volume(strains, pressure)
        return self.rod.elastic(strains, pressure) + pressure * volume, volume

    def held(self, shape: Shape, amounts: tuple[float, ...]) -> float:
        """Potential of the terms, N mm."""
        pairs = self.rod.acting(Level(amounts=amounts))
        return float(sum(term.potential(shape, amount) for term, amount in pairs))

    def energy(self, moving: Moving) -> float:
        """Of motion, sections with their air, and all terms that have a potential, N mm."""
        return moving.energy.total - moving.pressure * moving.energy.volume

    # --- steps -----------------------------------------------------------------------------------

    def rates(self, moving: Moving) -> Floats:
        """ε̇ with the momentum of the frames' velocity, (n, m), 1/s and 1/(mm s)."""
        return self.rates_of(moving.shape, moving.velocity)

    def rates_of(self, shape: Shape, velocity: Floats, more: Floats | float = 0.0) -> Floats:
        """ε̇ with the momentum of a velocity of the frames, (n, m), 1/s and 1/(mm s).

        Args:
            shape: the rod.
            velocity: of its frames, (n + 1, 3, 4).
            more: that is added to the masses, (n m, n m).
        """
        momentum = shape.pulled(velocity @ self.inertia).ravel()
        rates: Floats = dposv(shape.mass(self.inertia) + more, momentum)[1]
        return rates.reshape(shape.strains.shape)

    def run(self, moving: Moving, step: float, count: int) -> Iterator[Moving]:
        """States after each of a number of steps.

        Args:
            moving: the first one.
            step: Δt, s.
            count: number of steps.

        Yields:
            The states.

        Raises:
            NoEquilibriumError: a step does not converge.
        """
        for _ in range(count):
            moving = self.step(moving, step)
            yield moving

    def step(self, moving: Moving, step: float) -> Moving:
        """The state a time Δt later; in steps of half that time where Newton's method fails.

        Args:
            moving: a state.
            step: Δt, s.

        Raises:
            NoEquilibriumError: the shortest step does not converge.
        """
        return self._halved(moving, step, step * _SHORTEST)

    def _halved(self, moving: Moving, step: float, least: float) -> Moving:
        """A step, or two of half of it."""
        try:
            return self._whole(moving, step)
        except NoEquilibriumError:
            if step <= least:
                raise
        return self._halved(self._halved(moving, step / 2, least), step / 2, least)

    def _whole(self, moving: Moving, step: float) -> Moving:
        """One step by Newton's method, from the change of strains that the last two foresee."""
        now = Equations(self, moving, step)
        change = now.begin(step * moving.ahead)
        last, slow, kinked = np.inf, True, False
        for iteration in range(1, _MOST + 1):
            residual = now.residual(change)
            # nor is one of use that knows a touch that is over
            if slow or now.kinked or kinked:
                kinked = now.kinked
                # no exception by a singular one: what it gives is not finite, or too far
                factor = dgetrf(now.tangent())[:2]
            correction = dgetrs(*factor, residual.ravel())[0].reshape(change.shape)
            change, settled = change - correction, now.stepped(-correction)
            moves = float(np.max(np.abs(correction / self.sizes)))
            if not moves < _FAR or (now.kinked and iteration > _KINKED):
                break
            # what is left after it falls once more as the corrections do; where something is
            # touched they may fall otherwise, and a small one still is energy
            falls = 1.0 if now.kinked or last == np.inf else min(1.0, moves / last)
            loose = _LOOSE_KINKED if now.kinked else _LOOSE
            if settled and (moves * falls < _CLOSE or (moves < loose and moves > last / 2)):
                found = now.moved(change, iteration)
                outside = self.rod.law.outside(found.strains, found.pressure)
                if outside:
                    raise NoEquilibriumError(f"at {found.time:.6g} s: {outside}")
                if now.leapt(found.shape):
                    text = "it moves through a thin obstacle in one step"
                    raise NoEquilibriumError(f"at {found.time:.6g} s: {text}")
                return found
            slow = not settled or moves > _SLOW * last
            last = moves
        raise NoEquilibriumError(f"the step from {moving.time:.6g} s does not converge")


def retarded(rod: Rod, time: float) -> Floats:
    """Viscosity of Kelvin and Voigt of all sections by one retardation time, (n, m, m).

    η = τ K with the stiffness K = ∂²Φ/∂ε² of the straight rod without pressure: what is viscous is
    the rubber, whose stress at rest, the geometric stiffness by a pressure, takes no part.

    Args:
        rod: the rod.
        time: τ, s.

    Returns:
        η, N s and N mm² s.
    """
    out: Floats = time * rod.law.hessian(rod.layout.at_rest(), 0.0)
    return out


def _matrices(viscosity: Floats | float, shape: tuple[int, int]) -> Floats:
    """η as matrices of all pieces, (n, m, m)."""
    given = np.asarray(viscosity, dtype=float)
    n, m = shape
    if given.ndim == 3:
        return np.broadcast_to(given, (n, m, m))
    out = np.zeros((n, m, m))
    out[:, range(m), range(m)] = np.broadcast_to(given, shape)
    return out

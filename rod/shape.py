"""The line of a rod by its strains: places, axes, and what forces and inertia see of them.

A piece of constant strains ξ = (v, k) in its own axes is a screw: with φ = h k

    R' = R exp [φ×],    r' = r + R h V(φ) v,    V(φ) = ∫₀¹ exp [u φ×] du,

exact for any strain and length (Sonneville, Cardona and Brüls 2014, doi 10.1016/j.cma.2013.10.008;
Renda, Boyer, Dias and Seneviratne 2018, doi 10.1109/TRO.2018.2868815). The unknowns are the
strains: nothing locks, no constraint is left and a rigid motion changes none. A change of a piece's
strains moves all beyond it as a rigid body, by u + ω × (r − r'); forces are summed from the tip
(Featherstone 2008, doi 10.1007/978-1-4899-7560-7); second derivatives are exact too.

'Frames' are the ends and the middles of the pieces in turn, 2 n + 1 of them: root, middle of the
first piece, its end, and so on.
"""

from __future__ import annotations

import functools

import numpy as np

from rod.functions import Floats, Pair, axial, cross, cross_matrix, stumpff, trace
from rod.layout import Layout

_PARTS = np.array([0.5, 1.0])
"""Of a piece: to its middle and to its end."""
_EYE = np.eye(3)


class Shape:
    """The rod at given strains.

    Args:
        layout: pieces and root.
        strains: free strains, (n, m).

    Attributes:
        layout: as given.
        strains: as given.
        frames: [R | r], axes as columns and place of each frame, (2 n + 1, 3, 4); 1 and mm.
    """

    def __init__(self, layout: Layout, strains: Floats) -> None:
        self.layout, self.strains = layout, strains
        n = len(layout.lengths)
        full = layout.full(strains)
        self._v, spin = full[:, :3], full[:, 3:]
        self._reach = _PARTS[:, None] * layout.lengths
        phi = self._reach[..., None] * spin
        c = stumpff(np.sum(phi * phi, axis=-1))
        self._turn, self._mean = Pair(phi, c, 1), Pair(phi, c, 2)
        self._means = self._mean.matrix()
        turns = self._turn.matrix()
        steps = self._reach[..., None] * (self._means @ self._v[:, :, None])[..., 0]
        roots = _chained(turns[1], steps[1], layout.rotation, layout.place)
        self.frames = np.empty((2 * n + 1, 3, 4))
        self.frames[::2] = roots[:, :3]
        self._base = roots[:-1, :3, :3]
        self.frames[1::2, :, :3] = self._base @ turns[0]
        self.frames[1::2, :, 3] = roots[:-1, :3, 3] + (self._base @ steps[0][..., None])[..., 0]

    @property
    def rotations(self) -> Floats:
        """R of the frames, (2 n + 1, 3, 3)."""
        return self.frames[..., :3]

    @property
    def places(self) -> Floats:
        """r of the frames, (2 n + 1, 3), mm."""
        return self.frames[..., 3]

    # --- first derivatives -----------------------------------------------------------------------

    @functools.cached_property
    def _basis(self) -> tuple[Floats, Floats]:
        """u and ω of middle and end of a piece by its own strains in space, (2, n, 3, m)."""
        reach = self._reach[..., None, None]
        moved = reach * self._means
        bent = reach**2 * self._mean.slope(np.broadcast_to(self._v, self._mean.phi.shape))
        shift = np.concatenate([moved, bent], axis=-1)
        turned = np.concatenate([np.zeros_like(moved), moved], axis=-1)
        columns = list(self.layout.columns)
        u: Floats = self._base @ shift[..., columns]
        omega: Floats = self._base @ turned[..., columns]
        return u, omega

    @functools.cached_property
    def _screws(self) -> tuple[Floats, Floats]:
        """u0 and ω of all beyond a piece about the origin, δr = u0 + ω × r, (n, 3, m) each."""
        u, omega = self._basis
        ends = self.places[2::2]
        return u[1] + cross_matrix(ends) @ omega[1], omega[1]

    def pulled(self, loads: Floats) -> Floats:
        """Generalised forces of loads on the frames: their virtual work by each strain.

        Args:
            loads: conjugates A of the frames [R | r], whose work is Σ A : δ[R | r],
                (2 n + 1, 3, 4), N mm and N. A force f at the place y of a section's own axes is
                f ⊗ (y, 1).

        Returns:
            Work by a unit of each free strain, (n, m), N mm and N mm².
        """
        force, dyad, beyond, about = self._forces(loads)
        u, omega = self._basis
        out: Floats = _dot(u[1], beyond) + _dot(omega[1], axial(about))
        out += _dot(u[0], force[1::2]) + _dot(omega[0], axial(dyad[1::2]))
        return out

    def jacobian(self, frame: int = -1) -> tuple[Floats, Floats]:
        """How a frame moves and turns with the strains.

        Args:
            frame: which; the tip if none is given.

        Returns:
            δr and the spin δθ in space by each strain, (3, n m) both, mm and rad.
        """
        frame = range(len(self.places))[frame]
        u0, omega = (part.copy() for part in self._screws)
        u0 -= cross_matrix(self.places[frame]) @ omega
        whole, half = divmod(frame, 2)
        u0[whole:], omega[whole:] = 0.0, 0.0
        if half:
            u0[whole], omega[whole] = (part[0, whole] for part in self._basis)
        count = u0.shape[0] * u0.shape[2]
        return _flat(u0, count), _flat(omega, count)

    def moved(self, rates: Floats) -> Floats:
        """Rates of all frames [R | r], (2 n + 1, 3, 4), by rates of the strains, (n, m)."""
        u, omega = self._basis
        u0, _ = self._screws
        spin, shift = np.zeros_like(self.places), np.zeros_like(self.places)
        spin[2::2] = np.cumsum(_apply(omega[1], rates), axis=0)
        shift[2::2] = np.cumsum(_apply(u0, rates), axis=0)
        # the middle with all before its piece, and within it by itself
        ahead = shift[:-1:2] + cross(spin[:-1:2], self.places[1::2])
        shift[2::2] += cross(spin[2::2], self.places[2::2])
        shift[1::2] = ahead + _apply(u[0], rates)
        spin[1::2] = spin[:-1:2] + _apply(omega[0], rates)
        return np.concatenate([cross_matrix(spin) @ self.rotations, shift[..., None]], axis=-1)

    # --- second derivatives ----------------------------------------------------------------------

    def curved(self, loads: Floats) -> Floats:
        """Second derivatives of the work of dead loads on the frames, Σ A : [R | r].

        A piece i before a piece j turns what j moves: ∂²r/∂i∂j = ω_i × ∂r/∂j. Within a piece they
        are those of its screw.

        Args:
            loads: A as of `pulled`.

        Returns:
            Symmetric matrix (n m, n m).
        """
        force, dyad, beyond, about = self._forces(loads)
        u, omega = self._basis
        moved = _couple(u[1], omega[1], beyond, about)
        moved += _couple(u[0], omega[0], force[1::2], dyad[1::2])
        n, m = self.layout.shape
        turns, moments = _flat(omega[1], n * m), _flat(moved, n * m)
        upper = _upper(turns.T @ moments, n, m)
        out = upper + upper.T
        own = self._own(
            np.stack([force[1::2], beyond]),
            np.stack([dyad[1::2], about]),
            np.stack([self.rotations[1::2], self.rotations[2::2]]),
        )
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = own
        return out

    def _own(self, force: Floats, dyad: Floats, ends: Floats) -> Floats:
        """Second derivatives within the pieces, (n, m, m), of forces at middle and end."""
        base = np.swapaxes(self._base, -1, -2)
        pull = (base @ force[..., None])[..., 0]
        reach = self._reach[..., None, None]
        turned = base @ np.swapaxes(dyad, -1, -2) @ ends
        carried = pull[..., :, None] * self._v[..., None, :]
        bend = self._turn.hessian(turned) + reach * self._mean.hessian(carried)
        blocks = np.zeros((*pull.shape[:-1], 6, 6))
        blocks[..., 3:, 3:] = reach**2 * bend
        for axis in range(3):
            along = np.zeros_like(carried)
            along[..., axis] = pull
            mixed = reach[..., 0] ** 2 * self._mean.gradient(along)
            blocks[..., 3:, axis] = blocks[..., axis, 3:] = mixed
        columns = list(self.layout.columns)
        out: Floats = blocks.sum(axis=0)[:, columns][:, :, columns]
        return out

    def spun(self, moment: Floats) -> Floats:
        """Derivative of the virtual work of a moment at the tip that keeps its direction.

        In space it has no potential: the matrix is not symmetric.

        Args:
            moment: M, (3,), N mm.

        Returns:
            ∂(ω_i·M)/∂ε_j, (n m, n m).
        """
        _, omega = self._basis
        n, m = self.layout.shape
        turns = _flat(omega[1], n * m)
        # j before i turns ω_i
        out = _upper(turns.T @ cross(moment[None], turns.T).T, n, m, lower=True)
        pull = np.einsum("nji,j->ni", self._base, moment)
        blocks = np.zeros((n, 6, 6))
        for axis in range(3):
            z = np.zeros((2, n, 3, 3))
            z[..., axis] = pull
            blocks[:, 3 + axis, 3:] = self._reach[1][:, None] ** 2 * self._mean.gradient(z)[1]
        columns = list(self.layout.columns)
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = blocks[:, columns][:, :, columns]
        return out

    # --- inertia ---------------------------------------------------------------------------------

    def mass(self, inertia: Floats, other: Shape | None = None) -> Floats:
        """Mass matrix ∫ ∂x/∂i · ∂x/∂j dm of masses on the frames.

        Args:
            inertia: ∫ (y, 1) ⊗ (y, 1) dm of each frame, y in its own axes, (2 n + 1, 4, 4), t mm²,
                t mm and t.
            other: the shape at which the derivatives by j are taken; this one if none is given.

        Returns:
            (n m, n m), symmetric where there is no other shape; t times the squared units of x.
        """
        right = self if other is None else other
        n, m = self.layout.shape
        weighed = self.frames @ inertia
        square = weighed @ np.swapaxes(right.frames, -1, -2)
        first, other_first = weighed[..., 3], (right.frames @ inertia[..., 3:])[..., 0]
        sums = (inertia[:, 3, 3], first, other_first, square)
        beyond = tuple(_after(part) for part in sums)
        out = np.zeros((n * m, n * m))
        left_own, right_own = self._about_origin(), right._about_origin()
        # momentum about the origin of all that j moves, tested with the screw of i before j
        pushed = [_momentum(beyond, right_own[1]), _momentum(_middle(sums), right_own[0])]
        momentum = np.concatenate([_flat(a + b, n * m) for a, b in zip(*pushed, strict=True)])
        left = np.concatenate([_flat(part, n * m) for part in left_own[1]])
        upper = _upper(left.T @ momentum, n, m)
        if other is None:
            out = upper + upper.T
        else:
            swapped = (beyond[0], beyond[2], beyond[1], np.swapaxes(beyond[3], -1, -2))
            middle = _middle(sums)
            middle = (middle[0], middle[2], middle[1], np.swapaxes(middle[3], -1, -2))
            pushed_left = [_momentum(swapped, left_own[1]), _momentum(middle, left_own[0])]
            back = np.concatenate([_flat(a + b, n * m) for a, b in zip(*pushed_left, strict=True)])
            ahead = np.concatenate([_flat(part, n * m) for part in right_own[1]])
            out = upper + _upper(back.T @ ahead, n, m, lower=True)
        own = sum(
            np.einsum("nki,nkj->nij", test, moved)
            for screw, momenta in zip((left_own[1], left_own[0]), pushed, strict=True)
            for test, moved in zip(screw, momenta, strict=True)
        )
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = own
        return out

    def _about_origin(self) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Screws about the origin of middle and end by a piece's own strains, (u0, ω) each."""
        u, omega = self._basis
        middle = u[0] + cross_matrix(self.places[1::2]) @ omega[0]
        return (middle, omega[0]), self._screws

    def _forces(self, loads: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Forces f and dyads Σ y ⊗ f in space of loads on the frames, and sums of all beyond.

        Returns:
            Of the frames, (2 n + 1, 3) and (2 n + 1, 3, 3), and beyond each piece, the dyads about
            its end, (n, 3) and (n, 3, 3); N and N mm.
        """
        force = loads[..., 3]
        dyad = self.rotations @ np.swapaxes(loads[..., :3], -1, -2)
        beyond = _after(force)
        about = _after(dyad + self.places[:, :, None] * force[:, None, :])
        about -= self.places[2::2, :, None] * beyond[:, None, :]
        return force, dyad, beyond, about


def _chained(turns: Floats, steps: Floats, rotation: Floats, place: Floats) -> Floats:
    """Frames at the root of the pieces and at the tip, (n + 1, 4, 4), by doubling the reach."""
    count = len(turns) + 1
    frames = np.zeros((count, 4, 4))
    frames[:, 3, 3] = 1.0
    frames[0, :3, :3], frames[0, :3, 3] = rotation, place
    frames[1:, :3, :3], frames[1:, :3, 3] = turns, steps
    reach = 1
    while reach < count:
        frames[reach:] = frames[:-reach] @ frames[reach:]
        reach *= 2
    return frames


def _after(values: Floats) -> Floats:
    """Sums over all frames from the end of each piece on."""
    back: Floats = np.cumsum(values[::-1], axis=0)[::-1]
    return back[2::2].copy()


def _middle(sums: tuple[Floats, ...]) -> tuple[Floats, ...]:
    return tuple(part[1::2] for part in sums)


def _momentum(sums: tuple[Floats, ...], screw: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """Momentum and its moment about the origin of masses that a screw moves, (n, 3, m) both.

    They are Σ m δy and Σ m x × δy with δy = u + ω × y; Σ m x × (ω × y) = (tr S − Sᵀ) ω
    with S = Σ m x ⊗ y.
    """
    mass, first, other, square = sums
    u, omega = screw
    linear = mass[:, None, None] * u - cross_matrix(other) @ omega
    inertia = trace(square)[:, None, None] * _EYE - np.swapaxes(square, -1, -2)
    return linear, cross_matrix(first) @ u + inertia @ omega


def _couple(u: Floats, omega: Floats, force: Floats, dyad: Floats) -> Floats:
    """Σ δ(r + y) × f of forces that u + ω × y moves, (n, 3, m)."""
    square = trace(dyad)[:, None, None]
    out: Floats = dyad @ omega - cross_matrix(force) @ u - square * omega
    return out


def _upper(matrix: Floats, n: int, m: int, lower: bool = False) -> Floats:
    """What a piece before another makes with it: blocks above the diagonal, or below it."""
    out: Floats = matrix * _before(n, m, lower)
    return out


@functools.cache
def _before(n: int, m: int, lower: bool) -> Floats:
    rows = np.repeat(np.arange(n), m)
    keep = rows[:, None] > rows if lower else rows[:, None] < rows
    return keep.astype(float)


def _flat(columns: Floats, count: int) -> Floats:
    """(3, n m) of (n, 3, m)."""
    return np.ascontiguousarray(np.swapaxes(columns, 0, 1)).reshape(3, count)


def _dot(columns: Floats, vectors: Floats) -> Floats:
    out: Floats = np.einsum("nkm,nk->nm", columns, vectors)
    return out


def _apply(columns: Floats, rates: Floats) -> Floats:
    out: Floats = np.einsum("nkm,nm->nk", columns, rates)
    return out

"""The line of a rod by its strains: places, axes, and what forces and inertia see of them.

A piece of constant strains ξ = (v, k) in its own axes is a screw: with φ = h k

    R' = R exp [φ×],    r' = r + R h V(φ) v,    V(φ) = ∫₀¹ exp [u φ×] du,

exact for any strain and length (Sonneville, Cardona and Brüls 2014, doi 10.1016/j.cma.2013.10.008;
Renda, Boyer, Dias and Seneviratne 2018, doi 10.1109/TRO.2018.2868815). The unknowns are the
strains: nothing locks, no constraint is left and a rigid motion changes none. A change of a piece's
strains moves all beyond it as a rigid body, by u + ω × (r − r'); forces are summed from the tip
(Featherstone 2008, doi 10.1007/978-1-4899-7560-7); second derivatives are exact too.

'Frames' are the root and the ends of the pieces, n + 1 of them: axes R and place r.
"""

from __future__ import annotations

import functools

import numpy as np

from rod.functions import Floats, Ints, Pair, axial, cross, cross_matrix, matrices, stumpff, trace
from rod.layout import Layout

_EYE = np.eye(3)


class Shape:
    """The rod at given strains.

    Args:
        layout: pieces and root.
        strains: free strains, (n, m).

    Attributes:
        layout: as given.
        strains: as given.
    """

    def __init__(self, layout: Layout, strains: Floats) -> None:
        self.layout, self.strains = layout, strains

    @functools.cached_property
    def frames(self) -> Floats:
        """[R | r], axes as columns and place of each frame, (n + 1, 3, 4); 1 and mm."""
        layout, (_, _, turns, means) = self.layout, self._screw
        steps = (self._reach * (means @ self._v[..., None]))[..., 0]
        return _chained(turns, steps, layout.rotation, layout.place)[:, :3]

    @functools.cached_property
    def _full(self) -> Floats:
        """All six strains, (n, 6)."""
        return self.layout.full(self.strains)

    @property
    def _v(self) -> Floats:
        return self._full[:, :3]

    @property
    def _spin(self) -> Floats:
        return self._full[:, 3:]

    @property
    def _reach(self) -> Floats:
        return self.layout.lengths[:, None, None]

    @functools.cached_property
    def _screw(self) -> tuple[Pair, Pair, Floats, Floats]:
        """The turn of each piece and its mean, and their matrices, (n, 3, 3)."""
        phi = self._reach[..., 0] * self._spin
        c = stumpff(np.sum(phi * phi, axis=-1))
        return Pair(phi, c, 1), Pair(phi, c, 2), *matrices(phi, c)

    @property
    def _base(self) -> Floats:
        """R at the begin of each piece, (n, 3, 3)."""
        return self.frames[:-1, :, :3]

    @property
    def rotations(self) -> Floats:
        """R of the frames, (n + 1, 3, 3)."""
        return self.frames[..., :3]

    @property
    def places(self) -> Floats:
        """r of the frames, (n + 1, 3), mm."""
        return self.frames[..., 3]

    @property
    def arcs(self) -> Floats:
        """Lengths of the pieces' lines, (n,), mm."""
        out: Floats = self._reach[:, 0, 0] * np.linalg.norm(self._v, axis=1)
        return out

    def between(self, pieces: Ints, parts: Floats) -> Floats:
        """Frames within pieces, (s, 3, 4).

        Args:
            pieces: which, (s,).
            parts: of the piece before each frame, 0 to 1, (s,).
        """
        reach = parts[:, None] * self._reach[pieces, 0]
        phi = reach * self._spin[pieces]
        c = stumpff(np.sum(phi * phi, axis=-1))
        step = np.concatenate(
            [
                Pair(phi, c, 1).matrix(),
                reach[..., None] * (Pair(phi, c, 2).matrix() @ self._v[pieces][..., None]),
            ],
            axis=-1,
        )
        out: Floats = self._base[pieces] @ step
        out[..., 3] += self.places[pieces]
        return out

    def along(self, reach: Floats) -> Floats:
        """Axes and places [R | r] of sections anywhere, (k, 3, 4).

        Args:
            reach: of each from the root along the rod at rest, (k,), mm.
        """
        lengths = self.layout.lengths
        ends = np.cumsum(lengths)
        piece = np.minimum(np.searchsorted(ends, reach), len(ends) - 1)
        return self.between(piece, 1 - (ends[piece] - reach) / lengths[piece])

    # --- first derivatives -----------------------------------------------------------------------

    @functools.cached_property
    def _basis(self) -> tuple[Floats, Floats]:
        """u and ω of a piece's end by its own strains in space, (n, 3, m)."""
        reach = self._reach
        moved = reach * self._screw[3]
        bent = reach**2 * self._screw[1].slope(self._v)
        shift = np.concatenate([moved, bent], axis=-1)
        turned = np.concatenate([np.zeros_like(moved), moved], axis=-1)
        columns = self.layout.columns
        u: Floats = self._base @ shift[..., columns]
        omega: Floats = self._base @ turned[..., columns]
        return u, omega

    @functools.cached_property
    def _screws(self) -> tuple[Floats, Floats]:
        """u0 and ω of all beyond a piece about the origin, δr = u0 + ω × r, (n, 3, m) each."""
        u, omega = self._basis
        return u + cross_matrix(self.places[1:]) @ omega, omega

    def pulled(self, loads: Floats) -> Floats:
        """Generalised forces of loads on the frames: their virtual work by each strain.

        Args:
            loads: conjugates A of the frames [R | r], whose work is Σ A : δ[R | r],
                (n + 1, 3, 4), N mm and N. A force f at the place y of a section's own axes is
                f ⊗ (y, 1).

        Returns:
            Work by a unit of each free strain, (n, m), N mm and N mm².
        """
        u0, omega = self._screws
        # [R | r] Aᵀ: the dyads Σ y ⊗ f about the origin
        total = _after(loads[..., 3])
        about = _after(self.frames @ np.swapaxes(loads, -1, -2))
        out: Floats = total[:, None] @ u0 + axial(about)[:, None] @ omega
        return out[:, 0]

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
        u0[frame:], omega[frame:] = 0.0, 0.0
        count = u0.shape[0] * u0.shape[2]
        return _flat(u0, count), _flat(omega, count)

    def moved(self, rates: Floats) -> Floats:
        """Rates of all frames [R | r], (n + 1, 3, 4), by rates of the strains, (n, m)."""
        u0, omega = self._screws
        spin, shift = np.zeros_like(self.places), np.zeros_like(self.places)
        np.cumsum(np.einsum("nkm,nm->nk", omega, rates), axis=0, out=spin[1:])
        np.cumsum(np.einsum("nkm,nm->nk", u0, rates), axis=0, out=shift[1:])
        shift += cross(spin, self.places)
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
        force, about = self._beyond(loads)
        u, omega = self._basis
        n, m = self.layout.shape
        turns, moments = (_flat(part, n * m) for part in (omega, _couple(u, omega, force, about)))
        upper = _upper(turns.T @ moments, n, m)
        out = upper + upper.T
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = self._own(force, about)
        return out

    def _own(self, force: Floats, dyad: Floats) -> Floats:
        """Second derivatives within the pieces, (n, m, m), of forces beyond them."""
        base = np.swapaxes(self._base, -1, -2)
        pull = (base @ force[..., None])[..., 0]
        reach = self._reach
        turned = base @ np.swapaxes(dyad, -1, -2) @ self.rotations[1:]
        carried = pull[..., :, None] * self._v[..., None, :]
        bend = self._screw[0].hessian(turned) + reach * self._screw[1].hessian(carried)
        blocks = np.zeros((len(pull), 6, 6))
        blocks[:, 3:, 3:] = reach**2 * bend
        for axis in range(3):
            along = np.zeros_like(carried)
            along[..., axis] = pull
            mixed = reach[..., 0] ** 2 * self._screw[1].gradient(along)
            blocks[:, 3:, axis] = blocks[:, axis, 3:] = mixed
        columns = self.layout.columns
        return blocks[:, columns][:, :, columns]

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
        turns = _flat(omega, n * m)
        # j before i turns ω_i
        out = _upper(turns.T @ cross(moment[None], turns.T).T, n, m, lower=True)
        pull = np.einsum("nji,j->ni", self._base, moment)
        blocks = np.zeros((n, 6, 6))
        for axis in range(3):
            z = np.zeros((n, 3, 3))
            z[..., axis] = pull
            blocks[:, 3 + axis, 3:] = self._reach[..., 0] ** 2 * self._screw[1].gradient(z)
        columns = self.layout.columns
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = blocks[:, columns][:, :, columns]
        return out

    def stiffened(self, blocks: Floats, other: Shape | None = None) -> Floats:
        """Σ s_i · B s_j of springs on the frames, s the screw (u0, ω) of what moves a frame.

        With ∂x = u0 + ω × x of a point x, a stiffness D there is the block AᵀD A, A = (I, −[x×]).

        Args:
            blocks: B of each frame about the origin, (n + 1, 6, 6); symmetric with one shape alone.
            other: the shape at which s_j are taken; this one if none is given.

        Returns:
            Matrix (n m, n m).
        """
        n, m = self.layout.shape
        screws = np.concatenate(self._screws, axis=1)
        ahead = screws if other is None else np.concatenate(other._screws, axis=1)
        sums = _after(blocks)
        left, right = (_flat(part, n * m) for part in (screws, sums @ ahead))
        out = _upper(left.T @ right, n, m)
        if other is None:
            out = out + out.T
        else:
            back = _flat(np.swapaxes(sums, 1, 2) @ screws, n * m)
            out += _upper(back.T @ _flat(ahead, n * m), n, m, lower=True)
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = np.swapaxes(screws, 1, 2) @ sums @ ahead
        return out

    # --- inertia ---------------------------------------------------------------------------------

    def mass(self, inertia: Floats, other: Shape | None = None) -> Floats:
        """Mass matrix ∫ ∂x/∂i · ∂x/∂j dm of masses on the frames.

        Args:
            inertia: ∫ (y, 1) ⊗ (y, 1) dm of each frame, y in its own axes, (n + 1, 4, 4), t mm²,
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
        mass, x, y, square = (_after(part) for part in sums)
        left, ahead = (_stacked(*shape._screws, n * m) for shape in (self, right))
        # momentum about the origin of all that j moves, tested with the screw of i before j
        pushed = _momentum((mass, x, y, square), right._screws)
        out = _upper(left.T @ _stacked(*pushed, n * m), n, m)
        if other is None:
            out = out + out.T
        else:
            swapped = (mass, y, x, np.swapaxes(square, -1, -2))
            back = _stacked(*_momentum(swapped, self._screws), n * m)
            out = out + _upper(back.T @ ahead, n, m, lower=True)
        place = np.arange(n)
        out.reshape(n, m, n, m)[place, :, place] = sum(
            np.swapaxes(test, 1, 2) @ moved
            for test, moved in zip(self._screws, pushed, strict=True)
        )
        return out

    def _beyond(self, loads: Floats) -> tuple[Floats, Floats]:
        """Forces of loads on all frames beyond each piece, and their dyads about its end.

        Returns:
            Σ f, (n, 3), N, and Σ y ⊗ f in space, (n, 3, 3), N mm.
        """
        force = loads[..., 3]
        dyad = self.rotations @ np.swapaxes(loads[..., :3], -1, -2)
        total = _after(force)
        about = _after(dyad + self.places[:, :, None] * force[:, None, :])
        about -= self.places[1:, :, None] * total[:, None, :]
        return total, about


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
    back: Floats = np.cumsum(values[:0:-1], axis=0)[::-1]
    return back


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
    """(k, n m) of (n, k, m)."""
    rows = np.ascontiguousarray(np.swapaxes(columns, 0, 1))
    return rows.reshape(columns.shape[1], count)


def _stacked(first: Floats, second: Floats, count: int) -> Floats:
    """(6, n m) of two of (n, 3, m)."""
    return np.concatenate([_flat(first, count), _flat(second, count)])

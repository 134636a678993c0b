"""The line of a rod that stays in the plane of y and z of its root, by complex numbers.

A point of the plane is w = z − i y in the axes of the root: a curvature k turns it by e^{iθ}. With
φ = h k and the functions E_k(z) = Σ z^j/(j + k)!, which have E_k' = E_k − k E_{k+1} (Hochbruck and
Ostermann 2010, doi 10.1017/S0962492910000048), a piece is

    θ' = θ + φ,    p' = p + h e^{iθ} E_1(iφ) v,    v = v_z − i v_y:

the screw of `rod.shape` with a third of its numbers. What is not derived here is that shape's own.
"""

from __future__ import annotations

import functools
from typing import NamedTuple, TypeVar, cast

import numpy as np
import numpy.typing as npt

from rod.functions import Bools, Floats, stumpff
from rod.layout import STRAINS, Layout
from rod.shape import Shape

Complex = npt.NDArray[np.complex128]
Values = TypeVar("Values", Floats, Complex)
_SHEAR, _STRETCH, _CURVATURE = (STRAINS.index(n) for n in ("shear_y", "stretch", "curvature"))


class _Planar(NamedTuple):
    """What acts on the frames, or moves with them, in the plane: by place p and turn θ of each."""

    force: Complex
    """f with the work Re(f* δp)."""
    turning: Complex
    """g with the work Re(g* e^{iθ}) δθ."""


class PlaneShape(Shape):
    """A rod at given strains of a layout in the plane; see `Shape`."""

    def __init__(self, layout: Layout, strains: Floats) -> None:
        super().__init__(layout, strains)
        h = layout.lengths
        full = layout.full(strains)
        self._line: Complex = full[:, _STRETCH] - 1j * full[:, _SHEAR]
        phi: Floats = h * full[:, _CURVATURE]
        square: Floats = phi * phi
        c = stumpff(square)
        self._e: Complex = np.asarray(c[:4] + 1j * phi * c[1:5])
        turn = np.zeros(len(h) + 1)
        np.cumsum(phi, out=turn[1:])
        self._turned: Complex = np.exp(1j * turn)
        self._ahead: Complex = h * self._turned[:-1]
        place = np.zeros(len(h) + 1, dtype=complex)
        np.cumsum(self._ahead * self._e[1] * self._line, out=place[1:])
        self._place: Complex = place

    @functools.cached_property
    def frames(self) -> Floats:
        """See `Shape`."""
        turn = self._turned
        out = np.zeros((len(turn), 3, 4))
        out[:, 0, 0] = 1.0
        out[:, 1, 1] = out[:, 2, 2] = turn.real
        out[:, 2, 1] = turn.imag
        out[:, 1, 2] = -turn.imag
        out[:, 1, 3], out[:, 2, 3] = -self._place.imag, self._place.real
        if self.layout.turned:
            out = self.layout.rotation @ out
        out[:, :, 3] += self.layout.place
        return out

    @functools.cached_property
    def _columns(self) -> tuple[Complex, Floats]:
        """δp of the end of a piece about the root, and δθ, by its own strains, (n, m) both."""
        h, layout = self.layout.lengths, self.layout
        e = self._e
        way = self._ahead * e[1]
        bent = 1j * (h * self._ahead * (e[1] - e[2]) * self._line - h * self._place[1:])
        by = {_SHEAR: -1j * way, _STRETCH: way, _CURVATURE: bent}
        u = np.stack([by[column] for column in layout.columns], axis=1)
        omega = np.zeros(u.shape)
        if _CURVATURE in layout.columns:
            omega[:, layout.columns.index(_CURVATURE)] = h
        return u, omega

    @functools.cached_property
    def _screws(self) -> tuple[Floats, Floats]:
        """See `Shape`."""
        u, omega = self._columns
        n, m = u.shape
        shift, spin = np.zeros((n, 3, m)), np.zeros((n, 3, m))
        shift[:, 1], shift[:, 2], spin[:, 0] = -u.imag, u.real, omega
        if self.layout.turned:
            shift, spin = self.layout.rotation @ shift, self.layout.rotation @ spin
        # about the origin of space, not about the root
        shift += np.cross(self.layout.place, spin, axisb=1, axisc=1)
        return shift, spin

    def _planar(self, loads: Floats) -> _Planar:
        """Of loads on the frames, (n + 1, 3, 4), what is in the plane."""
        if self.layout.turned:
            loads = self.layout.rotation.T @ loads
        w: Complex = loads[:, 2] - 1j * loads[:, 1]
        return _Planar(w[:, 3], w[:, 1] - 1j * w[:, 2])

    def pulled(self, loads: Floats) -> Floats:
        """See `Shape`."""
        force, turning = self._planar(loads)
        u, omega = self._columns
        moment = (np.conj(turning) * self._turned + 1j * np.conj(force) * self._place).real
        total = _after(np.conj(force))
        out: Floats = (total[:, None] * u).real + _after(moment)[:, None] * omega
        return out

    def curved(self, loads: Floats) -> Floats:
        """See `Shape`."""
        force, turning = self._planar(loads)
        u, omega = self._columns
        n, m = u.shape
        total = _after(np.conj(force))
        square = (1j * np.conj(turning) * self._turned - np.conj(force) * self._place).real
        bent = _after(square)
        # a piece before another turns what the other moves
        turned = (1j * total[:, None] * u).real + bent[:, None] * omega
        out = np.outer(omega, turned)
        out = np.where(_before(n, m), out, out.T)
        columns, place, blocks = self.layout.columns, np.arange(n), out.reshape(n, m, n, m)
        blocks[place, :, place] = 0.0
        if _CURVATURE not in columns:
            return out
        h, e, k = self.layout.lengths, self._e, columns.index(_CURVATURE)
        pull = total * h * self._ahead
        mixed = 1j * pull * (e[1] - e[2])
        for column, sign in ((_SHEAR, -1j), (_STRETCH, 1.0)):
            if column in columns:
                at = columns.index(column)
                value = (sign * mixed).real
                blocks[place, at, place, k] = blocks[place, k, place, at] = value
        own = -pull * (e[1] - 2 * e[2] + 2 * e[3]) * self._line + h * total * self._place[1:]
        blocks[place, k, place, k] = h * own.real + h**2 * bent
        return out

    def mass(self, inertia: Floats, other: Shape | None = None) -> Floats:
        """See `Shape`."""
        right = self if other is None else other
        assert isinstance(right, PlaneShape), "shapes of one rod"
        # of the points x = p + e^{iθ} a that a frame carries: Σ m, Σ m a, Σ m |a|²
        mass, arm = inertia[:, 3, 3], inertia[:, 2, 3] - 1j * inertia[:, 1, 3]
        second = inertia[:, 1, 1] + inertia[:, 2, 2]
        first: Complex = mass * self._place + self._turned * arm
        ahead: Complex = mass * right._place + right._turned * arm
        square = np.conj(first) * right._place
        square += right._turned * (np.conj(self._place) * arm + np.conj(self._turned) * second)
        total, x, y, xy = _after(mass), _after(first), _after(ahead), _after(square)
        n, m = self.layout.shape
        left = _rows(*self._columns)
        # momentum of all that j moves, tested with what moves i before j or itself
        out: Floats = left.T @ _rows(*_momentum(total, np.conj(x), y, xy, right._columns))
        if other is None:
            return np.where(_before(n, m), out, out.T)
        back = _rows(*_momentum(total, np.conj(y), x, np.conj(xy), self._columns))
        return np.where(_before(n, m), out, back.T @ _rows(*right._columns))

    def moved(self, rates: Floats) -> Floats:
        """See `Shape`."""
        u, omega = self._columns
        spin, shift = np.zeros(len(self._place)), np.zeros_like(self._place)
        np.cumsum((omega * rates).sum(axis=1), out=spin[1:])
        np.cumsum((u * rates).sum(axis=1), out=shift[1:])
        shift += 1j * self._place * spin
        turn = spin * self._turned
        out = np.zeros((len(spin), 3, 4))
        out[:, 1, 1] = out[:, 2, 2] = -turn.imag
        out[:, 2, 1], out[:, 1, 2] = turn.real, -turn.real
        out[:, 1, 3], out[:, 2, 3] = -shift.imag, shift.real
        return self.layout.rotation @ out if self.layout.turned else out


def placed(layout: Layout, strains: Floats) -> Shape:
    """The line of a rod at given strains: in the plane where its strains leave it there."""
    return PlaneShape(layout, strains) if layout.plane else Shape(layout, strains)


def _after(values: Values) -> Values:
    """Sums over all frames from the end of each piece on."""
    return cast(Values, np.cumsum(values[:0:-1])[::-1])


def _momentum(
    mass: Floats, first: Complex, ahead: Complex, square: Complex, columns: tuple[Complex, Floats]
) -> tuple[Complex, Floats]:
    """Momentum and its moment about the root, (n, m) both, of masses that u + i x ω moves.

    Args:
        mass: Σ m, (n,).
        first: Σ m x*, of the places about which the moment is.
        ahead: Σ m x', of those that move.
        square: Σ m x* x'.
        columns: u and ω of what moves.
    """
    u, omega = columns
    linear = mass[:, None] * u + 1j * ahead[:, None] * omega
    return linear, (square[:, None] * omega - 1j * first[:, None] * u).real


def _rows(u: Complex, omega: Floats) -> Floats:
    """(3, n m) with products Re(u* u') + ω ω'."""
    return np.stack([u.real.ravel(), u.imag.ravel(), omega.ravel()])


@functools.cache
def _before(n: int, m: int) -> Bools:
    """Blocks above the diagonal and on it."""
    rows = np.repeat(np.arange(n), m)
    out: Bools = rows[:, None] <= rows
    return out

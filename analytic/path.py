"""Lines of constant curvature, plane and in space, and where the tip of one is. mm, rad."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

import numpy as np

from analytic.stress import Floats

_NEXT, _LAST = [1, 2, 0], [2, 0, 1]


def cross_matrix(vector: Floats) -> Floats:
    """The matrix of the cross product with a vector, [a×] x = a × x.

    Args:
        vector: a, (3,).

    Returns:
        Skew matrix (3, 3).
    """
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def screw(z: Floats, spin: Floats, stretch: float) -> tuple[Floats, Floats]:
    """A frame that moves along its own axis e3 at a constant rate while it turns at one.

    R' = R [ω×] and c' = λ R e3 from R = I and c = 0. With φ = |ω| z and N = [ω×]/|ω|

        R = I + sin φ N + (1 − cos φ) N²,
        c = λ z [I + (1 − cos φ)/φ N + (1 − sin φ/φ) N²] e3:

    a straight line, an arc (ω ⊥ e3), a twist (ω ∥ e3) or a helix. Rodrigues' formula and its
    integral; Murray, Li and Sastry 1994, A Mathematical Introduction to Robotic Manipulation,
    eqs. (2.14) and (2.36).

    Args:
        z: stations z, (n,), mm.
        spin: ω in the frame itself, (3,), rad/mm; (k_x, k_y, τ) bends toward −y and x, and twists.
        stretch: λ, mm of axis a mm of z.

    Returns:
        Rotations R, (n, 3, 3), and places c, (n, 3), mm.
    """
    rate = float(np.linalg.norm(spin))
    cross = cross_matrix(spin / rate if rate else spin)
    square = cross @ cross
    reach = z[:, None, None]
    turn = rate * reach
    rotation = np.eye(3) + np.sin(turn) * cross + (1 - np.cos(turn)) * square
    # sin φ/φ and (1 − cos φ)/φ by sinc, which needs no limit at φ = 0
    chord = reach * np.sinc(turn / np.pi)
    rise = reach * np.sinc(turn / (2 * np.pi)) * np.sin(turn / 2)
    place = reach * np.eye(3) + rise * cross + (reach - chord) * square
    return rotation, stretch * place[..., 2]


def centre_line(
    spin: Floats,
    stretch: complex | Floats,
    centre: Floats,
    across: tuple[Floats, Floats] | None = None,
) -> tuple[Floats, Floats, Floats]:
    """The line of a point that stays at its place in a screwing frame, and how it bends and twists.

    The frame of `screw` carries the point c along at g = λ e3 + ω × c a mm of z. Its line has the
    stretch |g| and the tangent t = g/|g|. The axes d1, d2 across it are those of the frame, turned
    by the least rotation that takes e3 to t:

        d_i = e_i − t_i/(1 + t_3) (e3 + t),      i = 1, 2.

    On them ω = (ω·d1) d1 + (ω·d2) d2 + (ω·t) t: the first two turn the tangent, t' = ω × t, the
    last one turns the axes about it. A change of the frame, to another point and other axes, moves
    none of them, apart from a turn about e3; where no symmetry keeps e1 and e2, d1 and d2 are
    those of `section_axes`, which do not hang on the frame. Where half a turn about y or a mirror
    plane keeps them, both are the same. Analytic in all arguments, so that complex steps
    differentiate it.

    Args:
        spin: ω, (..., 3), rad/mm.
        stretch: λ of the frame's own origin, (...); like the others real, or complex to
            differentiate.
        centre: c in the frame, (..., 3), mm.
        across: what has become of the section's axes, a_x and a_y; None: symmetry keeps them.

    Returns:
        |g|, (...); ω on (d1, d2, t), (..., 3), rad/mm of z; the axes as columns d1, d2, t,
        (..., 3, 3).
    """
    along = np.array([0.0, 0.0, 1.0])
    carried = _product(spin, centre) + np.asarray(stretch)[..., None] * along
    length = np.sqrt(np.sum(carried * carried, axis=-1))
    t = carried / length[..., None]
    if across is not None:
        axes = section_axes(*across, t)
    else:
        axes = np.tile(np.eye(3, dtype=t.dtype), (*t.shape[:-1], 1, 1))
        tilt = t[..., :2] / (1 + t[..., 2:])
        axes[..., :2] -= (t + along)[..., :, None] * tilt[..., None, :]
        axes[..., 2] = t
    return length, (spin[..., None, :] @ axes)[..., 0, :], axes


def chained(parts: Sequence[tuple[Floats, Floats]]) -> list[tuple[Floats, Floats]]:
    """Frames at the root of every part of a line that is put together, and at its end.

    A part carries a frame from its root, the axes e1, e2, e3 at the origin, to its end R, c. Put
    together, R_{i+1} = R_i R and c_{i+1} = c_i + R_i c: the end of a part is the root of the next.

    Args:
        parts: R, (3, 3), and c, (3,), mm, of every part from root to tip.

    Returns:
        Rotations and places, one more than parts, the first ones those of space.
    """
    rotation, place = np.eye(3), np.zeros(3)
    frames = [(rotation, place)]
    for turn, step in parts:
        rotation, place = rotation @ turn, place + rotation @ step
        frames.append((rotation, place))
    return frames


def section_axes(a_x: Floats, a_y: Floats, along: Floats) -> Floats:
    """Axes across a direction t, by what has become of a section's own axes.

    d1 ∥ a_x + a_y × t (the part across t), d2 = t × d1: of all turned pairs the nearest to the
    images a_x and a_y across t, the rotation of their polar decomposition in that plane. Analytic,
    so that complex steps differentiate it.

    Args:
        a_x: images of e1, (..., 3).
        a_y: images of e2, (..., 3).
        along: directions ∥ t, of any length, (..., 3).

    Returns:
        Rotations with d1, d2 and t as columns, (..., 3, 3).
    """
    t = _unit(along)
    d1 = _unit(a_x - np.sum(a_x * t, axis=-1, keepdims=True) * t + _product(a_y, t))
    return np.stack([d1, _product(t, d1), t], axis=-1)


def _product(a: Floats, b: Floats) -> Floats:
    """a × b, (..., 3); of few vectors numpy's own takes four times as long."""
    product: Floats = a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]
    return product


def _unit(vectors: Floats) -> Floats:
    unit: Floats = vectors / np.sqrt(np.sum(vectors * vectors, axis=-1, keepdims=True))
    return unit


@dataclasses.dataclass(frozen=True)
class CentreLine:
    """The line of the sections' centroids in a body that bends and twists uniformly.

    Attributes:
        spin: ω of the frame that turns with the section, (3,), rad/mm.
        carried: λ, mm by which the frame's origin moves along e3 a mm of z.
        centre: c, the centroid in that frame, (3,), mm.
        stretch: of the centre-line.
        rates: turn of the tangent about d1 and d2, and of the section about the tangent, (3,),
            rad a mm of z.
        axes: d1, d2 and the tangent t in the frame, as columns, (3, 3).
        section: axes of the section and its normal in the frame, as columns, (3, 3). Where a body
            bends and twists it is sheared too: the normal is not the tangent.
    """

    spin: Floats
    carried: float
    centre: Floats
    stretch: float
    rates: Floats
    axes: Floats
    section: Floats

    @classmethod
    def of(
        cls,
        spin: Floats,
        carried: float,
        centre: Floats,
        a_x: Floats,
        a_y: Floats,
        turned: bool = False,
    ) -> CentreLine:
        """By frame and section, see `centre_line` and `section_axes`.

        Args:
            spin: ω, (3,), rad/mm.
            carried: λ.
            centre: c, (3,), mm.
            a_x: image in the frame of the section's axis x, (3,).
            a_y: of its axis y.
            turned: no symmetry keeps these axes: a section may turn in its frame about e3.
        """
        across = (a_x, a_y) if turned else None
        stretch, rates, axes = centre_line(spin, carried, centre, across)
        section = section_axes(a_x, a_y, _product(a_x, a_y))
        return cls(spin, carried, centre, float(stretch), rates, axes, section)

    def advance(self, position: Floats) -> Floats:
        """∂x/∂z of points that keep their place in the frame, λ e3 + ω × x'.

        Args:
            position: x' in the frame, (..., 3), mm.

        Returns:
            In the frame, (..., 3); its norm is the stretch of the point's line.
        """
        along: Floats = _product(self.spin, position) + np.array([0.0, 0.0, self.carried])
        return along

    def turning(self, z: Floats) -> tuple[Floats, Floats]:
        """The turning frame in space, its section at z = 0 held by a clamp across e3.

        Args:
            z: stations, (n,), mm.

        Returns:
            Rotations from the frame to space, (n, 3, 3), and places of the centroids, the first
            one the origin, (n, 3), mm.
        """
        along, line = screw(z, self.rates, self.stretch)
        # from the axes of the line, which start as e1, e2, e3, to a section that does
        held = self.section.T @ self.axes
        return held @ along @ self.axes.T, line @ held.T

    def sections(self, z: Floats) -> tuple[Floats, Floats]:
        """The sections themselves: their axes and normal, e1, e2 and e3 at z = 0, and places.

        Args:
            z: stations, (n,), mm.

        Returns:
            Rotations, (n, 3, 3), and centroids, (n, 3), mm.
        """
        rotation, place = self.turning(z)
        return rotation @ self.section, place


def arc(
    angle: Floats | float,
    length: Floats | float,
    ahead: Floats | float = 0.0,
    height: Floats | float = 0.0,
) -> Floats:
    """Points at the end of plane arcs that start along z at the origin; `screw` in the plane.

    The chord is L sin(θ/2)/(θ/2) long, at half the angle. All arguments broadcast.

    Args:
        angle: turns θ of the tangent, rad, positive toward −y.
        length: arc lengths L, mm.
        ahead: of a point, along the end's tangent, mm.
        height: of a point, along the end's normal (y where θ = 0), mm.

    Returns:
        Points (z, −y), (..., 2), mm.
    """
    angle = np.asarray(angle, dtype=float)
    # sinc needs no limit at θ = 0
    chord = np.asarray(length) * np.sinc(angle / (2 * math.pi))
    cos, sin = np.cos(angle), np.sin(angle)
    along = chord * np.cos(angle / 2) + ahead * cos + height * sin
    down = chord * np.sin(angle / 2) + ahead * sin - height * cos
    return np.stack(np.broadcast_arrays(along, down), axis=-1)


def tip(
    angle: Floats | float, length: Floats | float, cap: float = 0.0, height: float = 0.0
) -> Floats:
    """Tip of a constant-curvature arc that starts along z at the origin, with a straight cap.

    Args:
        angle: bending angles θ, rad, positive toward −y.
        length: arc lengths L, mm; broadcast with `angle`, so that `tip(θ s, L s)` with s from 0 to
            1 is the whole arc.
        cap: length of a straight end that goes on along the tangent, mm.
        height: height of the tracked point above the arc in the section's own frame, mm.

    Returns:
        Points (z, −y), (..., 2), mm.

    Raises:
        ValueError: a length or a cap that is negative or not finite.
    """
    length = np.asarray(length, dtype=float)
    if not np.all((length >= 0) & (length < math.inf)):
        raise ValueError(f"length: zero or positive mm expected, not {length}")
    if not 0 <= cap < math.inf:
        raise ValueError(f"cap: zero or positive mm expected, not {cap}")
    return arc(angle, length, cap, height)

"""Drucker's condition: a step of strain must cost work, whatever its direction.

An incompressible sheet that is free in one direction is stable in the state of logarithmic strains
h, h1 + h2 + h3 = 0, where the tangent ∂²W/∂h∂h on this plane is positive definite (that of the
Kirchhoff stress; the condition of Abaqus' "material stability"). By isotropy states of one order,
h1 ≥ h2 ≥ h3, stand for all: strains s, b s, −(1 + b) s with b from −1/2, a bar that is pulled, by
0, pure shear, to 1, a sheet that is pulled to all sides or, the same state, a bar that is pressed.
So s ≤ ln λ are all states, in tension and in compression, without a stretch above λ.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from materials.fit.form import Form, Numbers
from materials.stretches import Floats

MARGIN = 0.01
"""Part of the stiffness at rest that a fit keeps in every state."""
MOST = 10.0
"""Greatest stretch to which stability is looked for."""
_PLANE = np.array([[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]) / np.sqrt([[2.0], [6.0]])
_STEP = 1e-5
_RAYS = np.linspace(-0.5, 1.0, 13)


@dataclasses.dataclass(frozen=True)
class Stability:
    """How far a law is stable.

    Attributes:
        stretch: greatest stretch up to which all states are stable; `MOST` where it is not lost.
        across: b of the first state that is not, or None.
    """

    stretch: float
    across: float | None

    @property
    def where(self) -> str:
        """The first state that is not stable, in words; empty where there is none."""
        if self.across is None:
            return ""
        if self.across < -0.25:
            return "uniaxial"
        return "pure-shear" if self.across < 0.5 else "equibiaxial"


def states(stretch: float, count: int = 14) -> Floats:
    """Logarithmic strains of a grid of states up to a greatest stretch, (n, 3)."""
    sizes = np.linspace(0.0, np.log(stretch), count + 1)[1:]
    return np.concatenate([_ray(b, sizes) for b in _RAYS])


def tangents(form: Form, shape: Numbers, strains: Floats) -> Floats:
    """∂²W/∂h∂h on the plane of isochoric strains, of each modulus at 1 MPa by itself.

    Args:
        form: the law.
        shape: its pure numbers.
        strains: logarithmic strains, (n, 3).

    Returns:
        (moduli, n, 2, 2); NaN where the law has no value.
    """
    moves = np.concatenate([_STEP * _PLANE, -_STEP * _PLANE])
    moved = np.exp(strains[:, None, :] + moves)
    slopes = form.slopes(list(moved.reshape(-1, 3).T), shape)
    # by modulus, state, move and direction on the plane
    on_plane = np.einsum("kin,ai->kna", slopes, _PLANE).reshape(len(slopes), -1, 4, 2)
    tangent = (on_plane[:, :, :2] - on_plane[:, :, 2:]) / (2 * _STEP)
    return np.asarray((tangent + np.swapaxes(tangent, 2, 3)) / 2)


def stability(form: Form, moduli: Floats, shape: Numbers) -> Stability:
    """How far a law with its numbers is stable."""
    sizes = np.linspace(0.0, np.log(MOST), 231)
    least = [_least(form, moduli, shape, _ray(b, sizes)) for b in _RAYS]
    lost = [np.flatnonzero(row <= 0) for row in least]
    if not any(len(row) for row in lost):
        return Stability(MOST, None)
    first, ray = min((row[0], i) for i, row in enumerate(lost) if len(row))
    if first == 0:
        return Stability(1.0, float(_RAYS[ray]))
    low, high = sizes[first - 1], sizes[first]
    for _ in range(20):
        middle = (low + high) / 2
        rows = np.concatenate([_ray(b, np.array([middle])) for b in _RAYS])
        good = not (_least(form, moduli, shape, rows) <= 0).any()
        low, high = (middle, high) if good else (low, middle)
    return Stability(float(np.exp(low)), float(_RAYS[ray]))


def _ray(across: float, sizes: Floats) -> Floats:
    return np.stack([sizes, across * sizes, -(1 + across) * sizes], axis=1)


def _least(form: Form, moduli: Floats, shape: Numbers, strains: Floats) -> Floats:
    """The least eigenvalue of the tangent; beyond the law's limit infinite: it is not reached."""
    tangent = np.tensordot(moduli, tangents(form, shape, strains), 1)
    there = np.isfinite(tangent).all(axis=(1, 2))
    least = np.full(len(strains), np.inf)
    least[there] = np.linalg.eigvalsh(tangent[there])[:, 0]
    return least

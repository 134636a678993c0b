"""An incompressible layer in plane strain, bonded below, under a rigid strip without friction."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from numpy.polynomial.legendre import leggauss
from scipy.sparse.linalg import spsolve

from rod.functions import Floats, Ints

_BESIDE = 6.0
"""Reach of the layer beside the strip, in thicknesses: pressure dies off within one."""
_THROUGH = 8
"""Elements through it."""


def factor(width: float, sides: int, along: int = 14) -> float:
    """Mean pressure over mean strain and Young's modulus.

    Elements with squares of displacements and linear pressures, which lock nowhere; finer toward
    the strip's edges, where the pressure is singular.

    Args:
        width: of the strip, in thicknesses.
        sides: to which the layer goes on beside it, 1 or 2.
        along: elements under it.
    """
    parts = [_graded(-_BESIDE, 0.0, along), _graded(0.0, width, along)]
    parts += [_graded(width, width + _BESIDE, along)] * (sides == 2)
    x, y = _halved(np.unique(np.concatenate(parts))), _halved(_graded(0.0, 1.0, _THROUGH))
    stiffness, volume = _matrices(x, y)
    nodes, high = len(x) * len(y), len(y)
    bottom: Ints = np.arange(len(x)) * high
    pressed = bottom[(x >= 0) & (x <= width)] + high - 1 + nodes
    fixed = np.concatenate([bottom, bottom + nodes, pressed])
    free = np.setdiff1d(np.arange(2 * nodes), fixed)
    moved = np.zeros(2 * nodes)
    moved[pressed] = -1.0
    inner, own = stiffness[free][:, free], volume[:, free]
    whole = sp.bmat([[inner, own.T], [own, None]], format="csc")
    found = spsolve(whole, -np.concatenate([(stiffness @ moved)[free], volume @ moved]))
    moved[free] = found[: len(free)]
    forces = stiffness @ moved + volume.T @ found[len(free) :]
    # the shear modulus is 1, and Young's three times that
    return -float(forces[pressed].sum()) / (3 * width)


def _graded(start: float, end: float, count: int) -> Floats:
    places: Floats = start + (end - start) * (1 - np.cos(np.linspace(0, np.pi, count + 1))) / 2
    return places


def _halved(ends: Floats) -> Floats:
    out = np.empty(2 * len(ends) - 1)
    out[::2], out[1::2] = ends, (ends[1:] + ends[:-1]) / 2
    return out


def _shapes(at: float) -> tuple[Floats, Floats]:
    """Squares on -1, 0, 1, and their slopes."""
    return (
        np.array([at * (at - 1) / 2, 1 - at**2, at * (at + 1) / 2]),
        np.array([at - 0.5, -2 * at, at + 0.5]),
    )


def _matrices(x: Floats, y: Floats) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """Stiffness for a shear modulus of 1, and the volumes that pressures see."""
    nodes, high = len(x) * len(y), len(y)
    points = [
        (a, b, u * v)
        for a, u in zip(*leggauss(3), strict=True)
        for b, v in zip(*leggauss(3), strict=True)
    ]
    rows, columns, values = [], [], []
    held, of = [], []
    volumes: list[Floats] = []
    for first in range(0, len(x) - 2, 2):
        for low in range(0, high - 2, 2):
            wide, tall = x[first + 2] - x[first], y[low + 2] - y[low]
            here = ((first + np.arange(3))[:, None] * high + low + np.arange(3)).ravel()
            stiff, volume = np.zeros((18, 18)), np.zeros((3, 18))
            for a, b, weight in points:
                (na, da), (nb, db) = _shapes(a), _shapes(b)
                by_x = np.outer(da, nb).ravel() * 2 / wide
                by_y = np.outer(na, db).ravel() * 2 / tall
                zero, size = np.zeros(9), weight * wide * tall / 4
                strain = np.block([[by_x, zero], [zero, by_y], [by_y, by_x]])
                stiff += size * strain.T @ (np.array([2.0, 2.0, 1.0])[:, None] * strain)
                volume += size * np.outer([1.0, a, b], np.concatenate([by_x, by_y]))
            unknowns = np.concatenate([here, here + nodes])
            pressures = len(volumes) * 3 + np.arange(3)
            rows.append(np.repeat(unknowns, 18))
            columns.append(np.tile(unknowns, 18))
            values.append(stiff.ravel())
            held.append(np.repeat(pressures, 18))
            of.append(np.tile(unknowns, 3))
            volumes.append(volume.ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    stiffness = sp.csr_matrix((np.concatenate(values), places), shape=(2 * nodes, 2 * nodes))
    places = np.concatenate(held), np.concatenate(of)
    shape = (3 * len(volumes), 2 * nodes)
    return stiffness, sp.csr_matrix((np.concatenate(volumes), places), shape=shape)

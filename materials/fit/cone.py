"""Least squares with moduli that keep a law stable: a convex problem, solved by cutting planes."""

from __future__ import annotations

import dataclasses

import numpy as np
from scipy.optimize import nnls

from materials.stretches import Floats

_TINY = 1e-11
"""Singular values below this part of the greatest say nothing."""
_ROUNDS = 80


@dataclasses.dataclass(frozen=True, eq=False)
class Answer:
    """Moduli of a fit.

    Attributes:
        moduli: their values, (k,).
        active: rows g of the conditions g · moduli ≥ 0 that hold the fit back, (a, k).
        states: for each the number of its state, −1 of a condition of another kind.
        directions: for each the direction on the plane of strains, (a, 2).
    """

    moduli: Floats
    active: Floats
    states: tuple[int, ...]
    directions: Floats


def solve(matrix: Floats, right: Floats, tangents: Floats, signs: Floats) -> Answer:
    """min |A c − b|² over moduli c with Σ ck Tk(state) positive in every state.

    Each vᵀ T v ≥ 0 is a half-space of c. Those that a solution violates most are added until none
    is.

    Args:
        matrix: A, (n, k).
        right: b, (n,).
        tangents: Tk of every state, (k, states, 2, 2), less the margin; NaN: state is left out.
        signs: rows g of further conditions g · c ≥ 0, (m, k).

    Raises:
        ValueError: only c = 0 satisfies the conditions.
    """
    there = np.flatnonzero(np.isfinite(tangents).all(axis=(0, 2, 3)))
    inside = tangents[:, there]
    rows, kept = [*signs], [-1] * len(signs)
    ways = [np.zeros(2)] * len(signs)
    size = np.abs(inside).max(axis=(1, 2, 3), initial=1e-300)
    for _ in range(_ROUNDS):
        moduli, pressed = _in_cone(matrix, right, np.array(rows).reshape(-1, matrix.shape[1]))
        values, vectors = np.linalg.eigh(np.tensordot(moduli, inside, 1))
        worst = np.argsort(values[:, 0])[:3]
        bad = [i for i in worst if values[i, 0] < -1e-10 * (size @ np.abs(moduli))]
        if not bad:
            break
        for i in bad:
            v = vectors[i, :, 0]
            rows.append(np.einsum("kab,a,b->k", inside[:, i], v, v))
            kept.append(int(there[i]))
            ways.append(v)
    if not np.abs(moduli).max() > 0:
        raise ValueError("no moduli keep it stable")
    active = np.flatnonzero(pressed)
    return Answer(
        moduli,
        np.array(rows).reshape(-1, matrix.shape[1])[active],
        tuple(kept[i] for i in active),
        np.array(ways).reshape(-1, 2)[active],
    )


def _in_cone(matrix: Floats, right: Floats, rows: Floats) -> tuple[Floats, Floats]:
    """min |A c − b|² with G c ≥ 0, and which rows press.

    C. L. Lawson and R. J. Hanson, Solving Least Squares Problems (1974), chapter 23: in the
    directions of the singular values the nearest point of a polyhedron is a problem of
    non-negative least squares.
    """
    scale = np.linalg.norm(matrix, axis=0)
    scale[scale == 0] = 1.0
    left, values, ways = np.linalg.svd(matrix / scale, full_matrices=False)
    keep = values > _TINY * values[0]
    back = (ways[keep].T / values[keep]) / scale[:, None]
    free = left[:, keep].T @ right
    plain = back @ free
    if not len(rows):
        return plain, np.zeros(0, dtype=bool)
    length = np.linalg.norm(rows @ back, axis=1)
    length[length == 0] = 1.0
    inner = (rows @ back) / length[:, None]
    size = np.linalg.norm(free) or 1.0
    gap = -(inner @ free) / size
    if (gap <= 1e-13).all():
        return plain, np.zeros(len(rows), dtype=bool)
    dual = np.vstack([inner.T, gap])
    target = np.zeros(len(dual))
    target[-1] = 1.0
    weights, _ = nnls(dual, target, maxiter=50 * len(rows) + 200)
    rest = dual @ weights - target
    if not abs(rest[-1]) > 1e-14:
        return np.zeros(matrix.shape[1]), weights > 0
    return back @ (free - size * rest[:-1] / rest[-1]), weights > 0

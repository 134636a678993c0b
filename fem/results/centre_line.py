"""How a body bends and twists: the line of its sections' centroids, and their axes along it."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from analytic.path import section_axes
from fem.kinematics.kinematics import Kinematics
from fem.ranks import total
from geometry.mesh.centroid import winding_weights
from geometry.mesh.data import MeshData, facet_positions
from geometry.mesh.reference import gauss

Floats = npt.NDArray[np.float64]

ENDS = ("section_root", "section_tip")
_ODD, _EVEN = (1.0, 0.0, 0.0), (0.0, 1.0, 1.0)
"""Components that the mirror image across x = 0 leaves of what is odd in x, and of the rest."""
_STEP = 1e-30
"""Of complex differentiation: nothing is subtracted."""
_SMALL = 1e-3
"""Squared sine of half a turn below which a series of five terms is exact to round-off."""


class CentreLine:
    """Turns of the centre-line and of the sections about it, between z = 0 and z = L.

    The winding's surface is fitted as a rod with sections that deform evenly,

        x ≈ c(z) + (X − X̄) a_x(z) + (Y − Ȳ) a_y(z),

    c, a_x and a_y cubic splines, by least squares with the weights of `geometry.mesh.centroid`, so
    that c is the centroid of what lies inside. Stations stand at the knots, t ∥ c' there. Before
    the first and behind the last one stand the plane sections z = 0 and z = L themselves, each
    with its own least squares and with t its normal a_x × a_y. Everywhere the section's own axes
    across t are d1 and d2 of
    `analytic.path.section_axes`. The rotation vectors from station to station, on (d1, d2, t), add
    up to the three turns. Of a body
    that bends and twists evenly they are exact whatever the distance of the stations, and they
    are those of `analytic.path.centre_line`; of a body that stays in its plane they add up to the
    rotation of the section z = L against z = 0. Nothing wraps, as long as neighbouring stations
    turn by less than half a turn against each other: a section may collapse to a flat one, which
    turns any fit of its own plane over, and the line of the centroids goes on.

    Args:
        body: kinematics of a mesh with the surfaces "winding", "section_root", "section_tip".
    """

    def __init__(self, body: Kinematics) -> None:
        from scipy.sparse import csr_matrix, vstack

        self._body = body
        data = body.domain.data
        nodes = data.nodes
        root, tip = (float(nodes[body.domain.surface_nodes(name), 2].mean()) for name in ENDS)
        self._length = tip - root
        spline = _RodFit(data, root, tip)
        self._inverse, self._value, self._rate = spline.inverse, spline.value, spline.rate
        self._along, self._within, self._share = spline.along, spline.within, spline.share
        ends = [plane_fit(nodes, body.domain.surface_weights(name), data.half) for name in ENDS]
        rows = vstack([csr_matrix(ends[0]), spline.moments, csr_matrix(ends[1])]).tocsc()
        used = body.owned_nodes[np.diff(rows.indptr)[body.owned_nodes] > 0]
        self._dofs, self._nodes = body.node_dofs[used], nodes[used]
        self._operator = rows[:, used].tocsr()
        self._z = np.concatenate([[root], spline.stations, [tip]])
        self._kept: Floats = np.ones((rows.shape[0], 3))
        if data.half:
            # with the mirror image the centre-line stays in the plane, and d1 is x
            blocks = np.repeat([_EVEN, _ODD, _EVEN], spline.value.shape[1], axis=0)
            self._kept = np.vstack([_ODD, _EVEN, blocks, _ODD, _EVEN])

    def _sums(self) -> Floats:
        """What is linear in the positions, (rows, 3): both ends' a_x and a_y, moments between."""
        x = self._nodes + self._body.w.x.array[self._dofs]
        sums: Floats = total(self._body.domain.comm, self._operator @ x) * self._kept
        return sums

    def _parts(self) -> tuple[Floats, Floats, Floats]:
        """Images a_x and a_y of the axes, (k, 3), and tangents inside, (k − 2, 3); collective."""
        sums = self._sums()
        centre, a_x, a_y = (self._inverse @ sums[2:-2]).reshape(3, -1, 3)
        if self._body.domain.data.half:
            # d1 is x by symmetry: a collapsed section, which turns a_y over, does not turn it
            a_y = np.zeros_like(a_y)
        return (
            np.vstack([sums[0], self._value @ a_x, sums[-2]]),
            np.vstack([sums[1], self._value @ a_y, sums[-1]]),
            self._rate @ centre,
        )

    def end_axes(self) -> Floats:
        """Axes of the plane sections z = 0 and z = L as columns, (2, 3, 3); collective."""
        ends: Floats = _axes(*self._parts())[[0, -1]]
        return ends

    def _steps(self) -> Floats:
        """Rotation vectors from station to station on (d1, d2, t), rad, (k − 1, 3)."""
        steps: Floats = _rotations(_axes(*self._parts()))
        return steps

    def turns(self) -> Floats:
        """Of the whole length at the present state, about d1, d2 and t, (3,), rad; collective."""
        whole: Floats = self._steps().sum(axis=0)
        return whole

    def turns_to(self, z: Floats) -> Floats:
        """The part of `turns` from z = 0 to some heights, (n, 3), rad; collective.

        Args:
            z: (n,), mm; between stations turns grow evenly.
        """
        along = np.vstack([np.zeros(3), np.cumsum(self._steps(), axis=0)])
        parts: Floats = np.column_stack([np.interp(z, self._z, part) for part in along.T])
        return parts

    def stretch(self) -> float:
        """Length of the centre-line from z = 0 to z = L over L; collective."""
        centre = (self._inverse @ self._sums()[2:-2])[: self._value.shape[1]]
        return float(self._share @ np.linalg.norm(self._along @ centre, axis=1))

    def middle(self) -> Floats:
        """L times the rates of the middle half: the turns were it not for the ends, (3,), rad.

        Near the caps sections warp and the curvature differs; models of uniform bending compare
        with these.
        """
        along = np.vstack([np.zeros(3), np.cumsum(self._steps(), axis=0)])
        far = np.abs(self._z - (self._z[0] + self._z[-1]) / 2)
        some = np.argsort(far)[: max(2, int(np.sum(far <= (1 + 1e-9) * self._length / 4)))]
        slopes: Floats = np.polyfit(self._z[some], along[some], 1)[0]
        return slopes * self._length

    def middle_stretch(self) -> float:
        """Length of the middle half of the centre-line over its length at rest; collective."""
        centre = (self._inverse @ self._sums()[2:-2])[: self._value.shape[1]]
        return float(self._share @ np.linalg.norm(self._within @ centre, axis=1))

    def row(self, component: int) -> Floats:
        """Gradient of one of the turns on the owned dofs, rad/mm, (owned,); collective."""
        parts = self._parts()
        slopes = [np.zeros_like(part) for part in parts]
        for which, part in enumerate(parts):
            for axis in range(3):
                for parity in (0, 1):
                    moved: list[Any] = [p.astype(complex) for p in parts]
                    moved[which][parity::2, axis] += 1j * _STEP
                    change = _rotations(_axes(*moved))[:, component].imag / _STEP
                    # a station enters the step before it and the one behind it, its like do not
                    at = np.concatenate([[0.0], change]) + np.concatenate([change, [0.0]])
                    at = at[1:-1] if len(part) < len(at) else at
                    slopes[which][parity::2, axis] = at[parity::2]
        a_x, a_y, tangent = slopes
        inner = np.vstack(
            [self._rate.T @ tangent, self._value.T @ a_x[1:-1], self._value.T @ a_y[1:-1]]
        )
        by_sum = np.vstack([a_x[0], a_y[0], self._inverse.T @ inner, a_x[-1], a_y[-1]])
        by_sum *= self._kept
        row = np.zeros(self._body.owned)
        row[self._dofs] = self._operator.T @ by_sum
        return row


class BendingAngle:
    """θ: turn of the centre-line about the sections' own lateral axis, positive toward −y.

    Args:
        line: of the body.
    """

    def __init__(self, line: CentreLine) -> None:
        self._line = line

    def value(self) -> float:
        """θ at the present state, rad."""
        return float(self._line.turns()[0])

    def row(self) -> Floats:
        """∂θ/∂w on the owned dofs, rad/mm."""
        return self._line.row(0)

    def slope(self, scalar: str) -> float:
        """∂θ/∂q of a global scalar: none enters."""
        return 0.0


class _RodFit:
    """Least squares of a rod to the winding's surface, see `CentreLine`.

    Args:
        mesh: of the body.
        root: z of the first section, mm.
        tip: z of the last one.

    Attributes:
        stations: z of the knots, mm, (s,).
        value: values of the m basis functions there, (s, m).
        rate: their slopes there, 1/mm, (s, m).
        along: slopes at Gauss points between the knots, (g, m).
        within: slopes at as many points of the middle half, between a quarter and three, (g, m).
        share: their weights as parts of the length, or of half of it, (g,).
        moments: right-hand sides of the normal equations by the n nodes' positions, (3 m, n): of
            c, then of a_x, then of a_y.
        inverse: of the normal equations' matrix, (3 m, 3 m).
    """

    def __init__(self, mesh: MeshData, root: float, tip: float) -> None:
        from scipy.interpolate import BSpline
        from scipy.sparse import csr_matrix, vstack

        weights, rest = winding_weights(mesh)
        on = np.flatnonzero(weights)
        z, plane = mesh.nodes[on, 2], mesh.nodes[on, :2] - rest
        length = tip - root
        # an element between knots at least
        cell, facet = mesh.facets["winding"].T
        corners = mesh.nodes[mesh.cells[cell[:, None], facet_positions(mesh.cell_type)[facet]], 2]
        finest = max(float(np.ptp(corners, axis=1).max()), length / 200)
        # mesh generators place nodes to a few parts in a million: a tie must not hang on them
        most = (1 + 1e-5) * length
        count = max(1, int(most / max(float(np.ptp(plane, axis=0).max()) / 4, finest)))
        breaks = np.linspace(root, tip, count + 1)
        knots = np.concatenate([[root] * 3, breaks, [tip] * 3])
        basis = BSpline.design_matrix(np.clip(z, root, tip), knots, 3).T
        spline = BSpline(knots, np.eye(count + 3), 3)
        self.stations: Floats = breaks
        self.value: Floats = spline(self.stations)
        self.rate: Floats = spline(self.stations, 1)
        points, parts = gauss(3)
        inside = (breaks[:-1, None] + np.diff(breaks)[:, None] * points).ravel()
        self.along: Floats = spline(inside, 1)
        self.within: Floats = spline((inside + (root + tip) / 2) / 2, 1)
        self.share: Floats = np.tile(parts / count, count)
        levers = vstack([basis, basis.multiply(plane[:, 0]), basis.multiply(plane[:, 1])])
        weighted = levers.multiply(weights[on]).tocoo()
        gram = (levers.tocsr() @ weighted.tocsr().T).toarray()
        self.moments = csr_matrix(
            (weighted.data, (weighted.row, on[weighted.col])),
            shape=(len(gram), len(mesh.nodes)),
        )
        if mesh.half:
            # odd in x: the mirror image takes it away
            odd = np.repeat([False, True, False], count + 3)
            gram[np.ix_(odd, ~odd)] = gram[np.ix_(~odd, odd)] = 0.0
        self.inverse: Floats = np.linalg.pinv(gram, rcond=1e-12, hermitian=True)


def plane_fit(nodes: Floats, weights: Floats, half: bool) -> Floats:
    """Least squares x ≈ c + (X − X̄) a_x + (Y − Ȳ) a_y in a plane section.

    Args:
        nodes: (n, 3), mm.
        weights: areas of the nodes in the section, zero elsewhere, (n,).
        half: only x ≥ 0 is meshed.

    Returns:
        Rows for a_x and a_y that multiply the nodes' positions, (2, n).
    """
    centre = weights @ nodes[:, :2] / weights.sum()
    if half:
        centre[0] = 0.0
    levers = (nodes[:, :2] - centre) * weights[:, None]
    gram = levers.T @ (nodes[:, :2] - centre)
    if half:
        gram[0, 1] = gram[1, 0] = 0.0
    rows: Floats = np.linalg.solve(gram, levers.T)
    return rows


def face_axes(body: Kinematics, surface: str) -> Floats:
    """Axes of a plane face by least squares, as columns, (3, 3); collective.

    Args:
        body: kinematics.
        surface: the face, which is across z at rest.
    """
    domain = body.domain
    rows = plane_fit(domain.data.nodes, domain.surface_weights(surface), domain.data.half)
    owned = body.owned_nodes
    x = domain.data.nodes[owned] + body.w.x.array[body.node_dofs[owned]]
    a_x, a_y = total(domain.comm, rows[:, owned] @ x)[:, None]
    if domain.data.half:
        a_x, a_y = a_x * _ODD, np.zeros_like(a_y) + a_y * _EVEN
    axes: Floats = section_axes(a_x, a_y, np.cross(a_x, a_y))[0]
    return axes


def turn_of(before: Floats, after: Floats) -> Floats:
    """Rotation vector between axes on the first ones, (3,), rad, less than half a turn."""
    turn: Floats = _rotations(np.stack([before, after]))[0]
    return turn


def _axes(a_x: Any, a_y: Any, inside: Any) -> Any:
    """Axes d1, d2, t of all stations as columns, (k, 3, 3)."""
    normal = np.cross(a_x, a_y)
    return section_axes(a_x, a_y, np.concatenate([normal[:1], inside, normal[-1:]]))


def _rotations(axes: Any) -> Any:
    """Rotation vectors between neighbours on their own axes, (k − 1, 3), less than half a turn.

    With R = A_jᵀ A_{j+1}, q0 = cos φ/2 = ½ √(1 + tr R) and q = n sin φ/2 = (R − Rᵀ)ˇ/(4 q0), the
    vector is 2 q arcsin|q|/|q|. Analytic, as the complex steps need it.
    """
    relative = np.swapaxes(axes[:-1], 1, 2) @ axes[1:]
    odd = relative - np.swapaxes(relative, 1, 2)
    scalar = np.sqrt(1 + np.trace(relative, axis1=1, axis2=2)) / 2
    q = np.stack([odd[:, 2, 1], odd[:, 0, 2], odd[:, 1, 0]], axis=1) / (4 * scalar[:, None])
    square = np.sum(q * q, axis=1)
    small = np.abs(square) < _SMALL
    sine = np.sqrt(np.where(small, 0.25, square))
    series = 1 + square / 6 * (
        1 + square * 9 / 20 * (1 + square * 25 / 42 * (1 + square * 49 / 72))
    )
    factor = np.where(small, series, np.arcsin(sine) / sine)
    return 2 * q * factor[:, None]

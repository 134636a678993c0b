"""Stretch of material lines in the faces of solid elements, with its derivatives, vectorised."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from analytic.path import cross_matrix
from fem.kinematics.kinematics import Kinematics
from geometry.mesh.data import facet_positions
from geometry.mesh.reference import shape_functions
from geometry.winding.segments import Lines

Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Second:
    """Second derivatives of s pieces with k dofs each.

    Attributes:
        block: ∂²Π/∂w², (s, k, k).
        mixed: by scalar, ∂²Π/∂w∂q, (s, k).
        scalars: by pair of scalars, ∂²Π/∂q∂r of all pieces together.
    """

    block: Floats
    mixed: dict[str, Floats]
    scalars: dict[tuple[str, str], float]


def _contract(vectors: Floats, maps: Floats) -> Floats:
    """Σ_qi v_qi M_qik over points and components: v (n, q, 3), M (n, q, 3, k), result (n, k)."""
    count, points, components, width = maps.shape
    # sizes in full: numpy infers none where a rank holds nothing
    flat = maps.reshape(count, points * components, width)
    result: Floats = (vectors.reshape(count, 1, points * components) @ flat)[:, 0]
    return result


class MeanStretch:
    """λ, the mean of |F T| over the points of a piece of line with the unit tangent T.

    A piece couples the dofs of one facet only. In uniform bending F T has a part
    T_z (λ0 e_z + ω × x') that depends on global scalars.

    Args:
        body: the kinematics; the host cells are here.
        lines: the pieces.

    Attributes:
        dofs: local dofs of every piece, (n, k).
        value: λ, (n,).
        by_dofs: ∂λ/∂w, (n, k).
        by_scalar: by name of the scalar, ∂λ/∂q, (n,).
    """

    def __init__(self, body: Kinematics, lines: Lines) -> None:
        self._body = body
        domain = body.domain
        kind, data = domain.data.cell_type, domain.data

        # With φ_a the shape functions of the host cell, ξ its reference coordinates, X_a (mm) the
        # nodes of the host facet and t = dξ/ds along the piece (s its parameter): dX/ds =
        # Σ_a (∇φ_a · t) X_a, S (mm) the arc length, dS = |dX/ds| ds. At each point i
        #   _slope: T·∇φ_a = (∇φ_a · t)/|dX/ds|, 1/mm, so that F T = Σ_a slope_a x_a;
        #   _rise: T_z = dZ/dS; _value: φ_a; _share: c_i = w_i dS_i/Σ w dS, weights of the mean.
        # Only nodes of the facet enter: off it φ_a and its derivative along it vanish.
        positions = facet_positions(kind)[lines.facet]
        count, quadrature, dim = lines.points.shape
        value, gradient = shape_functions(kind, lines.points.reshape(-1, dim))
        tangent = lines.tangents.reshape(-1, dim)
        along = np.einsum("pad,pd->pa", gradient, tangent)
        along = along.reshape(count, quadrature, along.shape[1])
        along = np.take_along_axis(along, positions[:, None, :], axis=2)
        local = domain.local_cell[lines.cell]
        parts = body.components
        width = positions.shape[1] * parts
        self.dofs = body.cell_dofs[local[:, None], positions].reshape(count, width)
        reference = data.nodes[data.cells[lines.cell[:, None], positions]]
        rise = lines.axial
        if reference.shape[2] == 3:
            rise = np.einsum("nqa,na->nq", along, reference[:, :, 2])
        plane = along @ reference[:, :, :2]
        metric = np.sqrt(np.sum(plane**2, axis=2) + rise**2)
        slope = along / metric[:, :, None]  # ∂φ_a/∂S, 1/mm
        share = lines.weights * metric
        self._share = share / share.sum(axis=1, keepdims=True)
        carry = body.carry()
        self._turned: dict[str, Floats] = {}
        """By scalar, ∂²t/∂w∂q = T_z (∂ω/∂q) × φ: where the spin turns to does not change."""
        if carry is not None:
            value = np.take_along_axis(
                value.reshape(count, quadrature, value.shape[1]), positions[:, None, :], axis=2
            )
            self._value = np.einsum("nqa,ij->nqiaj", value, np.eye(3)[:, :parts]).reshape(
                count, quadrature, 3, width
            )
            self._rise: Floats = (rise / metric)[:, :, None]
            for name, (_, turn) in carry.rates.items():
                self._turned[name] = self._rise[..., None] * (cross_matrix(turn) @ self._value)
        self._slope = np.einsum("nqa,ij->nqiaj", slope, np.eye(3)[:, :parts]).reshape(
            count, quadrature, 3, width
        )
        rest = np.zeros((*reference.shape[:2], parts))
        # x' in the turning frame: z is not a position there
        shown = 3 if carry is None else 2
        rest[:, :, :shown] = reference[:, :, :shown]
        self._reference = rest.reshape(count, width)
        self.value = np.ones(count)

    def update(self, w: Floats) -> None:
        """Stretch and its first derivatives at local coefficients w and the present scalars."""
        x = self._reference + w[self.dofs]
        self._map = self._slope
        self._rates: dict[str, Floats] = {}
        t = (self._slope @ x[:, None, :, None])[..., 0]
        carry = self._body.carry()
        if carry is not None:
            position = (self._value @ x[:, None, :, None])[..., 0]
            along, spin = np.array([0.0, 0.0, carry.stretch]), cross_matrix(carry.spin)
            t = t + self._rise * (along + position @ spin.T)
            self._map = self._slope + self._rise[..., None] * (spin @ self._value)
            for name, (vector, turn) in carry.rates.items():
                self._rates[name] = self._rise * (vector + position @ cross_matrix(turn).T)
        self._stretch = np.linalg.norm(t, axis=2)
        self._direction = t / self._stretch[:, :, None]
        self.value = np.sum(self._share * self._stretch, axis=1)
        weighted = self._share[:, :, None] * self._direction
        self.by_dofs = _contract(weighted, self._map)
        self.by_scalar = {
            name: np.sum(weighted * rate, axis=(1, 2)) for name, rate in self._rates.items()
        }

    def add(self, b: Floats, values: Floats) -> None:
        """Add values (n, k) at the pieces' dofs to local coefficients."""
        b += np.bincount(self.dofs.ravel(), values.ravel(), len(b))

    def noise(self) -> Floats:
        """What round-off makes of λ at rest, (n,).

        F T is a sum of positions over the size of an element: its error is that of the summands.
        """
        x = np.abs(self._reference)[:, None, :, None]
        error = np.finfo(float).eps * np.linalg.norm((np.abs(self._slope) @ x)[..., 0], axis=2)
        found: Floats = np.sum(self._share * error, axis=1)
        return found

    def change(self, correction: Floats, scalars: Mapping[str, float] | None) -> Floats:
        """Change of λ, to first order, with a correction of local dofs and one of scalars, (n,)."""
        change: Floats = np.einsum("nk,nk->n", self.by_dofs, correction[self.dofs])
        for name, value in (scalars or {}).items():
            if name in self.by_scalar:
                change += self.by_scalar[name] * value
        return change

    def curved(self, pull: Floats) -> Second:
        """Σ p ∂²λ with a weight p for every piece, N mm, (n,): what is geometric in a tangent.

        With t = F T, λ = |t| and n = t/λ at each point, c its weight and a, b any of the unknowns:

            ∂²λ/∂a∂b = Σ c [∂t/∂a · (I − n nᵀ)/λ · ∂t/∂b + n · ∂²t/∂a∂b].

        t is linear in w and in q; ∂²t/∂w∂q alone does not vanish, and only in uniform bending.
        """
        n = self._direction
        across = np.eye(3) - n[..., :, None] * n[..., None, :]
        shared = pull[:, None] * self._share
        across *= (shared / self._stretch)[..., None, None]
        side = across @ self._map
        count, points, components, width = self._map.shape
        flat = (count, points * components, width)
        block = self._map.reshape(flat).swapaxes(1, 2) @ side.reshape(flat)
        mixed: dict[str, Floats] = {}
        scalars: dict[tuple[str, str], float] = {}
        for name, rate in self._rates.items():
            turning = _contract(shared[:, :, None] * n, self._turned[name])
            mixed[name] = _contract(rate, side) + turning
            for other, last in self._rates.items():
                scalars[name, other] = float(np.sum(rate * (across @ last[..., None])[..., 0]))
        return Second(block, mixed, scalars)

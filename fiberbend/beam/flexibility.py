"""Flexibility of a section as a beam's: stretch, bending, twist, and shear with its warping.

A prismatic body under forces at its far ends: the displacement is a rigid motion of the section,
by strains ψ = (γ_x, γ_y, ε, k_x, k_y, τ), and a warping u of it. Along z both are linear, for
moments grow by the shear forces, θ' = D θ with θ = (V_x, V_y, N, M_x, M_y, T):

    E u' + R ψ' = 0,                      Rᵀ u' + A ψ' = D θ,
    E u + R ψ = (Cᵀ − C) u' + L ψ',       Rᵀ u + A ψ = θ − Lᵀ u'.

Stresses are exact but for the elements, so that shear counts by its energy and no factor of shear
is assumed (Giavotto et al. 1983, doi 10.1016/0045-7949(83)90179-7).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from scipy.sparse import bmat, coo_matrix, csc_matrix
from scipy.sparse.linalg import splu

from geometry.mesh.data import MeshData
from geometry.mesh.reference import cell_rule, gauss, shape_functions
from geometry.winding.segments import EmbeddedFibers
from materials.material import Material
from rod.functions import Floats

_INCOMPRESSIBLE = 1e4
"""Bulk modulus over shear modulus of what cannot be compressed."""
_NAMES = 6
_VOLUME = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 1.0])
"""Of the strains ε_xx, ε_yy, γ_xy, γ_xz, γ_yz, ε_zz."""
_SHAPE = np.diag([2.0, 2.0, 1.0, 1.0, 1.0, 2.0]) - 2 / 3 * np.outer(_VOLUME, _VOLUME)
"""Stress without pressure by them, over G."""
_GROWTH = np.zeros((6, 6))
_GROWTH[3, 1], _GROWTH[4, 0] = 1.0, -1.0
"""D: M_x' = V_y and M_y' = −V_x."""


@dataclasses.dataclass(frozen=True)
class Threads:
    """Lines on a section that strain along themselves alone.

    Attributes:
        segments: where they are and which way they go.
        stiffness: EA of a thread, N; of several the one of every segment, (n,).
    """

    segments: EmbeddedFibers
    stiffness: float | Floats


def flexibility(
    mesh: MeshData,
    height: float,
    materials: dict[str, Material],
    threads: Sequence[Threads] = (),
) -> Floats:
    """Strains by forces without load, (6, 6), symmetric; 1/N, 1/(N mm) and 1/(N mm²).

    In the order of `rod.layout.STRAINS`: V_x, V_y, N, M_x, M_y, T. Elements of second order, what
    cannot be compressed by fewer points than its shape.

    Args:
        mesh: quadrilaterals of the whole section.
        height: y of the line that forces and moments are about, mm; its x is zero.
        materials: by region.
        threads: on its outline.
    """
    return _Sums(mesh, height).filled(materials).wound(threads).flexibility()


class _Sums:
    """E, R, A, C, L and M of a section."""

    def __init__(self, mesh: MeshData, height: float) -> None:
        self._mesh, self._height = mesh, height
        width = 3 * mesh.cells.shape[1]
        self._dofs = (3 * mesh.cells[:, :, None] + np.arange(3)).reshape(-1, width)
        wide = 2 * width + _NAMES
        self._blocks: Floats = np.zeros((len(mesh.cells), wide, wide))

    def filled(self, materials: dict[str, Material]) -> _Sums:
        """With the rubber of all cells."""
        numbers = list(self._mesh.regions.values())
        found = [materials[name] for name in self._mesh.regions]
        shear = np.array([each.initial_shear_modulus for each in found])
        bulk = np.array(
            [
                _INCOMPRESSIBLE * modulus if each.bulk is None else each.bulk
                for each, modulus in zip(found, shear, strict=True)
            ]
        )
        which = [numbers.index(number) for number in self._mesh.cell_region.tolist()]
        cells = np.arange(len(self._mesh.cells))
        for (points, weights), moduli, law in (
            (cell_rule("quadrilateral"), shear, _SHAPE),
            (_few(), bulk, np.outer(_VOLUME, _VOLUME)),
        ):
            for point, weight in zip(points, weights, strict=True):
                strains, jacobian = self._strains(cells, np.tile(point, (len(cells), 1)))
                area = moduli[which] * weight * np.linalg.det(jacobian)
                self._blocks += np.einsum("c,cki,kl,clj->cij", area, strains, law, strains)
        return self

    def wound(self, threads: Sequence[Threads]) -> _Sums:
        """With threads on its outline."""
        for each in threads:
            lines = each.segments
            shares = each.stiffness * lines.share * lines.length
            for number in range(lines.points.shape[1]):
                strains, jacobian = self._strains(lines.cell, lines.points[:, number])
                plane = np.einsum("nij,nj->ni", jacobian, lines.tangents[:, number])
                way = np.column_stack([plane, lines.axial[:, number]])
                x, y, z = (way / np.linalg.norm(way, axis=1)[:, None]).T
                along = np.column_stack([x * x, y * y, x * y, x * z, y * z, z * z])
                pulled = np.einsum("nk,nki->ni", along, strains)
                weight = shares * lines.weights[:, number]
                np.add.at(self._blocks, lines.cell, weight[:, None, None] * _square(pulled))
        return self

    def _strains(self, cells: np.ndarray, points: Floats) -> tuple[Floats, Floats]:
        """Strains by u, u' and ψ at a point of each cell, (n, 6, …), and the Jacobian."""
        values, slopes = shape_functions("quadrilateral", points)
        nodes = self._mesh.nodes[self._mesh.cells[cells]] - [0.0, self._height]
        jacobian = np.einsum("naj,nai->nij", slopes, nodes)
        gradient = np.einsum("naj,nji->nai", slopes, np.linalg.inv(jacobian))
        place = np.einsum("na,nai->ni", values, nodes)
        count, corners = values.shape
        by_u, by_rate = (np.zeros((count, 6, corners, 3)) for _ in range(2))
        by_u[:, 0, :, 0] = by_u[:, 2, :, 1] = by_u[:, 3, :, 2] = gradient[..., 0]
        by_u[:, 1, :, 1] = by_u[:, 2, :, 0] = by_u[:, 4, :, 2] = gradient[..., 1]
        by_rate[:, 3, :, 0] = by_rate[:, 4, :, 1] = by_rate[:, 5, :, 2] = values
        x, y = place.T
        own = np.zeros((count, 6, _NAMES))
        own[:, 3, 0] = own[:, 4, 1] = own[:, 5, 2] = 1.0
        own[:, 5, 3], own[:, 5, 4] = y, -x
        own[:, 3, 5], own[:, 4, 5] = -y, x
        flat = [part.reshape(count, 6, 3 * corners) for part in (by_u, by_rate)]
        return np.concatenate([*flat, own], axis=2), jacobian

    def flexibility(self) -> Floats:
        """By the strains' energy under unit forces."""
        width = self._dofs.shape[1]
        size = 3 * len(self._mesh.nodes)
        u, rate, own = slice(0, width), slice(width, 2 * width), slice(2 * width, None)

        def square(first: slice, second: slice) -> csc_matrix:
            rows = np.repeat(self._dofs, width, axis=1).ravel()
            columns = np.tile(self._dofs, (1, width)).ravel()
            data = self._blocks[:, first, second].ravel()
            return coo_matrix((data, (rows, columns)), shape=(size, size)).tocsc()

        def tall(first: slice) -> Floats:
            out = np.zeros((size, _NAMES))
            np.add.at(out, self._dofs, self._blocks[:, first, own])
            return out

        e, c, m = square(u, u), square(u, rate), square(rate, rate)
        r, grown_by = tall(u), tall(rate)
        a = self._blocks[:, own, own].sum(axis=0)
        used = np.unique(self._dofs)
        rigid = self._rigid()[used]
        inner = e[used][:, used]
        none = np.zeros((_NAMES, _NAMES))
        matrix = bmat(
            [
                [inner, csc_matrix(r[used]), csc_matrix(rigid)],
                [csc_matrix(r[used].T), csc_matrix(a), None],
                [csc_matrix(rigid.T), None, csc_matrix(none)],
            ]
        ).tocsc()
        solver = splu(matrix)
        count = len(used)

        def solved(right: Floats, forces: Floats) -> tuple[Floats, Floats]:
            found = solver.solve(np.vstack([right, forces, none]))
            return found[:count], found[count : count + _NAMES]

        rates, grown = solved(np.zeros((count, _NAMES)), _GROWTH)
        across = c[used][:, used]
        m_, l_ = m[used][:, used], grown_by[used]
        warping, strains = solved(
            (across.T - across) @ rates + l_ @ grown, np.eye(_NAMES) - l_.T @ rates
        )
        mixed = warping.T @ (across @ rates + r[used] @ strains) + rates.T @ (l_ @ strains)
        whole = warping.T @ (inner @ warping) + rates.T @ (m_ @ rates)
        whole = whole + strains.T @ a @ strains + mixed + mixed.T
        out: Floats = (whole + whole.T) / 2
        return out

    def _rigid(self) -> Floats:
        """Motions of all nodes that are those of the strains already, (3 n, 6): shifts, turns."""
        x, y = (self._mesh.nodes - [0.0, self._height]).T
        out = np.zeros((len(x), 3, _NAMES))
        out[:, 0, 0] = out[:, 1, 1] = out[:, 2, 2] = 1.0
        out[:, 2, 3], out[:, 2, 4] = y, -x
        out[:, 0, 5], out[:, 1, 5] = -y, x
        return out.reshape(-1, _NAMES)


def _few() -> tuple[Floats, Floats]:
    points, weights = gauss(2)
    grid = np.stack(np.meshgrid(points, points, indexing="ij"), axis=-1).reshape(-1, 2)
    return grid, np.outer(weights, weights).ravel()


def _square(rows: Floats) -> Floats:
    out: Floats = rows[:, :, None] * rows[:, None, :]
    return out

"""Strains and stresses of a state at the nodes, averaged within each region but never across."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.snapshot import Scenery, Snapshot
from geometry.mesh import Floats, Ints, MeshData, reference_nodes
from geometry.reference import shape_functions
from materials.laws import Material, energy_slopes


@dataclasses.dataclass(frozen=True)
class SplitNodes:
    """Nodes with one copy per region, so that a field may jump where materials meet.

    Attributes:
        cells: numbers of the copies, (m, k), in the node order of the mesh.
        node: node of the mesh that each copy stands for, (n,).
    """

    cells: Ints
    node: Ints

    def average(self, values: Floats) -> Floats:
        """Mean over the cells that share a copy.

        Args:
            values: at the nodes of each cell, (m, k, ...).

        Returns:
            At the copies, (n, ...).
        """
        flat = values.reshape(self.cells.size, -1)
        index, number = self.cells.ravel(), len(self.node)
        sums = [np.bincount(index, column, number) for column in flat.T]
        mean = np.stack(sums, axis=1) / np.bincount(index, minlength=number)[:, None]
        return mean.reshape(number, *values.shape[2:])


def split_nodes(mesh: MeshData) -> SplitNodes:
    """Give every region its own nodes."""
    number = int(mesh.cell_region.max()) + 1
    key = mesh.cells * number + mesh.cell_region[:, None]
    used, cells = np.unique(key, return_inverse=True)
    return SplitNodes(cells.reshape(mesh.cells.shape), used // number)


@dataclasses.dataclass(frozen=True)
class NodalFields:
    """A state at n nodes, each the copy of one region.

    Attributes:
        jacobian: det F, (n,).
        stretches: principal stretches, descending, (n, 3).
        cauchy: Cauchy stress, (n, 3, 3), MPa.
        multiplier: p, a pressure counted positive in tension, (n,), MPa.
    """

    jacobian: Floats
    stretches: Floats
    cauchy: Floats
    multiplier: Floats

    @property
    def log_strain(self) -> Floats:
        """Maximum principal logarithmic (Hencky) strain, ln λ1, (n,); Abaqus' LE."""
        return np.log(self.stretches[:, 0])

    @property
    def nominal_strain(self) -> Floats:
        """Maximum principal nominal strain, λ1 − 1, (n,); Abaqus' NE."""
        return self.stretches[:, 0] - 1

    @property
    def von_mises(self) -> Floats:
        """Von Mises stress, √(3/2) |dev σ|, (n,), MPa."""
        return np.sqrt(1.5) * np.linalg.norm(_deviator(self.cauchy), axis=(1, 2))


def deformation_gradients(mesh: MeshData, displacement: Floats) -> Floats:
    """F at the nodes of every cell.

    Args:
        mesh: hexahedra or tetrahedra, m cells with k nodes.
        displacement: by node number, (n, 3), mm.

    Returns:
        Array (m, k, 3, 3).
    """
    gradients = shape_functions(mesh.cell_type, reference_nodes(mesh.cell_type))[1]
    operator = gradients.transpose(1, 0, 2).reshape(len(gradients), -1)

    def slopes(values: Floats) -> Floats:
        """Reference gradients of a field given at the nodes of every cell, (m, k, 3, 3)."""
        flat = values.swapaxes(1, 2) @ operator
        return flat.reshape(len(values), 3, len(gradients), 3).swapaxes(1, 2)

    to_reference = _inverse(slopes(mesh.nodes[mesh.cells]))
    result: Floats = np.eye(3) + slopes(displacement[mesh.cells]) @ to_reference
    return result


def cauchy_stress(material: Material, f: Floats, multiplier: Floats) -> Floats:
    """σ = p 1 + (2/J) dev(ψ1 b̄ + ψ2 (Ī1 b̄ − b̄²)), b̄ = J^(−2/3) F Fᵀ.

    It follows from W = ψ(Ī1, Ī2) + p (J − 1), with ψi = ∂ψ/∂Īi.

    Args:
        material: the material.
        f: deformation gradients, (..., 3, 3).
        multiplier: p, (...), MPa.

    Returns:
        Cauchy stress, (..., 3, 3), MPa.
    """
    jacobian = np.linalg.det(f)[..., None, None]
    b = jacobian ** (-2 / 3) * (f @ f.swapaxes(-1, -2))
    square = b @ b
    i1 = np.trace(b, axis1=-2, axis2=-1)
    i2 = (i1**2 - np.trace(square, axis1=-2, axis2=-1)) / 2
    first, second = (slope[..., None, None] for slope in energy_slopes(material, i1, i2))
    shape = first * b + second * (i1[..., None, None] * b - square)
    return multiplier[..., None, None] * np.eye(3) + 2 / jacobian * _deviator(shape)


def recover(scenery: Scenery, snapshot: Snapshot, nodes: SplitNodes | None = None) -> NodalFields:
    """Strains and stresses of a state.

    Det F, stretches, stress and p are evaluated at the nodes of every cell and averaged; what
    `NodalFields` derives from them belongs to the averages.

    Args:
        scenery: mesh and materials.
        snapshot: the state.
        nodes: `split_nodes` of the mesh, if at hand.

    Returns:
        The fields at the copies of the nodes.

    Raises:
        ValueError: arrays that do not fit the mesh.
    """
    mesh = scenery.mesh
    if snapshot.displacement.shape != mesh.nodes.shape:
        raise ValueError(f"displacement {snapshot.displacement.shape}: expected {mesh.nodes.shape}")
    if snapshot.multiplier.shape != mesh.cells.shape:
        raise ValueError(f"multiplier {snapshot.multiplier.shape}: expected {mesh.cells.shape}")
    nodes = nodes or split_nodes(mesh)
    f = deformation_gradients(mesh, snapshot.displacement)
    stress = np.empty_like(f)
    for name, number in mesh.regions.items():
        here = mesh.cell_region == number
        stress[here] = cauchy_stress(scenery.materials[name], f[here], snapshot.multiplier[here])
    squares = np.linalg.eigvalsh(f.swapaxes(-1, -2) @ f)[..., ::-1]
    return NodalFields(
        jacobian=nodes.average(np.linalg.det(f)),
        stretches=nodes.average(np.sqrt(np.maximum(squares, 0.0))),
        cauchy=nodes.average(stress),
        multiplier=nodes.average(snapshot.multiplier),
    )


def _inverse(matrices: Floats) -> Floats:
    """Inverses of many 3×3 matrices by cofactors, several times faster than LAPACK's."""
    a, b, c = (matrices[..., i, :] for i in range(3))
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
    determinant = (a * cofactors[..., 0]).sum(axis=-1)
    inverse: Floats = cofactors / determinant[..., None, None]
    return inverse


def _deviator(tensor: Floats) -> Floats:
    mean = np.trace(tensor, axis1=-2, axis2=-1)[..., None, None] / 3
    deviator: Floats = tensor - mean * np.eye(3)
    return deviator

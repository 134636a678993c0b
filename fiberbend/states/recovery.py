"""Strains and stresses of a state at the nodes, averaged within each region but never across."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.states.bend import Bend, in_frame
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import (
    Floats,
    Ints,
    MeshData,
    reference_nodes,
)
from geometry.mesh.reference import cell_rule, gauss, jacobians, shape_functions
from materials.material import Material

_CHUNK = 20_000
_LEAST_STRETCH = 1e-3
"""What extrapolation may leave in a cell that is crushed."""


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
    """A state at n nodes, each the copy of one region, and in m cells.

    Attributes:
        jacobian: det F, (n,).
        stretches: principal stretches, descending, (n, 3).
        cauchy: Cauchy stress, (n, 3, 3), MPa.
        multiplier: p, a pressure counted positive in tension, (n,), MPa.
        volume_error: of every cell, see `volume_errors`, (m,).
    """

    jacobian: Floats
    stretches: Floats
    cauchy: Floats
    multiplier: Floats
    volume_error: Floats

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


def sampling(cell_type: str) -> tuple[Floats, Floats]:
    """Where strains are evaluated, and how they are carried on to the nodes of a cell.

    At the points of the reduced Gauss rule the strains of an order-2 cell are one order better
    than elsewhere, and not yet distorted where a corner or a fiber pulls at a node.

    Returns:
        Reference coordinates (q, d), and the matrix (k, q) of (multi-)linear extrapolation.
    """
    nodes = reference_nodes(cell_type)
    d = nodes.shape[1]
    if cell_type == "tetrahedron":
        near, far = 0.25 - 0.05 * 5**0.5, 0.25 + 0.15 * 5**0.5
        points = np.full((4, 3), near)
        points[1:] += (far - near) * np.eye(3)
        powers = np.concatenate([np.zeros((1, 3)), np.eye(3)])
    else:
        line = gauss(2)[0]
        points = np.stack(np.meshgrid(*[line] * d, indexing="ij"), axis=-1).reshape(-1, d)
        powers = np.stack(np.meshgrid(*[[0.0, 1.0]] * d, indexing="ij"), axis=-1).reshape(-1, d)

    def basis(x: Floats) -> Floats:
        values: Floats = np.prod(x[:, None, :] ** powers, axis=2)
        return values

    return points, basis(nodes) @ np.linalg.inv(basis(points))


def deformation_gradients(mesh: MeshData, state: Snapshot, points: Floats) -> Floats:
    """F at the same points of every cell.

    In uniform bending F = ∇x' + (λ0 e_z + ω × x') ⊗ e_z, its rows in the turning frame; a body in
    space is the case λ0 = 1, ω = 0 of it.

    Args:
        mesh: hexahedra, tetrahedra or quadrilaterals, m cells with k nodes.
        state: displacement, and curvature, stretch and twist.
        points: reference coordinates, (q, d).

    Returns:
        Array (m, q, 3, 3).
    """
    values, gradients = shape_functions(mesh.cell_type, points)
    operator = gradients.transpose(1, 0, 2).reshape(gradients.shape[1], -1)

    def slopes(field: Floats) -> Floats:
        """Reference gradients of a field given at the nodes of every cell, (m, q, c, d)."""
        flat = field.swapaxes(1, 2) @ operator
        return flat.reshape(*flat.shape[:2], *gradients.shape[::2]).swapaxes(1, 2)

    to_reference = _inverse(slopes(mesh.nodes[mesh.cells]))
    slope = slopes(state.displacement[mesh.cells]) @ to_reference
    f = np.tile(np.eye(3), (len(mesh.cells), len(points), 1, 1))
    f[..., : slope.shape[2], : slope.shape[3]] += slope
    bend = Bend(state.curvature, state.stretch, state.twist, side_curvature=state.side_curvature)
    if not bend.is_rest:
        position = values @ in_frame(mesh.nodes, state.displacement)[mesh.cells]
        f[..., 2] += bend.line.advance(position) - [0.0, 0.0, 1.0]
    return f


def cauchy_stress(material: Material, f: Floats, multiplier: Floats) -> Floats:
    """σ = p 1 + (1/J) dev(Σ βi ni ⊗ ni) with βi = λ̄i ∂ψ/∂λ̄i.

    λ̄i² and ni are principal values and directions of b̄ = J^(−2/3) F Fᵀ. It follows from
    W = ψ(λ̄1, λ̄2, λ̄3) + p (J − 1); where stretches are equal, so are the βi, and the directions
    do not matter.

    Args:
        material: the material.
        f: deformation gradients, (..., 3, 3).
        multiplier: p, (...), MPa.

    Returns:
        Cauchy stress, (..., 3, 3), MPa; not a number where J ≤ 0, as between the points at which an
        extreme state was solved.
    """
    jacobian = np.linalg.det(f)[..., None, None]
    if not np.all(jacobian > 0):
        right = jacobian[..., 0, 0] > 0
        stress: Floats = np.full(f.shape, np.nan)
        stress[right] = cauchy_stress(material, f[right], multiplier[right])
        return stress
    squares, axes = np.linalg.eigh(jacobian ** (-2 / 3) * (f @ f.swapaxes(-1, -2)))
    principal = np.stack(material.principal(*np.moveaxis(np.sqrt(squares), -1, 0)), axis=-1)
    shape = (axes * principal[..., None, :]) @ axes.swapaxes(-1, -2)
    return multiplier[..., None, None] * np.eye(3) + _deviator(shape) / jacobian


def volume_errors(model_mesh: ModelMesh, snapshot: Snapshot) -> Floats:
    """∫ (J − 1 − p/κ) dV / V of every cell, (m,): the volume gained beyond what the material asks.

    1/κ is zero in incompressible rubber. What is kept in an equilibrium is this, not J at a point.
    """
    mesh = model_mesh.mesh
    points, weights = cell_rule(mesh.cell_type)
    values = shape_functions(mesh.cell_type, points)[0]
    compliance = np.zeros(max(mesh.regions.values()) + 1)
    for name, number in mesh.regions.items():
        bulk = model_mesh.materials[name].bulk
        compliance[number] = 0.0 if bulk is None else 1 / bulk
    errors = np.zeros(len(mesh.cells))
    for start in range(0, len(errors), _CHUNK):
        some = slice(start, start + _CHUNK)
        part = dataclasses.replace(mesh, cells=mesh.cells[some])
        excess = np.linalg.det(deformation_gradients(part, snapshot, points)) - 1
        excess -= compliance[mesh.cell_region[some], None] * snapshot.multiplier[some] @ values.T
        jacobian = jacobians(part, np.arange(len(part.cells)), points)[1]
        volume = weights * np.linalg.det(jacobian)
        errors[some] = (volume * excess).sum(axis=1) / volume.sum(axis=1)
    return errors


def recover(
    model_mesh: ModelMesh, snapshot: Snapshot, nodes: SplitNodes | None = None
) -> NodalFields:
    """Strains and stresses of a state.

    FᵀF, det F and stress are evaluated at the points of `sampling` and carried on to the nodes
    of every cell, where they are averaged; what `NodalFields` derives belongs to the averages.

    Args:
        model_mesh: mesh and materials.
        snapshot: the state.
        nodes: `split_nodes` of the mesh, if at hand.

    Returns:
        The fields at the copies of the nodes.

    Raises:
        ValueError: arrays that do not fit the mesh.
    """
    mesh = model_mesh.mesh
    # a section has two components, and three where it warps
    shapes = {mesh.nodes.shape, (len(mesh.nodes), 3)}
    if snapshot.displacement.shape not in shapes:
        raise ValueError(f"displacement {snapshot.displacement.shape}: expected {mesh.nodes.shape}")
    if snapshot.multiplier.shape != mesh.cells.shape:
        raise ValueError(f"multiplier {snapshot.multiplier.shape}: expected {mesh.cells.shape}")
    nodes = nodes or split_nodes(mesh)
    points, onward = sampling(mesh.cell_type)
    f = deformation_gradients(mesh, snapshot, points)
    multiplier = snapshot.multiplier @ shape_functions(mesh.cell_type, points)[0].T
    stress = np.empty_like(f)
    for name, number in mesh.regions.items():
        here = mesh.cell_region == number
        stress[here] = cauchy_stress(model_mesh.materials[name], f[here], multiplier[here])

    def at_nodes(values: Floats) -> Floats:
        flat = onward @ values.reshape(*values.shape[:2], -1)
        return flat.reshape(*flat.shape[:2], *values.shape[2:])

    return NodalFields(
        jacobian=nodes.average(at_nodes(np.linalg.det(f))),
        stretches=nodes.average(_stretches(f, onward)),
        cauchy=nodes.average(at_nodes(stress)),
        multiplier=nodes.average(snapshot.multiplier),
        volume_error=volume_errors(model_mesh, snapshot),
    )


def principal_stretches(mesh: MeshData, snapshot: Snapshot, nodes: SplitNodes) -> Floats:
    """Principal stretches of a state as `recover` has them, and nothing else; descending, (n, 3).

    Args:
        mesh: of the model.
        snapshot: the state.
        nodes: `split_nodes` of the mesh.
    """
    points, onward = sampling(mesh.cell_type)
    return nodes.average(_stretches(deformation_gradients(mesh, snapshot, points), onward))


def _stretches(f: Floats, onward: Floats) -> Floats:
    """Principal stretches at the nodes of every cell, descending, (m, k, 3).

    FᵀF is smooth and does not turn with the body; its principal values change places.

    Args:
        f: deformation gradients at the points of `sampling`, (m, q, 3, 3).
        onward: carries them on to the nodes, (k, q).
    """
    squares = (f.swapaxes(-1, -2) @ f).reshape(*f.shape[:2], 9)
    at_nodes = (onward @ squares).reshape(len(f), len(onward), 3, 3)
    values = np.linalg.eigvalsh(at_nodes)[..., ::-1]
    stretches: Floats = np.sqrt(np.maximum(values, _LEAST_STRETCH**2))
    return stretches


def _inverse(matrices: Floats) -> Floats:
    """Inverses of many small matrices; 3×3 by cofactors, several times faster than LAPACK's."""
    if matrices.shape[-1] != 3:
        return np.linalg.inv(matrices)
    a, b, c = (matrices[..., i, :] for i in range(3))
    cofactors = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-1)
    determinant = (a * cofactors[..., 0]).sum(axis=-1)
    inverse: Floats = cofactors / determinant[..., None, None]
    return inverse


def _deviator(tensor: Floats) -> Floats:
    mean = np.trace(tensor, axis1=-2, axis2=-1)[..., None, None] / 3
    deviator: Floats = tensor - mean * np.eye(3)
    return deviator

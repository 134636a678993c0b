"""A convergence ladder: one exact solution, several meshes, errors and rates."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import ClassVar, Protocol

from fem import compat  # starts MPI, without which dolfinx may find none

# isort: split
import dolfinx.fem as dfem
import numpy as np
import numpy.typing as npt
import ufl
from mpi4py import MPI

from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from geometry.mesh.data import MeshData
from geometry.mesh.reference import cell_rule, jacobians
from geometry.mesh.tets import to_tetrahedra

Floats = npt.NDArray[np.float64]
YEOH = {"c1": 0.11, "c2": 0.02}
FAMILIES = {"hexahedron": "Q2–P1 discontinuous", "tetrahedron": "P2–P1"}


class Exact(Protocol):
    """Fields of an exact solution."""

    def displacement(self, X: Floats) -> Floats:
        """Displacement at reference points (n, 3)."""

    def multiplier(self, X: Floats) -> Floats:
        """Pressure-like multiplier at reference points (n, 3)."""


@dataclasses.dataclass
class Rung:
    """What one mesh gave.

    Attributes:
        n: refinement.
        cells: number of cells.
        unknowns: number of unknowns.
        u: ‖u − u_exact‖ / ‖u_exact‖ in L2.
        p: the same of the multiplier.
        values: reference numbers as computed.
        iterations: Newton iterations.
    """

    n: int
    cells: int
    unknowns: int
    u: float
    p: float
    values: dict[str, float]
    iterations: int


class Ladder:
    """One problem; a subclass gives the mesh, the exact solution and what is held.

    Attributes:
        title: heading of its table.
        text: what is solved.
        levels: refinements by cell type, coarse to fine.
        reference: numbers that are known, by name, and the relative error that the finest mesh
            may have: some ten times what it has, a hundredth of what the coarsest has.
        rubbers: numbers of Yeoh's law by region.
        exact: the exact solution.
    """

    title: ClassVar[str]
    text: ClassVar[str]
    levels: ClassVar[dict[str, tuple[int, ...]]]
    reference: ClassVar[dict[str, tuple[float, float]]]
    rubbers: ClassVar[dict[str, dict[str, float]]] = {"solid": YEOH}
    exact: Exact

    def mesh(self, n: int) -> MeshData:
        """Hexahedra of refinement n."""
        raise NotImplementedError

    def effects(self, domain: Domain) -> list[Effect]:
        """Loads and supports besides the rubber."""
        return []

    def held(self) -> dict[str, tuple[int, ...]]:
        """Surfaces whose displacement components are prescribed as in the exact solution."""
        return {}

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """Solve from the exact state; returns the outcome and the reference numbers found."""
        raise NotImplementedError

    def rung(self, cell: str, n: int) -> Rung:
        """Solve on one mesh."""
        mesh = self.mesh(n)
        domain = Domain(to_tetrahedra(mesh) if cell == "tetrahedron" else mesh, MPI.COMM_SELF)
        rubber: list[Effect] = [Elastic("yeoh", self.rubbers), Incompressible()]
        scene = Scene(domain, [*rubber, *self.effects(domain)])
        start_from(scene, self.exact)
        for surface, components in self.held().items():
            nodes = domain.surface_nodes(surface)
            values = self.exact.displacement(domain.data.nodes[nodes])
            for i in components:
                scene.fix(scene.body.node_dofs[nodes, i], values[:, i])
        outcome, values_found = self.find(scene, Newton(scene, MPI.COMM_SELF, Settings()))
        assert outcome.converged, f"{self.title}, {cell}, n = {n}: {outcome.reason}"
        u, p = errors(scene, self.exact)
        size = scene.body.size
        cells = len(domain.data.cells)
        return Rung(n, cells, size, u, p, values_found, outcome.iterations)

    def climb(self, cell: str) -> list[Rung]:
        """All rungs of one element family."""
        return [self.rung(cell, n) for n in self.levels[cell]]


def rates(errors: Sequence[float], sizes: Sequence[float]) -> list[float]:
    """Order between neighbouring rungs; `sizes` falls with the mesh."""
    e, h = np.log(errors), np.log(sizes)
    return [float(rate) for rate in np.diff(e) / np.diff(h)]


def start_from(scene: Scene, exact: Exact) -> None:
    """Set the state to the interpolated exact solution."""
    body, nodes = scene.body, scene.domain.data.nodes
    body.set_displacement(exact.displacement(nodes)[body.owned_nodes])
    space, parent = body.space.sub(3).collapse()
    p = dfem.Function(space)
    p.interpolate(lambda X: exact.multiplier(np.ascontiguousarray(X.T)))
    body.w.x.array[np.asarray(parent)] = p.x.array
    scene.set(scene.w.copy())
    scene.predict(None)


def errors(scene: Scene, exact: Exact) -> tuple[float, float]:
    """Relative L2 errors of displacement and multiplier over the reference volume."""
    domain, body = scene.domain, scene.body
    points, weights = cell_rule(domain.data.cell_type)
    X, J = jacobians(domain.data, domain.cells[: domain.owned], points)
    volumes = (np.linalg.det(J) * weights).ravel()
    fields = ufl.as_vector([*body.part(body.w, "u"), body.p])
    found = compat.PointValues(domain.mesh, fields, points)().reshape(-1, 4)
    u, p = exact.displacement(X.reshape(-1, 3)), exact.multiplier(X.reshape(-1, 3))
    difference = volumes @ np.square(found[:, :3] - u).sum(axis=1)
    u_error = np.sqrt(difference / (volumes @ np.square(u).sum(axis=1)))
    p_error = np.sqrt(volumes @ np.square(found[:, 3] - p) / (volumes @ np.square(p)))
    return float(u_error), float(p_error)


def end_load(scene: Scene, surface: str, origin: Floats) -> tuple[Floats, Floats]:
    """Force and moment about a point that the held dofs of a surface put on the body."""
    body = scene.body
    nodes = scene.domain.surface_nodes(surface)
    dofs = body.node_dofs[nodes]
    force = np.where(scene.free[dofs], 0.0, scene.residual()[0][dofs])
    x = scene.domain.data.nodes[nodes] + scene.w[dofs] - origin
    return force.sum(axis=0), np.cross(x, force).sum(axis=0)


class VolumeRatio:
    """Closing equation: the cavity's volume in multiples of its volume at rest."""

    def __init__(self, scene: Scene, rest: float, ratio: float) -> None:
        self._scene, self._rest, self._ratio = scene, rest, ratio

    def value(self) -> float:
        """V/V₀ less its target."""
        return self._scene.conjugate("pressure") / self._rest - self._ratio

    def noise(self) -> float:
        """None."""
        return 0.0

    def lag(self) -> float:
        """No fiber force is in it."""
        return 0.0

    def row(self) -> Floats:
        """Its gradient."""
        return -self._scene.load("pressure") / self._rest

    def slope(self, scalar: str) -> float:
        """V depends on no scalar."""
        return 0.0


def volume_at_rest(scene: Scene) -> float:
    """Volume of the cavity in the mesh's own geometry; the state is kept."""
    keep = scene.body.w.x.array.copy()
    scene.body.w.x.array[:] = 0.0
    volume = scene.conjugate("pressure")
    scene.body.w.x.array[:] = keep
    return volume


def balanced_pressure(
    scene: Scene, solve: Callable[[], Outcome], axial: Callable[[], float], guess: float
) -> tuple[Outcome, float]:
    """Pressure at which the axial force vanishes, by a secant: the force is all but linear."""
    pressures, forces = [guess, 1.01 * guess], []
    for pressure in pressures:
        scene.set_scalar("pressure", pressure)
        outcome = solve()
        if not outcome.converged:
            return outcome, np.nan
        forces.append(axial())
    slope = (forces[1] - forces[0]) / (pressures[1] - pressures[0])
    found = pressures[0] - forces[0] / slope
    scene.set_scalar("pressure", found)
    return solve(), found

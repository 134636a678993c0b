"""How positions follow from the unknowns: what every model shares."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import dolfinx.fem as dfem
import numpy as np
import numpy.typing as npt
import ufl
from mpi4py import MPI

from fem import compat
from fem.kinematics.domain import Domain
from fem.kinematics.numbers import Numbers
from fem.kinematics.regions import continuous_by_region

Floats = npt.NDArray[np.float64]
Dofs = npt.NDArray[np.int32]


def _displacement(cell: str) -> Any:
    # scalar elements, not one vector element: contiguous rows let the compiler vectorise kernels
    return compat.scalar_element("Lagrange", cell, 2)


def _pressure(cell: str) -> Any:
    """P1: an element's own on bricks (Q2–P1disc), by vertex and region on tetrahedra."""
    family = "Discontinuous Lagrange" if cell == "tetrahedron" else "DPC"
    return compat.scalar_element(family, cell, 1)


DISPLACEMENT, PRESSURE = "u", "p"
FIELDS: dict[str, Callable[[str], Any]] = {DISPLACEMENT: _displacement, PRESSURE: _pressure}
"""Scalar element of each field that an effect may ask for."""


@dataclasses.dataclass(frozen=True)
class Carry:
    """The part of F e_z that no gradient gives: stretch e_z + spin × x, x in the section's frame.

    Attributes:
        stretch: λ0.
        spin: (k_x, k_y, τ), 1/mm.
        rates: by scalar, its derivative as a pair (of the vector λ0 e_z, of the spin).
    """

    stretch: float
    spin: Floats
    rates: dict[str, tuple[Floats, Floats]]


class Kinematics:
    """How positions follow from the unknowns; the effects ask it for F, x and measures.

    A subclass gives `F`, `x` and `volume_density`. Only the fields that some effect asks for
    exist.

    Args:
        domain: the mesh with names.
        fields: names of the fields that the effects ask for.
        components: number of displacement components.

    Attributes:
        domain: the mesh with names.
        space: the one mixed space of all fields.
        w: all unknown fields together, a dolfinx function.
        names: the fields present, in their order within the space.
        pressure_field: that of them that is a pressure, which multiplies a change of volume; None
            where no effect asked for it.
        components: number of displacement components.
        scalars: the global scalars, by name, that effects and kinematics declared.
        natural: those of them that are unknowns of the kinematics: at an equilibrium the
            potential is stationary in them.
        pins: (node, component) fixed so that no rigid motion is left.
        opposite_pins: the same for modes of the symmetry opposite to that of half the body.
        ties: local dofs that follow others, and these; on one rank only.
        symmetry_factor: how many of what is modelled make up the whole actuator: two halves, or a
            length over that of a slice.
        numbers: those within the effects' forms.
        stand_ins: constants that stand for frozen scalars while forms are differentiated, and
            these; whoever compiles a form replaces them.
    """

    def __init__(self, domain: Domain, fields: Iterable[str], components: int) -> None:
        self.domain, self.numbers = domain, Numbers(domain)
        self.components = components
        self.natural: tuple[str, ...] = ()
        self.pins: tuple[tuple[int, int], ...] = ()
        self.opposite_pins: tuple[tuple[int, int], ...] = ()
        self.ties: tuple[Dofs, Dofs] = (np.zeros(0, dtype=np.int32), np.zeros(0, dtype=np.int32))
        self.symmetry_factor = 2.0 if domain.data.half else 1.0
        cell = domain.data.cell_type
        wanted = set(fields)
        self.names = [name for name in FIELDS if name in wanted]
        self.pressure_field = PRESSURE if PRESSURE in self.names else None
        counts = {DISPLACEMENT: components, PRESSURE: 1}
        elements = {name: (FIELDS[name](cell), counts[name]) for name in self.names}
        self.space = compat.mixed_space(
            domain.mesh, [element for element, count in elements.values() for _ in range(count)]
        )
        if cell == "tetrahedron" and self.pressure_field is not None:
            first = sum(counts[name] for name in self.names[: self.names.index(PRESSURE)])
            self.space = continuous_by_region(domain, self.space, first)
        self.w = dfem.Function(self.space)
        self._scratch = dfem.Function(self.space)
        self._slices: dict[str, range] = {}
        self._dofs: dict[str, Dofs] = {}
        first = 0
        for name, (_, count) in elements.items():
            self._slices[name] = range(first, first + count)
            columns = [compat.field_dofs(self.space, i) for i in self._slices[name]]
            self._dofs[name] = np.stack(columns, axis=2)
            first += count
        self.scalars: dict[str, Any] = {}
        self._variables: dict[str, Any] = {}
        self.stand_ins: dict[Any, Any] = {}

        order = np.argsort(compat.node_permutation(cell))
        self.cell_dofs: Dofs = self._dofs[DISPLACEMENT][:, order]
        """Displacement dofs of every local cell, (cells, nodes, components), `geometry.mesh`
        order."""
        self.node_dofs: Dofs = np.full((len(domain.data.nodes), components), -1, dtype=np.int32)
        """Local displacement dofs of every input node, (n, components); -1: not here."""
        self.node_dofs[domain.data.cells[domain.cells]] = self.cell_dofs
        index_map = self.space.dofmap.index_map
        self.owned = int(index_map.size_local)
        self.local = self.owned + int(index_map.num_ghosts)
        self.size = int(index_map.size_global)
        here = self.node_dofs[:, 0]
        self.owned_nodes = np.flatnonzero((here >= 0) & (here < self.owned))
        """Input numbers of the nodes whose displacement this rank owns."""

    def part(self, function: Any, field: str) -> list[Any]:
        """Components of one field of a function or argument on the mixed space.

        Raises:
            KeyError: no effect of the scene asked for the field.
        """
        components = ufl.split(function)
        return [components[i] for i in self._slices[field]]

    # --- what effects ask for ---------------------------------------------------------------

    @property
    def u(self) -> Any:
        """Displacement, a UFL vector in mm; in uniform bending in the section's own frame."""
        return ufl.as_vector(self.part(self.w, DISPLACEMENT))

    @property
    def p(self) -> Any:
        """Pressure-like multiplier of J = 1, a UFL scalar in MPa.

        Raises:
            KeyError: no effect of the scene asked for it.
        """
        return self.part(self.w, PRESSURE)[0]

    @property
    def x(self) -> Any:
        """Deformed position, a UFL vector of three in mm."""
        raise NotImplementedError

    @property
    def F(self) -> Any:
        """Deformation gradient, a UFL 3×3 tensor."""
        raise NotImplementedError

    def volume_density(self, surface: str) -> Any:
        """Density per reference area of the volume that a closed cavity surface encloses."""
        raise NotImplementedError

    def moved(self) -> None:
        """Follow the nodes of the mesh, which have been put to other places at rest."""

    def carry(self) -> Carry | None:
        """How the axis carries positions along z at the present state; None in a 3-D body."""
        return None

    def turned(self) -> float | None:
        """All that the centre-line turns, rad, where the bending angle is a part of it alone."""
        return None

    def dx(self) -> Any:
        """Reference volume measure, mm³."""
        return self.domain.dx()

    def ds(self, surface: str) -> Any:
        """Reference area measure of a named boundary surface, mm²."""
        return self.domain.ds(surface)

    @property
    def span(self) -> float:
        """Greatest extent of what is modelled, mm."""
        return float(self.domain.data.extent.max())

    def size_of(self, scalar: str) -> float:
        """A change of a natural scalar that strains like a stretch of one."""
        raise KeyError(scalar)

    def coefficient(self, by_region: dict[str, float]) -> Any:
        """A material constant as a piecewise constant field, one value per region."""
        return self.numbers.field(by_region)

    def constants(self, values: Sequence[float]) -> Any:
        """Numbers that are no code: other ones do not recompile."""
        return self.numbers.constants(values)

    def scalar(self, name: str) -> Any:
        """The UFL variable of a global scalar, such as the chamber pressure in MPa."""
        if name not in self.scalars:
            self.scalars[name] = dfem.Constant(self.domain.mesh, 0.0)
            self._variables[name] = ufl.variable(self.scalars[name])
        return self._variables[name]

    def frozen(self, value: Any) -> Any:
        """A UFL scalar by its present value alone: no derivative goes through it."""
        stand_in, new = self.numbers.stand_in()
        if new:
            self.stand_ins[stand_in] = value
        return stand_in

    def astray(self) -> Floats:
        """A displacement of the owned nodes without sense, in mm, (len(owned_nodes), components).

        Every component is the least extent of the elements around its node, with a sign by lot:
        times the precision of double, it is what round-off makes of a displacement at rest. The
        same on every machine and on any number of ranks.
        """
        data = self.domain.data
        extent = np.ptp(data.nodes[data.cells], axis=1).min(axis=1)
        around = np.full(len(data.nodes), np.inf)
        np.minimum.at(around, data.cells, extent[:, None])
        lots = np.random.default_rng(0).choice([-1.0, 1.0], (len(around), self.components))
        values: Floats = (around[:, None] * lots)[self.owned_nodes]
        return values

    # --- what measures and predictors ask for ---------------------------------------------

    def with_ghosts(self, owned: Floats) -> Floats:
        """Local coefficients, ghosts and tied ones included, of owned ones; collective."""
        scratch = self._scratch.x
        scratch.array[: self.owned] = owned
        scratch.scatter_forward()
        values: Floats = scratch.array.copy()
        values[self.ties[0]] = values[self.ties[1]]
        return values

    def dofs(self, field: str) -> Dofs:
        """Local dofs of a field for every local cell, (cells, nodes, components), basix order."""
        return self._dofs[field]

    def volumetric(self) -> npt.NDArray[np.bool_]:
        """Which owned dofs are pressures, (owned,)."""
        found = np.zeros(self.owned, dtype=bool)
        if self.pressure_field is not None:
            p = self.dofs(self.pressure_field)
            found[p[p < self.owned]] = True
        return found

    def displacement(self) -> Floats:
        """Displacement of the owned nodes in mm, (len(owned_nodes), components)."""
        values: Floats = self.w.x.array[self.node_dofs[self.owned_nodes]]
        return values

    def set_displacement(self, values: Floats) -> None:
        """Set the displacement of the owned nodes in mm, and update the ghosts."""
        self.w.x.array[self.node_dofs[self.owned_nodes]] = values
        self.w.x.scatter_forward()

    def det_f(self) -> Callable[[], float]:
        """A function that returns the least det F over the quadrature points of all ranks."""
        points = compat.quadrature_points(self.domain.data.cell_type, self.domain.degree)
        values = compat.PointValues(self.domain.mesh, ufl.det(self.F), points)

        def least() -> float:
            here = values()
            mine = float(here.min()) if here.size else np.inf
            return float(self.domain.comm.allreduce(mine, MPI.MIN))

        return least

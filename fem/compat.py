"""The only file that knows dolfinx versions; each function says what it bridges.

Local cells and dofs are those that this rank owns, then its ghosts.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem.quick_start import without_pkg_resources, without_settings_files

with without_pkg_resources():
    import basix
    import dolfinx
    import dolfinx.cpp
    import dolfinx.fem as dfem
    import dolfinx.fem.petsc
    import dolfinx.jit
    import dolfinx.mesh
    import ffcx.parameters
    import ufl

    from fem import kernels

    without_settings_files(dolfinx.jit, ffcx.parameters)

from geometry.mesh.data import reference_nodes


def _basix_cell(cell_type: str) -> Any:
    """Cell type by its name; bridges basix's enumeration."""
    return getattr(basix.CellType, cell_type)


def node_permutation(cell_type: str) -> npt.NDArray[np.int64]:
    """Position in `geometry.mesh` order of each basix node; bridges the order of a cell's nodes."""
    element = basix.create_element(
        basix.ElementFamily.P, _basix_cell(cell_type), 2, basix.LagrangeVariant.equispaced
    )
    ours = reference_nodes(cell_type)
    return np.array([np.argmin(np.abs(ours - point).sum(axis=1)) for point in element.points])


def create_mesh(
    comm: MPI.Comm, cell_type: str, nodes: npt.NDArray[np.float64], cells: npt.NDArray[np.int64]
) -> Any:
    """Distribute a mesh of order-2 cells; bridges create_mesh's signature and the node order.

    Args:
        comm: communicator.
        cell_type: cell name of `geometry.mesh`.
        nodes: (n, d), the same on every rank.
        cells: (m, nodes per cell), the same on every rank, in `geometry.mesh` order.
    """
    # FFCx sets this variant itself at the first compilation, which would change every signature
    element = ufl.VectorElement("Lagrange", cell_type, 2, variant="equispaced")
    share = np.array_split(np.arange(len(cells)), comm.size)[comm.rank]
    points = np.array_split(np.arange(len(nodes)), comm.size)[comm.rank]
    return dolfinx.mesh.create_mesh(
        comm,
        np.ascontiguousarray(cells[share][:, node_permutation(cell_type)]),
        np.ascontiguousarray(nodes[points]),
        ufl.Mesh(element),
        dolfinx.mesh.GhostMode.none,
        dolfinx.cpp.mesh.create_cell_partitioner(),
    )


def input_cells(mesh: Any) -> npt.NDArray[np.int64]:
    """Input number of every local cell; bridges the renumbering of cells."""
    return np.asarray(mesh.topology.original_cell_index, dtype=np.int64)


def _rows(adjacency: Any, count: int) -> npt.NDArray[np.int32]:
    """A dofmap as an array; bridges adjacency lists, which dolfinx before 0.8 returns."""
    return np.asarray(getattr(adjacency, "array", adjacency)).reshape(count, -1)


def cell_facets(mesh: Any) -> npt.NDArray[np.int32]:
    """Facet number of every local cell's facets, (cells, facets per cell); bridges connectivity."""
    tdim = mesh.topology.dim
    mesh.topology.create_connectivity(tdim, tdim - 1)
    mesh.topology.create_connectivity(tdim - 1, tdim)
    return _rows(mesh.topology.connectivity(tdim, tdim - 1), len(input_cells(mesh)))


def owned_cells(mesh: Any) -> int:
    """Number of cells that this rank owns; bridges the topology's index maps."""
    return int(mesh.topology.index_map(mesh.topology.dim).size_local)


def meshtags(mesh: Any, dim: int, entities: Any, values: Any) -> Any:
    """Tags on mesh entities; bridges that they must be sorted, unique and int32."""
    order = np.argsort(entities)
    tags = (np.asarray(array, dtype=np.int32)[order] for array in (entities, values))
    return dolfinx.mesh.meshtags(mesh, dim, *tags)


def scalar_element(family: str, cell_type: str, degree: int) -> Any:
    """A scalar finite element; bridges that elements are ufl's before dolfinx 0.8, then basix's."""
    return ufl.FiniteElement(family, cell_type, degree)


def mixed_space(mesh: Any, elements: Sequence[Any]) -> Any:
    """One mixed space, also of one element: block sizes are always 1; bridges FunctionSpace."""
    return _jit(mesh.comm, lambda _: dfem.FunctionSpace(mesh, ufl.MixedElement(*elements)))


def field_dofs(space: Any, index: int) -> npt.NDArray[np.int32]:
    """Local dofs of a scalar part of a mixed space, (cells, nodes); bridges collapse, dofmaps."""
    collapsed, parent = _jit(space.mesh.comm, lambda _: space.sub(index).collapse())
    rows = _rows(collapsed.dofmap.list, len(input_cells(space.mesh)))
    return np.asarray(parent, dtype=np.int32)[rows]


def shared_space(
    space: Any, rows: npt.NDArray[np.int32], owned: int, ghosts: Any, owners: Any
) -> Any:
    """The same elements with other dofs; bridges DofMap, IndexMap and adjacency lists.

    Args:
        space: a space with a block size of 1.
        rows: local dofs of every local cell, (cells, dofs).
        owned: number of dofs that this rank owns.
        ghosts: global numbers of those that other ranks own, (ghosts,).
        owners: these ranks, (ghosts,).
    """
    ghosts, owners = np.asarray(ghosts, dtype=np.int64), np.asarray(owners, dtype=np.int32)
    index_map = dolfinx.cpp.common.IndexMap(space.mesh.comm, owned, ghosts, owners)
    adjacency = dolfinx.cpp.graph.AdjacencyList_int32(np.ascontiguousarray(rows, dtype=np.int32))
    layout = space._cpp_object.dofmap.dof_layout
    dofmap = dolfinx.cpp.fem.DofMap(layout, index_map, 1, adjacency, 1)
    made = dolfinx.cpp.fem.FunctionSpace(space._cpp_object.mesh, space.element, dofmap)
    return dfem.FunctionSpace(space.mesh, space.ufl_element(), made)


def owned_dofs(space: Any) -> int:
    """Number of dofs that this rank owns; bridges index maps."""
    return int(space.dofmap.index_map.size_local)


def ghost_owners(space: Any) -> npt.NDArray[np.int32]:
    """Ranks that own the dofs of `ghost_numbers`, (ghosts,); bridges index maps."""
    return np.asarray(space.dofmap.index_map.owners, dtype=np.int32)


def from_owners(space: Any, numbers: npt.NDArray[np.integer]) -> npt.NDArray[np.int64]:
    """What other ranks say of the dofs that they own, (ghosts,); bridges scatters.

    Args:
        space: the space.
        numbers: whole numbers below 2⁵³, one for each dof that this rank owns.
    """
    carrier = dfem.Function(space)
    carrier.x.array[: len(numbers)] = numbers
    carrier.x.scatter_forward()
    return np.asarray(carrier.x.array[len(numbers) :], dtype=np.int64)


def cell_field(mesh: Any, values: npt.NDArray[np.float64]) -> Any:
    """A piecewise constant field of one value a local cell; bridges FunctionSpace, dofmaps."""
    space = _jit(mesh.comm, lambda _: dfem.FunctionSpace(mesh, ("DG", 0)))
    function = dfem.Function(space)
    dofs = _rows(space.dofmap.list, len(input_cells(mesh)))[:, 0]
    function.x.array[dofs] = values
    return function


def cell_dofs(space: Any) -> npt.NDArray[np.int32]:
    """Local dofs of a space for every local cell, (cells, dofs); bridges dofmaps."""
    return _rows(space.dofmap.list, len(input_cells(space.mesh)))


def ghost_numbers(space: Any) -> npt.NDArray[np.int64]:
    """Global numbers of the dofs that other ranks own, (ghosts,); bridges index maps."""
    return np.asarray(space.dofmap.index_map.ghosts, dtype=np.int64)


def coordinates(mesh: Any) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    """Points, (n, 3), and those of every local cell, (cells, nodes); bridges dofmaps."""
    rows = _rows(mesh.geometry.dofmap, len(input_cells(mesh)))
    return np.ascontiguousarray(mesh.geometry.x), np.ascontiguousarray(rows)


class Integral(NamedTuple):
    """An integral: kernel's address, key of its coefficients, cells (n,), facets in them (n,)."""

    kernel: int
    key: Any
    cells: npt.NDArray[np.int32]
    facets: npt.NDArray[np.int32]


def integrals(form: Any, ffi: Any) -> list[Integral]:
    """Integrals of a form over cells and boundary facets; bridges where FFCx and dolfinx list them.

    Args:
        form: compiled.
        ffi: of a compiled module; a new one of cffi would load a parser of C.

    Raises:
        NotImplementedError: an integral or an element of another kind.
    """
    kinds = dolfinx.cpp.fem.IntegralType
    sides = {kinds.cell: 0, kinds.exterior_facet: 1}
    if (
        not set(form.integral_types) <= set(sides)
        or form.needs_facet_permutations
        or any(space.element.needs_dof_transformations for space in form.function_spaces)
    ):
        raise NotImplementedError("only cells, boundary facets and elements that need no turning")
    found, ufcx = [], form.ufcx_form
    for kind in form.integral_types:
        own = ufcx.integrals(sides[kind])
        for i in range(ufcx.num_integrals(sides[kind])):
            number = ufcx.integral_ids(sides[kind])[i]
            rows = np.asarray(form.domains(kind, number), dtype=np.int32)
            cells, facets = rows.T if rows.ndim == 2 else (rows, np.zeros_like(rows))
            address = ffi.cast("uintptr_t", own[i].tabulate_tensor_float64)
            found.append(Integral(int(address), (kind, number), cells, facets))
    return found


def coefficients(form: Any) -> tuple[npt.NDArray[np.float64], dict[Any, npt.NDArray[np.float64]]]:
    """Constants of a form now, and by integral its coefficients, (n, c); bridges their packing."""
    return dolfinx.cpp.fem.pack_constants(form), dolfinx.cpp.fem.pack_coefficients(form)


def _jit(comm: MPI.Comm, make: Callable[[dict[str, Any]], Any]) -> Any:
    """Compile with our options; bridges the defaults, with which elements and maps are compiled."""

    def with_defaults(options: dict[str, Any]) -> Any:
        table = dolfinx.jit.DOLFINX_DEFAULT_JIT_PARAMETERS
        table.update({name: (value, table[name][1]) for name, value in options.items()})
        return make(options)

    return kernels.compiled(comm, with_defaults)


def compile_form(mesh: Any, form: Any) -> Any:
    """Compile a UFL form; bridges jit_params, which are jit_options from dolfinx 0.6 on."""
    return _jit(mesh.comm, lambda options: dfem.form(form, jit_params=options))


class PointValues:
    """A UFL expression at points (q, d) of every owned cell; bridges Expression.eval."""

    def __init__(self, mesh: Any, expression: Any, points: npt.NDArray[np.float64]) -> None:
        self._cells = np.arange(owned_cells(mesh), dtype=np.int32)
        self._points = len(points)
        self._expression = _jit(
            mesh.comm, lambda options: dfem.Expression(expression, points, jit_params=options)
        )

    def __call__(self) -> npt.NDArray[np.float64]:
        """Values now, (owned cells, points, components)."""
        if not len(self._cells):
            return np.zeros((0, self._points, 1))
        values = np.asarray(self._expression.eval(self._cells))
        return values.reshape(len(self._cells), self._points, -1)


def quadrature(
    cell_type: str, degree: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Points (q, d) and weights (q,) of a measure of this degree; bridges make_quadrature."""
    points, weights = basix.make_quadrature(_basix_cell(cell_type), degree)
    return np.asarray(points), np.asarray(weights)


def quadrature_points(cell_type: str, degree: int) -> npt.NDArray[np.float64]:
    """Points (q, d) of the scheme of a measure of this degree."""
    return quadrature(cell_type, degree)[0]


def assemble_vector(vector: PETSc.Vec, form: Any) -> None:
    """Add a form to a vector, ghosts included, without communication; bridges its name."""
    dolfinx.fem.petsc.assemble_vector(vector, form)


def create_vector(form: Any) -> PETSc.Vec:
    """A vector with ghosts for a linear form; bridges what it is made from."""
    return dolfinx.fem.petsc.create_vector(form)


def assemble_scalar(form: Any) -> float:
    """This rank's part of a functional; bridges its complex type."""
    return float(dfem.assemble_scalar(form))

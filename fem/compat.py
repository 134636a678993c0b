"""The only file that knows a version of dolfinx, ufl, ffcx or basix; it says what it bridges.

Local cells and dofs are those that this rank owns, then its ghosts.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

from fem.quick_start import without_method_caches, without_pkg_resources, without_settings_files

with without_pkg_resources(), without_method_caches():
    import basix
    import dolfinx
    import dolfinx.cpp
    import dolfinx.fem as dfem
    import dolfinx.fem.petsc
    import dolfinx.jit
    import dolfinx.mesh
    import ufl

    from fem import kernels

from geometry.mesh.data import reference_nodes
from machine.folders import MachineError

SUPPORTED = {
    (0, 5): "0.5 of Debian 12",
    (0, 9): "0.9 of Debian 13",
    (0, 11): "0.11 of dolfinx-solver-real from PyPI",
}
"""Releases of dolfinx that this file bridges, and where they come from."""


def supported_release(version: str) -> tuple[int, int]:
    """Major and minor number of a version of dolfinx.

    Raises:
        MachineError: it is not supported.
    """
    parts = version.split(".")
    release = tuple(int(part) if part.isdecimal() else -1 for part in (*parts, "")[:2])
    if release not in SUPPORTED:
        raise MachineError(
            f"dolfinx {version} is not supported, but {', '.join(SUPPORTED.values())}"
        )
    return release[0], release[1]


_RELEASE = supported_release(dolfinx.__version__)
_BEFORE_8 = _RELEASE < (0, 8)
"""Elements are ufl's, compiled by FFCx; later they are basix's."""
_BEFORE_10 = _RELEASE < (0, 10)
"""Integrals of a form go by the number of a subdomain, later by their place in a list; a mesh has
one type of cell, later lists have an entry for each type."""
_TAG = 1300
"""Of messages about ghosts: another than dolfinx's own, which may still be under way."""

if _BEFORE_8:
    _SETTINGS, _JIT = "parameters", "jit_params"
else:
    _SETTINGS, _JIT = "options", "jit_options"
    import basix.ufl
without_settings_files(
    f"_load_{_SETTINGS}", dolfinx.jit, importlib.import_module(f"ffcx.{_SETTINGS}")
)


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
    share = np.array_split(np.arange(len(cells)), comm.size)[comm.rank]
    points = np.array_split(np.arange(len(nodes)), comm.size)[comm.rank]
    mine = np.ascontiguousarray(cells[share][:, node_permutation(cell_type)])
    placed = np.ascontiguousarray(nodes[points])
    if _BEFORE_8:
        # FFCx sets this variant itself at the first compilation, which would change every signature
        element = ufl.VectorElement("Lagrange", cell_type, 2, variant="equispaced")
        partitioner = dolfinx.cpp.mesh.create_cell_partitioner()
        mode = dolfinx.mesh.GhostMode.none
        return dolfinx.mesh.create_mesh(comm, mine, placed, ufl.Mesh(element), mode, partitioner)
    variant, shape = basix.LagrangeVariant.equispaced, (nodes.shape[1],)
    element = basix.ufl.element("Lagrange", cell_type, 2, lagrange_variant=variant, shape=shape)
    # no ghosts unless asked for
    return dolfinx.mesh.create_mesh(comm, cells=mine, x=placed, e=ufl.Mesh(element))


def input_cells(mesh: Any) -> npt.NDArray[np.int64]:
    """Input number of every local cell; bridges the renumbering of cells."""
    return np.asarray(mesh.topology.original_cell_index, dtype=np.int64)


def _rows(adjacency: Any, count: int) -> npt.NDArray[np.int32]:
    """A dofmap as an array; bridges adjacency lists, which dolfinx before 0.8 returns."""
    return np.asarray(getattr(adjacency, "array", adjacency)).reshape(count, -1)


def cell_facets(mesh: Any) -> npt.NDArray[np.int32]:
    """Facet number of every local cell's facets, (cells, facets per cell).

    Bridges connectivity, which numbers the facets itself before dolfinx 0.9.
    """
    tdim = mesh.topology.dim
    mesh.topology.create_entities(tdim - 1)
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
    if _BEFORE_8:
        return ufl.FiniteElement(family, cell_type, degree)
    return basix.ufl.element(family, cell_type, degree)


def _space(mesh: Any, element: Any) -> Any:
    """A function space of an element; bridges FunctionSpace, later functionspace."""
    make = dfem.FunctionSpace if _BEFORE_8 else dfem.functionspace
    return _jit(mesh.comm, lambda _: make(mesh, element))


def mixed_space(mesh: Any, elements: Sequence[Any]) -> Any:
    """One mixed space, also of one element: block sizes are always 1; bridges MixedElement."""
    if _BEFORE_8:
        return _space(mesh, ufl.MixedElement(*elements))
    return _space(mesh, basix.ufl.mixed_element(list(elements)))


def field_dofs(space: Any, index: int) -> npt.NDArray[np.int32]:
    """Local dofs of a scalar part of a mixed space, (cells, nodes); bridges collapse, dofmaps."""
    collapsed, parent = _jit(space.mesh.comm, lambda _: space.sub(index).collapse())
    parent = parent if _BEFORE_10 else parent[0]
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
    tag = () if _BEFORE_10 else (_TAG,)
    index_map = dolfinx.cpp.common.IndexMap(space.mesh.comm, owned, ghosts, owners, *tag)
    adjacency = dolfinx.cpp.graph.AdjacencyList_int32(np.ascontiguousarray(rows, dtype=np.int32))
    own = space._cpp_object
    dofmap = dolfinx.cpp.fem.DofMap(own.dofmap.dof_layout, index_map, 1, adjacency, 1)
    shape = (own.value_shape,) if _BEFORE_10 and not _BEFORE_8 else ()
    made = type(own)(own.mesh, own.element, dofmap, *shape)
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
    """A piecewise constant field of one value a local cell; bridged by `set_cell_field`."""
    function = dfem.Function(_space(mesh, ("DG", 0)))
    set_cell_field(function, values)
    return function


def set_cell_field(function: Any, values: npt.NDArray[np.float64]) -> None:
    """Give a piecewise constant field one value a local cell; bridges dofmaps."""
    function.x.array[_rows(function.function_space.dofmap.list, len(values))[:, 0]] = values


def cell_dofs(space: Any) -> npt.NDArray[np.int32]:
    """Local dofs of a space for every local cell, (cells, dofs); bridges dofmaps."""
    return _rows(space.dofmap.list, len(input_cells(space.mesh)))


def ghost_numbers(space: Any) -> npt.NDArray[np.int64]:
    """Global numbers of the dofs that other ranks own, (ghosts,); bridges index maps."""
    return np.asarray(space.dofmap.index_map.ghosts, dtype=np.int64)


def coordinates(mesh: Any) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]:
    """Points, (n, 3), and those of every local cell, (cells, nodes).

    Bridges the dofmap of the geometry: one for each type of cell from dolfinx 0.10 on.
    """
    geometry = mesh.geometry
    dofmap = geometry.dofmap if _BEFORE_10 else geometry.dofmaps[0]
    rows = _rows(dofmap, len(input_cells(mesh)))
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
    kinds = dfem.IntegralType
    sides = {kinds.cell: 0, kinds.exterior_facet: 1}
    compiled = _compiled(form)
    there = set(compiled.integral_types)
    if (
        not there <= set(sides)
        or compiled.needs_facet_permutations
        or any(space.element.needs_dof_transformations for space in compiled.function_spaces)
    ):
        raise NotImplementedError("only cells, boundary facets and elements that need no turning")
    found = []
    # always in this order: from dolfinx 0.9 on they are a set, ordered anew in each process
    for kind in (kind for kind in sides if kind in there):
        kernels_of, ids = _kernels(form.ufcx_form, sides[kind])
        keys = ids if _BEFORE_10 else range(len(ids))
        if len(set(keys)) < len(ids):
            raise NotImplementedError("several integrals over one subdomain")
        for own, key in zip(kernels_of, keys, strict=True):
            rows = np.asarray(compiled.domains(kind, key), dtype=np.int32)
            cells, facets = rows.T if rows.ndim == 2 else (rows, np.zeros_like(rows))
            address = ffi.cast("uintptr_t", own.tabulate_tensor_float64)
            found.append(Integral(int(address), (kind, key), cells, facets))
    return found


def _compiled(form: Any) -> Any:
    """A compiled form as C++ knows it; bridges that it is the form itself before dolfinx 0.7."""
    return getattr(form, "_cpp_object", form)


def _kernels(ufcx: Any, side: int) -> tuple[list[Any], list[int]]:
    """Integrals of one kind and their subdomains; bridges functions, later tables of all kinds."""
    if _BEFORE_8:
        count, own, ids = (
            ask(side) for ask in (ufcx.num_integrals, ufcx.integrals, ufcx.integral_ids)
        )
        return [own[i] for i in range(count)], [ids[i] for i in range(count)]
    places = range(ufcx.form_integral_offsets[side], ufcx.form_integral_offsets[side + 1])
    own, ids = ufcx.form_integrals, ufcx.form_integral_ids
    return [own[i] for i in places], [ids[i] for i in places]


def kernel_type() -> str:
    """C: the type of a compiled kernel, and what ends its arguments; bridges data of one's own."""
    data, nothing = ("", "") if _BEFORE_10 else (", void *", ", 0")
    return f"""#include <stdint.h>
typedef void tabulate(double *, const double *, const double *, const double *, const int *,
                      const uint8_t *{data});
#define NO_DATA {nothing}
"""


def coefficients(form: Any) -> tuple[npt.NDArray[np.float64], dict[Any, npt.NDArray[np.float64]]]:
    """Constants of a form now, and by integral its coefficients, (n, c); bridges their packing."""
    compiled = _compiled(form)
    return dolfinx.cpp.fem.pack_constants(compiled), dolfinx.cpp.fem.pack_coefficients(compiled)


def _jit(comm: MPI.Comm, make: Callable[[dict[str, Any]], Any]) -> Any:
    """Compile with our options; bridges the defaults, with which elements and maps are compiled."""

    def with_defaults(options: dict[str, Any]) -> Any:
        if not _BEFORE_8:
            # FFCx asks for standard C, in which gcc rounds every product before it adds it
            flags = [*options["cffi_extra_compile_args"], "-ffp-contract=fast"]
            options = options | {"cffi_extra_compile_args": flags}
        table = getattr(dolfinx.jit, f"DOLFINX_DEFAULT_JIT_{_SETTINGS.upper()}")
        table.update({name: (value, table[name][1]) for name, value in options.items()})
        return make(options)

    return kernels.compiled(comm, with_defaults)


def compile_form(mesh: Any, form: Any) -> Any:
    """Compile a UFL form; bridges jit_params, which are jit_options from dolfinx 0.6 on."""
    return _jit(mesh.comm, lambda options: dfem.form(form, **{_JIT: options}))


class PointValues:
    """A UFL expression at points (q, d) of every owned cell; bridges Expression.eval."""

    def __init__(self, mesh: Any, expression: Any, points: npt.NDArray[np.float64]) -> None:
        cells = np.arange(owned_cells(mesh), dtype=np.int32)
        self._cells, self._where = cells, (cells,) if _BEFORE_8 else (mesh, cells)
        self._points = len(points)
        # UFL ≥ 2024.2 counts variables of the process: FFCx would compile anew for each scene
        bare = ufl.algorithms.strip_variables(expression)
        self._expression = _jit(mesh.comm, lambda to: dfem.Expression(bare, points, **{_JIT: to}))

    def __call__(self) -> npt.NDArray[np.float64]:
        """Values now, (owned cells, points, components)."""
        if not len(self._cells):
            return np.zeros((0, self._points, 1))
        values = np.asarray(self._expression.eval(*self._where))
        return values.reshape(len(self._cells), self._points, -1)


def quadrature(
    cell_type: str, degree: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Points (q, d) and weights (q,) of a measure of this degree; bridges make_quadrature."""
    points, weights = basix.make_quadrature(_basix_cell(cell_type), degree)
    return np.asarray(points), np.asarray(weights)


def quadrature_points(cell_type: str, degree: int) -> npt.NDArray[np.float64]:
    """Points (q, d) of the scheme of a measure of this degree; bridged by `quadrature`."""
    return quadrature(cell_type, degree)[0]


def assemble_vector(vector: PETSc.Vec, form: Any) -> None:
    """Add a form to a vector, ghosts included, without communication; bridges its name."""
    dolfinx.fem.petsc.assemble_vector(vector, form)


def create_vector(form: Any) -> PETSc.Vec:
    """A vector with ghosts for a linear form; bridges what it is made from."""
    described = form if _BEFORE_10 else form.function_spaces[0]
    return dolfinx.fem.petsc.create_vector(described)


def assemble_scalar(form: Any) -> float:
    """This rank's part of a functional; bridges its complex type."""
    return float(dfem.assemble_scalar(form))

"""The only file that knows dolfinx versions; each function says what it bridges."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
import logging
import os
import platform
import sys
import types
from collections.abc import Callable, Iterator, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc


class _Versions(types.ModuleType):
    """Stands for pkg_resources, which ufl and ffcx load for their version alone; takes 0.3 s."""

    @staticmethod
    def get_distribution(name: str) -> Any:
        """A thing with the version of a package."""
        return types.SimpleNamespace(version=metadata.version(name))


_stands_in = "pkg_resources" not in sys.modules
if _stands_in:
    sys.modules["pkg_resources"] = _Versions("pkg_resources")
import basix  # noqa: E402
import dolfinx  # noqa: E402
import dolfinx.cpp  # noqa: E402
import dolfinx.fem as dfem  # noqa: E402
import dolfinx.fem.petsc  # noqa: E402
import dolfinx.jit  # noqa: E402
import dolfinx.mesh  # noqa: E402
import ffcx  # noqa: E402
import ufl  # noqa: E402

if _stands_in:
    del sys.modules["pkg_resources"]

from geometry.mesh.data import FACET_VERTICES, reference_nodes, vertex_positions  # noqa: E402

COMPILER_FLAGS = [
    *("-O3", "-march=native", "-g0"),
    # sums over quadrature points may be reordered, so that they vectorise; NaN stays NaN
    *("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math", "-fno-math-errno"),
    "-freciprocal-math",
]

for _name in ("FFCx", "ffcx", "UFL", "UFL_LEGACY"):
    logging.getLogger(_name).setLevel(logging.ERROR)

_BASIX_CELLS = {
    "quadrilateral": basix.CellType.quadrilateral,
    "hexahedron": basix.CellType.hexahedron,
    "tetrahedron": basix.CellType.tetrahedron,
}


def node_permutation(cell_type: str) -> npt.NDArray[np.int64]:
    """Position in `geometry.mesh` order of each node of the order-2 basix cell."""
    element = basix.create_element(
        basix.ElementFamily.P, _BASIX_CELLS[cell_type], 2, basix.LagrangeVariant.equispaced
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
    """Input number of every local cell (owned, then ghosts)."""
    return np.asarray(mesh.topology.original_cell_index, dtype=np.int64)


def input_nodes(mesh: Any) -> npt.NDArray[np.int64]:
    """Input number of every local geometry node."""
    return np.asarray(mesh.geometry.input_global_indices, dtype=np.int64)


def _rows(adjacency: Any, count: int) -> npt.NDArray[np.int32]:
    """A dofmap as an array; dolfinx before 0.8 returns an adjacency list."""
    return np.asarray(getattr(adjacency, "array", adjacency)).reshape(count, -1)


def geometry_dofmap(mesh: Any) -> npt.NDArray[np.int32]:
    """Geometry node numbers of every local cell, (cells, nodes), basix order."""
    return _rows(mesh.geometry.dofmap, len(input_cells(mesh)))


def cell_facets(mesh: Any) -> npt.NDArray[np.int32]:
    """Facet number of every local cell's local facets, (cells, facets per cell)."""
    tdim = mesh.topology.dim
    mesh.topology.create_connectivity(tdim, tdim - 1)
    mesh.topology.create_connectivity(tdim - 1, tdim)
    return _rows(mesh.topology.connectivity(tdim, tdim - 1), len(input_cells(mesh)))


def owned_cells(mesh: Any) -> int:
    """Number of cells that this rank owns."""
    return int(mesh.topology.index_map(mesh.topology.dim).size_local)


def meshtags(mesh: Any, dim: int, entities: Any, values: Any) -> Any:
    """Tags on mesh entities; wants sorted unique entities and int32 values."""
    entities = np.asarray(entities, dtype=np.int32)
    order = np.argsort(entities)
    return dolfinx.mesh.meshtags(
        mesh, dim, entities[order], np.asarray(values, dtype=np.int32)[order]
    )


def mixed_space(mesh: Any, elements: Sequence[Any]) -> Any:
    """One mixed space; a single element is wrapped too, so that block sizes are always 1."""
    return _jit(mesh.comm, lambda _: dfem.FunctionSpace(mesh, ufl.MixedElement(*elements)))


def field_dofs(space: Any, index: int) -> npt.NDArray[np.int32]:
    """Local dofs of one scalar part of a mixed space for every cell, (cells, nodes)."""
    collapsed, parent = _jit(space.mesh.comm, lambda _: space.sub(index).collapse())
    rows = _rows(collapsed.dofmap.list, len(input_cells(space.mesh)))
    return np.asarray(parent, dtype=np.int32)[rows]


def cell_field(mesh: Any, values: npt.NDArray[np.float64]) -> Any:
    """A piecewise constant coefficient from one value per local cell."""
    space = _jit(mesh.comm, lambda _: dfem.FunctionSpace(mesh, ("DG", 0)))
    function = dfem.Function(space)
    dofs = _rows(space.dofmap.list, len(input_cells(mesh)))[:, 0]
    function.x.array[dofs] = values
    return function


@functools.cache
def _processor() -> str:
    """What tells processors apart that cannot run each other's kernels."""
    with contextlib.suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return "".join(s for s in lines[:30] if s.startswith(("model name", "flags")))
    return platform.processor()


def cache_folder() -> Path:
    """Folder of compiled kernels, keyed by versions, compiler flags and processor."""
    key = "|".join([dolfinx.__version__, ffcx.__version__, ufl.__version__, np.__version__])
    digest = hashlib.sha1(f"{key}|{COMPILER_FLAGS}|{_processor()}".encode()).hexdigest()[:12]
    root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return root / "fiberbend" / digest


_holding: list[Path] = []


@contextlib.contextmanager
def compiling(comm: MPI.Comm) -> Iterator[None]:
    """Let one process group at a time compile, and clear what a killed compiler left.

    What compiles takes it by itself; around several compilations it saves time.
    """
    folder = cache_folder()
    if comm.rank != 0 or folder in _holding:
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        names = {entry.name for entry in os.scandir(folder)}
        for name in names:
            if name.endswith(".c") and f"{name}.cached" not in names:
                (folder / name).unlink()
        _holding.append(folder)
        try:
            yield
        finally:
            _holding.remove(folder)


def _jit(comm: MPI.Comm, make: Callable[[dict[str, Any]], Any]) -> Any:
    folder = cache_folder()
    options = {
        "cache_dir": str(folder),
        "cffi_extra_compile_args": COMPILER_FLAGS,
        "timeout": 3600,
    }
    # elements and coordinate maps are compiled behind the scenes, with the defaults
    for name, value in options.items():
        _, doc = dolfinx.jit.DOLFINX_DEFAULT_JIT_PARAMETERS[name]
        dolfinx.jit.DOLFINX_DEFAULT_JIT_PARAMETERS[name] = (value, doc)
    previous = logging.root.manager.disable
    logging.disable(logging.INFO)  # the C compiler's calls
    try:
        with compiling(comm):
            return make(options)
    finally:
        logging.disable(previous)


def compile_form(mesh: Any, form: Any) -> Any:
    """Compile a UFL form under the cache lock; bridges jit_params and jit_options."""
    return _jit(mesh.comm, lambda options: dfem.form(form, jit_params=options))


class PointValues:
    """A UFL expression at fixed points of every owned cell; bridges Expression.eval."""

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
        values = self._expression.eval(self._cells)
        return np.asarray(values).reshape(len(self._cells), self._points, -1)


def quadrature_points(cell_type: str, degree: int) -> npt.NDArray[np.float64]:
    """Points of the scheme that a measure of this degree uses."""
    points, _ = basix.make_quadrature(_BASIX_CELLS[cell_type], degree)
    return np.asarray(points)


def facet_quadrature(
    cell_type: str, facet: int, degree: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Points (q, d) in the cell, weights (q,) and axes (d, 2) of a scheme on a local facet."""
    vertices = reference_nodes(cell_type)[vertex_positions(cell_type)]
    corners = vertices[list(FACET_VERTICES[cell_type][facet])]
    kind = basix.CellType.triangle if len(corners) == 3 else basix.CellType.quadrilateral
    points, weights = basix.make_quadrature(kind, degree)
    axes = (corners[1:3] - corners[0]).T
    return corners[0] + np.asarray(points) @ axes.T, np.asarray(weights), axes


def tabulate_gradient(
    cell_type: str, points: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Order-2 basis and reference gradient, (points, nodes) and (points, nodes, d), own order."""
    element = basix.create_element(
        basix.ElementFamily.P, _BASIX_CELLS[cell_type], 2, basix.LagrangeVariant.equispaced
    )
    table = element.tabulate(1, points)[..., 0]
    ours = np.argsort(node_permutation(cell_type))
    return table[0][:, ours], np.moveaxis(table[1:], 0, -1)[:, ours]


def dirichlet(space: Any, dofs: npt.NDArray[np.int32]) -> Any:
    """A constraint of these local dofs, for zeroing matrix rows and columns at assembly."""
    return dfem.dirichletbc(dfem.Function(space), np.unique(dofs).astype(np.int32))


def assemble_matrix(matrix: PETSc.Mat, form: Any, constraint: Any) -> None:
    """Add a form to a zeroed matrix; constrained rows and columns get a unit diagonal."""
    constraints = [] if constraint is None else [constraint]
    dolfinx.fem.petsc.assemble_matrix(matrix, form, constraints)


def assemble_vector(vector: PETSc.Vec, form: Any) -> None:
    """Add a form's local and ghost contributions to a vector, without communication."""
    dolfinx.fem.petsc.assemble_vector(vector, form)


def create_matrix(
    form: Any, ties: tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]
) -> PETSc.Mat:
    """An empty symmetric matrix with the form's sparsity, its upper triangle only.

    Inserting a triangle takes half the time. dolfinx does not preallocate this type itself.

    Args:
        form: a bilinear form.
        ties: local dofs that follow others, and these: what is inserted for the first goes to the
            second, which is the prolongation's TᵀKT. On one rank only.
    """
    pattern = dolfinx.fem.petsc.create_matrix(form)
    assemble_matrix(pattern, form, None)
    pattern.assemble()
    starts, columns, _ = pattern.getValuesCSR()
    first, end = pattern.getOwnershipRange()
    rows = np.repeat(np.arange(end - first), np.diff(starts))
    maps = pattern.getLGMap()
    if len(ties[0]):
        target = np.arange(end, dtype=PETSc.IntType)
        target[ties[0]] = target[ties[1]]
        own = ties[0]
        pairs = np.column_stack([np.r_[target[rows], own], np.r_[target[columns], own]])
        rows, columns = np.unique(pairs, axis=0).T
        tied = PETSc.LGMap().create(target, comm=pattern.getComm())
        maps = (tied, tied)
    upper = columns >= rows + first
    here = upper & (columns < end)
    counts = [np.bincount(rows[part], minlength=end - first) for part in (here, upper & ~here)]
    matrix = PETSc.Mat().create(pattern.getComm())
    matrix.setSizes(pattern.getSizes())
    matrix.setType(PETSc.Mat.Type.SBAIJ)
    matrix.setPreallocationNNZ(tuple(count.astype(PETSc.IntType) for count in counts))
    matrix.setLGMap(*maps)
    matrix.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
    matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    pattern.destroy()
    return matrix


def create_vector(form: Any) -> PETSc.Vec:
    """A vector with ghosts for the form."""
    return dolfinx.fem.petsc.create_vector(form)


def assemble_scalar(form: Any) -> float:
    """This rank's part of a functional."""
    return float(dfem.assemble_scalar(form))


def may_free(item: PETSc.Object) -> bool:
    """Whether a PETSc object that Python drops can be destroyed at once; bridges petsc4py 3.18.

    It keeps what Python drops, for several ranks drop at different times; a process that runs case
    after case would fill up with matrices and factors.
    """
    return not PETSc.Sys.isFinalized() and item.getComm().getSize() == 1


def total(comm: MPI.Comm, mine: Any) -> Any:
    """Sum over all ranks; free on a single one, where a reduction costs as much as an assembly."""
    return mine if comm.size == 1 else comm.allreduce(mine, MPI.SUM)


def versions() -> dict[str, str]:
    """Versions of what computes."""
    major, minor, micro = PETSc.Sys.getVersion()
    return {
        "dolfinx": dolfinx.__version__,
        "petsc": f"{major}.{minor}.{micro}",
        "numpy": np.__version__,
    }

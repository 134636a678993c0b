"""Fields for ParaView: quadratic cells with nodal fields, fibers, obstacles, and their series.

Everything lies where it is at rest and has the point data displacement_mm, so that one filter,
"Warp By Vector", moves all of it.

pyvista is imported where it is used: a run without output does without it.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fiberbend import columns as col
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.obstacles import Shape
from fiberbend.states.recovery import NodalFields, SplitNodes, recover, split_nodes
from fiberbend.states.snapshot import ModelMesh, Snapshot, Target, Write
from geometry.mesh.data import Floats, Ints, MeshData, reference_nodes

SERIES = "states.pvd"

_VTK_TYPES = {
    "hexahedron": "TRIQUADRATIC_HEXAHEDRON",
    "tetrahedron": "QUADRATIC_TETRA",
    "quadrilateral": "BIQUADRATIC_QUAD",
}


@functools.cache
def vtk_order(cell_type: str) -> Ints:
    """Positions in the node list of `MeshData` of a VTK cell's nodes, in VTK's order, (k,)."""
    import pyvista as pv

    ours = np.zeros((len(reference_nodes(cell_type)), 3))
    ours[:, : reference_nodes(cell_type).shape[1]] = reference_nodes(cell_type)
    cell = pv.UnstructuredGrid({_vtk_type(cell_type): np.arange(len(ours))[None]}, ours).GetCell(0)
    theirs = np.reshape(cell.GetParametricCoords(), (-1, 3))
    gap = np.linalg.norm(theirs[:, None] - ours, axis=2)
    return np.asarray(gap.argmin(axis=1))


def body_grid(
    model_mesh: ModelMesh,
    snapshot: Snapshot,
    fields: NodalFields | None = None,
    nodes: SplitNodes | None = None,
) -> Any:
    """The body of one state as a pyvista.UnstructuredGrid in the undeformed position.

    Nodes are doubled where regions meet. Point data: displacement_mm, pressure_MPa (−p),
    cauchy_stress_MPa (xx, yy, zz, xy, yz, xz), von_mises_MPa, principal_stretch (3, descending),
    max_principal_log_strain, max_principal_nominal_strain, det_F (of a point, as the mesh resolves
    it; the volume is kept by elements). Cell data: volume_error, the volume an element has gained
    beyond what its material asks, over that at rest; material, a number whose name stands at that
    place of the field data material_names. ParaView bends the body with its filter "Warp By
    Vector".

    Args:
        model_mesh: mesh and materials.
        snapshot: the state.
        fields: its recovered fields, if at hand.
        nodes: `split_nodes` of the mesh, if at hand.
    """
    import pyvista as pv

    mesh = model_mesh.mesh
    nodes = nodes or split_nodes(mesh)
    fields = fields or recover(model_mesh, snapshot, nodes)
    cells = nodes.cells[:, vtk_order(mesh.cell_type)]
    grid = pv.UnstructuredGrid({_vtk_type(mesh.cell_type): cells}, mesh.nodes[nodes.node])
    for name, values in _point_data(snapshot, fields, nodes).items():
        grid.point_data[name] = values
    names = _region_names(mesh)
    place = np.zeros(max(mesh.regions.values()) + 1, dtype=np.int32)
    place[[mesh.regions[name] for name in names]] = np.arange(len(names))
    grid.cell_data["volume_error"] = fields.volume_error
    grid.cell_data["material"] = place[mesh.cell_region]
    grid.field_data["material_names"] = names
    for name, value in _field_data(snapshot).items():
        grid.field_data[name] = [value]
    return grid


class Series:
    """The files of the states of a run: one for each part of the body, fibers, obstacles.

    LABEL.vtm names the blocks of a state: body (with a block for each region), fibers (where they
    form lines) and obstacles. Their data are in LABEL_REGION.vtu, LABEL_fibers.vtp and
    obstacle_NAME.vtp. states.pvd is the series; its time is the number of the load step, for steps
    follow each other: a pressure may stay or fall. Pressure and angle are field data of every
    block. Numbers have single precision, apart from the places of points.

    Args:
        model_mesh: mesh, materials and fibers.
        write: writes a file, such as `RunFolder.write`.
        shapes: rigid obstacles by their names.
    """

    def __init__(
        self, model_mesh: ModelMesh, write: Write, shapes: Mapping[str, Shape] | None = None
    ) -> None:
        self._model_mesh, self._write, self._shapes = model_mesh, write, shapes or {}
        mesh = model_mesh.mesh
        self._nodes = split_nodes(mesh)
        self._parts = {name: _Part(mesh, self._nodes, name) for name in _region_names(mesh)}
        self._written: list[str] = []
        self._steps: list[tuple[float, str]] = []
        self._corners: list[Floats] = []

    def add(self, state: Snapshot, fields: NodalFields | None = None) -> None:
        """Write the files of a state; its load step comes after those of all before.

        Args:
            state: the state.
            fields: its recovered fields, if at hand.
        """
        model_mesh, nodes = self._model_mesh, self._nodes
        fields = fields or recover(model_mesh, state, nodes)
        data, entries = _point_data(state, fields, nodes), _field_data(state)
        body = {}
        for name, part in self._parts.items():
            grid = part.grid(data, fields.volume_error)
            body[name] = self._put(f"{state.label}_{name}.vtu", grid, entries)
        blocks: dict[str, dict[str, str] | str] = {"body": body}
        if model_mesh.lines is not None:
            lines = fiber_lines(
                model_mesh.mesh,
                model_mesh.lines,
                state.displacement,
                state.fiber_force,
                moved=False,
            )
            blocks["fibers"] = self._put(f"{state.label}_fibers.vtp", lines, entries)
        if self._shapes:
            blocks["obstacles"] = {name: f"obstacle_{name}.vtp" for name in self._shapes}
        index = f"{state.label}.vtm"
        self._write(index, functools.partial(write_blocks, blocks=blocks))
        self._written.append(index)
        self._steps.append((float(state.step), index))
        placed = model_mesh.mesh.nodes + state.displacement
        self._corners += [placed.min(axis=0), placed.max(axis=0)]

    def finish(self) -> list[str]:
        """Write the obstacles, as large as the body's way wants them, and the series.

        Returns:
            The names of all files.
        """
        if self._shapes and self._corners:
            bounds = np.array(self._corners)
            low, high = bounds.min(axis=0), bounds.max(axis=0)
            around = np.array(list(itertools.product(*zip(low, high, strict=True))))
            for name, shape in self._shapes.items():
                surface = shape.surface(around)
                surface.point_data["displacement_mm"] = np.zeros((surface.n_points, 3))
                self._put(f"obstacle_{name}.vtp", surface, {})
        self._write(SERIES, functools.partial(write_series, entries=self._steps))
        return [*self._written, SERIES]

    def _put(self, name: str, data: Any, entries: Mapping[str, float]) -> str:
        for key, value in entries.items():
            data.field_data[key] = [value]
        self._write(name, functools.partial(write_grid, data))
        self._written.append(name)
        return name


class _Part:
    """The cells of one region, with the copies of nodes that are its own."""

    def __init__(self, mesh: MeshData, nodes: SplitNodes, name: str) -> None:
        self.cells = np.flatnonzero(mesh.cell_region == mesh.regions[name])
        ordered = nodes.cells[self.cells][:, vtk_order(mesh.cell_type)]
        self.copies, own = np.unique(ordered, return_inverse=True)
        self._cells = {_vtk_type(mesh.cell_type): own.reshape(ordered.shape)}
        self._points = mesh.nodes[nodes.node[self.copies]]

    def grid(self, data: Mapping[str, Floats], volume_error: Floats) -> Any:
        """As a pyvista.UnstructuredGrid with the point data of the whole body."""
        import pyvista as pv

        grid = pv.UnstructuredGrid(self._cells, self._points)
        for name, values in data.items():
            grid.point_data[name] = values[self.copies]
        grid.cell_data["volume_error"] = volume_error[self.cells]
        return grid


def write_grid(data: Any, target: Target) -> None:
    """Write a pyvista grid (.vtu) or polylines (.vtp), numbers in single precision.

    Args:
        data: UnstructuredGrid or PolyData.
        target: a path, or a file open for writing bytes such as `RunFolder.write` gives.
    """
    import pyvista as pv
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

    slim = data.copy(deep=False)
    for attributes in (slim.point_data, slim.cell_data):
        for name, data_array in list(attributes.items()):
            values = np.asarray(data_array)
            if values.dtype == np.float64:
                attributes[name] = values.astype(np.float32)
    lines = isinstance(data, pv.PolyData)
    writer = vtkXMLPolyDataWriter() if lines else vtkXMLUnstructuredGridWriter()
    writer.SetInputData(slim)
    writer.SetCompressorTypeToZLib()
    writer.SetCompressionLevel(1)
    # numbers in their own element: meshio decodes all that is appended as one piece of base64, and
    # Python no longer stops where the first array is padded
    writer.SetDataModeToBinary()
    writer.WriteToOutputStringOn()
    writer.Write()
    _put(writer.GetOutputString().encode(), target)


def write_blocks(target: Target, blocks: Mapping[str, Mapping[str, str] | str]) -> None:
    """Write an index of named blocks (.vtm).

    Args:
        target: a path or an open file.
        blocks: by its name the file of each block, or those of the blocks within it.
    """
    rows = []
    for number, (name, content) in enumerate(blocks.items()):
        where = f'index="{number}" name={quoteattr(name)}'
        if isinstance(content, str):
            rows.append(f"    <DataSet {where} file={quoteattr(content)}/>")
            continue
        rows.append(f"    <Block {where}>")
        rows += [
            f'      <DataSet index="{i}" name={quoteattr(part)} file={quoteattr(file)}/>'
            for i, (part, file) in enumerate(content.items())
        ]
        rows.append("    </Block>")
    _put(_xml("vtkMultiBlockDataSet", "1.0", "vtkMultiBlockDataSet", rows), target)


def write_series(target: Target, entries: Sequence[tuple[float, str]]) -> None:
    """Write a ParaView collection (.pvd).

    Args:
        target: a path or an open file.
        entries: for each state its time and the name of its file relative to the collection.
    """
    rows = [
        f'    <DataSet timestep="{time:.9g}" part="0" file={quoteattr(name)}/>'
        for time, name in entries
    ]
    _put(_xml("Collection", "0.1", "Collection", rows), target)


def _point_data(
    snapshot: Snapshot, fields: NodalFields, nodes: SplitNodes
) -> dict[str, NDArray[Any]]:
    stress = fields.cauchy
    parts = [stress[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]
    return {
        "displacement_mm": snapshot.displacement[nodes.node],
        "pressure_MPa": -fields.multiplier,
        "cauchy_stress_MPa": np.column_stack(parts),
        "von_mises_MPa": fields.von_mises,
        "principal_stretch": fields.stretches,
        "max_principal_log_strain": fields.log_strain,
        "max_principal_nominal_strain": fields.nominal_strain,
        "det_F": fields.jacobian,
    }


def _field_data(snapshot: Snapshot) -> dict[str, float]:
    return {
        col.STEP: float(snapshot.step),
        col.PRESSURE: snapshot.pressure_kpa,
        col.ANGLE: snapshot.angle_deg,
    }


def _region_names(mesh: MeshData) -> list[str]:
    """Regions that have cells, in the order of their numbers."""
    there = set(mesh.cell_region.tolist())
    names = sorted(mesh.regions, key=mesh.regions.__getitem__)
    return [name for name in names if mesh.regions[name] in there]


def _xml(kind: str, version: str, element: str, rows: Sequence[str]) -> bytes:
    lines = [
        '<?xml version="1.0"?>',
        f'<VTKFile type="{kind}" version="{version}">',
        f"  <{element}>",
        *rows,
        f"  </{element}>",
        "</VTKFile>",
        "",
    ]
    return "\n".join(lines).encode()


def _vtk_type(cell_type: str) -> int:
    import pyvista as pv

    return int(pv.CellType[_VTK_TYPES[cell_type]])


def _put(data: bytes, target: Target) -> None:
    if isinstance(target, Path):
        target.write_bytes(data)
    else:
        target.write(data)

"""Fields for ParaView: quadratic cells with nodal fields, fibers, and the series of states.

pyvista is imported where it is used: a run without output does without it.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from fiberbend import columns as col
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.recovery import (
    NodalFields,
    SplitNodes,
    recover,
    split_nodes,
)
from fiberbend.states.snapshot import (
    ModelMesh,
    Snapshot,
    Target,
    Write,
)
from geometry.mesh.data import Ints, reference_nodes


def vtk_order(cell_type: str) -> Ints:
    """Positions in the node list of `MeshData` of a VTK cell's nodes, in VTK's order, (k,)."""
    import pyvista as pv

    cell = pv.UnstructuredGrid(
        {_vtk_type(cell_type): np.arange(len(reference_nodes(cell_type)))[None]},
        reference_nodes(cell_type),
    ).GetCell(0)
    theirs = np.reshape(cell.GetParametricCoords(), (-1, 3))
    gap = np.linalg.norm(theirs[:, None] - reference_nodes(cell_type), axis=2)
    return np.asarray(gap.argmin(axis=1))


def body_grid(
    model_mesh: ModelMesh,
    snapshot: Snapshot,
    fields: NodalFields | None = None,
    nodes: SplitNodes | None = None,
) -> Any:
    """The body of one state as a pyvista.UnstructuredGrid in the undeformed position.

    Nodes are doubled where regions meet. Point data: displacement_mm, pressure_MPa (−p),
    cauchy_stress_MPa (3×3), von_mises_MPa, principal_stretch (3, descending),
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
    grid.point_data["displacement_mm"] = snapshot.displacement[nodes.node]
    grid.point_data["pressure_MPa"] = -fields.multiplier
    grid.point_data["cauchy_stress_MPa"] = fields.cauchy.reshape(-1, 9)
    grid.point_data["von_mises_MPa"] = fields.von_mises
    grid.point_data["principal_stretch"] = fields.stretches
    grid.point_data["max_principal_log_strain"] = fields.log_strain
    grid.point_data["max_principal_nominal_strain"] = fields.nominal_strain
    grid.point_data["det_F"] = fields.jacobian
    names = sorted(mesh.regions, key=mesh.regions.__getitem__)
    place = np.zeros(max(mesh.regions.values()) + 1, dtype=np.int32)
    place[[mesh.regions[name] for name in names]] = np.arange(len(names))
    grid.cell_data["volume_error"] = fields.volume_error
    grid.cell_data["material"] = place[mesh.cell_region]
    grid.field_data["material_names"] = names
    grid.field_data[col.PRESSURE] = [snapshot.pressure_kpa]
    grid.field_data[col.ANGLE] = [snapshot.angle_deg]
    return grid


def write_grid(data: Any, target: Target) -> None:
    """Write a pyvista grid (.vtu) or polylines (.vtp).

    Args:
        data: UnstructuredGrid or PolyData.
        target: a path, or a file open for writing bytes such as `RunFolder.write` gives.
    """
    import pyvista as pv
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter, vtkXMLUnstructuredGridWriter

    lines = isinstance(data, pv.PolyData)
    writer = vtkXMLPolyDataWriter() if lines else vtkXMLUnstructuredGridWriter()
    writer.SetInputData(data)
    writer.SetCompressorTypeToZLib()
    writer.SetCompressionLevel(1)
    writer.WriteToOutputStringOn()
    writer.Write()
    _put(writer.GetOutputString().encode(), target)


def write_series(target: Target, entries: Sequence[tuple[float, Sequence[str]]]) -> None:
    """Write a ParaView collection (.pvd).

    Args:
        target: a path or an open file.
        entries: for each state its pressure in kPa, which serves as time, and the names of its
            files relative to the collection: body, then fibers.
    """
    rows = [
        f'    <DataSet timestep="{time:.9g}" part="{part}" file={quoteattr(name)}/>'
        for time, names in entries
        for part, name in enumerate(names)
    ]
    head = '<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n  <Collection>\n'
    _put((head + "\n".join(rows) + "\n  </Collection>\n</VTKFile>\n").encode(), target)


def write_fields(
    model_mesh: ModelMesh,
    snapshots: Sequence[Snapshot],
    write: Write,
    fields: Sequence[NodalFields] | None = None,
) -> list[str]:
    """Write LABEL.vtu, LABEL_fibers.vtp where fibers form lines, and the series states.pvd.

    Args:
        model_mesh: mesh, materials and fibers.
        snapshots: the states, in the order of the series.
        write: writes a file, such as `RunFolder.write`.
        fields: recovered fields of the states, if at hand.

    Returns:
        The names written.
    """
    nodes = split_nodes(model_mesh.mesh)
    entries: list[tuple[float, list[str]]] = []
    for number, state in enumerate(snapshots):
        grid = body_grid(model_mesh, state, fields[number] if fields else None, nodes)
        files = {f"{state.label}.vtu": grid}
        if model_mesh.lines is not None:
            files[f"{state.label}_fibers.vtp"] = fiber_lines(
                model_mesh.mesh, model_mesh.lines, state.displacement, state.fiber_force
            )
        for name, data in files.items():
            write(name, functools.partial(write_grid, data))
        entries.append((state.pressure_kpa, list(files)))
    write("states.pvd", functools.partial(write_series, entries=entries))
    return [*(name for _, names in entries for name in names), "states.pvd"]


def _vtk_type(cell_type: str) -> int:
    import pyvista as pv

    hexahedron = cell_type == "hexahedron"
    kind = pv.CellType.TRIQUADRATIC_HEXAHEDRON if hexahedron else pv.CellType.QUADRATIC_TETRA
    return int(kind)


def _put(data: bytes, target: Target) -> None:
    if isinstance(target, Path):
        target.write_bytes(data)
    else:
        target.write(data)

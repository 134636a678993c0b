"""Fields for ParaView: quadratic cells with nodal fields, the fibers as lines, the series.

pyvista is imported where it is used: a run without output does without it.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from fiberbend.recovery import NodalFields, SplitNodes, recover, split_nodes
from fiberbend.snapshot import Scenery, Snapshot
from geometry.embed import EmbeddedFibers
from geometry.mesh import Floats, Ints, MeshData, reference_nodes
from geometry.reference import gauss, shape_functions

_JOINT = 1e-6
"""Distance in mm within which segments of a curve touch."""

Target = Path | IO[bytes]


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
    scenery: Scenery,
    snapshot: Snapshot,
    fields: NodalFields | None = None,
    nodes: SplitNodes | None = None,
) -> Any:
    """The body of one state as a pyvista.UnstructuredGrid in the undeformed position.

    Nodes are doubled where regions meet. Point data: displacement_mm, pressure_MPa (−p),
    cauchy_stress_MPa (3×3), von_mises_MPa, principal_stretch (3, descending),
    max_principal_log_strain, max_principal_nominal_strain, det_F. Cell data: material, a number
    whose name stands at that place of the field data material_names. ParaView bends the body with
    its filter "Warp By Vector".

    Args:
        scenery: mesh and materials.
        snapshot: the state.
        fields: its recovered fields, if at hand.
        nodes: `split_nodes` of the mesh, if at hand.
    """
    import pyvista as pv

    mesh = scenery.mesh
    nodes = nodes or split_nodes(mesh)
    fields = fields or recover(scenery, snapshot, nodes)
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
    grid.cell_data["material"] = place[mesh.cell_region]
    grid.field_data["material_names"] = names
    grid.field_data["pressure_kPa"] = [snapshot.pressure_kpa]
    grid.field_data["angle_deg"] = [snapshot.angle_deg]
    return grid


def fiber_lines(
    mesh: MeshData,
    fibers: EmbeddedFibers,
    displacement: Floats | None = None,
    force: Floats | None = None,
) -> Any:
    """The fibers as a pyvista.PolyData of polylines in the deformed position.

    A polyline follows a curve along z and ends where the curve leaves the mesh. Point data:
    tension_N, the axial force of the line itself, the mean of both sides at a joint;
    fiber_tension_N, the same of a whole fiber, of which a ribbon's line is a part. Cell data:
    curve, its number.

    Args:
        mesh: the mesh.
        fibers: segments along curves, sorted by curve and z.
        displacement: by node number, (n, 3), mm; none for the undeformed position.
        force: axial force of each segment, (segments,), N.
    """
    import pyvista as pv

    points = _segment_points(mesh, fibers, mesh.nodes)
    gap = np.linalg.norm(points[1:, 0] - points[:-1, 2], axis=1)
    fresh = np.r_[True, (fibers.curve[1:] != fibers.curve[:-1]) | (gap > _JOINT)]
    if displacement is not None:
        points = _segment_points(mesh, fibers, mesh.nodes + displacement)
    last = np.r_[fresh[1:], True]
    # start and middle of every segment, and the end of the last one of a polyline
    kept = np.column_stack([np.ones_like(last), np.ones_like(last), last]).ravel()
    sizes = 2 * np.diff(np.r_[np.flatnonzero(fresh), len(fresh)]) + 1
    lines = np.insert(np.arange(kept.sum()), np.cumsum(sizes) - sizes, sizes)
    data = pv.PolyData(points.reshape(-1, 3)[kept], lines=lines)
    data.cell_data["curve"] = fibers.curve[fresh]
    if force is not None:
        for name, value in (("tension_N", force), ("fiber_tension_N", force / fibers.share)):
            start = np.where(fresh, value, (value + np.roll(value, 1)) / 2)
            data.point_data[name] = np.column_stack([start, value, value]).ravel()[kept]
    return data


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


def _segment_points(mesh: MeshData, fibers: EmbeddedFibers, nodes: Floats) -> Floats:
    """Start, middle and end of every segment, (segments, 3, 3)."""
    first = gauss(fibers.points.shape[1])[0][0]
    tangent = fibers.tangents[:, :1]
    steps = np.array([0.0, 0.5, 1.0])[:, None]
    values = shape_functions(mesh.cell_type, fibers.points[:, :1] + (steps - first) * tangent)[0]
    points: Floats = values @ nodes[mesh.cells[fibers.cell]]
    return points


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

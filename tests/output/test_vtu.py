"""Files for ParaView, read back by VTK."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv

from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.paraview import body_grid, write_blocks, write_grid, write_series
from geometry.checks import region_volumes
from geometry.mesh.reference import cell_rule
from tests.output.bending import SHORT, bent, model_mesh, snapshot

ELEMENTS = {"hexahedron": 29, "tetrahedron": 24}


def vtk_volumes(grid: Any, element: str) -> np.ndarray:
    """Volume of every cell by VTK's own shape functions, (cells,); every Jacobian is checked."""
    points, weights = cell_rule(element)
    volumes = np.zeros(grid.n_cells)
    for number in range(grid.n_cells):
        cell = grid.GetCell(number)
        count = cell.GetNumberOfPoints()
        nodes = np.array([cell.GetPoints().GetPoint(i) for i in range(count)])
        for point, weight in zip(points, weights, strict=True):
            slopes = [0.0] * (3 * count)
            cell.InterpolateDerivs(point, slopes)
            jacobian = np.linalg.det(np.reshape(slopes, (3, count)) @ nodes)
            assert jacobian > 0
            volumes[number] += weight * jacobian
    return volumes


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("to_path", [True, False])
def test_vtk_sees_the_same_body(element: str, to_path: bool, tmp_path: Path) -> None:
    # a wrong order of nodes would turn cells inside out or lose their curved shape
    scene = model_mesh(element=element)
    target = tmp_path / "part.tmp"
    grid = body_grid(scene, snapshot(scene, 45.0))
    if to_path:
        write_grid(grid, target)
    else:
        with target.open("wb") as file:
            write_grid(grid, file)
    target = target.rename(tmp_path / "body.vtu")
    read = pv.read(target)
    assert set(read.celltypes) == {ELEMENTS[element]}
    assert read.n_cells == len(scene.mesh.cells)
    volumes = vtk_volumes(read, element)
    names = list(read.field_data["material_names"])
    for name, volume in region_volumes(scene.mesh).items():
        here = read.cell_data["material"] == names.index(name)
        assert volumes[here].sum() == pytest.approx(volume, rel=1e-6)


def test_fields_of_the_file(tmp_path: Path) -> None:
    scene = model_mesh()
    state = dataclasses.replace(
        snapshot(scene, 45.0), multiplier=np.full(scene.mesh.cells.shape, -0.25)
    )
    grid = body_grid(scene, state)
    write_grid(grid, tmp_path / "body.vtu")
    # the file is in single precision, what is written stays as it is
    assert grid.point_data["displacement_mm"].dtype == np.float64
    read = pv.read(tmp_path / "body.vtu")
    warped = read.points + read.point_data["displacement_mm"]
    assert warped == pytest.approx(bent(read.points, SHORT.length, np.pi / 4), abs=1e-4)
    assert read.point_data["pressure_MPa"] == pytest.approx(0.25)
    shapes = {name: read.point_data[name].shape[1:] for name in read.point_data}
    assert shapes == {
        "displacement_mm": (3,),
        "pressure_MPa": (),
        "cauchy_stress_MPa": (6,),
        "von_mises_MPa": (),
        "principal_stretch": (3,),
        "max_principal_log_strain": (),
        "max_principal_nominal_strain": (),
        "det_F": (),
    }
    assert read.cell_data.keys() == ["volume_error", "material"]
    # pure bending about the floor: the wall above it is longer than at rest, by its height
    heights = read.cell_centers().points[:, 1]
    inside = np.ptp(read.points[read.cells.reshape(read.n_cells, -1)[:, 1:], 2], axis=1) < 4.1
    inside &= (read.cell_centers().points[:, 2] > 0) & (read.cell_centers().points[:, 2] < 24)
    stretch = np.pi / 4 / SHORT.length * (heights - 1)
    assert read.cell_data["volume_error"][inside] == pytest.approx(stretch[inside], abs=0.01)
    assert read.field_data["angle_deg"] == pytest.approx(45.0)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("half", [True, False])
def test_fibers_lie_on_the_bent_outline(element: str, half: bool, tmp_path: Path) -> None:
    scene = model_mesh(axial=2.0, half=half, element=element)
    assert scene.fibers is not None
    state = snapshot(scene, 60.0)
    lines = fiber_lines(scene.mesh, scene.fibers, state.displacement, state.fiber_force)
    write_grid(lines, tmp_path / "fibers.vtp")
    read = pv.read(tmp_path / "fibers.vtp")
    theta = np.radians(60.0)
    x, y, z = read.points.T.astype(float)
    # back to the straight body: the centre of the circle lies below the axis y = 1
    center, radius = 1 - SHORT.length / theta, SHORT.length / theta
    height = np.hypot(y - center, z) - radius + 1
    along = np.arctan2(z, y - center) * radius
    assert along.min() == pytest.approx(0, abs=0.02)
    assert along.max() == pytest.approx(SHORT.length, abs=0.02)
    r, top = SHORT.outline_half_width, SHORT.profile.bottom
    arc = np.abs(np.hypot(x, height - top) - r) + 10 * (height < top - 0.01)
    flat = np.minimum(np.abs(height), np.abs(np.abs(x) - r)) + 10 * (height > top + 0.01)
    assert np.minimum(arc, flat).max() < 0.02


def test_polylines_follow_the_curves() -> None:
    # a full body has one unbroken line per curve, and lines lose none of the fibers' length
    scene = model_mesh(half=False)
    assert scene.fibers is not None
    lines = fiber_lines(scene.mesh, scene.fibers, force=np.arange(len(scene.fibers.cell)) + 1.0)
    assert lines.n_lines == 10
    assert sorted(lines.cell_data["curve"]) == list(range(10))
    length = lines.compute_cell_sizes(area=False, volume=False)["Length"].sum()
    assert length == pytest.approx(scene.fibers.length.sum(), rel=2e-3)
    forces = lines.point_data["tension_N"]
    assert (forces.min(), forces.max()) == (1.0, len(scene.fibers.cell))
    assert lines.point_data["fiber_tension_N"] == pytest.approx(5 * forces)


def test_half_body_breaks_its_lines_at_the_mirror() -> None:
    scene = model_mesh()
    assert scene.fibers is not None
    lines = fiber_lines(scene.mesh, scene.fibers)
    ends = np.concatenate([cell.points[[0, -1]] for cell in lines.cell])
    inside = (ends[:, 2] > 0.01) & (ends[:, 2] < SHORT.length - 0.01)
    assert inside.sum() > 10
    assert ends[inside, 0] == pytest.approx(0.0, abs=1e-6)


def test_names_in_indices_are_quoted(tmp_path: Path) -> None:
    write_series(tmp_path / "a.pvd", [(1.0, "a & b.vtm")])
    row = next(ElementTree.parse(tmp_path / "a.pvd").iter("DataSet"))
    assert row.attrib["file"] == "a & b.vtm"
    write_blocks(tmp_path / "a.vtm", {"x < y": "a & b.vtu"})
    row = next(ElementTree.parse(tmp_path / "a.vtm").iter("DataSet"))
    assert (row.attrib["name"], row.attrib["file"]) == ("x < y", "a & b.vtu")

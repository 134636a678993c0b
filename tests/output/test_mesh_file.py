"""Meshes for other programs, read back by meshio, VTK and gmsh."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import pyvista as pv

from fiberbend.cli import main
from fiberbend.reader.reader import parse_case, read_case
from fiberbend.results.mesh_file import write_mesh_file
from fiberbend.schema.problems import CaseError
from fiberbend.states.mesh_file import facet_order, write_mesh
from fiberbend.states.snapshot import ModelMesh
from geometry.checks import region_volumes, surface_area
from geometry.mesh.data import facet_positions
from geometry.mesh.reference import area_vectors, cell_rule
from tests.output import uniform
from tests.output.bending import model_mesh
from tests.run.conftest import small

ROOT = Path(__file__).resolve().parents[2]
SCENES: dict[str, Callable[[], ModelMesh]] = {
    "section": uniform.section,
    "cell": uniform.cell,
    "half hexahedra": lambda: model_mesh(half=True),
    "hexahedra": lambda: model_mesh(half=False),
    "tetrahedra": lambda: model_mesh(element="tetrahedron"),
}
EACH = pytest.mark.parametrize("scene", SCENES.values(), ids=list(SCENES))

SHAPES = {
    "hexahedron27": (29, "hexahedron"),
    "hexahedron20": (25, "hexahedron"),
    "tetra10": (24, "tetrahedron"),
    "quad9": (28, "quadrilateral"),
    "quad8": (23, "quadrilateral"),
    "triangle6": (22, "triangle"),
    "line3": (21, "line"),
    "line": (3, "line"),
}
"""VTK's number of a cell of meshio, and its shape."""


def rule(shape: str) -> tuple[Any, Any]:
    if shape == "triangle":
        # degree 2
        points = np.array([[1, 1], [4, 1], [1, 4]]) / 6
        return points, np.full(3, 1 / 6)
    if shape == "line":
        points, weights = cell_rule("quadrilateral")
        return points[:3, 1:], weights[:3] / weights[:3].sum()
    return cell_rule(shape)


def sizes(points: Any, kind: str, cells: Any) -> Any:
    """Volume, area or length of every cell by VTK's shape functions; of solids no negative one."""
    number, shape = SHAPES[kind]
    space = np.zeros((len(points), 3))
    space[:, : points.shape[1]] = points
    rows = np.insert(cells, 0, cells.shape[1], axis=1).ravel()
    grid = pv.UnstructuredGrid(rows, np.full(len(cells), number), space)
    at, weights = rule(shape)
    found = np.zeros(len(cells))
    for i in range(len(cells)):
        cell = grid.GetCell(i)
        for point, weight in zip(at, weights, strict=True):
            dimension, count = len(point), cells.shape[1]
            slopes = [0.0] * (dimension * count)
            cell.InterpolateDerivs((*point, 0.0, 0.0)[:3], slopes)
            tangents = np.reshape(slopes, (dimension, count)) @ space[cells[i]]
            if dimension == 3:
                assert np.linalg.det(tangents) > 0
            found[i] += weight * np.sqrt(np.linalg.det(tangents @ tangents.T))
    return found


def normals(points: Any, kind: str, cells: Any) -> Any:
    """Sum of the area vectors of facets by their corners; exact where they are flat."""
    nodes = np.zeros((*cells.shape, 3))
    nodes[..., : points.shape[1]] = points[cells]
    if kind == "line3":
        along = nodes[:, 1] - nodes[:, 0]
        return np.column_stack([along[:, 1], -along[:, 0]])
    if kind == "triangle6":
        return np.cross(nodes[:, 1] - nodes[:, 0], nodes[:, 2] - nodes[:, 0]) / 2
    return np.cross(nodes[:, 2] - nodes[:, 0], nodes[:, 3] - nodes[:, 1]) / 2


def fiber_length(scene: ModelMesh) -> float:
    return 0.0 if scene.lines is None else float(scene.lines.length.sum())


@EACH
def test_gmsh_file(scene: Callable[[], ModelMesh], tmp_path: Path) -> None:
    made, path = scene(), tmp_path / "body.msh"
    assert write_mesh(made, path) == []
    read = meshio.read(path)
    mesh, dimension = made.mesh, made.mesh.nodes.shape[1]
    found: dict[str, float] = {}
    outward: dict[str, Any] = {}
    for name, (tag, _) in read.field_data.items():
        for block, tags in zip(read.cells, read.cell_data["gmsh:physical"], strict=True):
            cells = block.data[tags == tag]
            if not len(cells) or block.type == "vertex":
                continue
            total = sizes(read.points, block.type, cells).sum()
            found[name] = found.get(name, 0.0) + total
            if name in mesh.facets:
                outward[name] = normals(read.points, block.type, cells).sum(axis=0)
    length = fiber_length(made)
    expected = region_volumes(mesh)
    expected |= {name: surface_area(mesh, name) for name, p in mesh.facets.items() if len(p)}
    assert {k: v for k, v in found.items() if k != "fibers"} == pytest.approx(expected, rel=1e-4)
    assert found.get("fibers", 0.0) == pytest.approx(length, rel=2e-3)
    for name, vector in outward.items():
        exact = area_vectors(mesh, name)[1].reshape(-1, dimension).sum(axis=0)
        # corners only: a curved surface is a little smaller
        assert vector[:dimension] == pytest.approx(exact, abs=0.02 * surface_area(mesh, name))
    for name, number in mesh.points.items():
        tag = read.field_data[name][0]
        pairs = zip(read.cells, read.cell_data["gmsh:physical"], strict=True)
        (node,) = np.concatenate(
            [block.data[tags == tag].ravel() for block, tags in pairs if block.type == "vertex"]
        )
        assert read.points[node][:dimension] == pytest.approx(mesh.nodes[number])


GMSH = """
import json, sys
import gmsh
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.open(sys.argv[1])
sizes = {}
for dim, tag in gmsh.model.getPhysicalGroups():
    name, total, least = gmsh.model.getPhysicalName(dim, tag), 0.0, 1.0
    for entity in gmsh.model.getEntitiesForPhysicalGroup(dim, tag):
        for kind in gmsh.model.mesh.getElementTypes(dim, entity):
            local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss6")
            _, det, _ = gmsh.model.mesh.getJacobians(kind, local, entity)
            det = np.reshape(det, (-1, len(weights)))
            total += (det @ weights).sum()
            least = min(least, det.min())
    sizes[name] = [dim, total, least]
print(json.dumps(sizes))
"""


@EACH
def test_gmsh_reads_its_file(scene: Callable[[], ModelMesh], tmp_path: Path) -> None:
    import json

    made, path = scene(), tmp_path / "body.msh"
    write_mesh(made, path)
    command = [sys.executable, "-c", GMSH, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    found = json.loads(done.stdout.splitlines()[-1])
    mesh, dimension = made.mesh, made.mesh.nodes.shape[1]
    for name, volume in region_volumes(mesh).items():
        assert found[name][:2] == pytest.approx([dimension, volume])
        assert found[name][2] > 0
    for name, pairs in mesh.facets.items():
        if len(pairs):
            area = surface_area(mesh, name)
            assert found[name][:2] == pytest.approx([dimension - 1, area], rel=1e-4)
    if made.lines is not None:
        assert found["fibers"][:2] == pytest.approx([1, fiber_length(made)], rel=2e-3)


@EACH
def test_vtk_file(scene: Callable[[], ModelMesh], tmp_path: Path) -> None:
    made, path = scene(), tmp_path / "body.vtu"
    assert write_mesh(made, path) == []
    read, mesh = meshio.read(path), made.mesh
    found = dict.fromkeys(read.cell_data, 0.0)
    for number, block in enumerate(read.cells):
        size = sizes(read.points, block.type, block.data)
        for name in found:
            mask = read.cell_data[name][number]
            found[name] += size[mask == 1].sum() if name != "curve" else 0.0
    expected = region_volumes(mesh)
    expected |= {name: surface_area(mesh, name) for name, p in mesh.facets.items() if len(p)}
    if made.lines is not None:
        assert found.pop("curve") == 0.0
        assert found.pop("fibers") == pytest.approx(fiber_length(made), rel=2e-3)
        curves = pv.read(path).cell_data["curve"]
        assert {*curves[curves >= 0].tolist()} == {*made.lines.curve.tolist()}
    assert found == pytest.approx(expected, rel=1e-4)
    for name, node in mesh.points.items():
        (there,) = np.flatnonzero(read.point_data[name])
        assert there == node
    # VTK sees the same cells
    assert pv.read(path).n_cells == sum(len(block.data) for block in read.cells)


def abaqus_surfaces(path: Path) -> dict[str, list[tuple[int, int]]]:
    """Elements and faces of the surfaces of an input file."""
    surfaces: dict[str, list[tuple[int, int]]] = {}
    name = ""
    for line in path.read_text().splitlines():
        if line.startswith("*"):
            name = line.split("NAME=")[1].split(",")[0] if line.startswith("*SURFACE") else ""
        elif name:
            element, face = line.split(", S")
            surfaces.setdefault(name, []).append((int(element), int(face)))
    return surfaces


FACES = {
    "hexahedron20": (
        ((1, 2, 3, 4), (9, 10, 11, 12)),
        ((5, 8, 7, 6), (16, 15, 14, 13)),
        ((1, 5, 6, 2), (17, 13, 18, 9)),
        ((2, 6, 7, 3), (18, 14, 19, 10)),
        ((3, 7, 8, 4), (19, 15, 20, 11)),
        ((4, 8, 5, 1), (20, 16, 17, 12)),
    ),
    "tetra10": (
        ((1, 2, 3), (5, 6, 7)),
        ((1, 4, 2), (8, 9, 5)),
        ((2, 4, 3), (9, 10, 6)),
        ((3, 4, 1), (10, 8, 7)),
    ),
    "quad8": (((1, 2), (5,)), ((2, 3), (6,)), ((3, 4), (7,)), ((4, 1), (8,))),
}
"""Corners and middles of the faces S1, S2, … in Abaqus' numbering of a C3D20, C3D10 and CPE8."""
FACE_KIND = {"hexahedron20": "quad8", "tetra10": "triangle6", "quad8": "line3"}


@EACH
def test_abaqus_file(scene: Callable[[], ModelMesh], tmp_path: Path) -> None:
    made, path = scene(), tmp_path / "body.inp"
    remarks = write_mesh(made, path)
    # meshio has no plane strain of eight nodes: a shell has the same nodes
    known = tmp_path / "known.inp"
    known.write_text(path.read_text().replace("TYPE=CPE8", "TYPE=S8R"))
    read, mesh = meshio.read(known), made.mesh
    solids = [block for block in read.cells if block.type != "line"]
    kind = solids[0].type
    expected = region_volumes(mesh)
    found = [sizes(read.points, block.type, block.data).sum() for block in solids]
    assert found == pytest.approx(list(expected.values()), rel=1e-4)
    for number, name in enumerate(expected):
        assert len(read.cell_sets[name][number]) == len(solids[number].data)
    cells = np.concatenate([block.data for block in solids])
    surfaces = abaqus_surfaces(path)
    assert surfaces.keys() == {name for name, pairs in mesh.facets.items() if len(pairs)}
    for name, faces in surfaces.items():
        rows = []
        for element, face in faces:
            corners, middles = FACES[kind][face - 1]
            rows.append(cells[element - 1][np.array([*corners, *middles]) - 1])
        area = sizes(read.points, FACE_KIND[kind], np.array(rows)).sum()
        assert area == pytest.approx(surface_area(mesh, name), rel=1e-4)
        assert {*np.ravel(rows).tolist()} == {*read.point_sets[name].tolist()}
    text = " ".join(remarks)
    assert ("left out" in text) == (kind != "tetra10")
    if made.lines is None:
        assert "T3D2" not in text
    else:
        trusses = next(block for block in read.cells if block.type == "line")
        length = sizes(read.points, "line", trusses.data).sum()
        # straight pieces of a helix
        assert length == pytest.approx(fiber_length(made), rel=5e-3)
        assert "T3D2" in text
    assert all(len(line.rstrip(",").split(",")) <= 16 for line in path.read_text().splitlines())


@pytest.mark.parametrize("cell_type", ["quadrilateral", "hexahedron", "tetrahedron"])
def test_facets_have_all_their_nodes(cell_type: str) -> None:
    for ordered, positions in zip(facet_order(cell_type), facet_positions(cell_type), strict=True):
        assert sorted(ordered.tolist()) == positions.tolist()


def test_ribbons_and_curves_of_the_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "slice.msh"
    arguments = ["mesh", str(ROOT / "cases" / "cell.yaml"), "--out", str(path)]
    assert main(arguments) == 0
    out = capsys.readouterr().out
    assert "hexahedra" in out
    assert "lengths in mm" in out
    assert "regions: wall, floor, sheath" in out
    assert "x ≥ 0 only" in out
    assert "fibers: 9 curves" in out
    assert [entry.name for entry in tmp_path.iterdir()] == ["slice.msh"]
    before = path.read_bytes()
    path.write_text("mine")
    assert main(arguments) == 1
    assert "exists, expected a new file, or --overwrite" in capsys.readouterr().err
    assert path.read_text() == "mine"
    assert main([*arguments, "--overwrite"]) == 0
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("body.stl", "body.stl has the ending '.stl', expected .msh, .vtu or .inp"),
        ("body", "body has no ending, expected .msh, .vtu or .inp"),
        ("nowhere/body.msh", "no such folder"),
    ],
)
def test_what_cannot_be_written_is_refused(
    name: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = str(ROOT / "cases" / "section.yaml")
    assert main(["mesh", case, "--out", str(tmp_path / name)]) == 1
    assert text in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_closed_form_has_no_mesh(tmp_path: Path) -> None:
    case = parse_case(small(model="analytic", mesh={}, output={"pictures": False}))
    with pytest.raises(CaseError, match="analytic has no elements, expected section, cell or body"):
        write_mesh_file(case, tmp_path / "body.msh")


def test_a_body_as_gmsh_meshes_it(tmp_path: Path) -> None:
    case = parse_case(small(mesh={"axial": "4 mm", "symmetry": "full"}))
    lines = write_mesh_file(case, tmp_path / "body.vtu")
    assert not any("half" in line for line in lines)
    read = pv.read(tmp_path / "body.vtu")
    assert read.cell_data["winding"].any()
    assert read.cell_data["clamp"].any()
    assert read.cell_data["fibers"].any()
    lowest, highest = read.bounds[4:]
    assert (lowest, highest) == pytest.approx((-6.0, 30.0))


def test_a_smeared_winding_is_said_to_have_no_curves(tmp_path: Path) -> None:
    lines = write_mesh_file(read_case(ROOT / "cases" / "section.yaml"), tmp_path / "a.inp")
    assert "fibers: none, the winding is spread over the surface 'winding'" in lines
    assert any("CPE8H in place of CPE8; CalculiX has none" in line for line in lines)
    assert lines[-1].endswith("a bulk modulus, and CPE8R")

"""The series of states for ParaView: blocks that agree, read back by VTK and by meshio."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import pyvista as pv

from analytic.path import tip
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.obstacles import Box, Sheet
from fiberbend.states.paraview import Series, vtk_order
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.checks import region_volumes
from geometry.mesh.data import MeshData
from geometry.mesh.reference import cell_rule, jacobians
from tests.output.bending import SHORT, bent, model_mesh, snapshot

BOTH_ELEMENTS = pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])
MESHIO = {"hexahedron": "hexahedron27", "tetrahedron": "tetra10"}


def written(
    folder: Path, scene: ModelMesh, states: list[Snapshot], shapes: dict[str, Any] | None = None
) -> list[str]:
    """Names of the files of a series in a folder."""

    def write(name: str, fill: Any) -> None:
        with (folder / name).open("wb") as file:
            fill(file)

    series = Series(scene, write, shapes)
    for state in states:
        series.add(state)
    names = series.finish()
    assert sorted(names) == sorted(path.name for path in folder.iterdir())
    return names


def at_time(folder: Path, time: float) -> Any:
    """The blocks of a state, as VTK reads them."""
    reader = pv.get_reader(str(folder / "states.pvd"))
    reader.set_active_time_value(time)
    return reader.read()[0]


def test_blocks_are_named_and_time_is_the_step(tmp_path: Path) -> None:
    scene = model_mesh()
    # a load after a pressure that is kept, and a pressure that falls
    states = [snapshot(scene, angle) for angle in (0.0, 30.0, 60.0, 90.0)]
    states[2] = dataclasses.replace(states[2], pressure_kpa=states[1].pressure_kpa)
    states[3] = dataclasses.replace(states[3], pressure_kpa=1.0)
    block = Box((-4.0, -20.0, 10.0), (4.0, -12.0, 20.0))
    names = written(tmp_path, scene, states, {"post": block})
    assert set(names) == {
        *(f"{s.label}_{part}.vtu" for s in states for part in ("wall", "floor", "sheath")),
        *(f"{s.label}_fibers.vtp" for s in states),
        *(f"{s.label}.vtm" for s in states),
        *("obstacle_post.vtp", "states.pvd"),
    }
    reader = pv.get_reader(str(tmp_path / "states.pvd"))
    assert reader.time_values == [0.0, 1.0, 2.0, 3.0]
    for state in states:
        blocks = at_time(tmp_path, float(state.step))
        assert blocks.keys() == ["body", "fibers", "obstacles"]
        assert blocks["body"].keys() == ["wall", "floor", "sheath"]
        for part in (*blocks["body"], blocks["fibers"]):
            known = {name: float(part.field_data[name][0]) for name in part.field_data}
            assert known == {
                "step": state.step,
                "pressure_kPa": state.pressure_kpa,
                "angle_deg": state.angle_deg,
            }
        post = blocks["obstacles"]["post"]
        assert post.bounds == pytest.approx((-4, 4, -20, -12, 10, 20))
        assert not post.point_data["displacement_mm"].any()


def test_a_sheet_reaches_under_all_states(tmp_path: Path) -> None:
    scene = model_mesh()
    states = [snapshot(scene, angle) for angle in (30.0, 90.0)]
    written(tmp_path, scene, states, {"table": Sheet((0.0, -40.0, 0.0), (0.0, 1.0, 0.0))})
    bounds = np.reshape(pv.read(tmp_path / "obstacle_table.vtp").bounds, (3, 2))
    for state in states:
        placed = scene.mesh.nodes + state.displacement
        assert (bounds[[0, 2], 0] < placed.min(axis=0)[[0, 2]]).all()
        assert (bounds[[0, 2], 1] > placed.max(axis=0)[[0, 2]]).all()


@BOTH_ELEMENTS
@pytest.mark.parametrize("half", [True, False])
def test_one_filter_moves_body_and_fibers(element: str, half: bool, tmp_path: Path) -> None:
    scene = model_mesh(axial=2.0, half=half, element=element)
    assert scene.fibers is not None
    state = snapshot(scene, 60.0)
    written(tmp_path, scene, [state])
    blocks = at_time(tmp_path, 2.0)
    body, fibers = blocks["body"].combine(), blocks["fibers"]
    # both at rest
    assert body.bounds == pytest.approx(pv.PolyData(scene.mesh.nodes).bounds, abs=1e-5)
    rest = fiber_lines(scene.mesh, scene.fibers)
    assert fibers.points == pytest.approx(rest.points, abs=1e-5)
    # where they go
    warped = fibers.warp_by_vector("displacement_mm")
    there = fiber_lines(scene.mesh, scene.fibers, state.displacement, state.fiber_force)
    assert warped.points == pytest.approx(there.points, abs=2e-5)
    assert fibers.point_data["tension_N"] == pytest.approx(there.point_data["tension_N"], rel=1e-6)
    # and the displacement is that of the body there, by VTK's own shape functions: it looks for
    # the place in a cell of 2 mm to a part of a thousand
    inside = pv.PolyData(np.array(fibers.points)).sample(body, tolerance=1e-3)
    found = inside["vtkValidPointMask"] == 1
    assert found.mean() > 0.95
    gap = inside["displacement_mm"][found] - fibers.point_data["displacement_mm"][found]
    assert np.abs(gap).max() < 3e-3
    assert np.abs(fibers.point_data["displacement_mm"]).max() > 5.0


@BOTH_ELEMENTS
def test_meshio_reads_every_grid(element: str, tmp_path: Path) -> None:
    scene = model_mesh(element=element)
    state = snapshot(scene, 45.0)
    written(tmp_path, scene, [state])
    inverse = np.argsort(vtk_order(element))
    for name, volume in region_volumes(scene.mesh).items():
        path = tmp_path / f"45deg_{name}.vtu"
        # which it reads only where Python's base64 is lenient
        assert b"AppendedData" not in path.read_bytes()
        read = meshio.read(path)
        assert [block.type for block in read.cells] == [MESHIO[element]]
        mesh = MeshData(
            element, read.points, read.cells[0].data[:, inverse], {}, np.zeros(1, int), {}
        )
        points, weights = cell_rule(element)
        sizes = np.linalg.det(jacobians(mesh, np.arange(len(mesh.cells)), points)[1])
        assert sizes.min() > 0
        assert (sizes @ weights).sum() == pytest.approx(volume, rel=1e-6)
        warped = read.points + read.point_data["displacement_mm"]
        assert warped == pytest.approx(bent(read.points, SHORT.length, np.pi / 4), abs=1e-4)
        assert read.point_data["cauchy_stress_MPa"].shape == (len(read.points), 6)
        assert read.field_data["pressure_kPa"] == pytest.approx([22.5])


def test_smeared_fibers_are_no_lines(tmp_path: Path) -> None:
    scene = dataclasses.replace(model_mesh(), smeared=True)
    written(tmp_path, scene, [snapshot(scene, 30.0)])
    assert at_time(tmp_path, 1.0).keys() == ["body"]


def test_single_precision_is_enough(tmp_path: Path) -> None:
    # of the displacement of a body of 175 mm less than a ten-thousandth of a millimetre is lost
    scene = model_mesh()
    state = snapshot(scene, 90.0)
    large = dataclasses.replace(state, displacement=5 * state.displacement)
    written(tmp_path, scene, [large])
    wall = at_time(tmp_path, 3.0)["body"]["wall"]
    assert wall["displacement_mm"].dtype == np.float32
    assert wall.points.dtype == np.float64
    placed = wall.points + wall["displacement_mm"]
    exact = 5 * (bent(wall.points, SHORT.length, np.pi / 2) - wall.points) + wall.points
    assert placed == pytest.approx(exact, abs=1e-4)


def test_the_analytic_tip_is_where_the_warped_section_ends(tmp_path: Path) -> None:
    from fiberbend.results.fields import write_fields
    from fiberbend.results.folder import RunFolder
    from tests.output.test_uniform_pictures import case_of
    from tests.output.uniform import section, state

    scene = section()
    write_fields(RunFolder(tmp_path), case_of("section"), scene, [state(scene)], [], print)
    reader = pv.get_reader(str(tmp_path / "fields" / "states.pvd"))
    assert reader.time_values == [0.0, 1.0]
    rest, body = (at_time(tmp_path / "fields", time)["body"].combine() for time in (0.0, 1.0))
    assert rest["displacement_mm"] == pytest.approx(0.0, abs=1e-12)
    assert rest["von_mises_MPa"] == pytest.approx(0.0, abs=1e-12)
    placed = body.points + body["displacement_mm"]
    pin = np.flatnonzero(np.linalg.norm(body.points - [0.0, 0.0, SHORT.length], axis=1) < 1e-5)
    z, down = tip(np.pi / 2, SHORT.length)
    assert len(pin)
    assert placed[pin] == pytest.approx(np.tile([0.0, -down, z], (len(pin), 1)), abs=1e-4)

"""Half a body with its mirror image, held to the whole body."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista as pv

from fiberbend.results.fields import WHOLE_ANYWAY, write_fields
from fiberbend.results.folder import RunFolder
from fiberbend.results.space import Space
from fiberbend.states.fiber_lines import fiber_lines
from fiberbend.states.halves import Halves
from fiberbend.states.recovery import recover, split_nodes
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.checks import region_volumes
from geometry.mesh.data import Floats
from geometry.mesh.mirror import both_halves
from geometry.mesh.reference import area_vectors
from tests.output import uniform
from tests.output.bending import model_mesh, snapshot
from tests.output.test_uniform_pictures import case_of
from tests.output.test_vtu import vtk_volumes

BOTH_ELEMENTS = pytest.mark.parametrize("element", ["hexahedron", "tetrahedron"])


def sheared(nodes: Floats) -> Floats:
    """A displacement with every component of strain, u odd in x, v and w even."""
    x, y, z = nodes.T / 100
    return np.column_stack(
        [2 * x * y + x * z, 3 * x**2 - y * z + 0.5 * z**2, 4 * x**2 * z + y * z + z**2]
    )


def state_of(scene: ModelMesh) -> Snapshot:
    """A state with that displacement, pressures even in x and fiber forces."""
    base = snapshot(scene, 30.0)
    corners = scene.mesh.nodes[scene.mesh.cells]
    multiplier = -0.01 * (corners[..., 1] + np.abs(corners[..., 0]) + 0.1 * corners[..., 2])
    return dataclasses.replace(base, displacement=sheared(scene.mesh.nodes), multiplier=multiplier)


def keyed(places: Floats, region: Any) -> dict[tuple[Any, ...], int]:
    """Numbers of points by place and region."""
    rows = np.round(places, 4) + 0.0
    return {
        (*row, name): i for i, (row, name) in enumerate(zip(rows.tolist(), region, strict=True))
    }


def copies_of(scene: ModelMesh) -> tuple[Floats, Any]:
    """Places of the copies of nodes, and their regions."""
    nodes = split_nodes(scene.mesh)
    region = np.empty(len(nodes.node), dtype=int)
    region[nodes.cells] = scene.mesh.cell_region[:, None]
    return scene.mesh.nodes[nodes.node], region.tolist()


def test_fields_are_those_of_the_whole_body() -> None:
    """Of a body that is solved whole in the same state: every number at every node."""
    half, full = model_mesh(half=True), model_mesh(half=False)
    halves, own = Halves(half), state_of(half)
    whole = halves.model_mesh
    moved = halves.snapshot(own)
    assert moved.displacement == pytest.approx(sheared(whole.mesh.nodes), abs=1e-12)
    ours, theirs = halves.fields(recover(half, own)), recover(full, state_of(full))
    again = recover(whole, moved)
    places, regions = copies_of(whole)
    there = keyed(*copies_of(full))
    other = np.array([there[key] for key in keyed(places, regions)])
    assert len(set(other.tolist())) == len(other) == len(theirs.jacobian)
    # shear that would be lost or keep its sign is there to be seen
    assert np.abs(theirs.cauchy[:, 0, 1:]).max() > 0.05 * np.abs(theirs.cauchy).max()
    for field in ("jacobian", "stretches", "cauchy", "multiplier"):
        values, exact = getattr(ours, field), getattr(theirs, field)[other]
        assert values == pytest.approx(exact, abs=1e-9 * np.abs(exact).max()), field
        assert values == pytest.approx(getattr(again, field), abs=1e-9 * np.abs(exact).max())
    assert np.sort(ours.volume_error) == pytest.approx(np.sort(theirs.volume_error), abs=1e-12)


@BOTH_ELEMENTS
def test_the_mesh_is_twice_as_large_and_right_side_out(element: str) -> None:
    half = model_mesh(element=element).mesh
    whole = both_halves(half)
    volumes = region_volumes(whole.mesh)
    assert volumes == pytest.approx({k: 2 * v for k, v in region_volumes(half).items()})
    assert "symmetry" not in whole.mesh.facets
    assert len(np.unique(whole.mesh.nodes.round(6), axis=0)) == len(whole.mesh.nodes)
    for name in whole.mesh.facets:
        before, after = (area_vectors(mesh, name)[1] for mesh in (half, whole.mesh))
        twice = before.reshape(-1, 3).sum(axis=0) * [0, 2, 2]
        assert after.reshape(-1, 3).sum(axis=0) == pytest.approx(twice, abs=1e-6)
        count = np.linalg.norm(before, axis=2).sum()
        assert np.linalg.norm(after, axis=2).sum() == pytest.approx(2 * count)
    with pytest.raises(ValueError, match="whole"):
        both_halves(whole.mesh)


@BOTH_ELEMENTS
def test_fibers_go_on_across_the_mirror(element: str) -> None:
    half, full = (model_mesh(half=h, element=element, axial=2.0) for h in (True, False))
    halves = Halves(half)
    whole, moved = halves.model_mesh, halves.snapshot(state_of(half))
    assert whole.fibers is not None
    assert full.fibers is not None
    lines = fiber_lines(whole.mesh, whole.fibers, moved.displacement, moved.fiber_force)
    exact = fiber_lines(full.mesh, full.fibers, sheared(full.mesh.nodes))
    # one unbroken line a curve, each as long as that of a body that is whole
    assert lines.cell_data["curve"].tolist() == exact.cell_data["curve"].tolist()
    ours, theirs = (
        data.compute_cell_sizes(area=False, volume=False)["Length"] for data in (lines, exact)
    )
    assert ours == pytest.approx(theirs, rel=1e-4)
    forces = lines.point_data["tension_N"].reshape(-1)
    assert forces.min() >= state_of(half).fiber_force.min()  # type: ignore[union-attr]
    assert fiber_lines(whole.mesh, whole.fibers).bounds == pytest.approx(
        fiber_lines(full.mesh, full.fibers).bounds, abs=1e-4
    )


@pytest.mark.parametrize("model", ["section", "cell", "body"])
def test_both_halves_in_files(model: str, tmp_path: Path) -> None:
    if model == "body":
        scene = model_mesh()
        state = snapshot(scene, 45.0)
    else:
        scene = uniform.section() if model == "section" else uniform.cell()
        state = uniform.state(scene)
    case = case_of(model)
    grids = {}
    for halves in ("modelled", "both"):
        output = case.output.model_copy(update={"field_halves": halves})
        folder, said = RunFolder(tmp_path / halves), list[str]()
        chosen = case.model_copy(update={"output": output})
        write_fields(folder, chosen, scene, [state], [], said.append)
        assert said == []
        grids[halves] = pv.read(tmp_path / halves / "fields" / f"{state.label}.vtm")
    names = grids["both"]["body"].keys()
    assert names == grids["modelled"]["body"].keys()
    for name in names:
        one, both = (grids[halves]["body"][name] for halves in ("modelled", "both"))
        # every Jacobian is positive, at rest and warped
        first = vtk_volumes(one, "hexahedron").sum()
        assert vtk_volumes(both, "hexahedron").sum() == pytest.approx(2 * first, rel=1e-6)
        moved = both.warp_by_vector("displacement_mm")
        assert vtk_volumes(moved, "hexahedron").min() > 0
        x = both.points[:, 0]
        assert x.min() == pytest.approx(-x.max())
    if model != "section":
        lengths = [
            grids[halves]["fibers"].compute_cell_sizes(area=False, volume=False)["Length"].sum()
            for halves in ("modelled", "both")
        ]
        assert lengths[1] == pytest.approx(2 * lengths[0], rel=1e-6)


def test_a_whole_body_has_no_image(tmp_path: Path) -> None:
    scene = model_mesh(half=False)
    case = case_of("body")
    output = case.output.model_copy(update={"field_halves": "both"})
    case, said = case.model_copy(update={"output": output}), list[str]()
    names = write_fields(RunFolder(tmp_path), case, scene, [snapshot(scene, 30.0)], [], said.append)
    assert said == [WHOLE_ANYWAY]
    wall = pv.read(tmp_path / "fields" / "30deg_wall.vtu")
    assert wall.n_cells == (scene.mesh.cell_region == scene.mesh.regions["wall"]).sum()
    assert len(names) == len(set(names))
    with pytest.raises(ValueError, match="whole"):
        Halves(scene)


def test_strains_of_pictures_have_both_halves_too() -> None:
    scene = uniform.cell()
    state = uniform.state(scene, move=uniform.wave)
    one, both = (Space(case_of("cell"), scene, halves) for halves in (False, True))
    first, second = one.at_cells(state), both.at_cells(state)
    cells = len(first)
    assert len(second) == 2 * cells
    assert np.sort(second[cells:], axis=1) == pytest.approx(np.sort(first, axis=1))
    assert second[cells:, 0] == pytest.approx(first[:, 2])

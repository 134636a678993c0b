from __future__ import annotations

import base64
import copy
import dataclasses
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from fiberbend.case.case import Case
from fiberbend.reader.reader import parse_case
from fiberbend.report import scene
from fiberbend.report.run_page import report
from fiberbend.report.scene import scene_data, thinned
from fiberbend.report.side_view import loops_of, plane_edges
from fiberbend.results.folder import MESH, RunFolder
from fiberbend.results.space import Space
from fiberbend.results.states import REST, Kept, States, write_fibers, write_snapshot
from fiberbend.states.snapshot import ModelMesh, Snapshot
from tests.output import bending, uniform
from tests.report.folders import ANGLES, CASE, bent_folder, case, row, rows, run_of


def unpacked(text: str, kind: str) -> NDArray[Any]:
    planes = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8)
    size = np.dtype(kind).itemsize
    return np.ascontiguousarray(planes.reshape(size, -1).T).view(kind).ravel()


def positions(content: dict[str, Any], packed: str) -> NDArray[Any]:
    whole = unpacked(packed, "<u2").reshape(len(content["steps"]), -1, 3)
    return np.asarray(content["corner"]) + content["scale"] * whole


@pytest.fixture(scope="module", params=["hexahedron", "tetrahedron"])
def content(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("scene") / "run"
    bent_folder(folder, case(), run_of(), request.param)
    return scene_data(case(), States(folder, case(), rows())).content


def test_every_point_lies_on_its_arc_in_every_step(content: dict[str, Any]) -> None:
    for skin in content["skins"]:
        found = positions(content, skin["positions"])
        for points, degrees in zip(found, (0.0, *ANGLES), strict=True):
            exact = bending.bent(found[0], 24.0, np.radians(degrees))
            assert np.abs(points - exact).max() < 3 * content["scale"]


def test_strips_of_fabric_are_on_the_body_in_every_step(tmp_path: Path) -> None:
    strip = {"at": "right", "width": "3 mm", "thickness": "0.2 mm", "modulus": "1 GPa"}
    given = case(effects=[*CASE["effects"], {"strip": strip}], mesh={"axial": "4 mm"})
    bent_folder(tmp_path / "run", given, run_of())
    found = scene_data(given, States(tmp_path / "run", given, rows())).content
    fabric = found["fabric"]
    points = positions(found, fabric["positions"])
    for moved, degrees in zip(points, (0.0, *ANGLES), strict=True):
        exact = bending.bent(points[0], 24.0, np.radians(degrees))
        assert np.abs(moved - exact).max() < 0.02
    triangles = unpacked(fabric["triangles"], "<u4").reshape(-1, 3)
    assert triangles.max() == fabric["points"] - 1
    a, b, c = (points[0][triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    assert area == pytest.approx(3 * 24, rel=0.03)
    assert np.cross(b - a, c - a)[:, 0].mean() > 0


def test_without_strips_there_is_no_fabric(content: dict[str, Any]) -> None:
    assert content["fabric"]["points"] == 0


def test_surfaces_are_closed_and_their_outside_is_outside(content: dict[str, Any]) -> None:
    solid = {"body": 0.0, "sheath": 0.0}
    for skin in content["skins"]:
        points = positions(content, skin["positions"])[0]
        a, b, c = (
            points[unpacked(skin["triangles"], "<u4").reshape(-1, 3)[:, i]] for i in range(3)
        )
        solid[skin["part"]] += float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6
        if skin["cut"]:
            assert np.abs(points[:, 0]).max() < content["scale"]
    mesh = bending.model_mesh().mesh
    region = mesh.cell_region == mesh.regions["sheath"]
    from geometry.mesh.reference import cell_rule, jacobians

    places, weights = cell_rule(mesh.cell_type)
    volume = np.linalg.det(jacobians(mesh, np.arange(len(mesh.cells)), places)[1]) @ weights
    # flat pieces cut off a little of what is round; the sheath's inner face is left out
    assert solid["body"] == pytest.approx(volume[~region].sum(), rel=0.01)


def test_fibers_lie_in_the_surface(content: dict[str, Any]) -> None:
    lines = positions(content, content["fibers"]["positions"])
    assert lines.shape[1] == content["fibers"]["points"] > 100
    rest = lines[0]
    # on the wall, 10 mm around the middle of the floor's upper face, or under the floor
    radius = np.hypot(rest[:, 0], rest[:, 1] - 2.0)
    assert (np.abs(radius[rest[:, 1] > 2.1] - 10.0) < 0.1).all()
    assert (rest[rest[:, 1] < 1.9, 1] > -0.1).all()
    exact = bending.bent(rest, 24.0, np.radians(ANGLES[-1]))
    # nodes bend exactly, what is between them as their parabolas do
    assert np.abs(lines[-1] - exact).max() < 0.05


def test_colours_are_the_strain_of_pure_bending(content: dict[str, Any]) -> None:
    assert [each["name"] for each in content["quantities"]] == ["strain", "stress"]
    for skin in content["skins"]:
        top = skin["tops"][0]
        points = positions(content, skin["positions"])[0]
        shown = unpacked(skin["values"][0], "u1").reshape(len(content["steps"]), -1) / 255 * top
        assert not shown[0].any()
        middle = (points[:, 2] > 9) & (points[:, 2] < 15)
        angle = np.radians(ANGLES[-1])
        stretch = 1 + angle / 24.0 * (points[middle, 1] - 1.0)
        exact = np.log(np.maximum(stretch, 1.0))
        far = exact > 0.05
        assert np.abs(shown[-1][middle][far] - np.minimum(exact[far], top)).max() < 0.03


def test_obstacles_are_there(content: dict[str, Any]) -> None:
    (bar,) = content["obstacles"]
    points = unpacked(bar["points"], "<f4").reshape(-1, 3)
    assert np.hypot(points[:, 1] + 20, points[:, 2] - 20).max() == pytest.approx(5.0, rel=1e-4)
    assert unpacked(bar["triangles"], "<u4").max() < len(points)


def test_steps_say_pressure_and_angle(content: dict[str, Any]) -> None:
    assert [step["angle"] for step in content["steps"]] == [0.0, *ANGLES]
    assert [step["step"] for step in content["steps"]] == [0, 1, 2, 3]


def test_a_large_body_gets_coarser_then_loses_steps_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = bent_folder(tmp_path / "run", case(), run_of())
    states = States(folder, case(), rows())
    fine = scene_data(case(), states)
    assert fine.steps == 4
    points = sum(skin["points"] for skin in fine.content["skins"])
    monkeypatch.setattr(scene, "MOST_NUMBERS", 8 * points * 4 - 1)
    coarse = scene_data(case(), states)
    assert coarse.steps == 4
    assert sum(skin["points"] for skin in coarse.content["skins"]) < points / 2
    assert any("straight edges" in note for note in coarse.notes)
    monkeypatch.setattr(scene, "MOST_NUMBERS", 1)
    least = scene_data(case(), states)
    assert [step["step"] for step in least.content["steps"]] == [0, 3]
    assert any("2 of 4 load steps" in note for note in least.notes)


def kept(labels: list[str]) -> list[Kept]:
    return [Kept(label, step, 1.0, 1.0, None) for step, label in enumerate(labels)]


def test_states_that_were_asked_for_stay_longest() -> None:
    labels = [REST, *(f"step_{n:04d}" for n in range(1, 20))]
    labels[7] = "090deg"
    found = thinned(kept(labels), 4)
    assert len(found) == 4
    assert {0, 7, 19} < {each.step for each in found}
    assert thinned(kept(labels), 99) == tuple(kept(labels))
    assert [each.step for each in thinned(kept(labels), 2)] == [0, 19]


def test_a_cut_body_has_the_outlines_of_wall_and_chamber() -> None:
    mesh = bending.model_mesh().mesh
    loops = loops_of(plane_edges(mesh))
    assert len(loops) == 2
    sizes = sorted(tuple(np.ptp(mesh.nodes[loop][:, 1:], axis=0).round(6)) for loop in loops)
    # chamber 8 mm high and 24 mm long; outside with wall, floor, sheath and caps
    assert sizes == [(8.0, 24.0), (14.0, 32.0)]
    whole = bending.model_mesh(half=False).mesh
    assert len(loops_of(plane_edges(whole))) == 2
    tets = bending.model_mesh(element="tetrahedron").mesh
    assert len(loops_of(plane_edges(tets))) == 2


def test_a_body_without_facets_in_the_plane_has_no_outline() -> None:
    mesh = bending.model_mesh().mesh
    aside = dataclasses.replace(mesh, nodes=mesh.nodes + np.array([1.0, 0.0, 0.0]))
    assert loops_of(plane_edges(aside)) == []


UNIFORM = CASE | {
    "effects": [
        {"pressure": {"angle": "90 deg"}},
        {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}},
    ],
    "mesh": {},
    "output": {"pictures": False, "fields": False, "at_angles": ["90 deg"]},
}


def uniform_folder(path: Path, given: Case, own: ModelMesh, shot: Snapshot) -> Path:
    """The folder of a section or a cell with one state."""
    folder = RunFolder(path)
    folder.write_case(given)
    folder.write(MESH, own.mesh.save)
    assert own.fibers is not None
    write_fibers(folder, own.fibers, own.smeared)
    write_snapshot(folder, shot)
    return path


@pytest.mark.parametrize("model", ["section", "cell"])
def test_section_and_cell_are_where_their_body_in_space_is(model: str, tmp_path: Path) -> None:
    smeared = {"as": "smeared"} if model == "section" else {}
    effects = copy.deepcopy(UNIFORM["effects"])
    effects[1]["winding"] |= smeared
    given = parse_case(UNIFORM | {"model": model, "effects": effects})
    own = uniform.section() if model == "section" else uniform.cell()
    shot = uniform.state(own, 90.0, 1.05)
    path = uniform_folder(tmp_path / "run", given, own, shot)
    states = States(path, given, [row(0, 0.0), row(1, 90.0)])
    found = scene_data(given, states)
    space = Space(given, states.model_mesh)
    mesh = space.model_mesh.mesh
    moved = mesh.nodes + space.snapshot(shot).displacement
    strain = space.at_cells(shot)
    for skin in found.content["skins"]:
        top = skin["tops"][0]
        points = positions(found.content, skin["positions"])
        distance, node = cKDTree(mesh.nodes).query(points[0])
        assert distance.max() < 2 * found.content["scale"]
        assert np.abs(points[1] - moved[node]).max() < 3 * found.content["scale"]
        shown = unpacked(skin["values"][0], "u1").reshape(2, -1)[1] / 255 * top
        least, most = np.full(len(mesh.nodes), np.inf), np.full(len(mesh.nodes), -np.inf)
        np.minimum.at(least, mesh.cells, strain)
        np.maximum.at(most, mesh.cells, strain)
        slack = top / 250
        assert (shown > np.minimum(least[node], top) - slack).all()
        assert (shown < np.minimum(most[node], top) + slack).all()
    assert bool(found.content["fibers"]["points"]) == (model == "cell")
    assert any("no caps" in note for note in found.notes)


def test_a_section_without_pictures_shows_its_shape(tmp_path: Path) -> None:
    effects = copy.deepcopy(UNIFORM["effects"])
    effects[1]["winding"] |= {"as": "smeared"}
    given = parse_case(UNIFORM | {"model": "section", "effects": effects})
    own = uniform.section()
    path = uniform_folder(tmp_path / "run", given, own, uniform.state(own, 90.0))
    page = report(path, given, [row(0, 0.0), row(1, 90.0)], run_of(model="section"))
    assert page.count('alt="Section of the actuator in several states') == 1
    assert 'alt="Greatest principal strain in the section."' not in page
    assert page.count('alt="Bending angle against pressure."') == 1


def test_colours_span_what_is_seen_from_outside(tmp_path: Path) -> None:
    """Not the chamber's surface, whose corners strain most and nobody sees."""
    folder = bent_folder(tmp_path / "run", case(), run_of())
    space = Space(case(), States(folder, case(), rows()).model_mesh)
    own, mesh = scene._own_nodes(space.own), space.own.mesh
    node_of = np.zeros(int(own.cells.max()) + 1, dtype=int)
    node_of[own.cells.ravel()] = mesh.cells.ravel()
    chamber = set(mesh.facet_nodes("chamber").ravel().tolist())
    skins = scene._skins(space, 2)
    assert {(skin.part, skin.cut) for skin in skins} >= {("body", False), ("sheath", False)}
    for skin in skins:
        if skin.part == "body" and not skin.cut:
            assert chamber & set(node_of[skin.value].tolist())
        if not skin.cut:
            assert not chamber & set(node_of[skin.seen].tolist())


def test_a_step_says_the_forces_of_obstacles(tmp_path: Path) -> None:
    folder = bent_folder(tmp_path / "run", case(), run_of())
    history = rows()
    history[3] |= {"contact_cylinder_y_N": -3.0, "contact_cylinder_z_N": 4.0}
    page = report(folder, case(), history, run_of())
    assert page.count('"forces": "cylinder 5 N"') == 1
    assert page.count('"forces": ""') == 3


def test_stress_is_on_a_logarithmic_scale(content: dict[str, Any]) -> None:
    powers = {each["name"]: each["powers"] for each in content["quantities"]}
    assert powers["strain"] == 0 < powers["stress"]
    tops = {skin["tops"][1] for skin in content["skins"]}
    assert len(tops) == 1
    assert np.log10(tops.pop()) % 1 == pytest.approx(0, abs=1e-9)

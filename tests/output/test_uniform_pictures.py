"""Section and cell in space: the mapping, the recovered stress, the stacks and the pictures."""

from __future__ import annotations

import dataclasses
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analytic.path import tip
from fiberbend.case.case import Case
from fiberbend.drawing.cell import Slices, plot_tension, tension_along
from fiberbend.drawing.crosscut import Crosscut
from fiberbend.drawing.renderer import Renderer
from fiberbend.drawing.section import Sections
from fiberbend.reader.reader import parse_case
from fiberbend.results.folder import RunFolder
from fiberbend.results.scenery import scenery
from fiberbend.results.space import Space
from fiberbend.running.outputs import draw
from fiberbend.states.bend import Bend
from fiberbend.states.recovery import cauchy_stress, recover
from fiberbend.states.snapshot import ModelMesh
from fiberbend.states.stack import extruded, repeated, split_alike
from geometry.bodies.extrude import section_quadrilaterals
from geometry.checks import region_volumes
from geometry.mesh.data import Floats, MeshData
from geometry.sections.circle import CircleActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from materials.material import Material
from tests.materials.rubber import uniaxial_stress
from tests.output.bending import MATERIALS, SHORT
from tests.output.test_pictures import is_drawn
from tests.output.uniform import DOUBLE, PITCH, cell, section, state, warp, wave
from tests.run.conftest import SMALL, small

BOTH = pytest.mark.parametrize("make", [section, cell], ids=["section", "cell"])


# --- the mapping -----------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [0.0, 1e-6, 90.0, 360.0, 500.0])
def test_the_axis_is_the_arc_of_the_analytic_model(degrees: float) -> None:
    stretch, height = 0.96, 4.5
    bend = Bend(np.radians(degrees) / 160.0, stretch)
    z = np.linspace(0.0, 160.0, 2001)
    axis = bend.place(np.zeros((len(z), 3)), z)
    length = np.linalg.norm(np.diff(axis, axis=0), axis=1).sum()
    # a chord of an arc of 0.25° is shorter by 1e-6 of itself
    assert length == pytest.approx(stretch * 160.0, rel=2e-6)
    above = bend.place(np.array([[0.0, height, 0.0]]), z[-1:])[0]
    for point, lift in ((axis[-1], 0.0), (above, height)):
        expected = tip(np.radians(degrees), stretch * 160.0, height=lift)
        assert [point[2], -point[1]] == pytest.approx(expected, abs=1e-9)
    assert axis[:, 0] == pytest.approx(0.0)


def test_the_frame_moves_as_the_kinematics_says() -> None:
    # dx/dZ = R (λ0 e_z + ω × x'), by central differences, with a twist
    bend, position, step = (
        Bend(0.03, 1.1, -0.02, (0.1, 4.0, 0.2), 5.0),
        np.array([[3.0, -2.0, 0.5]]),
        1e-4,
    )
    z = np.array([17.0])
    slope = (bend.place(position, z + step) - bend.place(position, z - step)) / (2 * step)
    rotation = bend.rotations(z)[0]
    assert slope[0] == pytest.approx(rotation @ bend.line.advance(position)[0], abs=1e-8)
    assert rotation @ rotation.T == pytest.approx(np.eye(3))


# --- strain and stress -----------------------------------------------------------------------


@BOTH
def test_straight_stretch_is_uniaxial(make: Callable[[], ModelMesh]) -> None:
    """No curvature, λ0 given, the section shrunk as incompressibility wants it."""
    stretch, scene = 1.4, make()
    rubber = Material("yeoh", {"c1": 0.11, "c2": 0.02})
    scene = dataclasses.replace(scene, materials=dict.fromkeys(MATERIALS, rubber))

    def shrink(nodes: Floats) -> Floats:
        moved = nodes * (stretch**-0.5 - 1)
        moved[:, 2:] = 0.0
        return moved

    free = cauchy_stress(rubber, np.diag([stretch**-0.5] * 2 + [stretch]), np.array(0.0))
    straight = state(scene, 0.0, stretch, shrink)
    straight = dataclasses.replace(straight, multiplier=straight.multiplier - free[0, 0])
    fields = recover(scene, straight)
    expected = stretch * uniaxial_stress(rubber, np.array([stretch]))[0]
    assert fields.jacobian == pytest.approx(1.0)
    assert fields.log_strain == pytest.approx(np.log(stretch))
    assert fields.cauchy[:, 2, 2] == pytest.approx(expected)
    assert fields.cauchy[:, :2, :2] == pytest.approx(0.0, abs=1e-12)
    assert fields.von_mises == pytest.approx(expected)


@BOTH
def test_bending_stretches_by_the_height(make: Callable[[], ModelMesh]) -> None:
    scene = make()
    bent = state(scene, 120.0, 0.95)
    nodes = split_alike(scene.mesh)
    stretch = 0.95 + bent.curvature * scene.mesh.nodes[nodes.node, 1]
    # nothing else moves: det F is the axial stretch, λ0 + k y; y is not linear in curved elements
    assert recover(scene, bent, nodes).jacobian == pytest.approx(stretch, rel=8e-3)


def test_twist_shears_by_the_distance() -> None:
    # a straight section that turns by τ: F = 1 + τ (−y, x) ⊗ e_z, σ23 = 2 ψ1 τ x, σ13 = −2 ψ1 τ y
    mu, twist, scene = 0.5, 0.01, section()
    scene = dataclasses.replace(
        scene, materials=dict.fromkeys(MATERIALS, Material("neo-hooke", {"mu": mu}))
    )
    nodes = split_alike(scene.mesh)
    fields = recover(scene, state(scene, 0.0, twist=twist), nodes)
    x, y = scene.mesh.nodes[nodes.node].T
    # up to 0.05; x and y are not linear in curved elements
    assert fields.cauchy[:, 1, 2] == pytest.approx(mu * twist * x, abs=1e-3)
    assert fields.cauchy[:, 0, 2] == pytest.approx(-mu * twist * y, abs=1e-3)


def test_wrong_shapes_are_refused() -> None:
    scene = section()
    bent = state(scene)
    with pytest.raises(ValueError, match="displacement"):
        recover(scene, dataclasses.replace(bent, displacement=bent.displacement[1:]))
    with pytest.raises(ValueError, match="multiplier"):
        recover(scene, dataclasses.replace(bent, multiplier=bent.multiplier[:, :4]))
    with pytest.raises(ValueError, match="expected a solid"):
        dataclasses.replace(scene, uniform=False)
    with pytest.raises(ValueError, match="no state"):
        Sections(cell(), [])
    with pytest.raises(ValueError, match="no state"):
        Slices(cell(), [], Renderer())


# --- stacks ----------------------------------------------------------------------------------


@pytest.mark.parametrize("half", [True, False])
def test_repeated_slices_are_the_long_body(half: bool) -> None:
    scene = cell(half)
    stack = repeated(scene, 3)
    fibers, long = stack.model_mesh.fibers, embed(stack.model_mesh.mesh, SHORT, DOUBLE)
    assert fibers is not None
    for field in dataclasses.fields(long):
        ours, theirs = getattr(fibers, field.name), getattr(long, field.name)
        assert ours == pytest.approx(theirs, abs=1e-9), field.name
    moved = stack.snapshot(scene, state(scene, move=wave))
    # one body in one piece: the same point of every pitch lies on the arc
    pitch = 2 * PITCH / 2 if half else PITCH
    mesh, bend = stack.model_mesh.mesh, Bend.of(state(scene, move=wave), scene.mesh)
    placed = mesh.nodes + moved.displacement
    own = mesh.nodes.copy()
    own[:, 2] = 0.0
    expected = bend.place(own + wave(mesh.nodes), mesh.nodes[:, 2])
    assert placed == pytest.approx(expected, abs=1e-9)
    assert mesh.nodes[-1, 2] == pytest.approx(1.5 * pitch if half else 3 * pitch)


def test_mirrored_slices_recover_alike() -> None:
    scene = cell()
    bent = state(scene, 60.0, 0.98, wave)
    nodes = split_alike(scene.mesh)
    stack = repeated(scene, 4)
    spread = stack.fields(scene, nodes, recover(scene, bent, nodes), bent)
    direct = recover(stack.model_mesh, stack.snapshot(scene, bent))
    inner = _inside(stack.model_mesh.mesh)
    # what second-order interpolation of the arc leaves
    assert spread.stretches[inner] == pytest.approx(direct.stretches[inner], rel=2e-3)
    off = np.linalg.norm(spread.cauchy[inner] - direct.cauchy[inner])
    # a mirrored shear with the wrong sign would leave 1 here
    assert off < 0.03 * np.linalg.norm(direct.cauchy[inner])


def _inside(mesh: MeshData) -> np.ndarray:
    z = mesh.nodes[split_alike(mesh).node, 2]
    return (z > PITCH / 2) & (z < z.max() - PITCH / 2)


def test_swept_section_recovers_alike() -> None:
    scene = section()
    bent = state(scene, 90.0, 0.98)
    nodes = split_alike(scene.mesh)
    stack = extruded(scene, SHORT.length, 24)
    spread = stack.fields(scene, nodes, recover(scene, bent, nodes), bent)
    direct = recover(stack.model_mesh, stack.snapshot(scene, bent))
    assert spread.stretches == pytest.approx(direct.stretches, rel=2e-3)
    assert spread.cauchy == pytest.approx(direct.cauchy, abs=5e-3 * np.abs(direct.cauchy).max())


def test_turned_half_completes_a_twisted_section() -> None:
    scene = section()
    twisted = state(scene, 90.0, move=warp, twist=-0.01)
    stack = extruded(scene, SHORT.length, 8, turned=True)
    mesh = stack.model_mesh.mesh
    assert not mesh.half
    half = extruded(scene, SHORT.length, 8).model_mesh.mesh
    volumes = region_volumes(half)
    assert region_volumes(mesh) == pytest.approx({name: 2 * v for name, v in volumes.items()})
    placed = mesh.nodes + stack.snapshot(scene, twisted).displacement
    own = np.column_stack([mesh.nodes[:, :2], 0.05 * mesh.nodes[:, 0]])
    expected = Bend.of(twisted, scene.mesh).place(own, mesh.nodes[:, 2])
    assert placed == pytest.approx(expected, abs=1e-9)


# --- pictures --------------------------------------------------------------------------------


def case_of(model: str) -> Case:
    smeared = "smeared" if model == "section" else "discrete"
    winding = SMALL["effects"][1]["winding"] | {"as": smeared}
    return parse_case(
        small(
            actuator=SMALL["actuator"] | {"cap": "4 mm"},
            effects=[{"pressure": {"to": "10 kPa"}}, {"winding": winding}],
            model=model,
            mesh={},
            output={"fields": True, "pictures": True},
        )
    )


@pytest.mark.parametrize(
    ("model", "half", "degrees"),
    [
        ("section", True, (60.0, 90.0)),
        ("section", False, (90.0,)),
        ("cell", True, (60.0, 90.0)),
        ("cell", False, (90.0,)),
    ],
)
def test_pictures(model: str, half: bool, degrees: tuple[float, ...], tmp_path: Path) -> None:
    scene = section(half) if model == "section" else cell(half)
    move = None if model == "section" else wave
    states = [state(scene, angle, move=move) for angle in degrees]
    said: list[str] = []
    draw(RunFolder(tmp_path), case_of(model), scene, states, [], None, said.append)
    assert not said
    names = {"rest", "section_shape", "section_stress", "section_strain", "bent"}
    if model == "cell":
        names |= {"cell_bulge", "fiber_stretch"}
    assert {path.stem for path in (tmp_path / "pictures").iterdir()} == names
    assert all(is_drawn(path) for path in (tmp_path / "pictures").iterdir())


def test_twisted_section_is_drawn_whole(tmp_path: Path) -> None:
    scene = section()
    states = [state(scene, 60.0, move=warp, twist=-0.01)]
    draw(RunFolder(tmp_path), case_of("section"), scene, states, [], None, print)
    assert is_drawn(tmp_path / "pictures" / "bent.png")


def test_a_picture_of_whole_slices_says_how_much_of_the_length_it_has() -> None:
    case, scene = case_of("cell"), cell(False)
    actuator = case.actuator.model_copy(update={"length": 2.3 * PITCH})
    space = Space(case.model_copy(update={"actuator": actuator}), scene)
    drawn = float(np.ptp(space.model_mesh.mesh.nodes[:, 2]))
    assert abs(drawn - 2.3 * PITCH) > 0.1
    assert space.in_slices == f", in whole slices: {drawn:.4g} of {2.3 * PITCH:.4g} mm"
    actuator = case.actuator.model_copy(update={"length": 2 * PITCH})
    assert Space(case.model_copy(update={"actuator": actuator}), scene).in_slices == ""


def test_captions_have_the_turns_of_the_history() -> None:
    """Those of the whole length, whatever is drawn; none of round-off."""
    rows: list[dict[str, Any]] = [
        {"step": 1, "twist_deg": 34.0821, "side_angle_deg": -1.2666},
        {"step": 2},
    ]
    rows.append({"step": 3, "twist_deg": 1e-9, "side_angle_deg": 0.0})
    shots = [dataclasses.replace(state(section(), 60.0), step=step) for step in (1, 2, 3)]
    captions = [scenery(case_of("section"), rows).caption(shot) for shot in shots]
    assert captions[0].endswith("θ = 60°,  side −1.27°,  twist 34.1°")
    assert captions[1] == captions[2] == shots[1].caption


def test_floor_bulge_is_read_between_middle_and_edge() -> None:
    scene = section()

    def sag(nodes: Floats) -> Floats:
        return np.column_stack([0 * nodes[:, 0], 0.7 * (nodes[:, 0] / 10) ** 2])

    # the edge of the winding lies at x = a + t = 10
    assert Crosscut(scene).bulge(state(scene, move=sag)) == pytest.approx(0.7)
    round_one = CircleActuator(radius=8, length=24, wall=2, cap=4)
    mesh = section_quadrilaterals(round_one, MeshSize(axial=PITCH))
    tube = ModelMesh(mesh, MATERIALS, None, smeared=False, title="", uniform=True)
    still = dataclasses.replace(
        state(scene),
        displacement=np.zeros_like(mesh.nodes),
        multiplier=np.zeros(mesh.cells.shape),
    )
    assert Crosscut(tube).bulge(still) is None
    assert Crosscut(tube).size(still) == pytest.approx((20.0, 20.0))


def test_crosscut_covers_the_section() -> None:
    for scene in (section(), cell(), section(half=False)):
        cut = Crosscut(scene)
        a, b, c = cut.points(None)[cut.triangles].transpose(1, 0, 2)
        area = np.abs(np.linalg.det(np.stack([b - a, c - a], axis=1))).sum() / 2
        # polygons inside round outlines: 9° pieces in 8 parts lose 1e-4
        assert area == pytest.approx(sum(SHORT.region_areas().values()), rel=5e-4)
    # the outlines close: every end meets another one
    lines = cut.outlines(None)
    ends = np.round(lines[:, [0, -1]].reshape(-1, 2), 6)
    assert np.unique(ends, axis=0, return_counts=True)[1].min() >= 2


def test_crown_bulge_is_that_of_the_state() -> None:
    scene = cell()
    z, height = Slices(scene, [state(scene)], Renderer()).crown(state(scene, move=wave))
    assert z == pytest.approx(np.linspace(0, PITCH / 2, 5))
    assert np.ptp(height) == pytest.approx(0.2)


@pytest.mark.parametrize("half", [True, False])
def test_tension_is_that_of_the_whole_fiber(half: bool, tmp_path: Path) -> None:
    scene = cell(half, fineness=3)
    s, tension = tension_along(scene, state(scene), SHORT)
    perimeter = SHORT.winding_perimeter
    assert (s[0], s[-1]) == pytest.approx((0.0, perimeter / 2 if half else perimeter))
    assert len(tension) == DOUBLE.lines_per_fiber
    # a running mean over 2 mm of 2 + cos(s / 5), given per segment of up to 1.3 mm
    assert tension == pytest.approx(np.tile(2 + np.cos(s / 5), (5, 1)), abs=0.15)
    slack = dataclasses.replace(state(scene), fiber_force=None)
    with pytest.raises(ValueError, match="no fiber forces"):
        plot_tension(scene, [slack], tmp_path / "fiber.png", SHORT, 881.0)


def test_nothing_is_imported_for_a_run_without_pictures() -> None:
    # pyvista and matplotlib take longer to import than a section takes to solve
    code = (
        "import sys, fiberbend.running.runner, fiberbend.running.outputs\n"
        "import fiberbend.running.uniform_outputs\n"
        "print([name for name in ('pyvista', 'matplotlib', 'vtkmodules') if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.strip() == "[]"


def test_no_pyvista_leaves_the_sections(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    scene, said = section(), list[str]()
    case = case_of("section").model_copy(
        update={"output": case_of("section").output.model_copy(update={"fields": False})}
    )
    draw(RunFolder(tmp_path), case, scene, [state(scene)], [], None, said.append)
    assert len(said) == 1
    assert "pictures need pyvista" in said[0]
    assert (tmp_path / "pictures" / "section_shape.png").exists()

"""A smeared winding on rubber that bulges between its turns, against what is known of it."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence

import numpy as np
import pytest

from fem.effects.bulging_fibers import BulgingPotential
from fem.effects.effect import Effect
from fem.effects.embedded_fibers import FiberPotential
from fem.effects.winding import CalibratedWinding, SmearedWinding
from fem.kinematics.cell import Cell
from fem.kinematics.domain import Domain
from fem.kinematics.section import Section
from fem.kinematics.uniform import CURVATURE, STRETCH, TWIST
from fem.scene import Scene
from geometry.bodies.extrude import hexahedral_slice, section_quadrilaterals
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.size import MeshSize
from geometry.winding.helix import Winding
from geometry.winding.smear import smear
from materials.bulging import Bulging
from tests.fem.parts import (
    BULGING,
    CELLS,
    EA,
    PITCH,
    SHORT,
    STUB,
    calibrated,
    law,
    perturb,
    stub,
    times_tangent,
)

REGIONS = ("wall", "floor", "sheath")
RIGID = Bulging(1e300)


def _section(
    bulging: Bulging | None,
    pattern: str = "double-helix",
    actuator: HemicircleActuator = SHORT,
    pitch: float = PITCH,
    stiffness: float = EA,
    twisted: bool = True,
    half: bool = True,
) -> Scene:
    """A section with the winding and next to nothing else."""
    domain = Domain(section_quadrilaterals(actuator, MeshSize(section=1, half=half)))
    segments = smear(domain.data, actuator, Winding(pattern, pitch, 0.38))
    winding: Effect = SmearedWinding(segments, stiffness)
    if bulging is not None:
        winding = CalibratedWinding(segments, stiffness, bulging)
    make = functools.partial(Section, length=actuator.length, twisted=twisted)
    return Scene(domain, [law("neo-hooke", REGIONS, scale=1e-9), winding], make)


def _potential(scene: Scene) -> BulgingPotential:
    found = scene.discrete["CalibratedWinding"]
    assert isinstance(found, BulgingPotential)
    return found


def _energy(scene: Scene) -> float:
    return scene.energies()["CalibratedWinding"]


def _stretched(scene: Scene, stretches: Sequence[float]) -> None:
    """A homogeneous deformation along x, y and z."""
    w = np.zeros(scene.body.owned)
    w[scene.body.node_dofs] = scene.domain.data.nodes * (np.array(stretches) - 1)
    scene.set(w)


@pytest.mark.parametrize("cell", CELLS)
def test_energy_of_a_homogeneous_stretch(cell: str) -> None:
    # by hand: λx = λy stretches every helix alike; threads on the arch are in series with the
    # bulge, those on the straight sides are not
    domain = stub(cell)
    scene = Scene(domain, [law("neo-hooke", REGIONS[:2], scale=1e-9), calibrated(domain)])
    around, along = 1.04, 1.15
    _stretched(scene, (around, around, along))
    radius = STUB.radius + STUB.wall
    arch, straight = np.pi * radius, 2 * STUB.floor + 2 * radius
    perimeter = arch + straight
    turn = np.hypot(perimeter, PITCH)
    density = 2 * turn / (perimeter * PITCH)
    strain = np.hypot(around * perimeter, along * PITCH) / turn - 1
    bulge = BULGING.stiffness * (1 + 1.1 * 0.15 + 3.0 * 0.15**2)
    curvature = (perimeter / turn) ** 2 / radius
    in_series = 1 / (1 / (EA * density) + curvature**2 / bulge)
    exact = STUB.length * (arch * in_series + straight * EA * density) * strain**2 / 2
    # quadratic arcs of 22.5° leave 4e-6 of the stretch, 1e-4 of the strain
    assert _energy(scene) == pytest.approx(exact, rel=3e-4)
    assert in_series < 0.5 * EA * density
    force = _potential(scene).force
    whole = EA * strain
    assert force.max() == pytest.approx(whole, rel=3e-4)
    assert force.min() == pytest.approx(in_series / density * strain, rel=3e-4)
    # the thread's own: EA (e − b/r), with K_b b = T ρ/r
    thinner = force.min() * density * curvature / bulge
    assert force.min() == pytest.approx(EA * (strain - thinner * curvature), rel=3e-3)


def test_without_a_bulge_it_is_the_smeared_winding() -> None:
    domain, found = stub("hexahedron"), []
    soft = law("neo-hooke", REGIONS[:2], scale=1e-9)
    segments = calibrated(domain).segments
    for winding in (SmearedWinding(segments, EA), CalibratedWinding(segments, EA, RIGID)):
        scene = Scene(domain, [soft, winding])
        perturb(scene, 0.03, 1)
        v = np.random.default_rng(2).uniform(-1, 1, scene.body.owned)
        product = times_tangent(scene, v)
        found.append((scene.energies()[type(winding).__name__], scene.residual()[0], product))
    (energy, forces, product), (same, alike, equal) = found
    assert same == pytest.approx(energy, rel=1e-14)
    assert np.abs(alike - forces).max() <= 1e-14 * np.abs(forces).max()
    assert np.abs(equal - product).max() <= 1e-14 * np.abs(product).max()


def test_a_softer_bulge_stores_less() -> None:
    energies = []
    for stiffness in (1e-6, 0.1, 1.0, 10.0, 1e6):
        scene = _section(Bulging(stiffness))
        _bend(scene)
        energies.append(_energy(scene))
    assert energies == sorted(energies)
    # what is left are the straight sides
    assert 0.1 * energies[-1] < energies[0] < 0.9 * energies[-1]


def _bend(scene: Scene, scale: float = 1.0, twist: float = 0.013) -> None:
    """A smooth state, the same on every mesh; lengths times `scale`."""
    body = scene.body
    x, y = scene.domain.data.nodes[:, :2].T / (10 * scale)
    u = [0.02 * x * y + 0.01 * x, 0.03 * y - 0.01 * x**2, 0.02 * x + 0.01 * y]
    if not scene.domain.data.half:
        u[1] += 0.02 * x
    w = np.zeros(body.owned)
    w[body.node_dofs] = 10 * scale * np.array(u).T[:, : body.components]
    rest = {CURVATURE: 0.02 / scale, STRETCH: 0.97, TWIST: twist / scale}
    for name in body.natural:
        scene.set_scalar(name, rest[name])
    scene.set(w)


def test_energy_scales_with_the_lengths() -> None:
    # strains stay; the thread's area grows by s², K0 is a modulus over a length
    s = 3.7
    large = HemicircleActuator(
        radius=8 * s, length=24 * s, wall=2 * s, floor=2 * s, sheath=s, cap=5 * s
    )
    scene = _section(BULGING)
    _bend(scene)
    wide = dataclasses.replace(BULGING, stiffness=BULGING.stiffness / s)
    scaled = _section(wide, actuator=large, pitch=PITCH * s, stiffness=EA * s**2)
    _bend(scaled, s)
    assert _energy(scaled) == pytest.approx(s**2 * _energy(scene), rel=1e-12)


@pytest.mark.parametrize(
    ("pattern", "image"),
    [("double-helix", "double-helix"), ("single-helix-right", "single-helix-left")],
)
def test_a_mirror_changes_the_hand_alone(pattern: str, image: str) -> None:
    scene, other = (_section(BULGING, name, pitch=20.0, half=False) for name in (pattern, image))
    _bend(scene)
    body, nodes = scene.body, scene.domain.data.nodes
    over = np.lexsort(np.round(nodes, 6).T)
    across = np.lexsort(np.round(nodes * [-1, 1], 6).T)
    assert nodes[over] == pytest.approx(nodes[across] * [-1, 1], abs=1e-9)
    w = np.zeros(body.owned)
    w[body.node_dofs[across]] = scene.w[body.node_dofs[over]] * [-1, 1, 1]
    for name, factor in {CURVATURE: 1, STRETCH: 1, TWIST: -1}.items():
        other.set_scalar(name, factor * scene.scalar(name))
    other.set(w)
    assert _energy(other) == pytest.approx(_energy(scene), rel=1e-12)
    other.set_scalar(TWIST, scene.scalar(TWIST))
    other.set(w)
    assert _energy(other) != pytest.approx(_energy(scene), rel=1e-3)


@pytest.mark.parametrize("twisted", [False, True])
def test_cell_stores_what_the_section_does(twisted: bool) -> None:
    # of x' = X nothing depends on z
    section = _section(BULGING, twisted=twisted)
    extent = PITCH / 2
    domain = Domain(hexahedral_slice(SHORT, MeshSize(section=1, half=True), extent, 2))
    make = functools.partial(Cell, length=SHORT.length, twisted=twisted)
    cell = Scene(domain, [law("neo-hooke", REGIONS, scale=1e-9), calibrated(domain, SHORT)], make)
    energies = []
    for scene in (section, cell):
        for name, value in {CURVATURE: 0.03, STRETCH: 1.02, TWIST: 0.02}.items():
            if name in scene.body.natural:
                scene.set_scalar(name, value)
        scene.set(np.zeros(scene.body.owned))
        energies.append(_energy(scene) * scene.body.symmetry_factor)
    assert energies[1] == pytest.approx(energies[0], rel=1e-12)


def test_slack_thread_lets_nothing_bulge() -> None:
    # its rubber is stretched along the axis, on which the stiffness of a bulge depends
    domain = stub("hexahedron")
    winding = calibrated(domain, tension_only=True)
    scene = Scene(domain, [law("neo-hooke", REGIONS[:2], scale=1e-9), winding])
    for around, carries in ((0.95, False), (1.05, True)):
        _stretched(scene, (around, around, 1.3))
        assert (_energy(scene) > 0) == carries
        forces = np.zeros(scene.body.local)
        _potential(scene).add_residual(forces)
        assert bool(np.any(forces)) == carries
        assert (_potential(scene).force_range()[1] > 0) == carries


@pytest.mark.parametrize("tension_only", [False, True])
def test_prediction_of_no_change_is_the_tangent(tension_only: bool) -> None:
    domain = stub("hexahedron")
    winding = calibrated(domain, tension_only=tension_only)
    scene = Scene(domain, [law("neo-hooke", REGIONS[:2], scale=1e-9), winding])
    w = perturb(scene, 0.03, 3)
    v = np.random.default_rng(4).uniform(-1, 1, len(w))
    exact = times_tangent(scene, v)
    remembered = scene.memory()
    scene.predict(np.zeros(len(w)))
    assert np.abs(times_tangent(scene, v) - exact).max() <= 1e-14 * np.abs(exact).max()
    scene.predict(v)
    assert np.abs(times_tangent(scene, v) - exact).max() > 1e-2 * np.abs(exact).max()
    scene.extrapolate([remembered], np.ones(1))
    assert np.abs(times_tangent(scene, v) - exact).max() <= 1e-14 * np.abs(exact).max()


def test_forces_are_predicted_to_first_order() -> None:
    # the error of both forces falls with the square of the correction
    scene = _section(BULGING)
    _bend(scene)
    w = scene.w.copy()
    v = np.where(scene.free[: len(w)], np.random.default_rng(5).uniform(-1, 1, len(w)), 0.0)
    rates = {CURVATURE: 0.01, STRETCH: 0.05, TWIST: 0.02}
    rest = {name: scene.scalar(name) for name in rates}
    errors = []
    for size in (1e-3, 1e-4):
        for name, value in rest.items():
            scene.set_scalar(name, value)
        scene.set(w)
        potential = _potential(scene)
        before = potential.state()
        scene.assemble_tangent()
        scene.predict(size * v, {name: size * rate for name, rate in rates.items()})
        predicted = (potential._predicted, potential._predicted_across)
        for name, value in rest.items():
            scene.set_scalar(name, value + size * rates[name])
        scene.set(w + size * v)
        after, bent = potential.state(), potential._bent
        assert predicted[0] is not None
        assert predicted[1] is not None
        errors.append(
            [
                np.abs(predicted[0] - after["force"]).max(),
                np.abs(predicted[1] - after["across"][bent]).max(),
            ]
        )
        assert errors[-1][0] < 0.1 * np.abs(after["force"] - before["force"]).max()
        assert errors[-1][1] < 0.1 * np.abs(after["across"] - before["across"]).max()
    for coarse, fine in zip(*errors, strict=True):
        assert fine == pytest.approx(coarse / 100, rel=0.2)


def test_an_outline_without_arcs_is_refused() -> None:
    # sharp corners have no length, so that the law has nothing to say about them
    box = RectangleActuator(width=10, height=6, length=24, wall=2, floor=2, cap=5)
    mesh = section_quadrilaterals(box, MeshSize(section=1, half=True))
    segments = smear(mesh, box, Winding("double-helix", PITCH, 0.38))
    with pytest.raises(ValueError, match="nowhere curved"):
        CalibratedWinding(segments, EA, BULGING)
    with pytest.raises(ValueError, match="fiber stiffness"):
        CalibratedWinding(calibrated(stub("hexahedron")).segments, 0.0, BULGING)


@pytest.mark.parametrize("kept", ["straight", "none"])
def test_a_rank_may_hold_no_curved_piece_or_none(kept: str) -> None:
    domain = stub("hexahedron")
    winding = calibrated(domain)
    scene = Scene(domain, [law("neo-hooke", REGIONS[:2], scale=1e-9), winding])
    whole = winding.segments
    chosen = np.flatnonzero(whole.curvature == 0 if kept == "straight" else whole.cell < 0)
    fields = {f.name: getattr(whole, f.name)[chosen] for f in dataclasses.fields(whole)}
    part = BulgingPotential(scene.body, dataclasses.replace(whole, **fields), EA, BULGING)
    plain = FiberPotential(scene.body, dataclasses.replace(whole, **fields), EA)
    perturb(scene, 0.03, 6)
    found = []
    for potential in (part, plain):
        potential.update(scene.body.w.x.array)
        forces = np.zeros(scene.body.local)
        potential.add_residual(forces)
        potential.add_noise(forces)
        blocks = potential._second_derivatives().block
        found.append((forces, blocks, np.array(potential.force_range())))
    for with_bulge, without in zip(*found, strict=True):
        assert np.array_equal(with_bulge, without)
    assert np.any(found[0][1]) == (kept == "straight")

"""Smeared families on rubber that yields under them, against what is known of it."""

from __future__ import annotations

import functools
import math

import numpy as np
import pytest

from fem.effects.bedded_fibers import MODES, PRESSURE, BeddedPotential, Run
from fem.effects.effect import Effect
from fem.effects.winding import BeddedWinding, SmearedWinding
from fem.kinematics.domain import Domain
from fem.kinematics.section import Section
from fem.kinematics.uniform import CURVATURE, SIDE, STRETCH, TWIST
from fem.scene import Scene
from geometry.bodies.extrude import section_quadrilaterals
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from geometry.winding.families import Family
from geometry.winding.ribbons import Ribbons
from geometry.winding.smear import smear
from materials.bedding import Bedding
from tests.fem.parts import SHORT, law, perturb, times_tangent

EA = 700.0
BED = Bedding(0.5, 4.0, 3.0, 2.0)
RIGID = Bedding(1e200, 1.0)
TUBE = CircleActuator(radius=5.0, length=24.0, wall=1.5, cap=5.0)
REGIONS = ("wall", "floor", "sheath")
FAMILIES = (
    Family(math.radians(40), 1, 3.0),
    Family(math.radians(65), -1, 4.0),
    Family(math.pi / 2, 0, 5.0),
    Family(0.0, 0, 6.0),
)
KEY = "BeddedWinding"
Way = tuple[np.ndarray, dict[str, float]]


def _section(
    bedding: Bedding | None,
    families: tuple[Family, ...] = FAMILIES,
    actuator: CircleActuator | HemicircleActuator = SHORT,
    half: bool = True,
    sideways: bool = False,
) -> Scene:
    """A section with the winding and next to nothing else."""
    domain = Domain(section_quadrilaterals(actuator, MeshSize(section=2, half=half)))
    laid = Ribbons(families)
    segments = smear(domain.data, actuator, laid)
    winding: Effect = SmearedWinding(segments, EA)
    if bedding is not None:
        sine = np.array([family.sine for family in families])[segments.family]
        winding = BeddedWinding(segments, EA, bedding, Run(sine, actuator.winding_perimeter))
    regions = REGIONS if isinstance(actuator, HemicircleActuator) else ("wall",)
    make = functools.partial(Section, length=actuator.length, twisted=True, sideways=sideways)
    return Scene(domain, [law("neo-hooke", regions, scale=1e-9), winding], make)


def _potential(scene: Scene) -> BeddedPotential:
    found = scene.discrete[KEY]
    assert isinstance(found, BeddedPotential)
    return found


def _stretched(scene: Scene, around: float, along: float) -> None:
    body, nodes = scene.body, scene.domain.data.nodes
    w = np.zeros(body.owned)
    w[body.node_dofs[:, :2]] = nodes[:, :2] * (around - 1)
    scene.set_scalar(STRETCH, along)
    scene.set(w)


def _rest(scene: Scene) -> dict[str, float]:
    """Scalars of a state that bends and twists."""
    given = {STRETCH: 1.01, CURVATURE: 0.004, TWIST: 0.006, PRESSURE: 0.02}
    return dict.fromkeys(_scalars(scene), 0.0) | given


def test_tube_stores_what_its_threads_do_in_series_with_their_bed() -> None:
    around, along, pressure = 1.02, 1.01, 0.03
    scene = _section(BED, FAMILIES[:2], TUBE)
    scene.set_scalar(PRESSURE, pressure)
    _stretched(scene, around, along)
    radius, exact = TUBE.radius + TUBE.wall, 0.0
    for family in FAMILIES[:2]:
        sine, cosine = family.sine, family.cosine
        strain = math.hypot(around * sine, along * cosine) - 1
        across = math.hypot(around * cosine, along * sine) - 1
        k = BED.normal * math.exp(BED.across * across + BED.pressure * pressure / BED.normal)
        series = 1 / (1 / EA + (sine**2 / radius) ** 2 / k)
        exact += math.pi * radius / family.spacing * series * strain**2 / 2
        assert series < 0.5 * EA
    assert scene.energies()[KEY] == pytest.approx(exact, rel=2e-4)


def test_slip_alone_stores_what_bed_and_threads_do() -> None:
    # s = c sin(s/r) along threads that are rigid against nothing: their strain is −s'
    family, amplitude = FAMILIES[0], 0.01
    scene = _section(Bedding(1e200, 4.0), (family,), TUBE)
    scene.set_scalar("slip 0 1", amplitude)
    _stretched(scene, 1.0, 1.0)
    radius = TUBE.radius + TUBE.wall
    length = math.pi * radius / family.spacing
    strain = amplitude * family.sine / radius
    exact = length / 2 * (4.0 * amplitude**2 / 2 + EA * strain**2 / 2)
    assert scene.energies()[KEY] == pytest.approx(exact, rel=1e-4)


def test_rigid_bed_is_the_smeared_winding() -> None:
    found = []
    for bedding in (None, RIGID):
        scene = _section(bedding)
        for name, value in _rest(scene).items():
            if name in scene.body.scalars:
                scene.set_scalar(name, value)
        scene.set(np.random.default_rng(1).uniform(-0.03, 0.03, scene.body.owned))
        v = np.random.default_rng(2).uniform(-1, 1, scene.body.owned)
        product = times_tangent(scene, v)
        (key,) = scene.discrete
        found.append((scene.energies()[key], scene.residual()[0], product))
    (energy, forces, product), (same, alike, equal) = found
    assert same == pytest.approx(energy, rel=1e-13)
    assert np.abs(alike - forces).max() <= 1e-13 * np.abs(forces).max()
    assert np.abs(equal - product).max() <= 1e-13 * np.abs(product).max()


def _scalars(scene: Scene) -> list[str]:
    return [*scene.natural, PRESSURE]


def _moved(scene: Scene, w: np.ndarray, rest: dict[str, float], by: float, way: Way) -> None:
    fields, scalars = way
    for name, value in rest.items():
        scene.set_scalar(name, value + by * scalars[name])
    scene.set(w + by * fields)


@pytest.mark.parametrize("half", [True, False])
def test_forces_and_tangent_are_derivatives_in_fields_and_scalars(half: bool) -> None:
    scene = _section(BED, half=half, sideways=not half)
    rng = np.random.default_rng(3)
    w = perturb(scene, 0.02, 4)
    rest = {name: 1e-3 * float(rng.uniform(-1, 1)) for name in _scalars(scene)}
    rest |= {STRETCH: 1.01, CURVATURE: 0.004, TWIST: 0.006, PRESSURE: 0.02}
    if not half:
        rest[SIDE] = 0.003
    fields = np.where(scene.free[: len(w)], rng.uniform(-1, 1, len(w)), 0.0)
    way = (fields, {name: float(rng.uniform(-1, 1)) for name in rest})
    potential = _potential(scene)
    step, work, forces = 1e-5, [], []
    for sign in (1, -1):
        _moved(scene, w, rest, sign * step, way)
        work.append(potential.energy())
        forces.append(_gradient(scene, potential))
    _moved(scene, w, rest, 0.0, way)
    slope = (work[0] - work[1]) / (2 * step)
    here = _gradient(scene, potential)
    direction = np.r_[fields, [way[1][name] for name in _scalars(scene)]]
    assert here @ direction == pytest.approx(slope, rel=1e-7)
    rate = (forces[0] - forces[1]) / (2 * step)
    product = _hessian(scene, potential, direction)
    assert np.abs(product - rate).max() <= 1e-6 * np.abs(rate).max()


def _gradient(scene: Scene, potential: BeddedPotential) -> np.ndarray:
    b = np.zeros(scene.body.local)
    potential.add_residual(b)
    return np.r_[b, [-potential.conjugate(name) for name in _scalars(scene)]]


def _hessian(scene: Scene, potential: BeddedPotential, way: np.ndarray) -> np.ndarray:
    names, n = _scalars(scene), scene.body.local
    fields, scalars = way[:n], way[n:]
    out = np.zeros(n)
    blocks = potential.tangent_blocks()
    parts = np.einsum("nij,nj->ni", blocks, fields[potential.block_dofs])
    np.add.at(out, potential.block_dofs, parts)
    rows = np.zeros(len(names))
    for number, name in enumerate(names):
        load = np.zeros(n)
        potential.add_load(name, load)
        out += load * scalars[number]
        rows[number] = load @ fields
        rows[number] += sum(
            potential.second_derivative(name, other) * value
            for other, value in zip(names, scalars, strict=True)
        )
    return np.r_[out, rows]


def test_forces_are_predicted_to_first_order() -> None:
    scene = _section(BED)
    w = perturb(scene, 0.02, 5)
    rng = np.random.default_rng(6)
    fields = np.where(scene.free[: len(w)], rng.uniform(-1, 1, len(w)), 0.0)
    way = (fields, {name: float(rng.uniform(-1, 1)) for name in _rest(scene)})
    rest, potential, errors = _rest(scene), _potential(scene), []
    for size in (1e-3, 1e-4):
        _moved(scene, w, rest, 0.0, way)
        before = potential.state()
        scene.assemble_tangent()
        moves = {name: size * rate for name, rate in way[1].items()}
        scene.predict(size * way[0], moves)
        across = potential._predicted_across
        assert across is not None
        found = {"force": potential.predicted, "across": across}
        _moved(scene, w, rest, size, way)
        after = potential.state()
        errors.append(
            [
                np.abs(found[key] - after[key]).max() / np.abs(after[key] - before[key]).max()
                for key in found
            ]
        )
    assert np.all(np.array(errors[1]) < 0.2 * np.array(errors[0]))


def test_unknowns_of_the_slip() -> None:
    # three of the four families go around: sines alone where half is modelled
    half, whole = (_section(BED, half=each) for each in (True, False))
    assert len(half.added) == 3 * MODES
    assert len(whole.added) == 6 * MODES
    assert not any(item.multiplier for item in half.added.values())


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ((0.0, 1.0), "normal 0.0 MPa"),
        ((1.0, -1.0), "along -1.0 MPa"),
        ((1.0, 1.0, math.nan), "across = nan"),
    ],
)
def test_wrong_numbers_are_refused(numbers: tuple[float, ...], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Bedding(*numbers)

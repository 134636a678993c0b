"""Every effect: R = ∂Π/∂w, K = ∂R/∂w, symmetric, and blind to rigid motions."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.contact import Contact, Cylinder, Obstacle, Plane
from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.incompressible import Incompressible
from fem.kinematics.domain import Domain
from fem.scene import Scene
from geometry.checks import region_volumes
from materials.laws.table import LAWS
from tests.fem.parts import (
    CELLS,
    EA,
    Floats,
    calibrated,
    gravity,
    law,
    perturb,
    smeared,
    stub,
    times_tangent,
    winding,
)

REGIONS = ("wall", "floor")
# The fibers' matrix lives in the sparsity of a solid: one so soft that it does not count.
SOFT = law("neo-hooke", REGIONS, scale=1e-9)


def obstacle(shape: Obstacle) -> Contact:
    """Something that reaches into the stub at rest."""
    return Contact("it", shape, ("outer", "tip"), 30.0)


def rubber(name: str, _: Domain) -> list[Effect]:
    """Every region of one law."""
    return [law(name, REGIONS)]


EFFECTS: dict[str, Callable[[Domain], list[Effect]]] = {
    **{name: functools.partial(rubber, name) for name in LAWS},
    "incompressible": lambda _: [Incompressible()],
    "perturbed": lambda _: [Incompressible({"wall": 40.0, "floor": 11.0})],
    "pressure": lambda _: [ChamberPressure()],
    "ribbon": lambda domain: [SOFT, winding(domain, 0.38)],
    "line": lambda domain: [SOFT, winding(domain, 0.0)],
    "tension-only": lambda domain: [SOFT, winding(domain, 0.38, tension_only=True)],
    "smeared": lambda domain: [SOFT, smeared(domain)],
    "calibrated": lambda domain: [SOFT, calibrated(domain)],
    "calibrated, tension only": lambda domain: [SOFT, calibrated(domain, tension_only=True)],
    "gravity": lambda _: [gravity(REGIONS)],
    "plane": lambda _: [SOFT, obstacle(Plane((0.0, 3.0, 5.0), (0.2, 1.0, -0.5)))],
    "bar": lambda _: [SOFT, obstacle(Cylinder((-2.0, 6.0), 7.0))],
}
LINEAR = {"gravity"}
IN_PLACE = {"gravity", "plane", "bar"}
"""What acts on the body depends on where it is."""
AMPLITUDE = 0.03
"""Of the random displacements in mm: strains of some 5 %."""
LONG = pytest.mark.long
STENCIL = ((1, 2 / 3), (2, -1 / 12))
"""Central differences of order 4."""


def both(names: Iterable[str]) -> pytest.MarkDecorator:
    """Effects in both elements.

    A law is the same function in both; compiling its kernels takes seconds in each.
    """
    pairs = itertools.product(names, CELLS)
    return pytest.mark.parametrize(
        ("name", "cell"),
        [
            pytest.param(name, cell, marks=LONG if name in LAWS and cell == "tetrahedron" else ())
            for name, cell in pairs
        ],
    )


@functools.cache
def _scene(name: str, cell: str) -> Scene:
    domain = stub(cell)
    return Scene(domain, EFFECTS[name](domain))


def _step(name: str) -> float:
    """In mm; so small that no fiber is caught going slack, and no point touching."""
    return 1e-7 if name in {"tension-only", "calibrated, tension only", "plane", "bar"} else 1e-4


def _direction(scene: Scene, seed: int) -> Floats:
    return np.random.default_rng(seed).uniform(-1, 1, scene.body.owned)


def _potential(scene: Scene, w: Floats) -> float:
    scene.set(w)
    return sum(scene.energies().values())


def _residual(scene: Scene, w: Floats) -> Floats:
    scene.set(w)
    return scene.residual()[0]


def _differences(f: Callable[[Floats], Floats | float], w: Floats, v: Floats, h: float) -> Floats:
    return np.asarray(sum(c * (f(w + k * h * v) - f(w - k * h * v)) for k, c in STENCIL)) / h


def _times_tangent(scene: Scene, w: Floats, v: Floats) -> Floats:
    scene.set(w)
    return times_tangent(scene, v)


@both(EFFECTS)
def test_residual_is_the_derivative_of_the_potential(name: str, cell: str) -> None:
    # along R itself plus noise, so that the derivative is not small by chance; a step of 1e-4 mm
    # leaves 1e-9 of truncation and of round-off
    scene = _scene(name, cell)
    w = perturb(scene, AMPLITUDE, 1)
    r = _residual(scene, w)
    v = r / np.abs(r).max() + _direction(scene, 2)
    slope = float(_differences(lambda at: _potential(scene, at), w, v, _step(name)))
    assert r @ v == pytest.approx(slope, rel=1e-7)
    assert np.abs(r).max() > 0


@both(EFFECTS)
def test_tangent_is_the_derivative_of_the_residual(name: str, cell: str) -> None:
    # K is stored as one triangle, so an unsymmetric K would fail here as well
    scene = _scene(name, cell)
    w = perturb(scene, AMPLITUDE, 3)
    v = _direction(scene, 4)
    slope = _differences(lambda at: _residual(scene, at), w, v, _step(name))
    product = _times_tangent(scene, w, v)
    assert np.abs(product - slope).max() <= 1e-7 * max(np.abs(slope).max(), 1e-10)
    assert (name in LINEAR) == (not np.abs(product).max() > 0)


@both(EFFECTS)
def test_second_derivative_is_symmetric(name: str, cell: str) -> None:
    # of the residual, without K: a load without a potential would have no symmetric tangent
    scene = _scene(name, cell)
    w = perturb(scene, AMPLITUDE, 5)
    a, b = _direction(scene, 6), _direction(scene, 7)
    along_a = _differences(lambda at: _residual(scene, at), w, a, _step(name))
    along_b = _differences(lambda at: _residual(scene, at), w, b, _step(name))
    scale = float(np.linalg.norm(along_a) * np.linalg.norm(b) / np.sqrt(len(b)))
    assert float(b @ along_a) == pytest.approx(float(a @ along_b), abs=1e-7 * max(scale, 1e-10))


@both(name for name in EFFECTS if name not in IN_PLACE)
def test_rigid_motion_changes_nothing(name: str, cell: str) -> None:
    # Π is objective, and forces turn with the body
    scene = _scene(name, cell)
    body, nodes = scene.body, scene.domain.data.nodes
    w = perturb(scene, AMPLITUDE, 8)
    before, forces = _potential(scene, w), _residual(scene, w)
    turn = Rotation.from_rotvec([0.9, -1.7, 0.6]).as_matrix()
    moved = w.copy()
    x = nodes + w[body.node_dofs]
    moved[body.node_dofs] = x @ turn.T + [20.0, -7.0, 11.0] - nodes
    after, turned = _potential(scene, moved), _residual(scene, moved)
    expected = forces.copy()
    expected[body.node_dofs] = forces[body.node_dofs] @ turn.T
    assert after == pytest.approx(before, rel=1e-10)
    assert np.abs(turned - expected).max() < 1e-10 * np.abs(forces).max()


def test_gravity_does_the_work_of_the_weight() -> None:
    # Π under a translation is −m g · c, exactly
    scene = _scene("gravity", "hexahedron")
    scene.set_scalar("gravity", 0.4)
    shift = np.array([3.0, -2.0, 5.0])
    w = np.zeros(scene.body.owned)
    w[scene.body.node_dofs] = shift
    mass = 1.07e-6 * sum(region_volumes(scene.domain.data).values())
    work = 0.4 * mass * (shift @ [1200.0, -9810.0, 500.0])
    assert _potential(scene, w) == pytest.approx(-work, rel=1e-9)


def test_pressure_is_conjugate_to_the_volume() -> None:
    # ∂Π/∂P = −V, and ∂R/∂P is the load that conditions use
    scene = _scene("pressure", "hexahedron")
    w = perturb(scene, AMPLITUDE, 9)
    scene.set_scalar("pressure", 0.7)
    r = _residual(scene, w)
    assert scene.energies()["ChamberPressure"] == pytest.approx(-0.7 * scene.conjugate("pressure"))
    assert r == pytest.approx(0.7 * scene.load("pressure"), abs=1e-12 * np.abs(r).max())


def test_slack_fibers_carry_nothing() -> None:
    # a uniform contraction makes every fiber slack, an expansion none
    scene = _scene("tension-only", "hexahedron")
    nodes = scene.domain.data.nodes
    for factor, carries in ((-0.02, False), (0.02, True)):
        w = np.zeros(scene.body.owned)
        w[scene.body.node_dofs] = factor * nodes
        scene.set(w)
        potential = scene.discrete["Winding"]
        assert (potential.energy() > 0) == carries
        e = scene.discrete["Winding"].strain  # type: ignore[attr-defined]
        assert e == pytest.approx(factor, abs=1e-12)


def test_round_off_at_rest_slackens_no_fiber() -> None:
    # strains of ±1e-14 are none: their sign decided which fibers stood in the first tangent
    scene = _scene("tension-only", "hexahedron")
    v = _direction(scene, 6)
    found = []
    for factor in (-1e-14, 0.0, 1e-14):
        w = np.zeros(scene.body.owned)
        w[scene.body.node_dofs] = factor * scene.domain.data.nodes
        scene.predict(None)
        found.append(_times_tangent(scene, w, v))
    # what is left is the geometric part of a force of 1e-11 N
    for product in found:
        assert product == pytest.approx(found[1], abs=1e-9 * EA)
    assert np.abs(found[1]).max() > 1e-3 * EA


STATES = {
    "rest": (1.0, 1.0, 1.0),
    "uniaxial": (0.8, 0.8, 1.5625),
    "equibiaxial": (1.3, 1.3, 0.6),
    "volumetric": (1.1, 1.1, 1.1),
}
"""Stretches along x, y and z, equal ones among them."""


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("name", LAWS)
def test_derivatives_where_stretches_are_equal(name: str, state: str) -> None:
    # there the stretches themselves have no derivatives, the energies have
    scene = _scene(name, "hexahedron")
    w = np.zeros(scene.body.owned)
    w[scene.body.node_dofs] = scene.domain.data.nodes * (np.array(STATES[state]) - 1)
    v, h = _direction(scene, 11), _step(name)
    r = _residual(scene, w)
    slope = float(_differences(lambda at: _potential(scene, at), w, v, h))
    work = float(np.linalg.norm(v)) * max(float(np.linalg.norm(r)), 1e-3)
    assert r @ v == pytest.approx(slope, abs=1e-8 * work)
    slopes = _differences(lambda at: _residual(scene, at), w, v, h)
    product = _times_tangent(scene, w, v)
    assert np.abs(product - slopes).max() <= 1e-7 * np.abs(slopes).max()


def _homogeneous(name: str, parameters: dict[str, float], stretch: Floats) -> tuple[float, Floats]:
    """Energy, and forces, of the stub under stretches along x, y and z."""
    scene = Scene(stub("hexahedron"), [Elastic(name, dict.fromkeys(REGIONS, parameters))])
    w = np.zeros(scene.body.owned)
    w[scene.body.node_dofs] = scene.domain.data.nodes * (stretch - 1)
    return _potential(scene, w), _residual(scene, w)


@LONG
@pytest.mark.parametrize("stretch", [(1.0, 1.0, 1.0), (0.8, 0.8, 1.5625), (1.4, 0.9, 0.7)])
def test_ogden_is_the_classical_laws_to_round_off(stretch: tuple[float, float, float]) -> None:
    # the spectral path against the path of the invariants, α = 2 and (2, −2)
    for law_, classical, ogden in (
        ("neo-hooke", {"mu": 0.3}, {"mu1": 0.3, "alpha1": 2.0}),
        (
            "mooney-rivlin",
            {"c10": 0.1, "c01": 0.04},
            {"mu1": 0.2, "alpha1": 2.0, "mu2": 0.08, "alpha2": -2.0},
        ),
    ):
        energy, forces = _homogeneous(law_, classical, np.array(stretch))
        same, alike = _homogeneous("ogden", ogden, np.array(stretch))
        assert same == pytest.approx(energy, rel=1e-12, abs=1e-11)
        assert np.abs(alike - forces).max() <= 1e-12 * max(np.abs(forces).max(), 1.0)


def test_no_forces_beyond_the_limiting_stretch() -> None:
    # I1 − 3 = 2²  + 2/2 − 3 = 2 beyond jm = 1.9: nothing that Newton could take for a force
    beyond = np.array([2**-0.5, 2**-0.5, 2.0])
    energy, forces = _homogeneous("gent", {"mu": 0.3, "jm": 1.9}, beyond)
    assert np.isnan(energy)
    assert np.isnan(forces).any()
    energy, forces = _homogeneous("gent", {"mu": 0.3, "jm": 2.1}, beyond)
    assert np.isfinite(energy)
    assert np.isfinite(forces).all()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name == "yeoh" else LONG) for name in LAWS]
)
def test_a_law_acts_in_its_own_regions_alone(name: str) -> None:
    # and changes nothing in those of another law, however far these are stretched
    domain, other = stub("hexahedron"), law("neo-hooke", ["floor"])
    both = [law(name, ["wall"]), other] if name != "neo-hooke" else [law(name, REGIONS)]
    scene = Scene(domain, both)
    w = perturb(scene, AMPLITUDE, 13)
    energies = scene.energies()
    alone = Scene(domain, [law(name, ["wall"])])
    assert sum(energies.values()) == pytest.approx(
        _potential(alone, w) + _potential(Scene(domain, [other]), w), rel=1e-12
    )
    w[scene.body.node_dofs] = domain.data.nodes * (np.array([4.0, 0.5, 0.5]) - 1)
    assert np.isfinite(_residual(Scene(domain, [law(name, [])]), w)).all()


def test_one_ogden_region_of_more_terms_than_another() -> None:
    # a term that a region lacks is zero there; one that all lack does not exist
    short, long = {"mu1": 0.3, "alpha1": 1.5}, {"mu1": 0.2, "alpha1": 2.5, "mu2": 0.1, "alpha2": -1}
    mixed = Elastic("ogden", {"wall": dict(short), "floor": dict(long)})
    apart = [
        Elastic("ogden", {"wall": dict(short)}).law.used([mixed.regions["wall"]]),
        mixed.law.used(mixed.regions.values()),
    ]
    assert apart == [["mu1", "alpha1"], ["mu1", "alpha1", "mu2", "alpha2"]]
    domain = stub("hexahedron")
    w = perturb(Scene(domain, [mixed]), AMPLITUDE, 12)
    whole = _potential(Scene(domain, [mixed]), w)
    parts = 0.0
    for region, row in (("wall", short), ("floor", long)):
        absent = {"wall": "floor", "floor": "wall"}[region]
        rows = {region: dict(row), absent: {"mu1": 1e-30, "alpha1": 1.0}}
        parts += _potential(Scene(domain, [Elastic("ogden", rows)]), w)
    assert whole == pytest.approx(parts, rel=1e-12)

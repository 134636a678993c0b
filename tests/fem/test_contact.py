"""Contact with rigid obstacles: exact forces, touch and lift-off, numbers that are no code."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
import pytest
from mpi4py import MPI

from fem.effects.contact import Contact, Cylinder, Obstacle, Plane
from fem.effects.effect import Effect
from fem.effects.elastic import Elastic
from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp
from fem.kinematics.domain import Domain
from fem.march.hooks import AfterStep, Hook
from fem.march.march import March
from fem.march.records import Ramp, Rules, State
from fem.results.measures import balance
from fem.results.touch import Probe, Touch
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome, Settings
from tests.exact.solids import box
from tests.fem.parts import Floats, stub

LENGTH, SIDE = 100.0, 5.0
MU, WEIGHT = 0.3, 2e-7
"""Shear modulus in MPa and weight in N/mm³ of a beam that sags by half a per cent of its length."""
LOAD = WEIGHT * SIDE**2
RIGIDITY = 3 * MU * SIDE**4 / 12
SAG = LOAD * LENGTH**4 / (8 * RIGIDITY)
STIFFNESS = 20.0


@dataclasses.dataclass
class Beam:
    """A cantilever along z over a table; y is up."""

    scene: Scene
    march: March
    contact: Contact


def beam(gap: float, hooks: Sequence[Hook] = ()) -> Beam:
    """A beam of neo-Hookean rubber, clamped at z = 0, that sinks onto a table."""
    domain = Domain(box((SIDE, SIDE, LENGTH), (1, 1, 24)), MPI.COMM_SELF)
    table = Contact("table", Plane((0.0, -gap, 0.0), (0.0, 2.0, 0.0)), ("front",), STIFFNESS)
    effects: list[Effect] = [
        Elastic("neo-hooke", {"solid": {"mu": MU}}),
        Incompressible(),
        Gravity({"solid": WEIGHT}, (0.0, -1.0, 0.0)),
        Clamp("bottom"),
        table,
    ]
    scene = Scene(domain, effects)
    newton = Newton(scene, domain.comm, Settings(iterations=25))
    rules = Rules(memory=2, jump=np.inf)
    march = March(scene, newton, rules, hooks=hooks)
    return Beam(scene, march, table)


def test_propped_cantilever() -> None:
    # R = 3/8 q L (1 − gap/sag) for a gap of half the sag: Euler and Bernoulli; shear adds 0.3 %, a
    # clamp that holds the width some 0.5 %, the edge that carries lies up to 0.2 % short of z = L,
    # which counts threefold
    body = beam(gap=SAG / 2)
    report = body.march.run([Ramp("gravity", 1.0, first=0.25, largest=0.25)])
    assert report.status == "converged", report.reason
    found = balance(body.scene)
    force = found.supports["Contact[table]"].force
    assert force[1] == pytest.approx(3 / 16 * LOAD * LENGTH, rel=0.02)
    # without friction a level table pushes straight up
    assert np.abs(force[[0, 2]]).max() < 1e-12
    assert found.supports["clamp"].force[1] + force[1] == pytest.approx(LOAD * LENGTH, rel=1e-8)
    assert max(found.force, found.moment) < 1e-7
    touch = Probe(body.scene, body.contact).read()
    # what touches is the last element at most, and yields by p/k
    assert 0 < touch.area < SIDE * LENGTH / 24
    assert touch.gap == pytest.approx(0, abs=10 * force[1] / touch.area / STIFFNESS)
    assert touch.gap < 0


def test_touch_and_lift_off_leave_no_trace() -> None:
    # elastic and without friction: at every weight the beam comes back to where it was, and leaves
    # the table where it met it, at half the weight
    stops = (0.25, 0.4, 0.6, 0.8)
    met: dict[float, list[tuple[Floats, float]]] = {stop: [] for stop in stops}

    def keep(state: State, _: Outcome) -> None:
        weight = round(state.scalars["gravity"], 9)
        if weight in met:
            met[weight].append((state.w, probe.read().gap))

    body = beam(SAG / 2, [AfterStep(keep)])
    probe = Probe(body.scene, body.contact)
    ramps = [Ramp("gravity", end, first=0.25, stops=stops) for end in (0.8, 0.25)]
    report = body.march.run(ramps)
    assert report.status == "converged", report.reason
    for stop in (0.25, 0.4, 0.6):
        (there, gap), (back, _) = met[stop]
        assert np.abs(there - back).max() < 1e-8 * LENGTH
        assert (gap < 0) == (stop > 0.5)
    assert not body.scene.force("Contact[table]").any()


def test_without_touch_the_obstacle_is_not_there() -> None:
    # nothing acts at a distance: with the table far below, forces and tangent are those without it
    body = beam(gap=10 * SAG)
    without = Scene(
        body.scene.domain,
        [e for e in body.scene.effects.values() if not isinstance(e, Contact)],
    )
    w = 0.01 * np.random.default_rng(1).uniform(-1, 1, body.scene.body.owned)
    for scene in (body.scene, without):
        scene.set_scalar("gravity", 1.0)
        scene.set(w)
    assert body.scene.residual()[0] == pytest.approx(without.residual()[0], abs=1e-15)
    assert body.scene.energies()["Contact[table]"] == 0.0
    products = []
    for scene in (body.scene, without):
        x, y = scene.assemble_tangent().createVecs()
        x.array_w[:] = w
        scene.matrix.mult(x, y)
        products.append(y.array_r.copy())
    assert products[0] == pytest.approx(products[1], abs=1e-14)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (Plane((0, 1, 2), (0, 1, 0)), Plane((5, -3, 0), (1, 2, -3))),
        (Cylinder((-30, 40), 20), Cylinder((-10, 4), 3)),
    ],
    ids=["plane", "bar"],
)
def test_numbers_are_no_code(one: Obstacle, other: Obstacle) -> None:
    # a sweep over gaps, bars and stiffnesses compiles once
    domain = stub("hexahedron")
    scenes = [
        Scene(domain, [Contact("it", obstacle, ("outer", "tip"), k)])
        for obstacle, k in ((one, 1.0), (other, 50.0))
    ]
    assert scenes[0].signatures == scenes[1].signatures


def test_gaps_are_distances() -> None:
    # by hand: 3 over a table that is tilted by 45°, and a point 5 − 2 from a bar
    plane = Plane((0.0, 1.0, 1.0), (0.0, 7.0, 7.0))
    x = np.array([9.0, 1.0 + 3 / np.sqrt(2), 1.0 + 3 / np.sqrt(2)])
    assert plane.gap(x, plane.numbers()) == pytest.approx(3.0)
    bar = Cylinder((1.0, -2.0), 2.0)
    assert bar.gap(np.array([7.0, 4.0, 2.0]), bar.numbers()) == pytest.approx(3.0)


def test_stiffness_must_be_positive() -> None:
    with pytest.raises(ValueError, match="expected a positive value"):
        Contact("it", Cylinder((0, 0), 1), ("outer",), 0.0)


@pytest.mark.parametrize("gap", [0.0, -4.4e-16, 4.4e-16])
def test_a_gap_of_zero_at_rest_touches_nothing(gap: float) -> None:
    # the sign of round-off changed with the thickness of the sheath
    assert not Touch(gap, 0.0, 1e-9).touches
    assert Touch(-1e-6, 1.0, 1e-9).touches

"""Forces and moments of a whole body from what is modelled of it."""

from __future__ import annotations

import numpy as np
import pytest

from fem.effects.gravity import Gravity
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.results.measures import Resultant, balance, resultant
from fem.scene import Scene
from tests.fem.parts import STUB, Floats, law, perturb, stub

REGIONS = ("wall", "floor")
FORCE: Floats = np.array([1.0, -2.0, 3.0])
MOMENT: Floats = np.array([0.3, 0.5, -0.7])


def test_resultants_add_up() -> None:
    both = Resultant(FORCE, MOMENT) + Resultant(2 * FORCE, -2 * MOMENT)
    assert both.force == pytest.approx(3 * FORCE)
    assert both.moment == pytest.approx(-MOMENT)


@pytest.mark.parametrize("half", [False, True])
def test_a_half_has_its_mirror_image(half: bool) -> None:
    scene = Scene(stub("hexahedron", half), [Incompressible()])
    body, nodes = scene.body, scene.domain.data.nodes
    perturb(scene, 0.1, 3)
    vector = np.random.default_rng(4).uniform(-1, 1, body.owned)
    dofs = body.node_dofs[body.owned_nodes]
    forces, x = vector[dofs], nodes[body.owned_nodes] + scene.w[dofs]
    if half:
        mirror = np.array([-1.0, 1.0, 1.0])
        forces, x = np.vstack([forces, mirror * forces]), np.vstack([x, mirror * x])
    found = resultant(scene, vector, None)
    assert found.force == pytest.approx(forces.sum(axis=0), abs=1e-10)
    assert found.moment == pytest.approx(np.cross(x, forces).sum(axis=0), abs=1e-8)


def test_of_some_dofs_the_others_have_no_force() -> None:
    scene = Scene(stub("hexahedron"), [Incompressible()])
    body = scene.body
    perturb(scene, 0.1, 3)
    vector = np.ones(body.owned)
    node = 17
    only = body.node_dofs[[node], 1].astype(np.int32)
    found = resultant(scene, vector, only)
    x = scene.domain.data.nodes[node] + scene.w[body.node_dofs[node]]
    assert found.force == pytest.approx([0.0, 1.0, 0.0])
    assert found.moment == pytest.approx(np.cross(x, [0.0, 1.0, 0.0]))


@pytest.mark.parametrize("half", [False, True])
def test_what_is_left_is_told(half: bool) -> None:
    # at rest nothing bears the weight yet: all of it is left, beside a clamp that holds nothing
    domain = stub("hexahedron", half)
    acceleration = (0.0, -9810.0, 0.0)
    supports = [Clamp(), Symmetry()] if half else [Clamp()]
    weight = Gravity(dict.fromkeys(REGIONS, 1e-6), acceleration)
    scene = Scene(domain, [law("yeoh", REGIONS), Incompressible(), weight, *supports])
    scene.set(scene.w.copy())
    scene.set_scalar("gravity", 1.0)
    found = balance(scene)
    assert found.supports.keys() == {"clamp"}
    held = found.supports["clamp"]
    # the clamped nodes' own share of the weight goes into it at once, the rest is not borne
    whole = 1e-6 * 9810.0 * sum(STUB.region_volumes().values())
    unborne = found.force * np.linalg.norm(held.force)
    assert 0 < held.force[1] < 0.2 * whole
    assert unborne == pytest.approx(whole - held.force[1], rel=2e-3)

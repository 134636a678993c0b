"""Loads on the tip's face: work, tangent, reference point, mirror and half."""

from __future__ import annotations

import numpy as np
import pytest

from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.effects.tip_load import FollowingTipLoad, TipForce, TipMoment
from fem.scene import Scene
from tests.fem.parts import STUB, Floats, law, stub

REGIONS = ("wall", "floor")
STENCIL = ((1, 2 / 3), (2, -1 / 12))
LOADS = {
    "force": (TipForce((0.1, -0.2, 0.3)), TipForce((0.0, -0.2, 0.3))),
    "moment": (TipMoment(3.0), TipMoment(3.0)),
    "follower": (
        FollowingTipLoad((0.1, -0.2, 0.3), (1.0, 2.0, -3.0), True),
        FollowingTipLoad((0.0, -0.2, 0.3), (1.0, 0.0, 0.0), True),
    ),
    "dead moment": (
        FollowingTipLoad((0.1, -0.2, 0.3), (1.0, 2.0, -3.0), False),
        FollowingTipLoad((0.0, -0.2, 0.3), (1.0, 0.0, 0.0), False),
    ),
}


def _scene(load: str, half: bool) -> Scene:
    supports = [Clamp(), *([Symmetry(halves=True)] if half else [])]
    effects = [law("yeoh", REGIONS), Incompressible(), LOADS[load][int(half)], *supports]
    return Scene(stub("hexahedron", half), effects)


class Bordered:
    """Fields and natural scalars as one vector."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.names = scene, list(scene.natural)

    def set(self, x: Floats) -> None:
        for name, value in zip(self.names, x[self.scene.body.owned :], strict=True):
            self.scene.set_scalar(name, float(value))
        self.scene.set(x[: self.scene.body.owned])

    def residual(self, x: Floats) -> Floats:
        self.set(x)
        r = self.scene.residual()[0]
        r[~self.scene.free[: len(r)]] = 0.0
        return np.concatenate([r, [-self.scene.conjugate(name) for name in self.names]])

    def tangent(self, x: Floats, v: Floats) -> Floats:
        self.set(x)
        scene, owned = self.scene, self.scene.body.owned
        matrix = scene.assemble_tangent()
        a, b = matrix.createVecs()
        a.array_w[:] = v[:owned]
        matrix.mult(a, b)
        columns = np.array([scene.load(name) for name in self.names]).reshape(-1, owned)
        corner = [[scene.second_derivative(i, j) for j in self.names] for i in self.names]
        field = b.array_r + v[owned:] @ columns
        field[~scene.free[:owned]] = 0.0
        corner = np.array(corner).reshape(len(self.names), len(self.names))
        return np.concatenate([field, columns @ v[:owned] + corner @ v[owned:]])


@pytest.mark.parametrize("half", [False, True])
@pytest.mark.parametrize("load", LOADS)
def test_bordered_tangent_is_the_derivative_of_the_equations(load: str, half: bool) -> None:
    whole = Bordered(_scene(load, half))
    scene, owned = whole.scene, whole.scene.body.owned
    scene.set_scalar("tip-load", 0.7)
    rng = np.random.default_rng(3)
    x = np.concatenate([0.05 * rng.uniform(-1, 1, owned), np.zeros(len(whole.names))])
    x[owned:] = [scene.scalar(name) + rng.uniform(-0.2, 0.2) for name in whole.names]
    v = rng.uniform(-1, 1, len(x))
    v[:owned][~scene.free[:owned]] = 0.0
    h = 1e-4
    slope = sum(
        c * (whole.residual(x + k * h * v) - whole.residual(x - k * h * v)) for k, c in STENCIL
    )
    product = whole.tangent(x, v)
    assert np.abs(product - slope / h).max() <= 1e-7 * np.abs(slope / h).max()
    tail = slice(owned, None)
    assert product[tail] == pytest.approx(np.asarray(slope)[tail] / h, abs=1e-7)

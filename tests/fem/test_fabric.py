"""A strip of fabric: its energy in states whose strains are known."""

from __future__ import annotations

import numpy as np
import pytest

from fem.effects.fabric import Strip
from fem.kinematics.domain import Domain
from fem.kinematics.section import Section
from fem.kinematics.uniform import CURVATURE, SIDE, STRETCH, TWIST
from fem.scene import Scene
from geometry.bodies.extrude import section_quadrilaterals
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.size import MeshSize
from geometry.winding.strip import Window, lay
from tests.fem.parts import law

BOX = RectangleActuator(width=12, height=10, length=24, wall=2, floor=2, cap=5)
STIFF = 400.0


def _scene(*strips: Strip) -> Scene:
    domain = Domain(section_quadrilaterals(BOX, MeshSize(section=1, half=False)))
    soft = law("neo-hooke", ("wall", "floor"), scale=1e-9)
    return Scene(
        domain,
        [soft, *strips],
        lambda d, fields: Section(d, fields, BOX.length, twisted=True, sideways=True),
    )


def _strip(name: str, window: Window, tension_only: bool = False) -> Strip:
    mesh = section_quadrilaterals(BOX, MeshSize(section=1, half=False))
    return Strip(name, lay(mesh, BOX, window), STIFF, tension_only)


def test_warp_and_weft_store_what_their_strains_say() -> None:
    # on the right side, below its middle, stretched along the axis and narrower across
    window = Window(BOX.winding_perimeter / 4 + 0.55, 3.3)
    scene = _scene(_strip("right", window))
    body, nodes = scene.body, scene.domain.data.nodes
    x = float(nodes[:, 0].max())
    stretch, narrow, k, side = 1.1, 0.06, 0.02, -0.015
    for name, value in {STRETCH: stretch, CURVATURE: k, SIDE: side, TWIST: 0.0}.items():
        scene.set_scalar(name, value)
    w = np.zeros(body.owned)
    w[body.node_dofs[:, 0]] = -narrow * nodes[:, 0]
    w[body.node_dofs[:, 1]] = -narrow * nodes[:, 1]
    body.w.x.array[:] = w
    for discrete in scene.discrete.values():
        discrete.update(body.w.x.array)
    middle = (BOX.outline_top + BOX.outline_bottom) / 2
    points, weights = np.polynomial.legendre.leggauss(8)
    y = middle - 0.55 + 1.65 * points
    warp = stretch - 1 + (1 - narrow) * (k * y - side * x)
    exact = STIFF / 2 * 1.65 * float(weights @ (warp**2 + narrow**2))
    assert scene.energies()["Strip[right]"] == pytest.approx(exact, rel=1e-9)


def test_fabric_that_carries_tension_only_goes_slack() -> None:
    window = Window(0.0, 4.0)
    scene = _scene(_strip("firm", window), _strip("slack", window, True))
    scene.set_scalar(STRETCH, 0.9)
    scene.set(np.zeros(scene.body.owned))
    energies = scene.energies()
    assert energies["Strip[firm]"] == pytest.approx(STIFF / 2 * 4.0 * 0.1**2, rel=1e-9)
    assert energies["Strip[slack]"] == pytest.approx(0, abs=1e-12)


def test_there_is_none_without_stiffness() -> None:
    with pytest.raises(ValueError, match="positive"):
        Strip("none", _strip("one", Window(0.0, 1.0)).segments, 0.0)

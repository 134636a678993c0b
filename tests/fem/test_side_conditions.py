"""Side conditions of an equilibrium: their rows and slopes are derivatives of their values."""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.incompressible import Incompressible
from fem.kinematics.section import Section
from fem.kinematics.uniform import CURVATURE, STRETCH, TWIST, CurvatureAngle
from fem.scene import Scene
from fem.solver.bordered import SideCondition
from fem.solver.side_conditions import GivenConjugate, GivenFunctional, Stationary
from tests.fem.parts import SHORT, perturb
from tests.fem.test_uniform import STENCIL, _domain, _effects

SCALE = 0.37
"""N; a scale of forces that is not one."""


@functools.cache
def _scene() -> Scene:
    # fibers: a potential with own code, in which no pressure enters
    effects = [*_effects(_domain("section"), "smeared"), Incompressible(), ChamberPressure()]
    make = functools.partial(Section, length=SHORT.length, twisted=True)
    return Scene(_domain("section"), effects, make)


CONDITIONS: dict[str, Callable[[Scene], SideCondition]] = {
    "volume": lambda scene: GivenConjugate(scene, "pressure", 1.1 * 100.0),
    "loss of volume": lambda scene: GivenConjugate(scene, "pressure", -50.0),
    "moment": lambda scene: Stationary(scene, CURVATURE),
    "axial force": lambda scene: Stationary(scene, STRETCH),
    "torque": lambda scene: Stationary(scene, TWIST),
    "angle": lambda scene: GivenFunctional(CurvatureAngle(scene.body), 0.2),  # type: ignore
}


@pytest.mark.parametrize("name", CONDITIONS)
def test_rows_and_slopes_are_derivatives(name: str) -> None:
    scene = _scene()
    w = perturb(scene, 0.03, 1)
    at = {CURVATURE: 0.02, STRETCH: 0.97, TWIST: 0.013, "pressure": 0.02}
    for key, value in at.items():
        scene.set_scalar(key, value)
    scene.force_scale = SCALE
    scene.predict(None)
    condition = CONDITIONS[name](scene)
    rng = np.random.default_rng(2)
    v = np.where(scene.free[: len(w)], rng.uniform(-1, 1, len(w)), 0.0)
    scene.set(w)
    rates: dict[str | None, float] = {None: float(condition.row() @ v)}
    rates |= {key: condition.slope(key) for key in at}

    def along(h: float, key: str | None) -> float:
        for other, value in at.items():
            scene.set_scalar(other, value + (h if other == key else 0.0))
        scene.set(w + h * v if key is None else w)
        return condition.value()

    for which, found in rates.items():
        h = 1e-4
        exact = sum(c * (along(k * h, which) - along(-k * h, which)) for k, c in STENCIL) / h
        assert found == pytest.approx(exact, rel=1e-6, abs=1e-9), which
        along(0.0, None)


def test_values_are_relative() -> None:
    # 1 is a large error: a volume by the volume asked for, a moment by force times size
    scene = _scene()
    perturb(scene, 0.03, 1)
    volume = scene.conjugate("pressure")
    assert GivenConjugate(scene, "pressure", volume / 2).value() == pytest.approx(1.0)
    assert GivenConjugate(scene, "pressure", -volume).value() == pytest.approx(2.0)
    # also by a small one: an actuator of a tenth of a millimetre
    assert GivenConjugate(scene, "pressure", 1e-3).value() == pytest.approx(1e3 * volume - 1)
    scene.force_scale = SCALE
    height, span = np.ptp(scene.domain.data.nodes[:, 1]), scene.body.span
    assert scene.body.size_of(STRETCH) == 1.0
    for name, size in {STRETCH: 1.0, CURVATURE: 1 / height, TWIST: 1 / height}.items():
        lever = span / size
        exact = -scene.conjugate(name) / (SCALE * lever)
        assert scene.body.size_of(name) == pytest.approx(size)
        assert Stationary(scene, name).value() == pytest.approx(exact)
    angle = CurvatureAngle(scene.body)  # type: ignore[arg-type]
    assert GivenFunctional(angle, 0.2).value() == pytest.approx(angle.value() - 0.2)

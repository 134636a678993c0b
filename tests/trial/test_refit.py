"""A scene with other numbers is the scene that would be compiled from them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.scene import Scene
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.models.parts import build
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.loads import bent
from fiberbend.uniform.small import Small
from tests.materials.rubber import RUBBERS
from tests.trial.cases import Data, checked, radians, shipped, under, wound

Array = np.ndarray[Any, Any]
STRIP = {"strip": {"at": "right", "width": "4 mm", "thickness": "0.1 mm", "modulus": "100 MPa"}}


def derivatives(scene: Scene, w: Array) -> list[Array]:
    """Residual, tangent times a vector, and volume at a state off rest."""
    scene.set_scalar("pressure", 0.02)
    scene.set_scalar("curvature", 0.004)
    scene.set(w)
    scene.predict(None)
    residual, _ = scene.residual()
    matrix = scene.assemble_tangent()
    x, y = matrix.createVecs()
    x.array_w[:] = np.cos(np.arange(len(w)))
    matrix.mult(x, y)
    return [residual, y.array_r.copy(), np.array([scene.conjugate("pressure")])]


def same(case: Case, other: Case) -> None:
    """The scene of a case, taken over by another one, beside a scene of its own."""
    first = Small(case)
    taken, fresh = Small(other, first), Small(other)
    assert taken.scene is first.scene
    assert fresh.scene is not first.scene
    rng = np.random.default_rng(2)
    w = 1e-2 * rng.standard_normal(taken.scene.body.owned)
    for a, b in zip(derivatives(taken.scene, w), derivatives(fresh.scene, w), strict=True):
        assert np.allclose(a, b, rtol=1e-9, atol=1e-11 * np.abs(b).max())
    assert taken.scene.force_noise == pytest.approx(fresh.scene.force_noise, rel=1e-3)
    assert taken.scene.volume_scale == pytest.approx(fresh.scene.volume_scale, rel=1e-9)
    assert taken.scene.body.symmetry_factor == fresh.scene.body.symmetry_factor


def changed(case: Case, *paths: str) -> Case:
    for path in paths:
        case = with_number(case, path, 1.07 * number(case, path))
    return case


CASES: dict[str, tuple[Data, tuple[str, ...]]] = {
    "section": (shipped("section"), ("actuator.wall", "actuator.length", "materials.wall.c1")),
    "cell": (shipped("cell"), ("actuator.radius", "materials.sheath.c1")),
    "whole cell": (
        shipped("cell", mesh={"section": 1, "axial": "0.9 mm", "symmetry": "full"}),
        ("actuator.wall", "effects.1.winding.pitch"),
    ),
    "twisting": (shipped("single_helix"), ("actuator.floor", "effects.1.winding.pitch")),
    "strip": (
        shipped("section") | {"effects": [*shipped("section")["effects"], STRIP]},
        ("actuator.radius", "effects.2.strip.modulus"),
    ),
    "slack": (
        wound(
            shipped("section"),
            **{"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"},
            tension_only=True,
        ),
        ("actuator.wall", "effects.1.winding.fiber.modulus"),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_other_numbers(name: str) -> None:
    data, paths = CASES[name]
    case = bent(checked(under(data, angle="60 deg")), radians(60))
    same(case, changed(case, *paths))


@pytest.mark.parametrize("law", RUBBERS)
def test_every_law(law: str) -> None:
    """Values that stand for what is not differentiated, as Ogden's law has, among them."""
    rubber = RUBBERS[law]
    wall = {"law": law, "bulk": "200 MPa"}
    data = under(shipped("section"), angle="60 deg")
    data["materials"] = data["materials"] | {"wall": wall | spelled(law, rubber.parameters)}
    case = bent(checked(data), radians(60))
    path = f"materials.wall.{next(iter(rubber.parameters))}"
    same(case, changed(case, path, "actuator.wall", "materials.wall.bulk"))


def spelled(law: str, parameters: Any) -> dict[str, Any]:
    """Parameters of a law as a case gives them."""
    from materials.laws.table import LAWS

    units = {parameter.name: parameter.unit for parameter in LAWS[law].parameters}
    return {
        name: value if units[name] == "1" else f"{value} {units[name]}"
        for name, value in parameters.items()
    }


class _Unknown(ChamberPressure):
    """An effect that says nothing of its structure, under the name of one that does."""

    @property
    def key(self) -> str:
        return "ChamberPressure"

    def structure(self) -> None:
        return None


def test_an_effect_that_says_nothing_is_compiled_anew() -> None:
    case = bent(checked(under(shipped("section"), angle="60 deg")), radians(60))
    scene, model = Small(case).scene, meshed(case)
    mesh = model.mesh(case)
    effects = build(case, mesh, model).effects
    strange = [_Unknown() if isinstance(e, ChamberPressure) else e for e in effects]
    before = dict(scene.effects)
    assert not scene.refit(strange, mesh)
    assert scene.effects == before
    assert scene.refit(effects, mesh)
    finer = case.model_copy(update={"mesh": case.mesh.model_copy(update={"section": 2})})
    assert not scene.refit(effects, model.mesh(finer))

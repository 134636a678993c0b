"""The scene only adds: order never matters, and what is absent leaves no trace."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.incompressible import Incompressible
from fem.effects.supports import Clamp, Symmetry
from fem.kinematics.domain import Domain
from fem.scene import Scene
from tests.fem.parts import Floats, gravity, law, perturb, stub, winding

CELL = "hexahedron"


def _all(domain: Domain) -> dict[str, Effect]:
    """One of each, by a short name."""
    return {
        "wall": law("yeoh", ["wall"]),
        "floor": law("neo-hooke", ["floor"]),
        "incompressible": Incompressible(),
        "pressure": ChamberPressure(),
        "winding": winding(domain, 0.38),
        "gravity": gravity(["wall", "floor"]),
        "clamp": Clamp(),
        "tip": Symmetry("tip", 2),
    }


def _trace(scene: Scene) -> tuple[object, ...]:
    """All that a scene compiled, allocated and holds."""
    return (
        scene.signatures,
        scene.kernels,
        scene.body.size,
        scene.body.names,
        sorted(scene.body.scalars),
        sorted(scene.discrete),
        int((~scene.free).sum()),
    )


def _state(scene: Scene, w: Floats) -> tuple[Floats, dict[str, float]]:
    for name in scene.body.scalars:
        scene.set_scalar(name, 0.3)
    scene.set(w)
    return scene.residual()[0], scene.energies()


def test_order_never_matters() -> None:
    # not even a recompilation: the signatures are the keys of the kernel cache; on a fresh mesh,
    # because the first compilation once changed the mesh's own element and with it every signature
    domain = Domain(stub(CELL).data)
    effects = list(_all(domain).values())
    first = Scene(domain, effects)
    w = perturb(first, 0.03, 1)
    r, energies = _state(first, w)
    rng = np.random.default_rng(3)
    for order in (range(len(effects) - 1, -1, -1), rng.permutation(len(effects))):
        other = Scene(domain, [effects[i] for i in order])
        assert _trace(other) == _trace(first)
        again, same = _state(other, w)
        assert np.array_equal(again, r)
        assert same == energies


LONG = pytest.mark.long
ABSENT = [
    "gravity",
    "incompressible",
    *(pytest.param(n, marks=LONG) for n in ("winding", "pressure", "clamp")),
]


@pytest.mark.parametrize("absent", ABSENT)
def test_absent_effects_leave_no_trace(absent: str) -> None:
    # filtered from a full list, against assembled from the others alone
    domain = stub(CELL)
    present = {name: effect for name, effect in _all(domain).items() if name != absent}
    filtered = Scene(domain, present.values())
    by_hand: dict[str, list[Effect]] = {
        "gravity": [ChamberPressure(), Incompressible(), winding(domain, 0.38), Clamp()],
        "winding": [gravity(["wall", "floor"]), ChamberPressure(), Incompressible(), Clamp()],
        "pressure": [gravity(["wall", "floor"]), Incompressible(), winding(domain, 0.38), Clamp()],
        "incompressible": [
            gravity(["wall", "floor"]),
            ChamberPressure(),
            winding(domain, 0.38),
            Clamp(),
        ],
        "clamp": [
            gravity(["wall", "floor"]),
            ChamberPressure(),
            Incompressible(),
            winding(domain, 0.38),
        ],
    }
    rubber = [law("neo-hooke", ["floor"]), law("yeoh", ["wall"])]
    hand = Scene(domain, [*rubber, *by_hand[absent], Symmetry("tip", 2)])
    full = Scene(domain, _all(domain).values())
    assert _trace(filtered) == _trace(hand)
    assert _trace(filtered) != _trace(full)
    if absent in ("gravity", "pressure", "incompressible"):
        assert filtered.kernels < full.kernels
        assert filtered.signatures["residual"] != full.signatures["residual"]
    if absent == "incompressible":
        assert filtered.body.names == ["u"]
        assert filtered.body.size == full.body.size - 4 * len(domain.data.cells)
        assert not filtered.volumetric.any()


@LONG
def test_each_key_names_what_is_missing() -> None:
    # energies are reported per effect that exists, and for no other
    domain = stub(CELL)
    effects = _all(domain)
    for pair in itertools.combinations(["gravity", "pressure", "winding"], 2):
        scene = Scene(domain, [effects["wall"], effects["floor"], *(effects[n] for n in pair)])
        labels = {"gravity": "Gravity", "pressure": "ChamberPressure", "winding": "Winding"}
        expected = {"Elastic[yeoh]", "Elastic[neo-hooke]", *(labels[name] for name in pair)}
        assert set(scene.energies()) == expected


def test_numbers_are_no_code() -> None:
    # a sweep over materials and pressures must never recompile
    domain = stub(CELL)
    soft = Scene(domain, [law("yeoh", ["wall", "floor"]), Incompressible(), ChamberPressure()])
    stiff = Scene(
        domain, [law("yeoh", ["wall", "floor"], 7.0), Incompressible(), ChamberPressure()]
    )
    stiff.set_scalar("pressure", 0.2)
    assert soft.signatures == stiff.signatures


def test_an_effect_twice_is_refused() -> None:
    domain = stub(CELL)
    with pytest.raises(ValueError, match="ChamberPressure is given twice"):
        Scene(domain, [ChamberPressure(), law("yeoh", ["wall"]), ChamberPressure()])


def test_held_dofs_take_their_values() -> None:
    # prescribed displacements are part of the state, whatever Newton proposes
    domain = stub(CELL)
    scene = Scene(domain, [law("yeoh", ["wall", "floor"]), Incompressible(), ChamberPressure()])
    dofs = scene.body.node_dofs[domain.surface_nodes("tip"), 2]
    scene.fix(dofs, np.linspace(0, 1, len(dofs)))
    scene.set(np.full(scene.body.owned, 0.5))
    assert np.array_equal(scene.w[dofs], np.linspace(0, 1, len(dofs)))
    assert np.array_equal(scene.fixed("prescribed"), np.unique(dofs))

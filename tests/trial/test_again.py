"""Cases solved one after another on scenes that are kept: each as if it were alone."""

from __future__ import annotations

import dataclasses

import pytest

from fiberbend.case.case import Case
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.solve import Trials
from fiberbend.trial.wanted import Answer, Point, Wanted
from fiberbend.uniform.small import Small
from tests.trial.cases import checked, radians, under
from tests.trial.test_solve import BENT

CHANGES: dict[str, dict[str, float]] = {
    "hemicircle": {
        "actuator.wall": 1.1,
        "actuator.radius": 0.9,
        "materials.wall.c1": 1.5,
        "effects.1.winding.pitch": 1.3,
        "actuator.length": 0.5,
    },
    "cell": {"actuator.wall": 1.05, "effects.1.winding.pitch": 0.95, "materials.floor.c1": 1.2},
    "rectangle": {"actuator.width": 1.2, "effects.1.winding.fiber.modulus": 0.5},
    "families": {"effects.1.winding.families.0.angle_from_axis": 0.9, "actuator.wall": 1.2},
}


def alike(one: Answer, other: Answer, rel: float = 1e-8) -> None:
    """Two answers to the same question."""
    assert one.converged == other.converged
    assert len(one.free + one.straight) == len(other.free + other.straight)
    for a, b in zip(one.free + one.straight, other.free + other.straight, strict=True):
        for item in dataclasses.fields(Point):
            x, y = getattr(a, item.name), getattr(b, item.name)
            size = b.fiber_high if item.name == "fiber_low" else 1.0
            assert x == pytest.approx(y, rel=rel, abs=rel * size), item.name


def varied(case: Case, changes: dict[str, float]) -> list[Case]:
    """The case, with each of its numbers changed in turn, and again."""
    found = [case]
    for path, factor in changes.items():
        found.append(with_number(case, path, factor * number(case, path)))
    return [*found, found[1], case]


@pytest.mark.parametrize("name", CHANGES)
def test_an_answer_hangs_on_no_other(name: str) -> None:
    case = checked(under(BENT[name], angle="100 deg"))
    wanted = Wanted(radians(45, 90), (0.02,), () if name == "families" else (0.02,))
    trials = Trials()
    for one in varied(case, CHANGES[name]):
        alike(trials.solve(one, wanted), Trials().solve(one, wanted))


def test_a_scene_serves_again() -> None:
    """Other numbers take it over; another mesh, law or symmetry does not."""
    case = checked(under(BENT["hemicircle"], angle="100 deg"))
    first = Small(case)
    changes = ("actuator.wall", "materials.wall.c1", "effects.1.winding.pitch")
    for path in changes:
        other = Small(with_number(case, path, 1.05 * number(case, path)), first)
        assert other.scene is first.scene
    finer = case.model_copy(update={"mesh": case.mesh.model_copy(update={"section": 2})})
    assert Small(finer, first).scene is not first.scene
    twisting = checked(under(BENT["single helix"], angle="100 deg"))
    assert Small(twisting, first).scene is not first.scene
    gent = {"wall": {"law": "gent", "mu": "0.3 MPa", "jm": 30.0}}
    data = under(BENT["hemicircle"], angle="100 deg")
    other_law = checked(data | {"materials": data["materials"] | gent})
    assert Small(other_law, first).scene is not first.scene


def test_a_scene_knows_its_own_numbers() -> None:
    """One that a later case has taken over is not taken for that of the first again."""
    case = checked(under(BENT["hemicircle"], angle="40 deg"))
    first = Small(case)
    Small(with_number(case, "actuator.wall", 3.0), first)
    again = Small(case, first)
    pressures = [small.march()[1] for small in (again,)]
    assert pressures[0].status == "converged"
    fresh = Small(case)
    fresh.march()
    assert again.scene.scalar("pressure") == pytest.approx(fresh.scene.scalar("pressure"), rel=1e-7)

"""Opposite walls of a chamber that pass through each other are seen, in space and in a section."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from fem.effects.chamber_pressure import ChamberPressure
from fem.kinematics.domain import Domain
from fem.results.walls import CHAMBER, Walls
from fem.scene import Scene
from fiberbend import run
from tests.fem.parts import actuator_effects, set_positions, short_domain

TUBE: dict[str, Any] = {
    "actuator": {"section": "circle", "radius": "8 mm", "length": "60 mm", "wall": "1 mm"},
    "materials": {"wall": {"law": "neo-hooke", "mu": "0.22 MPa"}},
    "model": "section",
    "mesh": {"section": 2},
    "output": {"pictures": False, "fields": False},
}
PASSED = "opposite walls of the chamber have passed through each other"


def _squeezed(domain: Domain, share: float) -> npt.NDArray[np.float64]:
    """Positions of a body whose chamber is flattened by a share of its height in its middle."""
    nodes = domain.data.nodes
    chamber = nodes[domain.surface_nodes(CHAMBER)]
    middle, (low, high) = np.ptp(chamber[:, 1]) / 2, (chamber[:, 2].min(), chamber[:, 2].max())
    along = np.clip((nodes[:, 2] - low) / (high - low), 0, 1)
    x = nodes.copy()
    height = chamber[:, 1].min() + middle
    x[:, 1] = height + (nodes[:, 1] - height) * (1 - share * np.sin(np.pi * along) ** 2)
    return x


@pytest.fixture(scope="module")
def scene() -> Scene:
    domain = short_domain()
    return Scene(domain, actuator_effects(domain))


@pytest.mark.parametrize(("share", "passed"), [(0.0, False), (0.95, False), (1.08, True)])
def test_a_body_squeezed_flat_passes_only_beyond_flat(
    scene: Scene, share: float, passed: bool
) -> None:
    set_positions(scene, _squeezed(scene.domain, share))
    walls = Walls(scene)
    assert walls._crossed() is passed


def test_what_was_seen_is_remembered() -> None:
    domain = short_domain()
    walls, again = (Walls(Scene(domain, [ChamberPressure()])) for _ in range(2))
    walls.passed = {"control": 0.1}
    again.recall(walls.memory())
    assert again.passed == {"control": 0.1}


def _ring(pressure: str) -> list[str]:
    """Warnings of a long tube under vacuum, a ring in plane strain that buckles at 0.36 kPa."""
    effects = [{"pressure": {"to": pressure}}, {"straight": {"stretch": "held"}}]
    warnings: list[str] = run(TUBE | {"effects": effects}).run["warnings"]
    return warnings


def test_a_collapsed_ring_is_told_from_one_whose_walls_have_passed() -> None:
    # a thin ring's walls touch at 5.247/3 of 0.358 kPa (Flaherty, Keller and Rubinow 1972)
    assert not any(PASSED in line for line in _ring("-0.55 kPa"))
    (line,) = [line for line in _ring("-0.68 kPa") if PASSED in line]
    assert -0.68 <= float(line.split()[1]) < -0.57

"""Distance of the turns of a winding, and windings of less than one turn."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from geometry.bodies.extrude import hexahedral_body
from geometry.checks import check
from geometry.sections.circle import CircleActuator
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.rectangle import RectangleActuator
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from geometry.winding.patterns import PATTERNS, Helix, Pattern, least_pitch, turn_spacing

BODIES = [
    HemicircleActuator(radius=8, length=40, wall=2, floor=2, sheath=1, cap=8),
    RectangleActuator(width=10, height=12, length=40, wall=2, floor=2, cap=8),
    CircleActuator(radius=8, length=40, wall=2, cap=8),
]
TURNS = {
    "two-start": Pattern("two threads side by side", (Helix(1), Helix(1, 0.3))),
    "three-start": Pattern("three", (Helix(-1), Helix(-1, 1 / 3), Helix(-1, 2 / 3))),
    "braid": Pattern("two each way", (Helix(1), Helix(1, 0.5), Helix(-1), Helix(-1, 0.25))),
}


@pytest.fixture(autouse=True)
def patterns(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, pattern in TURNS.items():
        monkeypatch.setitem(PATTERNS, name, pattern)


def measured(pattern: str, pitch: float, perimeter: float) -> float:
    """Least distance of successive lines of one hand on the developed surface (s, z)."""
    least = math.inf
    for hand in (1, -1):
        starts = [h.start for h in PATTERNS[pattern].helices if h.hand == hand]
        lines = sorted(start % 1 + turn for start in starts for turn in (0, 1, 2))
        along = np.array([perimeter, hand * pitch]) / math.hypot(perimeter, pitch)
        for one, other in itertools.pairwise(lines):
            across = np.array([0.0, pitch * (other - one)])
            least = min(least, float(np.linalg.norm(across - (across @ along) * along)))
    return least


@pytest.mark.parametrize("pattern", ["double-helix", "single-helix-left", *TURNS])
@pytest.mark.parametrize("pitch", [0.5, 6.0, 40.0])
def test_spacing_is_that_of_the_lines(pattern: str, pitch: float) -> None:
    perimeter = 60.0
    spacing = turn_spacing(pattern, pitch, perimeter)
    assert spacing == pytest.approx(measured(pattern, pitch, perimeter), rel=1e-12)
    least = least_pitch(pattern, spacing, perimeter)
    assert least == pytest.approx(pitch, rel=1e-9)


def test_no_pitch_is_long_enough_for_what_is_wider_than_the_way_around() -> None:
    assert turn_spacing("double-helix", 1e9, 60.0) == pytest.approx(60.0)
    assert least_pitch("double-helix", 60.0, 60.0) is None
    assert least_pitch("three-start", 20.5, 60.0) is None
    assert least_pitch("three-start", 19.5, 60.0) is not None


@pytest.mark.parametrize("body", BODIES, ids=lambda body: body.section)
@pytest.mark.parametrize("pitch", [41.0, 150.0, 5000.0])
@pytest.mark.parametrize("half", [True, False])
def test_less_than_a_turn_has_its_length(body: ShapedActuator, pitch: float, half: bool) -> None:
    winding = Winding("double-helix", pitch, 0.0)
    mesh = hexahedral_body(body, MeshSize(4.0, 1, "hexahedron", half))
    report = check(mesh, body, winding)["winding length"]
    length = 2 * 40 / pitch * math.hypot(body.winding_perimeter, pitch)
    assert report["expected"] == pytest.approx(length / (2 if half else 1))
    # of a circle the order-2 arcs are a little short
    assert report["error"] == pytest.approx(0, abs=1e-4)
    fibers = embed(mesh, body, winding)
    assert fibers.z.min() < 4, "from one end of the chamber"
    assert fibers.z.max() > 36, "to the other"

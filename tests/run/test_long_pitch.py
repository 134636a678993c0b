"""A braid of a few degrees from the axis: its pitch is longer than the chamber.

The smeared braid has an exact solution in a round tube, which neither bends nor twists.
"""

from __future__ import annotations

import math
from typing import Any

import pytest

from fiberbend import run
from fiberbend.models.result import RunResult
from tests.run.conftest import small
from tests.verify.helix_tube import HelixTube

INNER, OUTER = 6.35, 8.35
MODULUS, DIAMETER = 31067.0, 0.1778
MU = 0.24
QUIET = {"pictures": False, "fields": False}


def braid(pitch: float, model: str = "section", kind: str = "smeared") -> dict[str, Any]:
    """A round tube 160 mm long with a double helix."""
    thread = {"modulus": f"{MODULUS} MPa", "diameter": f"{DIAMETER} mm"}
    winding = {"pattern": "double-helix", "pitch": f"{pitch} mm", "fiber": thread, "as": kind}
    return {
        "actuator": {
            "section": "circle",
            "radius": f"{INNER} mm",
            "length": "160 mm",
            "wall": f"{OUTER - INNER} mm",
        },
        "materials": {"wall": {"law": "neo-hooke", "mu": f"{MU} MPa"}},
        "effects": [{"pressure": {"to": "60 kPa"}}, {"winding": winding}],
        "model": model,
        "output": QUIET,
    }


@pytest.mark.parametrize("degrees", [3.0, 10.0, 20.0, 40.0])
def test_a_braid_at_any_angle_is_the_exact_tube(degrees: float) -> None:
    # at 10° the pitch is 297 mm
    pitch = 2 * math.pi * OUTER / math.tan(math.radians(degrees))
    result = run(braid(pitch))
    stiffness = MODULUS * math.pi * (DIAMETER / 2) ** 2
    exact = HelixTube(MU / 2, 0.0, INNER, OUTER, pitch, stiffness, (1, -1))
    stretch, twist = exact.at_pressure(0.06)
    assert result.status == "converged"
    assert twist == pytest.approx(0, abs=1e-12)
    assert result.last("angle_deg") == pytest.approx(0, abs=1e-5)
    assert result.last("axis_stretch") == pytest.approx(stretch, abs=1e-5)


def test_a_chamber_with_less_than_a_turn_of_thread() -> None:
    """As a body, with the thread where it lies: it holds back, and less than if it were spread."""

    def volume(winding: dict[str, Any] | None) -> float:
        effects: list[dict[str, Any]] = [{"pressure": {"to": "8 kPa"}}]
        effects += [] if winding is None else [{"winding": winding}]
        result = run(small(effects=effects, mesh={"axial": "6 mm"}, output=QUIET))
        assert result.status == "converged"
        return result.last("chamber_mm3")

    thread = {"pattern": "double-helix", "pitch": "30 mm", "fiber": "kevlar"}
    spread = volume(thread | {"as": "smeared"})
    assert spread < volume(thread | {"as": "discrete"}) < volume(None)


def doubts(result: RunResult) -> str:
    return "\n".join(result.run["warnings"])


def test_spreading_half_a_turn_is_doubtful() -> None:
    assert "0.54 turns over the chamber's length are spread over its surface" in doubts(
        run(braid(297.0))
    )
    assert doubts(run(braid(5.0))) == ""

"""A thin stiff layer under the floor acts by its modulus times its thickness alone."""

from __future__ import annotations

import pytest

from fiberbend import run
from fiberbend.models.result import RunResult

SECTIONS = {
    "hemicircle": {"radius": "8 mm"},
    "rectangle": {"width": "16 mm", "height": "10 mm"},
}
THIN = (0.05, 0.02, 0.01, 0.005)
"""Thicknesses, mm; elements of 2.5 mm and less lie in them: up to 500 times as long as thick."""


def _run(section: str, thickness: float, shear: float) -> RunResult:
    """Bent by 10 kPa; the layer's shear modulus is given in MPa."""
    sizes = {"length": "160 mm", "wall": "2 mm", "floor": "2 mm", "layer": f"{thickness} mm"}
    soft = {"law": "neo-hooke", "mu": "0.1 MPa"}
    layer = {"law": "neo-hooke", "mu": f"{shear} MPa"}
    result = run(
        {
            "title": "A thin layer",
            "actuator": {"section": section} | SECTIONS[section] | sizes,
            "materials": {"wall": soft, "floor": soft, "layer": layer},
            "effects": [
                {"pressure": {"to": "10 kPa"}},
                {
                    "winding": {
                        "pattern": "double-helix",
                        "pitch": "3 mm",
                        "fiber": "kevlar",
                        "as": "smeared",
                    }
                },
            ],
            "model": "section",
            "output": {"fields": False, "pictures": False},
        }
    )
    assert result.status == "converged", result.reason
    return result


@pytest.mark.parametrize("section", SECTIONS)
@pytest.mark.parametrize(("stiffness", "band"), [(1.0, 0.01), (10.0, 0.03)])
def test_at_one_stiffness_a_thinner_layer_bends_as_far(
    section: str, stiffness: float, band: float
) -> None:
    # stiffness: shear modulus times thickness, N/mm; the layer's own stiffness against bending,
    # which falls with its thickness, is what is left
    bends = [_run(section, t, stiffness / t).last("angle_deg") for t in THIN]
    assert bends == pytest.approx([bends[-1]] * len(THIN), rel=band)
    # and the stiffness counts: of one thickness ten times the modulus is another actuator
    other = _run(section, THIN[0], stiffness / THIN[-1]).last("angle_deg")
    assert other != pytest.approx(bends[0], rel=0.03)

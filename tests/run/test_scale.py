"""Size and stiffness change no iteration and no angle; forces go by length² · modulus."""

from __future__ import annotations

import math
from typing import Any

import pytest

from fiberbend import run
from tests.run.conftest import small

SCALES = [(1.0, 1.0), (1e-3, 1.0), (1e3, 1.0), (1.0, 1e-6), (1.0, 1e6)]
"""Factors on lengths (mm; µm, m) and on moduli."""
MODELS: dict[str, dict[str, Any]] = {
    "section": {"length": 160, "load": {"angle": "360 deg"}, "as": "smeared"},
    "cell": {"length": 160, "load": {"angle": "180 deg"}, "axial": 1.5, "as": "discrete"},
    "body": {"length": 40, "load": {"angle": "40 deg"}, "axial": 8, "as": "discrete"},
}


def _case(model: str, length: float, modulus: float) -> dict[str, Any]:
    """The baseline with every length and every modulus times a factor."""

    def mm(value: float) -> str:
        return f"{length * value!r} mm"

    def mpa(value: float) -> str:
        return f"{modulus * value!r} MPa"

    given = MODELS[model]
    sizes = {"radius": 8, "length": given["length"], "wall": 2, "floor": 2, "sheath": 1, "cap": 15}
    thread = {"modulus": mpa(31076.0), "diameter": mm(0.38), "radius_factor": 0.5}
    winding = {"pattern": "double-helix", "pitch": mm(3), "fiber": thread, "as": given["as"]}
    case = {
        "actuator": {"section": "hemicircle"} | {key: mm(value) for key, value in sizes.items()},
        "materials": {
            "wall": {"law": "yeoh", "c1": mpa(0.11), "c2": mpa(0.02)},
            "floor": {"law": "yeoh", "c1": mpa(7.9)},
            "sheath": {"law": "yeoh", "c1": mpa(0.012662)},
        },
        "effects": [{"pressure": given["load"]}, {"winding": winding}],
        "model": model,
        "output": {"fields": False, "pictures": False},
    }
    return case | ({"mesh": {"axial": mm(given["axial"])}} if "axial" in given else {})


@pytest.mark.parametrize(
    "model", [pytest.param(m, marks=() if m == "section" else pytest.mark.long) for m in MODELS]
)
def test_scale_and_stiffness_change_no_iteration(model: str) -> None:
    usual: Any = None
    for length, modulus in SCALES:
        result = run(_case(model, length, modulus))
        assert result.status == "converged"
        counts = [row["newton_iterations"] for row in result.rows]
        angle = result.last("angle_deg")
        pressure = result.last("pressure_kPa") / modulus
        # a thread's force goes by its area and its modulus
        force = result.last("fiber_max_N") / (modulus * length**2)
        if usual is None:
            usual = counts, angle, pressure, force
        assert counts == usual[0]
        assert angle == pytest.approx(usual[1], rel=1e-10)
        assert pressure == pytest.approx(usual[2], rel=1e-9)
        assert force == pytest.approx(usual[3], rel=1e-8)


@pytest.mark.parametrize("winding", [True, False])
@pytest.mark.parametrize("model", ["section", pytest.param("cell", marks=pytest.mark.long)])
def test_a_load_too_small_to_be_told_from_round_off_bends_in_proportion(
    model: str, winding: bool
) -> None:
    # the reaction to 1e-9 Pa is 1e-14 N, and round-off of the rubber's stresses makes forces of
    # that size: measured against the reaction alone nothing converged
    bends = []
    for pressure in ("1e-9 Pa", "1e-3 Pa", "1 Pa"):
        case = _case(model, 1.0, 1.0)
        effects = [{"pressure": {"to": pressure}}, case["effects"][1]][: 1 + winding]
        result = run(case | {"effects": effects})
        assert result.status == "converged"
        assert result.run["cutbacks"] == 0
        bends.append(result.last("angle_deg") / result.last("pressure_kPa"))
    if winding:
        assert bends[0] == pytest.approx(bends[2], rel=1e-4)
        assert bends[1] == pytest.approx(bends[2], rel=1e-4)


def test_a_body_that_rests_on_its_post_touches_it_at_every_scale() -> None:
    # gaps of ±1e-16 decided which points stood in the first tangent: 28 iterations, or 13
    counts = []
    for length in (1.0, 1e-3):
        case = _case("body", length, 1.0)
        contact = {
            "roof": {"width": f"{4 * length!r} mm"},
            "post": {"length": f"{2 * length!r} mm"},
        }
        effects = [{"pressure": {"to": "40 kPa"}}, case["effects"][1], {"contact": contact}]
        result = run(case | {"effects": effects})
        assert result.status == "converged"
        counts.append(result.run["newton_iterations"])
    assert counts[0] == counts[1] < 20


@pytest.mark.parametrize("model", ["section", pytest.param("cell", marks=pytest.mark.long)])
@pytest.mark.parametrize("pressure", ["-5 kPa", "5 kPa"])
def test_the_first_tangent_knows_whether_threads_tighten_or_slacken(
    model: str, pressure: str
) -> None:
    # with all threads taut whatever the load, vacuum took 67 and 75 iterations with cut-backs
    case = _case(model, 1.0, 1.0)
    winding = case["effects"][1]["winding"] | {"tension_only": True}
    result = run(case | {"effects": [{"pressure": {"to": pressure}}, {"winding": winding}]})
    assert result.status == "converged"
    assert result.run["cutbacks"] == 0
    assert result.run["newton_iterations"] < 15


def test_an_obstacle_that_the_mesh_cannot_feel_is_refused() -> None:
    from fiberbend.schema.problems import CaseError

    bar = {"cylinder": {"center": ["-14 mm", "20 mm"], "radius": "0.01 mm"}}
    with pytest.raises(CaseError, match=r'cylinder.radius: "0.01 mm", expected at least "2 mm"'):
        run(small(effects=[{"pressure": {"to": "60 kPa"}}, {"contact": bar}]))


def test_an_obstacle_into_which_the_body_sinks_is_a_warning_with_the_depth() -> None:
    plane = {"point": ["0 mm", "-2 mm", "0 mm"], "normal": [0, 1, 0]}
    effects = small()["effects"]
    depths = []
    for stiffness in ("0.01 MPa/mm", "60 MPa/mm"):
        contact = {"contact": {"plane": plane, "stiffness": stiffness}}
        result = run(small(effects=[*effects, contact], output={"fields": False}))
        depth = result.run["contact"]["plane"]["greatest_depth_mm"]
        warned = [line for line in result.run["warnings"] if "sinks" in line]
        assert len(warned) == (depth > 0.05)
        assert all(f"sinks {depth:.3g} mm into the plane" in line for line in warned)
        depths.append(depth)
    assert depths[0] > 0.05 > 0.01 > depths[1]


def test_the_same_layout_and_mesh_at_every_size() -> None:
    from geometry.bodies.gmsh_body import build_body
    from geometry.sections.size import MeshSize
    from geometry.sections.table import make_actuator

    found = []
    for scale in (1.0, 1e-3, 1e3):
        sizes = {"radius": 8, "length": 24, "wall": 2, "floor": 2, "sheath": 1, "cap": 6}
        given = {"section": "hemicircle"} | {k: scale * v for k, v in sizes.items()}
        mesh = build_body(make_actuator(given), MeshSize(8 * scale))
        found.append((len(mesh.nodes), len(mesh.cells), mesh.nodes / scale))
        assert math.isclose(mesh.nodes[:, 2].max(), 30 * scale)
    for nodes, cells, places in found[1:]:
        assert (nodes, cells) == found[0][:2]
        assert abs(places - found[0][2]).max() < 1e-9

"""Every recipe of CONTRIBUTING.md works, and touches the files that it says."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.conftest import ROOT
from tests.contributing.recipes import House

BASELINE = yaml.safe_load((ROOT / "cases" / "free_bending.yaml").read_text(encoding="utf-8"))
QUIET = {"pictures": False, "fields": False}


def baseline(angle: str = "30 deg", **changes: Any) -> dict[str, Any]:
    """The paper's actuator as a section."""
    case = {
        "actuator": BASELINE["actuator"],
        "materials": BASELINE["materials"],
        "effects": [
            {"pressure": {"angle": angle}},
            {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}},
        ],
        "model": "section",
        "output": QUIET,
    }
    return case | changes


def end(answer: dict[str, Any], column: str) -> float:
    """The last value of a column."""
    assert answer["status"] == "converged"
    return float(answer["rows"][-1][column])


def test_a_law(tmp_path: Path) -> None:
    house = House(tmp_path, "A material law")
    touched = house.touched()
    assert list(touched) == ["materials/laws/fung.py", "materials/laws/table.py"]
    assert touched["materials/laws/table.py"] == 1
    assert house.lint() == ""
    said = house.tests("tests/materials/test_laws.py", "-k", "fung or every_law")
    assert re.match(r"[0-9]+ passed", said), said
    plain = house.case(baseline())
    plain["materials"]["wall"] = {"law": "neo-hooke", "mu": "0.3 MPa"}
    found = house.use(
        {"fung": house.case(baseline()), "neo-hooke": plain},
        """
import numpy as np
from fiberbend.case import convert
from fiberbend.models.closed_form import analytic_curves
from fiberbend.states.recovery import cauchy_stress

case = read_case("fung.yaml")
rubber = convert.material(case.materials.wall)
assert abs(rubber.initial_shear_modulus - 0.3) < 1e-12
stretch = np.array(1.3)
by_hand = 0.3 * np.exp(0.5 * (stretch - 1 / stretch) ** 2) * (stretch - stretch**-3.0)
assert abs(analytic_curves(case)["zero-fit"].stress(stretch) - by_hand) < 1e-12
f = np.diag([stretch, 1.0, 1 / stretch])
stress = cauchy_stress(rubber, f, np.array(0.0))
assert abs((stress[0, 0] - stress[2, 2]) / stretch - by_hand) < 1e-12
assert "materials.wall.jm: no effect on fung" in told("fung.yaml", "materials.wall.jm=3")
assert "materials.wall.stiffening: missing" in told(
    "fung.yaml", "materials.wall={law: fung, scale: 0.3 MPa}"
)
""",
    )
    assert '"fung"' in found["schema"]
    assert "Exponent b; fung." in found["schema"]
    # 2 a b = 0.3 MPa: stiffer than neo-Hooke, softer than twice as stiff
    ratio = end(found["fung"], "pressure_kPa") / end(found["neo-hooke"], "pressure_kPa")
    assert 1 < ratio < 1.25


TUBE: dict[str, Any] = {
    "actuator": {
        "section": "circle",
        "radius": "3 mm",
        "wall": "2 mm",
        "length": "64 mm",
        "cap": "8 mm",
    },
    "materials": {"wall": {"law": "neo-hooke", "mu": "0.3 MPa"}},
    "effects": [],
    "mesh": {"axial": "8 mm"},
    "output": QUIET,
}
"""A bare tube, slender enough for beam theory."""


def compliance(
    length: float, cap: float, inner: float, outer: float, mu: float
) -> tuple[float, float]:
    """Deflection and elongation of the tube per force at its end, mm/N.

    A cantilever whose caps are solid, E = 3 μ, without shear (2 % of the deflection).
    """
    total = length + 2 * cap
    solid, hollow = math.pi * outer**4 / 4, math.pi * (outer**4 - inner**4) / 4
    ends = [total, total - cap, cap, 0.0]
    bent = sum(
        (far**3 - near**3) / (3 * second)
        for far, near, second in zip(ends, ends[1:], (solid, hollow, solid), strict=False)
    )
    pulled = 2 * cap / (math.pi * outer**2) + length / (math.pi * (outer**2 - inner**2))
    return bent / (3 * mu), pulled / (3 * mu)


def test_an_effect(tmp_path: Path) -> None:
    house = House(tmp_path, "An effect")
    touched = house.touched()
    assert list(touched) == [
        "fem/effects/pull.py",
        "fiberbend/effects/pull.py",
        "fiberbend/effects/table.py",
    ]
    assert touched["fiberbend/effects/table.py"] == 2
    assert house.lint() == ""
    case = house.case(TUBE)

    def pulled(force: str, direction: str) -> dict[str, Any]:
        return case | {"effects": [{"pull": {"force": force, "direction": direction}}]}

    found = house.use(
        {"said": case, "light": pulled("1 mN", "-y"), "along": pulled("100 mN", "+z")},
        """
text = told("said.yaml", "effects.0.pull.force=1 mm")
assert 'expected a force with its unit such as "0.1 N"' in text
for model in ("analytic", "section", "cell"):
    text = told("said.yaml", f"model={model}")
    assert f"effects.0.pull: model {model} does not support it: only a body in space" in text
assert "a string along x pulls to one side" in told(
    "said.yaml", "effects.0.pull.direction=+x", "mesh.symmetry=half"
)
""",
    )
    assert "pull" in found["schema"]
    said, light, along = found["said"], found["light"], found["along"]
    assert said["model"] == "body"
    assert said["resolved"]["effects"] == [{"pull": {"force": "0.05 N", "direction": "-y"}}]
    assert "section does not support effects.0.pull: only a body in space" in said["plan"]
    # toward −y, and the tip turns there; the work-conjugate is the way of the tip
    for answer in (said, light):
        assert end(answer, "angle_deg") > 0
        way = answer["rows"][0]["tip_y_mm"] - answer["rows"][-1]["tip_y_mm"]
        assert end(answer, "conjugate_pull_mm") == pytest.approx(way, rel=1e-3)
        assert end(answer, "unstable_modes") == 0
    # the limit of small forces, and how a large one, which keeps its direction, falls behind it
    bent, stretched = compliance(64.0, 8.0, 3.0, 5.0, 0.3)
    assert end(light, "conjugate_pull_mm") == pytest.approx(1e-3 * bent, rel=0.02)
    assert end(light, "stored_mJ") == pytest.approx(1e-6 * bent / 2, rel=0.02)
    ratio = end(said, "conjugate_pull_mm") / end(light, "conjugate_pull_mm") / 50
    assert 0.9 < ratio < 0.96
    # along the axis: by EA, no bend
    assert end(along, "tip_z_mm") - along["rows"][0]["tip_z_mm"] == pytest.approx(
        0.1 * stretched, rel=0.01
    )
    assert end(along, "angle_deg") == pytest.approx(0, abs=1e-9)


def test_a_pattern(tmp_path: Path) -> None:
    house = House(tmp_path, "A winding pattern")
    assert house.touched() == {"geometry/winding/patterns.py": 1}
    assert house.lint() == ""
    case = house.case(baseline())
    # spread over the surface two threads are one of twice the modulus
    single = house.case(baseline())
    single["effects"][1]["winding"] |= {
        "pattern": "single-helix-right",
        "fiber": {"modulus": f"{2 * 31076.0} MPa", "diameter": "0.38 mm", "radius_factor": 0.5},
    }
    found = house.use(
        {"two": case, "one": single},
        """
from fiberbend.models.choice import MODELS

case = read_case("two.yaml", ["model=cell"])
assert MODELS["cell"].half(case) == (
    False,
    "half a turn about y maps it onto itself: it bends about x and twists, its section warps, "
    "no side (a two-start helix is not its own mirror image)",
)
assert "twist" in MODELS["cell"].scalars(case)
assert "model analytic does not support it: the closed form has no twist" in told(
    "two.yaml", "model=analytic"
)
""",
    )
    assert '"two-start-right"' in found["schema"]
    two, one = found["two"], found["one"]
    assert end(two, "twist_deg") != 0
    for name in ("pressure_kPa", "twist_deg", "tip_z_mm", "chamber_mm3", "fiber_max_N"):
        factor = 0.5 if name == "fiber_max_N" else 1.0
        assert end(two, name) == pytest.approx(factor * end(one, name), rel=1e-8)


def test_a_column(tmp_path: Path) -> None:
    house = House(tmp_path, "An output column")
    assert list(house.touched()) == ["fiberbend/columns.py"]
    assert house.lint() == ""
    held = house.case(TUBE) | {"model": "section", "mesh": {}}
    found = house.use({"held": held, "closed": baseline(model="analytic")})
    # a tube that keeps its length grows from A, B to a, b with b² − a² = B² − A²; the lowest line
    # is where it was, and the top of the chamber moves most
    inner, outer, length = 3.0, 5.0, 64.0
    assert len(found["held"]["rows"]) > 2
    for row in found["held"]["rows"]:
        a = math.sqrt(row["chamber_mm3"] / (math.pi * length))
        b = math.sqrt(a**2 + outer**2 - inner**2)
        assert row["bulge_mm"] == pytest.approx(a - inner + b - outer, rel=1e-3, abs=2e-5)
    assert end(found["held"], "bulge_mm") > 0.1
    # a closed form does not fill columns of uniform bending
    assert "bulge_mm" not in found["closed"]["rows"][-1]


def test_a_model(tmp_path: Path) -> None:
    house = House(tmp_path, "A model")
    touched = house.touched()
    assert list(touched) == ["fiberbend/case/names.py", "fiberbend/models/fine_section.py"]
    assert touched["fiberbend/case/names.py"] == 1
    assert house.lint() == ""
    found = house.use(
        {"fine": house.case(baseline("90 deg")), "usual": baseline("90 deg")},
        """
from fiberbend.columns import table
from fiberbend.models.choice import MODELS, choose_model

assert list(MODELS) == ["analytic", "section", "fine-section", "cell", "rod", "body"]
# the dearer of two that support everything is not chosen, but can be asked for
chosen = read_case("fine.yaml", ["model=auto", "effects.1.winding.as=smeared"])
assert choose_model(chosen)[0].name == "section"
assert read_case("fine.yaml", ["mesh.section=3"]).mesh.section == 3
text = told("fine.yaml", "effects.1.winding.as=discrete")
assert "model fine-section does not support it: only cell and body have turns" in text
assert any("| section, fine-section, cell |" in line for line in table(MODELS.values(), False))
""",
    )
    assert '"fine-section"' in found["schema"]
    fine, usual = found["fine"], found["usual"]
    assert (fine["model"], usual["model"]) == ("fine-section", "section")
    assert (fine["resolved"]["mesh"]["section"], usual["resolved"]["mesh"]["section"]) == (4, 2)
    assert "model: fine-section (given in the case)" in fine["plan"]
    assert "mesh: moves P by up to 0.05 %" in fine["plan"]
    # as far apart as docs/evidence/uniform.md has the refinements 2 and 4 at this angle
    ratio = end(usual, "pressure_kPa") / end(fine, "pressure_kPa")
    assert ratio == pytest.approx(45.111 / 45.067, abs=3e-5)
    # the section itself stands beside it
    assert set(fine["rows"][0]) - set(usual["rows"][0]) == {"section_kPa"}
    assert end(fine, "section_kPa") == pytest.approx(end(usual, "pressure_kPa"), rel=1e-4)

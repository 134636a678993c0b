"""A run that strains a rubber further than its tests says so."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fiberbend.models.result import RunResult
from fiberbend.reader.reader import as_case
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from tests.conftest import ROOT

BARE = {"output.pictures": False, "output.report": False}


def warned(material: Any, tmp_path: Path) -> tuple[RunResult, list[str]]:
    settings = {"materials.wall": material, "effects.0.pressure": {"angle": "90 deg"}, **BARE}
    case = as_case(ROOT / "cases" / "section.yaml", settings | {"output.at_angles": []})
    found = run_case(case, tmp_path / "run", True, Progress(quiet=True))
    assert found.status == "converged"
    begin = "materials.wall: tested to a stretch of"
    return found, [line for line in found.run["warnings"] if line.startswith(begin)]


def test_a_run_within_the_tests_says_nothing(tmp_path: Path) -> None:
    found, lines = warned({"law": "yeoh", "c1": "0.1 MPa", "tested": [1, 2.5]}, tmp_path)
    assert not lines
    assert "beyond_tests" not in found.run["greatest_strain"]


def test_a_run_beyond_the_tests_says_how_far(tmp_path: Path) -> None:
    found, lines = warned({"law": "yeoh", "c1": "0.1 MPa", "tested": [1, 1.05]}, tmp_path)
    (line,) = lines
    assert line in found.run["greatest_strain"]["beyond_tests"]
    reached = float(line.partition("the run reaches ")[2].partition(";")[0])
    assert 1.05 < reached <= 1 + found.run["greatest_strain"]["nominal"] + 0.005


def test_named_rubbers_know_their_tests(tmp_path: Path) -> None:
    assert warned("dragon-skin-10-beam", tmp_path)[1]
    # nobody says how far these were tested
    assert not warned("elastosil-m4601", tmp_path)[1]


@pytest.mark.long
@pytest.mark.parametrize("ratio", [0.45, 0.5])
def test_an_actuator_of_youngs_modulus_is_one_of_the_moduli_that_follow(
    ratio: float, tmp_path: Path
) -> None:
    one, _ = warned({"young": "0.6 MPa", "poisson": ratio}, tmp_path)
    moduli = {"law": "neo-hooke", "mu": f"{0.6 / (2 * (1 + ratio))!r} MPa"}
    if ratio < 0.5:
        moduli["bulk"] = f"{0.6 / (3 * (1 - 2 * ratio))!r} MPa"
    other, _ = warned(moduli, tmp_path)
    assert one.rows[-1]["pressure_kPa"] == pytest.approx(other.rows[-1]["pressure_kPa"], rel=1e-9)

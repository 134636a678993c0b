"""rod.json is what its schema says, and its axis is the section by another line."""

from __future__ import annotations

import dataclasses
import json
from importlib.resources import files

import jsonschema  # type: ignore[import-untyped]
import numpy as np
import pytest

from fiberbend.export import mjcf, record
from fiberbend.export.ends import KEYS
from fiberbend.export.section import Section, about, axis_of
from fiberbend.export.targets import TARGETS
from fiberbend.schema.problems import CaseError
from tests.export import rods

SCHEMA = json.loads((files("fiberbend.export") / "rod.schema.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("weighs", [True, False])
def test_the_file_is_what_the_schema_says(weighs: bool) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    made = json.loads(record.text(record.record_of(rods.handed(weighs=weighs))))
    jsonschema.validate(made, SCHEMA)
    assert made["version"] == SCHEMA["properties"]["version"]["const"] == record.VERSION
    for key in ("axis", "section"):
        del made[key]
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate(made, SCHEMA)


def test_every_number_says_its_unit() -> None:
    made = record.record_of(rods.handed())
    units = ("_mm", "_kPa", "_N", "_mm2", "_kg_per_mm", "_kg_mm", "_N_mm", "_N_mm2", "_rad")
    plain = {"rest_stretch", "coupling_of_stretch_and_twist", "coupling_of_bending", "version"}
    for group in ("geometry", "section", "axis", "cap"):
        for name in made[group]:
            assert name in plain or name.endswith(units), name
    for part in KEYS:
        assert all(name.endswith(units) for name in made["ends"][part])


def test_damping_is_the_time_times_the_stiffness_where_a_case_has_one() -> None:
    assert record.record_of(rods.handed())["damping"] is None
    given = dataclasses.replace(rods.handed(), retardation=0.03)
    made = json.loads(record.text(record.record_of(given)))
    jsonschema.validate(made, SCHEMA)
    assert made["damping"]["retardation_time_s"] == 0.03
    stiffness = np.array(made["section"]["stiffness_N_mm"][0])
    assert made["damping"]["section_N_mm_s"] == pytest.approx(0.03 * stiffness)
    assert made["damping"]["cap_N_mm_s"] == pytest.approx(0.03 * rods.CAP_STIFFNESS)
    said = mjcf.text(made)
    assert "Damping is of the motion's case: 0.03 s times the stiffness" in said
    joint = next(line for line in said.splitlines() if 'name="curvature_chamber_20"' in line)
    numbers = {k: float(joint.split(f'{k}="')[1].split('"')[0]) for k in ("stiffness", "damping")}
    assert numbers["damping"] == pytest.approx(0.03 * numbers["stiffness"], rel=1e-5)


def test_energy_is_that_of_the_other_line() -> None:
    """Of any strains; twist and side curvature coupled too."""
    random = np.random.default_rng(3)
    root = random.normal(size=(4, 4))
    one = Section(
        np.zeros(1), np.array([[1.1, 0.02, 0.01, -0.03]]), (root @ root.T)[None], np.zeros(1)
    )
    x, y = 1.7, -3.2
    moved = about(one, x, y)
    away = random.normal(size=4)
    # the stretch of a line at x, y: above the centroids it is longer where curvature > 0
    other = away + np.array([y * away[1] - x * away[2], 0.0, 0.0, 0.0])
    assert moved.rest[0] == pytest.approx([1.1 + y * 0.02 - x * 0.01, 0.02, 0.01, -0.03], rel=1e-12)
    # bent without a force along the line, its stretch takes what costs least
    least = np.linalg.inv(np.linalg.inv(one.stiffness[0])[1:, 1:])
    assert moved.bending[0] == pytest.approx(least, rel=1e-9)
    turn = np.eye(4)
    turn[0, 1:3] = y, -x
    back = np.linalg.inv(turn)
    energy = away @ one.stiffness[0] @ away
    assert other @ (back.T @ one.stiffness[0] @ back) @ other == pytest.approx(energy, rel=1e-12)


def test_the_axis_is_where_a_force_does_not_bend() -> None:
    axis = axis_of(rods.section(lever=-4.5))
    assert (axis.x, axis.y) == (0.0, pytest.approx(-4.5, rel=1e-12))
    assert (axis.off, axis.twisted) == (pytest.approx(0.0, abs=1e-12), 0.0)
    assert axis.bending[:, 0, 0] == pytest.approx(3900 + 1500 * axis.pressures, rel=1e-12)
    assert axis.rest[:, 0] == pytest.approx(1 + 0.25 * axis.pressures, rel=1e-12)


def test_what_a_program_cannot_take_is_refused() -> None:
    without = record.record_of(rods.handed(weighs=False))
    for name in ("pyelastica", "mujoco", "sofa"):
        with pytest.raises(CaseError, match="--density floor="):
            TARGETS[name].contents(without)
    assert TARGETS["json"].contents(without) == {}
    coupled = rods.section()
    coupled.stiffness[:, 2, 3] = coupled.stiffness[:, 3, 2] = 8000.0
    made = record.record_of(rods.handed(coupled))
    for name in ("mujoco", "sofa"):
        with pytest.raises(CaseError, match="bending, side bending and twist are coupled"):
            TARGETS[name].contents(made)
    assert set(TARGETS["pyelastica"].contents(made)) == {"rod_pyelastica.py"}
    pulled = rods.section()
    pulled.stiffness[:, 0, 3] = pulled.stiffness[:, 3, 0] = 2000.0
    made = record.record_of(rods.handed(pulled))
    for name in ("pyelastica", "mujoco", "sofa"):
        with pytest.raises(CaseError, match="stretch and twist are coupled"):
            TARGETS[name].contents(made)


def test_states_are_four_strains_by_rising_pressure() -> None:
    made = rods.section()
    with pytest.raises(ValueError, match="four strains"):
        Section(made.pressures, made.rest[:, :2], made.stiffness, made.areas)
    with pytest.raises(ValueError, match="rising"):
        Section(made.pressures[::-1], made.rest, made.stiffness, made.areas)

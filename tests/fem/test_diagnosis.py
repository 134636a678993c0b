"""A failure is told by what fails and where, the same on any number of ranks."""

from __future__ import annotations

import json

import numpy as np
import pytest
from mpi4py import MPI

from fem.march.records import Critical
from fem.results.diagnosis import Diagnosis
from fem.solver.newton import Outcome
from tests.conftest import MpiRun
from tests.fem.failing import cap_sheath, found, short, turn_inside_out
from tests.fem.parts import SHORT, Bender

FAILED = Outcome(False, 11, 11, "no convergence in 11 iterations", [], 1.0)


@pytest.fixture(scope="module")
def body() -> Bender:
    """The short actuator at rest, for tests that set a state."""
    return short(MPI.COMM_SELF)


def explain(body: Bender, critical: list[Critical] | None = None) -> str:
    """What is said where the present state is the last converged one."""
    state = body.march.equilibrium.capture()
    return Diagnosis(body.scene).explain([state], body.march.rest, critical or [], FAILED, "")


def test_without_a_physical_cause_a_failure_is_numerical(body: Bender) -> None:
    body.scene.set(np.zeros(body.scene.body.owned))
    assert explain(body) == "numerical: no convergence in 11 iterations"
    assert Diagnosis(body.scene).inverted() == ""


def test_an_inverted_element_has_a_place(body: Bender) -> None:
    cell = cap_sheath(body)
    middle = body.scene.domain.data.nodes[body.scene.domain.data.cells[cell]].mean(axis=0)
    turn_inside_out(body, cell)
    text = Diagnosis(body.scene).inverted()
    # neighbours share the corner that was pushed; the same region, the same end
    assert text.startswith("in the sheath of the tip cap at x = ")
    assert middle[2] > SHORT.length
    assert "z = " in text


def test_walls_that_meet_are_told(body: Bender) -> None:
    # the crown is pressed onto the floor: y of everything above it shrinks to a twentieth
    scene = body.scene
    nodes = scene.domain.data.nodes[scene.body.owned_nodes]
    moved = np.zeros_like(nodes)
    moved[:, 1] = -0.95 * np.clip(nodes[:, 1] - SHORT.floor, 0, None)
    scene.body.set_displacement(moved)
    scene.set(scene.w.copy())
    scene.set_scalar("pressure", -0.05)
    text = explain(body)
    scene.set_scalar("pressure", 0.0)
    assert "the chamber collapses under vacuum: 5 % of its volume is left" in text
    # what is more than half of 8 mm apart at rest is opposite: a twentieth of 4.4 mm is left
    assert "opposite walls of the chamber meet: 0.22 mm apart" in text


def test_a_lost_branch_is_called_buckling(body: Bender) -> None:
    body.scene.set(np.zeros(body.scene.body.owned))
    lost = Critical("bifurcation", "pressure", 0.01, 1.0, 0.1, 0, 1)
    state = body.march.equilibrium.capture()
    state.measures["modes"] = 1
    text = Diagnosis(body.scene).explain([state], body.march.rest, [lost], FAILED, "")
    assert text.startswith("buckling")


@pytest.mark.mpi
def test_two_ranks_say_the_same(mpirun: MpiRun) -> None:
    run = mpirun(2, ["-m", "tests.fem.failing"])
    assert run.returncode == 0, run.stderr
    other, serial = json.loads(run.stdout.splitlines()[-1]), found(MPI.COMM_SELF)
    assert other["reason"] == serial["reason"]
    assert "so says the test in the sheath of the tip cap" in str(serial["reason"])
    assert other["inverted"] == serial["inverted"]
    assert other["clearance"] == pytest.approx(serial["clearance"], rel=1e-9)

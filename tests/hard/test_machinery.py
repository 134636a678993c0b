"""What each part of the machinery is for: a case that fails, or is dearer, without it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import fem.march.march  # starts MPI, without which petsc4py may find none

# isort: split
import numpy as np
import pytest
from petsc4py import PETSc

import fem.scene
import fem.solver.newton
from bench.hard_cases import FIBER, find, thread
from bench.hard_procedures import unloaded
from fem.march.records import Rules
from fem.scene import Scene
from fem.solver.newton import Settings
from fem.solver.side_conditions import Stationary
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import parse_case
from fiberbend.running import assembly
from fiberbend.running.runner import run_case

Patch = pytest.MonkeyPatch


def solve(name: str, model: str = "section") -> RunResult:
    """Run a hard case."""
    return run_case(parse_case(find(name).case(model)), None)


def with_rules(patch: Patch, **changes: Any) -> None:
    """Change some rules of every march."""
    patch.setattr(assembly, "Rules", lambda **rules: Rules(**{**rules, **changes}))


def counts(result: RunResult, key: str = "newton_iterations") -> int:
    """A count of run.json."""
    return int(result.run[key])


@pytest.mark.parametrize("name", ["floor-0.01", "balloon", "vacuum-20"])
def test_cut_backs(name: str, monkeypatch: Patch) -> None:
    """Without them the first increment that is too long ends the run."""
    with_rules(monkeypatch, cutbacks=0)
    result = solve(name)
    assert result.status == "failed"
    assert counts(result, "load_steps") <= 2


def test_bounds_of_an_increment_of_volume(monkeypatch: Patch) -> None:
    """A chamber that may swell at any rate overshoots; three increments fail instead of one."""
    cuts = counts(solve("balloon"), "cutbacks")
    with_rules(monkeypatch, swell=np.inf)
    assert counts(solve("balloon"), "cutbacks") > cuts


def test_a_pressure_that_turns_to_the_volume(monkeypatch: Patch) -> None:
    """Held to the pressure, the march creeps up to the limit point and cannot name it."""
    monkeypatch.setattr(fem.march.march, "softens", lambda *_: False)
    monkeypatch.setattr(fem.march.march, "limit_ahead", lambda *_: False)
    result = solve("balloon")
    assert result.status == "failed"
    assert result.run["critical_points"] == []


def test_each_field_converges_for_itself(monkeypatch: Patch) -> None:
    """One norm of forces and volumes against the first residual is hardly met after a good start.

    That creeps on without an end unless the march gives up.
    """
    monkeypatch.setattr(fem.solver.newton._Solve, "test", _one_norm(fem.solver.newton._Solve.test))
    result = solve("floor-0.01")
    assert result.status == "failed"
    assert fem.march.march.CREEPS in result.reason


def _one_norm(test: Callable[..., int]) -> Callable[..., int]:
    """SNES's own test: the norm of everything below 1e-8 of the first."""
    reasons = PETSc.SNES.ConvergedReason

    def mixed(self: Any, snes: Any, iteration: int, norms: Any) -> int:
        force, volume, closing = self.history[-1]
        if not np.isfinite(force) or iteration >= self.newton.settings.iterations:
            return test(self, snes, iteration, norms)
        parts = force * self.scale, volume * self.problem.volume_scale, closing
        size = float(np.linalg.norm(parts))
        self.first = size if iteration == 0 else self.first
        done = size <= 1e-8 * self.first
        return int(reasons.CONVERGED_FNORM_RELATIVE if done else reasons.CONVERGED_ITERATING)

    return mixed


def test_forces_are_measured_by_those_before(monkeypatch: Patch) -> None:
    """Back at no load there is no force to be measured by: before, 'no convergence'."""
    monkeypatch.setattr(fem.solver.newton, "FADED", 0.0)
    monkeypatch.setattr(Scene, "_solid_noise", lambda _: 0.0)
    monkeypatch.setattr(Stationary, "noise", lambda _: 0.0)
    done = unloaded(find("unloaded"), "section")
    assert done.run["status"] == "failed"


def test_forces_are_no_finer_than_round_off(monkeypatch: Patch) -> None:
    """Of fibers 1e9 times as stiff as rubber the first digits of a strain are all there is.

    Of those 1e8 times as stiff some builds of the libraries happen to hit the one that is asked.
    """
    case = parse_case(replace(find("fiber-1000"), changes={FIBER: thread(10000)}).case("section"))
    assert run_case(case, None).status == "converged"
    monkeypatch.setattr(fem.scene, "summed_noise", lambda *_: 0.0)
    monkeypatch.setattr(Scene, "_solid_noise", lambda _: 0.0)
    assert run_case(case, None).status == "failed"


def test_hybrid_fiber_force(monkeypatch: Patch) -> None:
    """Predicted force in the geometric stiffness: a third fewer iterations for stiff fibers."""
    few = counts(solve("fiber-1000"))
    monkeypatch.setattr(assembly, "Settings", lambda **given: Settings(hybrid=False, **given))
    assert few < 0.8 * counts(solve("fiber-1000"))

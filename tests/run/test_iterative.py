"""`solver.linear: iterative`: the same states as the direct solver, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem.march.attempts import suspect
from fem.march.records import MODES as MODES_MEASURE
from fem.march.records import Critical, Report, State
from fem.solver import slabs
from fiberbend import run
from fiberbend.answer.answer import answer
from fiberbend.models.choice import choose_model
from fiberbend.models.result import RunResult
from fiberbend.plan.plan import make_plan, unused
from fiberbend.reader.reader import as_case
from fiberbend.results.reading import read_history
from fiberbend.schema.problems import CaseError
from tests.conftest import MpiRun
from tests.run.conftest import small, write_case

MODES = "unstable_modes"
QUIET = {"at_angles": ["8 deg"], "fields": False, "pictures": False, "report": False}
CASE = small(output=QUIET, mesh={"axial": "2 mm"})
ITERATIVE = CASE | {"solver": {"linear": "iterative"}}
COLUMNS = ("pressure_kPa", "angle_deg", "chamber_mm3", "fiber_max_N", "stored_mJ")


@pytest.fixture(scope="module")
def direct() -> RunResult:
    """By the direct solver."""
    return run(CASE)


def _same(rows: list[dict[str, Any]], known: list[dict[str, Any]]) -> None:
    assert len(rows) == len(known)
    for row, other in zip(rows[1:], known[1:], strict=True):
        assert MODES not in row or row[MODES] is None
        assert other[MODES] == 0
        for name in COLUMNS:
            assert row[name] == pytest.approx(other[name], rel=1e-6), name


def test_the_same_states(direct: RunResult) -> None:
    """Without a count of unstable modes, and with a warning of that."""
    result = run(ITERATIVE)
    assert result.status == "converged"
    _same(result.rows, direct.rows)
    assert any("no stability is told" in line for line in result.run["warnings"])
    assert result.run["stability_checked"] is False
    assert direct.run["stability_checked"] is True
    said = answer(as_case(ITERATIVE), result.rows, result.run)
    assert next(e.value for e in said.entries if e.label == "stability") == "not checked"


def test_what_is_not_known_to_be_stable_may_be_lost() -> None:
    """A step that strays is refused where a mode may have been lost on the way."""

    def state(**measures: float) -> State:
        return State(np.zeros(1), {}, measures, None, {})

    limit = Critical("limit", "pressure", 1.0, 1.0, None, 0, 1)
    assert suspect(state(), Report())
    assert suspect(state(**{MODES_MEASURE: 1}), Report())
    assert not suspect(state(**{MODES_MEASURE: 0}), Report())
    assert suspect(state(**{MODES_MEASURE: 0}), Report(critical=[limit]))


@pytest.mark.long
@pytest.mark.mpi
def test_two_ranks_find_the_same(direct: RunResult, mpirun: MpiRun, tmp_path: Path) -> None:
    case = write_case(tmp_path, ITERATIVE)
    done = mpirun(2, ["-m", "fiberbend", "run", case, "--out", tmp_path / "run"])
    assert done.returncode == 0, done.stderr
    _same(read_history(tmp_path / "run" / "history.csv"), direct.rows)


def test_no_convergence_is_one_line(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Nothing else solves it instead."""
    monkeypatch.setattr(slabs, "MOST", 3)
    with pytest.raises(CaseError) as caught:
        run(ITERATIVE, tmp_path / "run")
    (problem,) = caught.value.problems
    text = str(problem)
    assert text.startswith('solver.linear: "iterative", expected direct: no convergence in 3 it')
    record = json.loads((tmp_path / "run" / "run.json").read_text(encoding="utf-8"))
    assert (record["status"], record["reason"]) == ("failed", text)
    assert record["wall_s"]["mesh"] > 0


def test_a_limit_point_is_refused() -> None:
    """Beyond it the body may be unstable, which is not told."""
    soft = small(
        output=QUIET | {"at_angles": []},
        effects=[{"pressure": {"volume": "12 mL"}}],
        materials={
            "wall": {"law": "neo-hooke", "mu": "0.22 MPa"},
            "floor": {"law": "neo-hooke", "mu": "0.5 MPa"},
        },
        solver={"linear": "iterative"},
    )
    del soft["actuator"]["sheath"]
    with pytest.raises(CaseError, match=r"solver.linear.*a limit point of pressure"):
        run(soft)


def test_a_plan_says_that_its_figures_are_those_of_the_direct_solver() -> None:
    direct, iterative = (make_plan(as_case(case)) for case in (CASE, ITERATIVE))
    rows, known = dict(iterative.rows), dict(direct.rows)
    for heading, what in (("time", "several times longer"), ("memory", "more")):
        text, other = rows[heading][0], known[heading][0].split(";")[0]
        assert text.startswith(f"not known of the iterative solver, {what} on one rank")
        assert other in text
    assert direct.seconds is not None
    assert iterative.seconds is None


def test_tetrahedra_are_refused() -> None:
    case = ITERATIVE | {"mesh": {"axial": "4 mm", "element": "tetrahedron"}}
    with pytest.raises(CaseError, match="expected direct: pressures of tetrahedra couple layers"):
        as_case(case)


def test_a_section_has_no_use_for_it() -> None:
    case = as_case(ITERATIVE | {"model": "section"})
    assert "solver.linear" in list(unused(case, choose_model(case)[0]))
    case = as_case(ITERATIVE)
    assert "solver.linear" not in list(unused(case, choose_model(case)[0]))

"""What a design reads off the runs of a whole body."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.design.solving.body import Body
from fiberbend.design.solving.models import UnsolvedError
from fiberbend.design.solving.tries import Tries
from fiberbend.models.result import RunResult
from tests.design.made_up import MadeUp, design


def rows(*pressures: float) -> list[dict[str, Any]]:
    """Rows of a body at pressures in kPa."""
    zero = dict.fromkeys(
        (col.ANGLE, col.VOLUME, col.WORK, col.TIP_FORCE, col.TIP_Y, col.TIP_Z), 1.0
    )
    return [{col.PRESSURE: pressure, **zero} for pressure in (0.0, *pressures)]


def test_a_blocked_tip_that_does_not_reach_its_pressure_is_not_passed_over(tmp_path: Path) -> None:
    targets = [
        {"blocked-force": {"at": "60 kPa", "is": "1 N"}},
        {"straight-moment": {"at": "30 kPa", "least": "1 N*mm"}},
    ]
    vary = {"actuator.wall": {"from": "1 mm", "to": "3 mm"}}
    made = design(tmp_path, vary=vary, targets=targets)
    wanted = Tries(made, MadeUp()).wanted

    def body(*pressures: float) -> Body:
        def run(_: Case) -> RunResult:
            return RunResult("stopped", "it ends before", rows(*pressures), {}, None)

        return Body(run, made.quantities)

    # of the moment a body has nothing
    found, _ = body(60.0).states(made.data, wanted, 0)
    assert [state.value for state in found] == [pytest.approx(0.06)]
    with pytest.raises(UnsolvedError, match="it ends before"):
        body(40.0).states(made.data, wanted, 0)

"""Rods in motion that are stopped, or run on two ranks."""

from __future__ import annotations

import csv
import json
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fiberbend import columns as col
from fiberbend.case.case import Case
from fiberbend.reader.reader import read_case
from fiberbend.running.runner import run_case
from rod.functions import Floats
from rod.law import Law, Linear
from tests.conftest import MpiRun
from tests.slender.rods import by_law as by_law
from tests.slender.rods import case, linear

SHIPPED = Path(__file__).resolve().parents[2] / "cases" / "swing.yaml"
Put = Callable[[Law], None]
PRESSED = {"pressure": {"to": "20 kPa"}}
WEIGHT = {"gravity": {"direction": "-y"}}
BENT = linear((30.0, 400.0))
SINE = {"sine": {"mean": "10 kPa", "amplitude": "10 kPa", "frequency": "4 Hz"}}


def moving(pressure: dict[str, Any], *effects: dict[str, Any]) -> Case:
    time = {"duration": "300 ms", "step": "5 ms", "pressure": pressure}
    return case(*effects, time=time | {"damping": {"retardation_time": "3 ms"}})


class Stopped(Linear):
    """A law that sends the program a signal once it has been asked often enough."""

    left = 120

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `rod.law.Law`."""
        type(self).left -= 1
        if not self.left:
            signal.raise_signal(signal.SIGINT)
        return super().gradient(strains, pressure)


def test_stopped_it_keeps_its_rows(tmp_path: Path, by_law: Put) -> None:
    by_law(Stopped(BENT.stiffness, BENT.rest, BENT.area, BENT.thrust))
    given, folder = moving(SINE, WEIGHT, PRESSED), tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        run_case(given, folder)
    with (folder / "history.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert 10 < len(rows) < 60
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    assert run["status"] == "interrupted"
    assert f"stopped at {float(rows[-1]['time_s']):.4g} s" in run["reason"]


@pytest.mark.long
@pytest.mark.mpi
def test_two_ranks_move_as_one(mpirun: MpiRun, tmp_path: Path) -> None:
    settings = ["time.duration=50 ms", "output={pictures: false, report: false}"]
    given = [part for each in settings for part in ("--set", each)]
    folder = tmp_path / "run"
    done = mpirun(2, ["-m", "fiberbend", "run", SHIPPED, *given, "--out", folder])
    assert done.returncode == 0, done.stderr
    assert json.loads((folder / "run.json").read_text(encoding="utf-8"))["ranks"] == 2
    alone = run_case(read_case(SHIPPED, settings), None)
    with (folder / "history.csv").open(newline="", encoding="utf-8") as file:
        found = list(csv.DictReader(file))
    assert len(found) == 11
    for row, exact in zip(found, alone.rows, strict=True):
        assert float(row["tip_y_mm"]) == pytest.approx(exact[col.TIP_Y], rel=1e-9)

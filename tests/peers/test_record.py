"""What runs of other programs leave, and how their times are compared."""

import dataclasses
import datetime
import sys
from pathlib import Path

import pytest

from bench.peers.record import GOALS, Record, load_record, run
from bench.peers.table import page, points_of, ratios, reference_of, seconds_at

ANGLES = [30.0, 60.0, 91.0, 120.0, 150.0, 181.0]


def record(program: str, unknowns: int, error: float, cpu: float, last: int = 6) -> Record:
    """A made-up run whose pressures are linear in the angle and too high by a part."""
    return Record(
        program=program,
        version="1",
        section=1,
        axial=8.0,
        elements=unknowns // 30,
        unknowns=unknowns,
        kPa=[angle / 2 * (1 + error) for angle in ANGLES[:last]],
        degrees=ANGLES[:last],
        done=[10 * (i + 1) for i in range(last)],
        iterations=10 * last,
        wall=cpu,
        cpu=cpu,
        memory=100.0,
        load=0.1,
        ended="" if last == len(ANGLES) else "time limit of 5 s",
    )


OURS = [
    record("fiberbend", 1000, 0.04, 2.0),
    record("fiberbend", 4000, 0.01, 8.0),
    record("fiberbend", 16000, 0.0, 32.0),
]


def test_a_pressure_is_read_between_load_steps() -> None:
    run_ = OURS[0]
    assert run_.pressure(90.0) == pytest.approx(45 * 1.04)
    assert run_.pressure(200.0) is None
    assert run_.share(90.0) == pytest.approx(0.5)
    assert run_.steps(90.0) == 3


def test_errors_are_those_against_fiberbend_s_finest_mesh() -> None:
    reference = reference_of(OURS, 90.0)
    assert reference.kPa == pytest.approx(45.0)
    assert reference.apart == pytest.approx(0.01)
    points = points_of(OURS, "fiberbend", 90.0, reference)
    assert [point.error for point in points] == pytest.approx([0.04, 0.01])
    assert [point.seconds for point in points] == pytest.approx([1.0, 4.0])


def test_one_mesh_alone_is_no_reference() -> None:
    with pytest.raises(ValueError, match="90° on 1 meshes, expected two"):
        reference_of(OURS[:1], 90.0)


def test_the_time_for_an_error_lies_between_meshes() -> None:
    points = points_of(OURS, "fiberbend", 90.0, reference_of(OURS, 90.0))
    assert seconds_at(points, 0.02) == pytest.approx(2.0)
    assert seconds_at(points, 0.01 * (1 + 1e-9)) == pytest.approx(4.0, rel=1e-6)
    assert seconds_at(points, 0.5) == pytest.approx(1.0)
    assert seconds_at(points, 0.005) is None


def test_a_mesh_that_a_cheaper_one_beats_does_not_count() -> None:
    worse = record("fiberbend", 2000, 0.05, 6.0)
    points = points_of([*OURS, worse], "fiberbend", 90.0, reference_of(OURS, 90.0))
    assert seconds_at(points, 0.02) == pytest.approx(2.0)


def test_ratios_are_at_the_other_s_error() -> None:
    other = record("felupe", 3000, -0.02, 60.0)
    assert [ratio for _, ratio in ratios([*OURS, other], "felupe", 90.0)] == pytest.approx([15.0])


def test_what_was_not_reached_is_said() -> None:
    other = record("calculix-c3d20r", 3000, -0.02, 120.0, last=3)
    text = page([*OURS, other], "a machine", datetime.date(2026, 1, 1))
    (row,) = (line for line in text.splitlines() if "CalculiX, C3D20R 1 |" in line)
    assert "| 91° |" in row
    assert "| – | – |" in row
    assert "time limit of 5 s" in row
    assert "- CalculiX, C3D20R: 60.0 times; 10 times everywhere." in text
    assert f"bends to {GOALS[-1]:g}°" in text
    assert "The machine was busy" not in text
    busy = page([*OURS, dataclasses.replace(other, load=9.0)], "a machine", datetime.date.today())
    assert "The machine was busy with other work (load average up to 9)" in busy
    slow = dataclasses.replace(other, cpu=10.0)
    text = page([*OURS, slow], "a machine", datetime.date(2026, 1, 1))
    assert "CalculiX, C3D20R: 5.0 times; 10 times nowhere." in text


def test_a_verdict_counts_runs_and_angles() -> None:
    fast, slow = (record("dolfinx-dpc1", n, -0.02, cpu) for n, cpu in ((3000, 100.0), (2000, 10.0)))
    text = page([*OURS, fast, slow], "a machine", datetime.date(2026, 1, 1))
    assert "discontinuous: 2.5 to 25.0 times; 10 times in 2 of 4." in text
    assert "plain dolfinx, Q2–Q1: no run that can be compared." in text


def test_a_record_is_read_as_it_was_saved(tmp_path: Path) -> None:
    OURS[0].save(tmp_path / "a.json")
    assert load_record(tmp_path / "a.json") == OURS[0]


def test_a_process_is_measured(tmp_path: Path) -> None:
    code = "import os; x = bytearray(200_000_000); print(os.environ['OMP_NUM_THREADS']); exit(3)"
    usage = run([sys.executable, "-c", code], tmp_path, 60, {}, tmp_path / "log")
    assert usage.code == 3
    assert usage.memory > 190
    assert (tmp_path / "log").read_text() == "1\n"


def test_a_process_is_ended_at_its_limit(tmp_path: Path) -> None:
    code = "import time; time.sleep(60)"
    usage = run([sys.executable, "-c", code], tmp_path, 0.5, {}, tmp_path / "log")
    assert usage.code is None
    assert usage.wall < 30

"""The command: no rung twice, none lost, whatever is killed or damaged."""

from __future__ import annotations

import csv
import dataclasses
import functools
import json
import signal
from pathlib import Path
from typing import Any

import pytest

from fiberbend.cli import main
from fiberbend.ladder.asked import asked
from fiberbend.ladder.command import Options, duration, run_ladder
from fiberbend.ladder.record import FAILED, LATE, Record, Store
from fiberbend.ladder.rungs import Ladder, Rung, ladder
from fiberbend.ladder.solve import Processes, _Found
from fiberbend.ladder.words import seconds
from fiberbend.models.costs.price import price
from fiberbend.plan.memory import Room, gigabytes
from fiberbend.schema.problems import CaseError
from tests.conftest import ROOT
from tests.ladder.parts import CASE, record, truth

SECTION = ROOT / "cases" / "section.yaml"
ONLY = Options(only=("analytic", "section-spread"))


class Solver:
    """Stands for the process that solves a rung; notes which."""

    def __init__(self, act: str = "", at: str = "") -> None:
        self.names: list[str] = []
        self._act, self._at = act, at

    def __call__(self, rung: Rung, most_s: float | None, verbose: bool) -> Record:
        """Its record, or what is to happen."""
        self.names.append(rung.name)
        found = record(rung, {each.name: truth(rung, each) for each in asked(rung.case)})
        if not self._at or self._at not in rung.name:
            return found
        if self._act == "interrupt":
            raise KeyboardInterrupt
        return dataclasses.replace(found, status=self._act, reason="det F at element 7", values={})


def run(
    out: Path,
    solver: Solver,
    options: Options = ONLY,
    settings: tuple[str, ...] = (),
    draws: bool = False,
) -> tuple[int, list[str]]:
    """The command with a solver of a few lines; the rungs of a case are made up once."""
    said: list[str] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("fiberbend.ladder.command.ladder", rungs_of)
        if not draws:
            patch.setattr("fiberbend.ladder.picture.draw", lambda *_: None)
        code = run_ladder(CASE, out, settings, options, said.append, solver)
    return code, said


@functools.cache
def rungs_of(path: Path, settings: tuple[str, ...]) -> Ladder:
    """The ladder of a case."""
    return ladder(path, settings)


def test_a_ladder_leaves_table_picture_and_advice(tmp_path: Path) -> None:
    code, said = run(tmp_path / "out", Solver(), draws=True)
    assert code == 0
    assert said[0].startswith("5 rungs, 0 solved before, about ")
    assert any(line.startswith("[ 3/5] section-spread-s2") and "to go" in line for line in said)
    (text,) = (line for line in said if line.startswith("For "))
    assert text.startswith('For 1 % take "section, spread winding, mesh.section ')
    assert f"\n  fiberbend run {CASE} --set model=section --set " in text
    with (tmp_path / "out" / "accuracy.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5
    first = next(row for row in rows if row["rung"] == "section-spread-s2")
    assert float(first["pressure_90deg_kPa"]) == pytest.approx(97.5)
    assert float(first["mesh_error_percent"]) == pytest.approx(100 * 0.5 / 97, rel=1e-4)
    assert "model=section" in first["settings"]
    text = (tmp_path / "out" / "accuracy.md").read_text()
    assert "| **section, spread winding, mesh.section 1** |" in text
    assert "section-turns: effects.1.winding" in text
    found = json.loads((tmp_path / "out" / "accuracy.json").read_text())
    assert found["reference"] == "section-spread"
    assert (tmp_path / "out" / "accuracy.png").read_bytes().startswith(b"\x89PNG")


def test_no_rung_is_solved_twice(tmp_path: Path) -> None:
    first, again, more = Solver(), Solver(), Solver()
    assert run(tmp_path, first)[0] == 0
    assert run(tmp_path, again)[0] == 0
    assert len(first.names) == 5
    assert again.names == []
    code, _ = run(tmp_path, more, Options(only=("cell",)))
    assert code == 0
    assert len(more.names) == 6
    # what was solved before counts too
    assert json.loads((tmp_path / "accuracy.json").read_text())["reference"] == "cell-turns"
    assert len(json.loads((tmp_path / "accuracy.json").read_text())["rungs"]) == 11


def test_another_case_or_program_is_another_rung(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(tmp_path, Solver())
    other = Solver()
    thick = ("actuator.wall=3 mm",)
    run(tmp_path, other, settings=thick)
    assert len(other.names) == 5
    monkeypatch.setattr("fiberbend.ladder.record.__version__", "9.9")
    newer = Solver()
    run(tmp_path, newer, settings=thick)
    assert len(newer.names) == 5


@pytest.mark.parametrize(
    "damage",
    [
        "",
        "{",
        "[]",
        "null",
        "{}",
        '{"name": 1}',
        lambda text: text[: len(text) // 2],
        lambda text: text.replace('"wall_s"', '"wall"'),
        lambda text: text.replace('"values": {', '"values": {"x": NaN, '),
        lambda text: text.replace('"key": {', '"key": {"more": "1", '),
    ],
)
def test_a_damaged_file_is_solved_again(tmp_path: Path, damage: object) -> None:
    run(tmp_path, Solver())
    file = tmp_path / "rungs" / "section-spread-s3.json"
    whole = file.read_text()
    file.write_text(damage(whole) if callable(damage) else str(damage))
    again = Solver()
    assert run(tmp_path, again)[0] == 0
    assert again.names == ["section-spread-s3"]
    assert json.loads(file.read_text()) == json.loads(whole)


def test_a_failed_rung_is_named_and_kept(tmp_path: Path) -> None:
    code, said = run(tmp_path, Solver(FAILED, "s3"))
    assert code == 2
    assert "failed: section-spread-s3: det F at element 7" in said
    text = (tmp_path / "accuracy.md").read_text()
    head, _, named = text.partition("Rungs that failed.")
    assert "- section-spread-s3: failed, det F at element 7" in named
    # it counts nowhere: no row, and no mesh of its family
    assert "mesh.section 3" not in head
    assert "section-spread-s3,section," in (tmp_path / "accuracy.csv").read_text()
    again = Solver()
    assert run(tmp_path, again)[0] == 2
    assert again.names == []
    retried = Solver()
    assert run(tmp_path, retried, dataclasses.replace(ONLY, retry=True))[0] == 0
    assert retried.names == ["section-spread-s3"]


def test_a_rung_stopped_by_its_limit_is_named_and_not_kept(tmp_path: Path) -> None:
    code, _ = run(tmp_path, Solver(LATE, "s3"))
    assert code == 0
    assert "- section-spread-s3: det F at element 7" in (tmp_path / "accuracy.md").read_text()
    again = Solver()
    run(tmp_path, again)
    assert again.names == ["section-spread-s3"]


def test_interrupted_it_goes_on(tmp_path: Path) -> None:
    code, said = run(tmp_path, Solver("interrupt", "s3"))
    assert code == 128 + signal.SIGINT
    assert "interrupted; the same command goes on where it was" in said
    assert (tmp_path / "accuracy.csv").exists()
    again = Solver()
    assert run(tmp_path, again)[0] == 0
    assert again.names == ["section-spread-s3", "section-spread-s4"]


def test_what_does_not_fit_is_refused_and_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # of the sections the finest alone does not
    least = price("section", "quadrilaterals").memory_mb(3346, 1.0) - 1
    monkeypatch.setattr("fiberbend.ladder.command.room", lambda: Room(least, "of this machine"))
    small = Solver()
    code, said = run(tmp_path, small)
    assert code == 0
    assert "section-spread-s4" not in small.names
    assert any(line.startswith("not section-spread-s4: the rung needs about") for line in said)
    assert "- section-spread-s4: the rung needs about" in (tmp_path / "accuracy.md").read_text()
    forced = Solver()
    run(tmp_path, forced, dataclasses.replace(ONLY, force=True))
    assert "section-spread-s4" in forced.names


def test_nothing_solved_is_a_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fiberbend.ladder.command.room", lambda: Room(1.0, "of this machine"))
    code, said = run(tmp_path, Solver())
    assert code == 2
    assert said[-1].startswith("no rung is solved: ")


def test_a_dry_run_writes_nothing(tmp_path: Path) -> None:
    code, said = run(tmp_path / "out", Solver(), Options(dry=True))
    assert code == 0
    assert not (tmp_path / "out").exists()
    rungs = ladder(CASE, ()).rungs
    total = sum(rung.seconds for rung in rungs)
    most = gigabytes(max(rung.memory_mb for rung in rungs))
    assert said[-1] == (
        f"{len(rungs)} rungs, about {seconds(total)} one after the other, at most {most} of memory"
    )
    # 459 s when it was fitted, good to a factor of two; most of it for bodies
    assert 150 < total < 1500
    assert sum(rung.seconds for rung in rungs if rung.family.model == "body") > total / 2
    assert any("body-turns-hexahedron-half-s1-a1.5mm" in line for line in said)


def test_a_dry_run_counts_what_is_solved_and_what_does_not_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(tmp_path, Solver())
    monkeypatch.setattr("fiberbend.ladder.command.room", lambda: Room(1000.0, "of this machine"))
    _, said = run(tmp_path, Solver(), Options(dry=True))
    large = [rung for rung in rungs_of(CASE, ()).rungs if rung.memory_mb > 1000]
    assert large
    assert sum("(solved before)" in line for line in said) == 5
    assert sum("(left out: more memory than is free)" in line for line in said) == len(large)
    assert f", 5 solved before, {len(large)} left out for want of memory, about " in said[-1]


def test_rungs_of_another_commit_are_solved_again_and_that_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run(tmp_path, Solver())
    monkeypatch.setattr("fiberbend.ladder.record._commit", lambda: "0" * 40)
    newer = Solver()
    _, said = run(tmp_path, newer)
    assert len(newer.names) == 5
    assert "5 rungs were solved with another commit: solved again" in said
    _, said = run(tmp_path, Solver())
    assert not any("solved again" in line for line in said)


def test_the_commands_of_the_advice_have_the_changes_of_the_case(tmp_path: Path) -> None:
    _, said = run(tmp_path, Solver(), settings=("actuator.wall=3 mm",))
    found = json.loads((tmp_path / "accuracy.json").read_text())["commands"]
    assert found
    for line in found:
        assert line.startswith(f"fiberbend run {CASE} --set 'actuator.wall=3 mm' --set model=")
        assert any(line in text for text in said)
        assert f"$ {line}" in (tmp_path / "accuracy.md").read_text()


def test_what_is_not_solved_yet_is_named(tmp_path: Path) -> None:
    run(tmp_path, Solver())
    text = (tmp_path / "accuracy.md").read_text()
    assert "- cell-turns: 6 rungs not solved yet" in text
    assert "- body-turns-hexahedron-full: 1 rung not solved yet" in text
    assert "- section-spread:" not in text


def test_times_of_a_busy_machine_are_said(tmp_path: Path) -> None:
    class Busy(Solver):
        def __call__(self, rung: Rung, most_s: float | None, verbose: bool) -> Record:
            found = super().__call__(rung, most_s, verbose)
            wall = 10 * found.wall_s if rung.name.endswith("s3") else found.wall_s
            return dataclasses.replace(found, wall_s=wall)

    _, said = run(tmp_path, Busy())
    assert any(line.startswith("warning: 1 of 5 rungs waited for the processor") for line in said)
    assert "**1 of 5 rungs waited" in (tmp_path / "accuracy.md").read_text()
    _, said = run(tmp_path / "idle", Solver())
    assert not any("waited" in line for line in said)


def test_quiet_gives_the_advice_alone(tmp_path: Path) -> None:
    _, said = run(tmp_path, Solver(), dataclasses.replace(ONLY, quiet=True))
    assert len(said) == 1
    assert said[0].startswith("For 1 % take")
    assert all(line.startswith("  fiberbend run ") for line in said[0].splitlines()[1:])
    _, loud = run(tmp_path, Solver(), dataclasses.replace(ONLY, verbose=True))
    assert any(line.startswith("| **section, spread winding, mesh.section 1** |") for line in loud)


@pytest.mark.parametrize(
    ("arguments", "wrong"),
    [
        (["--only", "sektion"], "--only sektion: no rung of this case has it, expected analytic"),
        (["--within", "soon"], '--within: "soon", expected a time above zero'),
        (["--within", "0s"], '--within: "0s", expected a time above zero'),
        (["--set", "actuator.wall=3"], "actuator.wall: "),
        (["--set", "nothing=3"], "nothing: "),
    ],
)
def test_wrong_options_are_refused(
    arguments: list[str], wrong: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["accuracy", str(CASE), "--out", str(out), *arguments]) == 1
    assert wrong in capsys.readouterr().err
    assert not out.exists()


@pytest.mark.parametrize("arguments", [["--fast"], ["--quiet", "-v"]])
def test_unknown_options_are_refused(arguments: list[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["accuracy", str(CASE), *arguments])
    assert stop.value.code == 1


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("all of it")
    with pytest.raises(CaseError, match="contains no ladder"):
        run(tmp_path, Solver())
    held = tmp_path / "held"
    store = Store(held)
    try:
        with pytest.raises(CaseError, match="in use by"):
            run(held, Solver())
    finally:
        store.close()


@pytest.mark.parametrize(
    ("first", "runs", "forgotten"),
    [
        ({"compiled": False, "calibration": "", "made": False}, 1, []),
        ({"compiled": True, "calibration": "", "made": False}, 2, []),
        # made here, without a compiler beside it: its time is that of this ladder
        ({"compiled": False, "calibration": "abc", "made": True}, 1, []),
        ({"compiled": True, "calibration": "abc", "made": True}, 2, ["abc"]),
        ({"compiled": False, "calibration": "abc", "made": False}, 2, ["abc"]),
    ],
)
def test_a_calibration_of_another_day_is_made_again_once(
    first: dict[str, Any], runs: int, forgotten: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    rung = rungs_of(CASE, ()).rungs[1]
    calls: list[_Found] = []
    gone: list[str] = []

    def once(rung: Rung, most_s: float | None, verbose: bool) -> tuple[Record, _Found]:
        calls.append(_Found(**first))
        return record(rung, {}), calls[-1]

    monkeypatch.setattr("fiberbend.ladder.solve._once", once)
    monkeypatch.setattr(
        "fiberbend.ladder.solve.Store.forget", lambda _, digest: gone.append(digest)
    )
    processes = Processes()
    processes(rung)
    assert (len(calls), gone) == (runs, forgotten)
    # the next rung takes what this ladder has made
    first = first | {"compiled": False, "made": False}
    processes(rung)
    assert (len(calls), gone) == (runs + 1, forgotten)


def test_duration() -> None:
    assert [duration(text) for text in ("60s", "2 min", "0.5h")] == [60.0, 120.0, 1800.0]

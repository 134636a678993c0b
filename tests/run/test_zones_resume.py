"""A run over zones that is killed goes on with the zones that it had solved."""

from __future__ import annotations

import copy
import signal
from pathlib import Path
from typing import Any

import pytest
import yaml

from bench.survive import end, kill, launch
from fiberbend.models.result import RunResult
from fiberbend.reader.reader import as_case
from fiberbend.results.reading import read_history
from fiberbend.running.progress import Progress
from fiberbend.running.runner import run_case
from fiberbend.running.zones.march import ZoneMarch
from fiberbend.sweep.store import _run
from tests.run.test_zones import BASE, STRIP, WOUND

FIRST, SECOND = "zones/zone_1.npz", "zones/zone_2.npz"
HELIX = {"pattern": "single-helix-left", "pitch": "6 mm", "fiber": "kevlar", "as": "smeared"}
CASE: dict[str, Any] = copy.deepcopy(BASE) | {
    "zones": [{"length": "24 mm", "strip": STRIP | {"tension_only": True}}, {"winding": HELIX}],
    "effects": [*BASE["effects"], {"winding": WOUND}],
    "output": BASE["output"] | {"at_angles": ["4 deg"], "at_pressures": ["31 kPa"]},
}
SAME = ("status", "load_steps", "newton_iterations", "factorisations", "cutbacks", "zones")


class _KillError(Exception):
    """Stands for the end of the process."""


class _Killed(Progress):
    """Ends a run in a zone, at its third step, or at a phase; keeps what was said before."""

    def __init__(self, zone: int = 0, phase: str = "") -> None:
        super().__init__(quiet=True)
        self._zone, self._at, self._begun = zone, phase, 0
        self.lines: list[str] = []

    def step(self, step: int, *rest: Any) -> None:
        """End it."""
        self._begun += step == 1
        if (self._begun, step) == (self._zone, 3):
            raise _KillError

    def phase(self, name: str) -> None:
        """End it."""
        super().phase(name)
        if name == self._at:
            raise _KillError

    def message(self, text: str) -> None:
        """Keep it."""
        self.lines.append(text)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> RunResult:
    """The run that nobody has killed."""
    result = run_case(as_case(CASE), tmp_path_factory.mktemp("whole") / "run")
    assert (result.status, result.reason) == ("converged", "")
    return result


@pytest.fixture
def marched(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of the zones that are solved."""
    found: list[int] = []
    march = ZoneMarch.march

    def seen(self: ZoneMarch, *given: Any) -> None:
        found.append(self.number)
        march(self, *given)

    monkeypatch.setattr(ZoneMarch, "march", seen)
    return found


def cut(out: Path, zone: int = 0, phase: str = "") -> Path:
    """The folder of a run that was killed."""
    with pytest.raises(_KillError):
        run_case(as_case(CASE), out, progress=_Killed(zone, phase))
    return out


def on(out: Path) -> tuple[RunResult, list[str]]:
    heard = _Killed()
    return run_case(as_case(CASE), out, resume=True, progress=heard), heard.lines


def assert_bitwise(again: RunResult, whole: RunResult) -> None:
    """All that is read off the states, and what they have cost."""
    assert again.rows == whole.rows
    for key in SAME:
        assert again.run[key] == whole.run[key], key


def test_a_zone_that_was_solved_is_not_solved_again(
    whole: RunResult, tmp_path: Path, marched: list[int]
) -> None:
    out = cut(tmp_path / "run", zone=2)
    assert marched == [0, 1]
    assert (out / FIRST).exists()
    assert not (out / SECOND).exists()
    again, lines = on(out)
    assert marched == [0, 1, 1]
    assert "zone 1 taken up as it was solved" in lines
    assert_bitwise(again, whole)


@pytest.mark.parametrize("phase", ["crosscheck", "output"])
def test_all_zones_are_chained_again_after_a_kill_behind_them(
    phase: str, whole: RunResult, tmp_path: Path, marched: list[int]
) -> None:
    again, _ = on(cut(tmp_path / "run", phase=phase))
    assert marched == [0, 1]
    assert_bitwise(again, whole)


def test_a_kill_in_the_first_zone_leaves_nothing(
    whole: RunResult, tmp_path: Path, marched: list[int]
) -> None:
    again, lines = on(cut(tmp_path / "run", zone=1))
    assert marched == [0, 0, 1]
    assert not any("taken up" in line for line in lines)
    assert_bitwise(again, whole)


@pytest.mark.parametrize(
    "damage", [b"", *(pytest.param(each, marks=pytest.mark.long) for each in (b"no archive", None))]
)
def test_a_damaged_zone_is_solved_again(
    damage: bytes | None, whole: RunResult, tmp_path: Path, marched: list[int]
) -> None:
    out = cut(tmp_path / "run", phase="crosscheck")
    content = (out / FIRST).read_bytes()
    (out / FIRST).write_bytes(content[: len(content) // 2] if damage is None else damage)
    again, lines = on(out)
    assert marched == [0, 1, 0]
    assert f"{out / FIRST} is damaged: zone 1 is solved again" in lines
    assert_bitwise(again, whole)


def test_overwrite_leaves_no_zone(tmp_path: Path, marched: list[int]) -> None:
    out = cut(tmp_path / "run", zone=2)
    with pytest.raises(_KillError):
        run_case(as_case(CASE), out, overwrite=True, progress=_Killed(zone=1))
    assert marched == [0, 1, 0]
    assert not (out / FIRST).exists()


def test_a_sweep_goes_on_with_the_zones_of_its_point(
    whole: RunResult, tmp_path: Path, marched: list[int]
) -> None:
    out = cut(tmp_path / "run", zone=2)
    run = _run(as_case(CASE), out, force=True)
    assert marched == [0, 1, 1]
    assert run["newton_iterations"] == whole.run["newton_iterations"]


@pytest.mark.long
def test_killed_by_a_signal_and_gone_on_with(whole: RunResult, tmp_path: Path) -> None:
    """A process that ends by SIGKILL, and one that is told to stop, in the second zone."""
    case, out = tmp_path / "case.yaml", tmp_path / "run"
    case.write_text(yaml.safe_dump(CASE))
    command: list[str | Path] = ["run", case, "--out", out]
    for number in (signal.SIGKILL, signal.SIGTERM):
        process = launch(1, command)
        assert process.stdout is not None
        begun = 0
        for line in process.stdout:
            begun += line.startswith("step   1")
            if begun == (2 if number == signal.SIGKILL else 1):
                break
        if number == signal.SIGKILL:
            kill(process)
            assert (out / FIRST).exists()
        else:
            process.send_signal(number)
            _, text = end(process)
            assert "stopped in zone 2, those before it kept; go on with --resume" in text
        command = ["run", case, "--out", out, "--resume"]
    code, text = end(launch(1, command))
    assert code == 0, text
    folder = whole.folder
    assert folder is not None
    assert read_history(out / "history.csv") == read_history(folder / "history.csv")

"""The command `fiberbend hand`: several actuators with what they grasp, in a folder."""

from __future__ import annotations

import dataclasses
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from fiberbend.hand.reading import Hand, read_hand
from fiberbend.process import signals
from fiberbend.results.folder import HAND, HISTORY_FILE
from fiberbend.results.held import held
from fiberbend.running import launch, record
from fiberbend.schema.problems import CaseError, Problem

if TYPE_CHECKING:
    from fiberbend.hand.assembled import Assembled
    from fiberbend.hand.solved import Moment, Solved
    from fiberbend.results.folder import RunFolder

Say = Callable[[str], None]
VIEWS, STATES, CURVES = "hand_views.png", "hand_states.png", "hand_curves.png"
CONVERGED, FAILED = "converged", "failed"


@dataclasses.dataclass(frozen=True)
class Options:
    """How a hand is solved.

    Attributes:
        overwrite: replace an earlier one in the folder.
        quiet: no progress; the answer alone.
    """

    overwrite: bool = False
    quiet: bool = False


def run_hand(
    path: Path,
    out: Path,
    changes: Sequence[str] = (),
    options: Options | None = None,
    say: Say = print,
) -> int:
    """Solve a hand and write its folder.

    Args:
        path: the hand file.
        out: the folder.
        changes: changes to the cases of all fingers.
        options: how it is solved.
        say: takes lines for the user.

    Returns:
        The exit code: 0 with all states, 2 where a state was not found.

    Raises:
        CaseError: file, changes or folder are wrong; nothing has been solved.
    """
    options = options or Options()
    if launch.size() > 1:
        text = "under mpirun, expected one process: rods are too small to share"
        raise CaseError([Problem("fiberbend hand", text)])
    hand = read_hand(path, changes)
    with held(out, HAND, "hand", options.overwrite) as folder:
        launch.settle_folders()
        launch.start_mpi()
        return _Made(hand, folder, options, say).go()


class _Made:
    """A hand that is being solved; see `run_hand`."""

    def __init__(self, hand: Hand, folder: RunFolder, options: Options, say: Say) -> None:
        self._hand, self._folder, self._say = hand, folder, say
        self._tell: Say = (lambda _line: None) if options.quiet else say
        self._wall: dict[str, float] = {}
        self._warnings: list[str] = []

    def go(self) -> int:
        """Make the laws, solve, write; the exit code."""
        from fiberbend.answer.answer import lines
        from fiberbend.hand.assembled import Assembled
        from fiberbend.hand.rows import rows, text
        from fiberbend.hand.solved import solve_hand
        from fiberbend.hand.told import answer

        with self._phase("law"):
            assembled = Assembled(self._hand)
        content = yaml.safe_dump(self._hand.resolved, sort_keys=False, allow_unicode=True)
        self._folder.write_text(HAND, content)
        with self._phase("solve"):
            solved = solve_hand(assembled, self._listen)
        found = rows(assembled, solved)
        self._folder.write_text(HISTORY_FILE, text(found))
        told = answer(assembled, solved, found)
        self._warnings += told.warnings
        with self._phase("output"):
            self._draw(assembled, solved, found)
        self._write(assembled, solved, found)
        for line in lines(dataclasses.replace(told, warnings=tuple(self._warnings))):
            self._say(line)
        if solved.reason:
            launch.say(f"{FAILED}: {solved.reason}", sys.stderr)
        self._say(f"results in {self._folder.path}")
        return launch.FAILED if solved.reason else 0

    @contextmanager
    def _phase(self, name: str) -> Iterator[None]:
        begun = time.monotonic()
        yield
        self._wall[name] = round(time.monotonic() - begun, 3)

    def _listen(self, moment: Moment, part: float, iterations: int) -> None:
        signals.check()
        if moment.pressure:
            self._tell(f"{100 * part:.0f} %, {iterations} iterations")

    def _draw(self, hand: Assembled, solved: Solved, rows: Sequence[dict[str, Any]]) -> None:
        """Pictures that are asked for; what cannot be drawn costs a warning."""
        from fiberbend.drawing.renderer import Renderer
        from fiberbend.hand.pictures import HandPictures, draw_curves
        from fiberbend.running.outputs import pictures

        output, folder = self._hand.output, self._folder
        if output.pictures:
            folder.write(f"pictures/{CURVES}", lambda file: draw_curves(hand, rows, file))
        if not (output.pictures or output.animation):
            return
        with pictures(self._warnings.append), Renderer() as renderer:
            drawn = HandPictures(hand, solved.moments, rows, renderer)
            if output.pictures:
                folder.write(f"pictures/{VIEWS}", drawn.views)
                folder.write(f"pictures/{STATES}", drawn.states)
            if output.animation:
                folder.write("pictures/animation.gif", drawn.animation)

    def _write(self, hand: Assembled, solved: Solved, rows: Sequence[dict[str, Any]]) -> None:
        """run.json."""
        import numpy as np

        names = [finger.name for finger in self._hand.fingers]
        counts = {
            "fingers": names,
            "objects": list(self._hand.objects),
            "unknowns": len(hand.system.at_rest()),
            "load_steps": solved.steps,
            "newton_iterations": sum(solved.iterations),
            "touches": [
                {
                    "finger": names[touch.finger],
                    "what": names[touch.other] if isinstance(touch.other, int) else touch.other,
                    "weight": touch.weight,
                    "pressure": touch.pressure,
                }
                for touch in solved.touches
            ],
            "warnings": self._warnings,
        }
        entries = record.entries(
            FAILED if solved.reason else CONVERGED,
            solved.reason,
            "rod",
            counts,
            self._wall,
            record.peak_memory_mb(),
            1,
            {"numpy": np.__version__},
        )
        self._folder.write_run(**entries)

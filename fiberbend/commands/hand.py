"""The command `fiberbend hand`: several actuators and what they grasp."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fiberbend.process import signals
from fiberbend.reader.arguments import Changes
from fiberbend.running import launch
from fiberbend.running.launch import say
from fiberbend.schema.problems import CaseError
from machine.folders import MachineError

_Changes = Annotated[
    Changes,
    Parameter(help='Change the cases of all fingers, such as actuator.length="80 mm"; repeatable.'),
]


def hand(
    file: Annotated[Path, Parameter(name="HAND")],
    /,
    *,
    settings: _Changes = (),
    out: Path | None = None,
    overwrite: bool = False,
    quiet: bool = False,
) -> int:
    """Solve several actuators as rods, with what they grasp, and print what it answers.

    The file has fingers, each with a case and a place, and rigid objects. They touch objects and
    each other without friction. The folder gets the curves (history.csv: angle, tip and forces of
    every finger, force and moment on every object), run.json, pictures and an animation.

    Args:
        file: Hand file, YAML.
        settings: Changes to the cases of all fingers.
        out: Folder; runs/HAND unless given.
        overwrite: Replace an earlier run.
        quiet: No progress; the answer alone.
    """
    from fiberbend.hand.command import Options, run_hand

    folder = out or Path("runs") / file.stem
    try:
        with signals.raising():
            return run_hand(file, folder, settings, Options(overwrite, quiet), say)
    except (CaseError, MachineError):
        raise
    except KeyboardInterrupt as error:
        return launch.stopped(signals.stop_of(error))
    except Exception as error:
        return launch.crash(error, folder)

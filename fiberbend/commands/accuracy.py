"""The command `fiberbend accuracy`: what accuracy costs in time, for a case."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import CycloptsError, Parameter

from fiberbend.process import signals
from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running import launch
from fiberbend.running.launch import say
from fiberbend.schema.problems import CaseError
from machine.folders import MachineError

# A docstring's line breaks would be those of the help.
_WITHIN = "Skip rungs that are expected to take longer each, such as 60s or 2min."
_ONLY = (
    "Solve these rungs alone: a model, words of a family such as body-turns, or a rung's name; "
    "repeatable. What was solved before counts too."
)


def accuracy(
    case: CaseFile,
    /,
    *,
    settings: Changes = (),
    out: Path | None = None,
    within: Annotated[str, Parameter(metavar="TIME", help=_WITHIN)] = "",
    only: Annotated[
        tuple[str, ...], Parameter(metavar="RUNG", consume_multiple=False, help=_ONLY)
    ] = (),
    retry: bool = False,
    dry_run: bool = False,
    quiet: bool = False,
    verbose: Annotated[bool, Parameter(name=("--verbose", "-v"))] = False,
    force: bool = False,
) -> int:
    """Show what accuracy costs in time: solve a case by every model, with several meshes each.

    Each rung is solved in a process of its own, one at a time: leave the machine idle. Started
    again, the command goes on. Its folder gets a picture of error against time (accuracy.png), a
    table (accuracy.csv, accuracy.md) and a file of each rung. It ends with one sentence on which
    model and mesh to take, and the commands for them.

    Args:
        case: Case file.
        settings: Changes to it.
        out: Folder; runs/accuracy_CASE unless given.
        within: Skip rungs that take longer.
        only: Solve these rungs alone.
        retry: Solve failed rungs again.
        dry_run: Print rungs, time and memory; solve and write nothing.
        quiet: No progress; the advice and its commands alone.
        verbose: Print load steps and the table too.
        force: Solve rungs even if there is not enough memory.
    """
    from fiberbend.ladder.command import Options, duration, run_ladder

    if quiet and verbose:
        raise CycloptsError(msg="--quiet and --verbose together, expected one of them")
    most = duration(within) if within else None
    options = Options(most, only, retry, force, dry_run, quiet, verbose)
    folder = out or Path("runs") / f"accuracy_{case.stem}"
    try:
        with signals.raising():
            return run_ladder(case, folder, settings, options, say)
    except (CaseError, MachineError):
        raise
    except KeyboardInterrupt as error:
        return launch.stopped(signals.stop_of(error))
    except Exception as error:
        return launch.crash(error, folder)

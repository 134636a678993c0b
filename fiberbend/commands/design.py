"""The command `fiberbend design`: from what an actuator is to do to its case."""

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
    Changes, Parameter(help='Change the base case, such as actuator.length="80 mm"; repeatable.')
]


def design(
    file: Annotated[Path, Parameter(name="DESIGN")],
    /,
    *,
    settings: _Changes = (),
    out: Path | None = None,
    overwrite: bool = False,
    quiet: bool = False,
    force: bool = False,
) -> int:
    """Find the case that does what is wanted, and confirm it by the whole body.

    The file has a base case, the fields that may change with their ends, and what is wanted:
    angles at pressures, forces, strains, sizes, and what is to be least or greatest. Its folder
    gets the case (winner.yaml), what holds it and how it changes with every dimension
    (design.json, sensitivity.csv), all cases that were tried, pictures and report.html. Where no
    case has all that is wanted, it says which limit stops it, and the nearest case is nearest.yaml.

    Args:
        file: Design file, YAML.
        settings: Changes to the base case.
        out: Folder; runs/DESIGN unless given.
        overwrite: Replace an earlier design.
        quiet: No progress; the answer alone.
        force: Solve the body even if there is not enough memory.
    """
    from fiberbend.design.command import Options, run_design

    folder = out or Path("runs") / file.stem
    options = Options(overwrite, quiet, force)
    try:
        with signals.raising():
            return run_design(file, folder, settings, options, say)
    except (CaseError, MachineError):
        raise
    except KeyboardInterrupt as error:
        return launch.stopped(signals.stop_of(error))
    except Exception as error:
        return launch.crash(error, folder)

"""The command `fiberbend control`, with an option for everything that a loop is made of."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from fiberbend.control.settings import Options, read_settings
from fiberbend.process import signals
from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running import launch
from fiberbend.running.launch import say
from fiberbend.schema.descriptions import descriptions
from fiberbend.schema.quantities import Quantity
from fiberbend.schema.units import KINDS
from machine.folders import MachineError


def _text(name: str) -> tuple[str, Any, Any]:
    """An option as text, its help and default from the field that reads it."""
    field = Options.model_fields[name]
    default = field.default
    pair = isinstance(default, tuple)
    shown = " ".join(f'"{part}"' for part in default) if pair else str(default or "fitted")
    kinds = [part.kind for part in field.metadata if isinstance(part, Quantity)]
    kind = KINDS[kinds[0]].name.split()[-1] if kinds else name.split("_")[-1]
    annotation: Any = tuple[str, str] if pair else str
    if typing.get_origin(field.annotation) is typing.Literal:
        annotation = field.annotation
    option = Parameter(
        name=f"--{field.alias}",
        help=descriptions(Options).get(name),
        show_default=shown,
        metavar="LOW HIGH" if pair else kind.upper(),
        # "-10 deg" is a value
        allow_leading_hyphen=True,
    )
    return name, Annotated[annotation | None, option], dataclasses.field(default=None)


def lacks_value(tokens: Sequence[str]) -> str:
    """What is wrong with a command line in which an option of two values has fewer; else nothing.

    Args:
        tokens: of the command line.
    """
    for field in Options.model_fields.values():
        option, default = f"--{field.alias}", field.default
        if not isinstance(default, tuple) or option not in tokens:
            continue
        after = tokens[tokens.index(option) + 1 :][: len(default)]
        count = next((n for n, t in enumerate(after) if t.startswith("--")), len(after))
        if count < len(default):
            such = " ".join(f'"{part}"' for part in default)
            said = "no value" if not count else f'"{after[0]}" alone'
            return f"{option}: {said}, expected two values, such as {such}"
    return ""


if TYPE_CHECKING:

    class Loop:
        """The options of a loop as text."""
else:
    Loop = dataclasses.make_dataclass("Loop", map(_text, Options.model_fields), frozen=True)
    # cyclopts looks into no class of the module types, where Python 3.11 puts this one
    Loop.__module__ = __name__

_DEFAULT = Loop()


def control(
    case: CaseFile,
    /,
    *,
    settings: Changes = (),
    out: Path | None = None,
    overwrite: bool = False,
    loop: Annotated[Loop, Parameter(name="*")] = _DEFAULT,
) -> int:
    """Bend under feedback control: step response and sine.

    Args:
        case: Case file.
        settings: Changes to it.
        out: Folder; runs/CASE_control unless given.
        overwrite: Replace an earlier one.
        loop: The options of the loop.
    """
    from fiberbend.reader.reader import read_case
    from fiberbend.schema.problems import CaseError

    given = {name: value for name, value in vars(loop).items() if value is not None}
    checked, wanted = read_case(case, settings), read_settings(given)
    folder = out or Path("runs") / f"{case.stem}_control"
    try:
        launch.start_mpi()
        from fiberbend.control.command import run_control

        with signals.raising():
            result = run_control(checked, wanted, folder, overwrite)
    except (CaseError, MachineError):
        raise
    except KeyboardInterrupt as error:
        return launch.stopped(signals.stop_of(error))
    except BaseException as error:
        return launch.crash(error, folder)
    for line in result.lines("paper" in checked.compare):
        say(line)
    say(f"results in {folder}")
    return 0

"""The command `fiberbend show`: the actuator at rest, before anything is solved."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running.launch import say, settle_folders


def show(
    case: CaseFile,
    /,
    *,
    settings: Changes = (),
    out: Path | None = None,
    open_it: Annotated[bool, Parameter(name="--open")] = False,
) -> int:
    """Draw the actuator of a case at rest, with its dimensions; nothing is solved.

    Args:
        case: Case file.
        settings: Changes to it.
        out: PNG file; CASE_at_rest.png beside the case unless given.
        open_it: Open the picture.
    """
    from fiberbend.api.show import blueprint, facts
    from fiberbend.reader.reader import read_case
    from fiberbend.schema.problems import CaseError, Problem

    checked = read_case(case, settings)
    settle_folders()
    target = out or case.with_name(f"{case.stem}_at_rest.png")
    if target.suffix.lower() != ".png":
        raise CaseError([Problem(str(target), "expected a name that ends in .png")])
    found = list(facts(checked))
    say(f"{checked.title or case.stem}, at rest")
    wide = max(len(name) for name, _ in found)
    for name, words in found:
        say(f"  {name:<{wide}}  {words}")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        blueprint(checked).save(target)
    except OSError as error:
        raise CaseError([Problem(str(target), f"{error.strerror}, expected a file")]) from None
    say(f"picture: {target}")
    if open_it:
        from fiberbend.commands.opening import open_file

        open_file(target)
    return 0

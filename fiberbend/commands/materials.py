"""The command `fiberbend materials`: named materials, each with its source."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from fiberbend.running.launch import say, settle_folders
from fiberbend.schema.problems import CaseError, Problem

WIDTH = 100


def materials(
    name: str = "",
    /,
    *,
    kind: Annotated[
        Literal["rubber", "thread", "fabric", "paper"] | None,
        Parameter(metavar="rubber|thread|fabric|paper"),
    ] = None,
    plot: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    open_it: Annotated[bool, Parameter(name="--open")] = False,
) -> int:
    """List named rubbers, threads, fabrics and papers, or show one of them.

    Each has its law and coefficients, density, the range of its tests, source and licence; where
    two sources of one product disagree, both say so.

    Args:
        name: A material to show whole.
        kind: List these alone.
        plot: PNG file to write: stress over stretch of the rubber NAME, beside its tests.
        open_it: Open the picture.
    """
    from fiberbend.api import materials as known

    if not name:
        if plot is not None or open_it:
            raise CaseError([Problem("--plot", "no effect without NAME, expected a rubber")])
        found = known.materials(kind)
        if not found:
            say(f"no {kind} has a name so far: give modulus and thickness, or a file of your own")
        for entry in found:
            for line in known.lines(entry):
                # what is indented belongs to the name above it
                inner = " " * (6 if line.startswith(" ") else 0)
                _say(line, inner)
        return 0
    entry = known.material(name)
    if kind is not None and entry.kind != kind:
        raise CaseError([Problem("--kind", f"{kind}, but {name} is a {entry.kind}")])
    say(entry.name)
    rows = known.whole(entry)
    wide = max(len(label) for label, _ in rows)
    for label, words in rows:
        hanging = " " * (wide + 4)
        _say(f"  {label:<{wide}}  {words}", hanging)
    if plot is None and open_it:
        raise CaseError([Problem("--open", "no effect without --plot, expected a file")])
    if plot is not None:
        _draw(entry, plot)
        if open_it:
            from fiberbend.commands.opening import open_file

            open_file(plot)
    return 0


def _say(text: str, hanging: str) -> None:
    """Print a text in lines; addresses stay whole where they can."""
    import textwrap

    for line in textwrap.wrap(text, WIDTH, subsequent_indent=hanging, break_on_hyphens=False):
        say(line)


def _draw(entry: object, target: Path) -> None:
    """Write the picture of a rubber."""
    from fiberbend.api.material_picture import STYLE, draw
    from materials.named.entry import Rubber

    if not isinstance(entry, Rubber):
        raise CaseError([Problem("--plot", "expected a rubber: a straight line says nothing")])
    if target.suffix.lower() != ".png":
        raise CaseError([Problem(str(target), "expected a name that ends in .png")])
    settle_folders()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        draw(entry).savefig(target, dpi=STYLE.dpi)
    except OSError as error:
        raise CaseError([Problem(str(target), f"{error.strerror}, expected a file")]) from None
    say(f"picture: {target}")

"""The command `fiberbend init`: a first case file, by options or by questions."""

from __future__ import annotations

import functools
import shlex
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from fiberbend.running.launch import say
from fiberbend.schema.problems import CaseError, Problem, found, meant
from fiberbend.schema.units import parse

if TYPE_CHECKING:
    from fiberbend.reader.new_case import Part as NewPart

_PART = Parameter(consume_multiple=True, metavar="THICKNESS|MATERIAL", show_default=False)
Part = Annotated[tuple[str, ...], _PART]
_DEFAULTS = {"radius": "8 mm", "width": "16 mm", "height": "8 mm"}


def init(
    file: Path,
    /,
    *,
    title: str = "",
    section: str = "",
    radius: str = "",
    width: str = "",
    height: str = "",
    length: str = "",
    cap: str = "",
    wall: Part = (),
    floor: Part = (),
    sheath: Part = (),
    pitch: str = "",
    fiber: str = "",
    pressure: str = "",
    angle: str = "",
    blocked: bool = False,
    overwrite: bool = False,
) -> int:
    """Write a commented case file of your own actuator.

    Without options the values are asked for, on a terminal.

    Args:
        file: Case file to write, YAML.
        title: A line for the reader; the name of the file by default.
        section: hemicircle, rectangle or circle; hemicircle by default.
        radius: Radius of the chamber; 8 mm by default.
        width: Width of a rectangular chamber; 16 mm by default.
        height: Height of a rectangular chamber; 8 mm by default.
        length: Length of the chamber, without caps; 100 mm by default.
        cap: Length of each end cap; 15 mm by default.
        wall: Wall, such as 2mm dragon-skin-30; 2 mm elastosil-m4601 by default.
        floor: Stiff floor, or none; 2 mm combined-base by default.
        sheath: Soft sheath around everything; none by default.
        pitch: Pitch of the double helix of fibers; 3 mm by default.
        fiber: Thread of the winding; kevlar by default.
        pressure: Pressure at the end; without one the pressure for the angle is found.
        angle: Bending angle at the end where no pressure is given; 180 deg by default.
        blocked: Keep it straight and ask for the force of the tip.
        overwrite: Replace a case file that is there.
    """
    from fiberbend.reader import new_case
    from fiberbend.reader.new_case import spaced

    if file.suffix not in (".yaml", ".yml"):
        raise CaseError([Problem(str(file), "expected a name that ends in .yaml")])
    if file.exists() and not overwrite:
        raise CaseError([Problem(str(file), "exists, expected a new file, or --overwrite")])
    given = {"radius": radius, "width": width, "height": height}
    options = (title, section, *given.values(), length, cap, wall, floor, sheath)
    asks = not any((*options, pitch, fiber, pressure, angle, blocked))
    ask: Ask = _question if asks and sys.stdin.isatty() else _as_given
    sections = list(new_case.SECTIONS)

    def check_section(text: str) -> None:
        if text not in sections:
            wanted = f"expected one of {', '.join(sections)}{meant(text, sections)}"
            raise CaseError([Problem("--section", f"{found(text)}, {wanted}")])

    question = f"shape of the section ({', '.join(sections)})"
    shape = ask("section", section, "hemicircle", question, check_section)
    check_section(shape)
    needed = new_case.chamber_dimensions(shape)
    for name, value in given.items():
        if value and name not in needed:
            text = f"no effect on a section {shape}, expected {' and '.join(needed)}"
            raise CaseError([Problem(f"--{name}", text)])
    chamber = {
        name: ask(name, given[name], _DEFAULTS[name], f"{name} of the chamber", _check_length)
        for name in needed
    }
    question = "length of the chamber, without caps"
    along = ask("length", length, "100 mm", question, _check_length)
    parts = {}
    for name, words in (("wall", wall), ("floor", floor), ("sheath", sheath)):
        usual = new_case.usual_part(name, shape)
        default = new_case.NONE if name == "sheath" else f"{usual.thickness} {usual.material}"
        read = functools.partial(_read_part, name, usual)
        text = ask(name, " ".join(words), default, f"{name}: thickness and material", read)
        part = read(text)
        if part is not None:
            parts[name] = part
    turn = ask("pitch", pitch, "3 mm", "pitch of the double helix", _check_length)
    if ask is _question:
        question = "what to compute: bend, or force (of an actuator that is kept straight)"
        blocked = ask("force", "", "bend", question, _check_wish) == "force"
        if blocked:
            pressure = ask("pressure", "", "100 kPa", "pressure at the end", _check_pressure)
        else:
            end = ask("end", "", "180 deg", "end: an angle, or a pressure", _check_end)
            pressure, angle = (end, "") if _is_pressure(end) else ("", end)
    if blocked and angle:
        raise CaseError([Problem("--angle", "no effect on one that is blocked, expected none")])
    if pressure and angle:
        raise CaseError([Problem("--angle", "beside --pressure, expected one of them")])
    case = new_case.NewCase(
        title=title or _as_title(file.stem),
        section=shape,
        chamber={name: spaced(value) for name, value in chamber.items()},
        length=spaced(along),
        cap=spaced(cap or "15 mm"),
        parts=parts,
        pitch=spaced(turn),
        fiber=fiber or "kevlar",
        pressure=spaced(pressure or ("100 kPa" if blocked else "")),
        angle=spaced(angle or "180 deg"),
        blocked=blocked,
    )
    content = case.text()
    schema = new_case.schema_beside(file)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        if schema is not None:
            (file.parent / new_case.SCHEMA_FILE).write_text(schema, encoding="utf-8")
        file.write_text(content, encoding="utf-8")
    except OSError as error:
        raise CaseError([Problem(str(file), f"{error.strerror}, expected a file")]) from None
    beside = "" if schema is None else f", and {new_case.SCHEMA_FILE} for editors beside it"
    say(f"{file}: written{beside}. Next:")
    typed = shlex.quote(str(file))
    say(f"  fiberbend show {typed} --open")
    say(f"  fiberbend run {typed}")
    return 0


Check = Callable[[str], object]
"""Raises CaseError or ValueError for an answer of no use."""
Ask = Callable[[str, str, str, str, Check], str]
"""Takes name, given value, default, meaning and check; returns what is used."""


def _as_given(name: str, given: str, default: str, meaning: str, check: Check) -> str:
    """What an option gives; the case as a whole is checked later."""
    return given or default


def _question(name: str, given: str, default: str, meaning: str, check: Check) -> str:
    """The answer to a question, which is asked again until it is of use."""
    while True:
        try:
            text = input(f"{meaning} [{default}]: ").strip() or default
        except EOFError:
            say("")
            raise CaseError([Problem(f"--{name}", "no answer, expected one, or options")]) from None
        try:
            check(text)
        except CaseError as error:
            say(f"  {'; '.join(problem.text for problem in error.problems)}")
        except ValueError as error:
            say(f"  {found(text)}, {error}")
        else:
            return text


def _read_part(name: str, usual: NewPart, text: str) -> NewPart | None:
    from fiberbend.reader.new_case import Part as NewPart

    return NewPart.read(name, text.split(), usual)


def _check_length(text: str) -> None:
    if parse(text, "length") <= 0:
        raise ValueError("expected a length above zero")


def _check_pressure(text: str) -> None:
    parse(text, "pressure")


def _check_end(text: str) -> None:
    if not _is_pressure(text):
        try:
            parse(text, "angle")
        except ValueError:
            raise ValueError('expected an angle such as "180 deg", or a pressure') from None


def _check_wish(text: str) -> None:
    if text not in ("bend", "force"):
        raise ValueError("expected bend or force")


def _as_title(stem: str) -> str:
    words = stem.replace("_", " ").replace("-", " ").strip()
    return words[:1].upper() + words[1:]


def _is_pressure(text: str) -> bool:
    try:
        parse(text, "pressure")
    except ValueError:
        return False
    return True

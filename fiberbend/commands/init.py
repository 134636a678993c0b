"""The command `fiberbend init`: a first case file, by options or by questions."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fiberbend.running.launch import say
from fiberbend.schema.problems import CaseError, Problem

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
    shape = ask("section", section, "hemicircle", f"shape of the section ({', '.join(sections)})")
    if shape not in sections:
        text = f'"{shape}", expected one of {", ".join(sections)}'
        raise CaseError([Problem("--section", text)])
    needed = new_case.chamber_dimensions(shape)
    for name, value in given.items():
        if value and name not in needed:
            text = f"no effect on a section {shape}, expected {' and '.join(needed)}"
            raise CaseError([Problem(f"--{name}", text)])
    chamber = {
        name: ask(name, given[name], _DEFAULTS.get(name, "8 mm"), f"{name} of the chamber")
        for name in needed
    }
    along = ask("length", length, "100 mm", "length of the chamber, without caps")
    parts = {}
    for name, words in (("wall", wall), ("floor", floor), ("sheath", sheath)):
        usual = new_case.usual_part(name, shape)
        default = new_case.NONE if name == "sheath" else f"{usual.thickness} {usual.material}"
        text = ask(name, " ".join(words), default, f"{name}: thickness and material")
        part = new_case.Part.read(name, text.split(), usual)
        if part is not None:
            parts[name] = part
    turn = ask("pitch", pitch, "3 mm", "pitch of the double helix")
    if ask is _question:
        kind = ask("force", "", "bend", "what you want to see: bend, or force of a straight one")
        blocked = kind.startswith("f")
        if blocked:
            pressure = ask("pressure", "", "100 kPa", "pressure at the end")
        else:
            end = ask("end", "", angle or "180 deg", "end: an angle, or a pressure")
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
        if schema is not None:
            (file.parent / new_case.SCHEMA_FILE).write_text(schema, encoding="utf-8")
        file.write_text(content, encoding="utf-8")
    except OSError as error:
        raise CaseError([Problem(str(file), f"{error.strerror}, expected a file")]) from None
    say(f"{file}: written. Next:")
    say(f"  fiberbend show {file} --open")
    say(f"  fiberbend run {file}")
    return 0


Ask = Callable[[str, str, str, str], str]
"""Takes name, given value, default and meaning; returns what is used."""


def _as_given(name: str, given: str, default: str, meaning: str) -> str:
    return given or default


def _question(name: str, given: str, default: str, meaning: str) -> str:
    try:
        return input(f"{meaning} [{default}]: ").strip() or default
    except EOFError:
        say("")
        raise CaseError([Problem(f"--{name}", "no answer, expected one, or options")]) from None


def _as_title(stem: str) -> str:
    words = stem.replace("_", " ").replace("-", " ").strip()
    return words[:1].upper() + words[1:]


def _is_pressure(text: str) -> bool:
    from fiberbend.schema.units import parse

    try:
        parse(text, "pressure")
    except ValueError:
        return False
    return True

"""The text of a new case file: few lines, each with what it means."""

from __future__ import annotations

import dataclasses
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING
from pathlib import Path

import yaml

from fiberbend.reader.json_schema import json_schema
from fiberbend.reader.reader import parse_case
from fiberbend.schema.problems import CaseError, Problem, found, meant
from fiberbend.schema.units import parse
from geometry.actuator import Actuator
from geometry.sections.table import SECTIONS

SCHEMA_FILE = "case.schema.json"
"""Beside the case file, for editors; its first line names it."""
_QUANTITY = re.compile(r"([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)\s*(\S.*)")
PARTS = ("wall", "floor", "sheath")
"""Parts that have a thickness and a material."""
NONE = "none"
"""What is written for a part that does not exist."""


@dataclasses.dataclass(frozen=True)
class Part:
    """A part of the actuator.

    Attributes:
        thickness: with its unit.
        material: a named one.
    """

    thickness: str
    material: str

    @classmethod
    def read(cls, name: str, words: Sequence[str], usual: Part) -> Part | None:
        """A part from what a user writes: "2 mm", "dragon-skin-30", both, or "none".

        Args:
            name: of the part, for messages.
            words: in any order; the words of a quantity may stand apart.
            usual: for what is not given.

        Raises:
            CaseError: neither a thickness nor a material that there is.
        """
        text = " ".join(words).replace(",", " ").split()
        if text == [NONE]:
            return None
        thickness, material = usual.thickness, usual.material
        rest: list[str] = []
        for word in text:
            # "2 mm" comes as two words
            joined = f"{rest[-1]} {word}" if rest else word
            if _is_length(joined):
                thickness, rest = joined, rest[:-1]
            elif _is_length(word):
                thickness = word
            else:
                rest.append(word)
        names = known_materials()
        for word in rest:
            if word not in names:
                wanted = (
                    f"expected a thickness, {NONE}, or a material that `fiberbend materials` lists"
                )
                raise CaseError(
                    [Problem(f"--{name}", f"{found(word)}, {wanted}{meant(word, names)}")]
                )
            material = word
        if len(rest) > 1:
            raise CaseError([Problem(f"--{name}", f"{' and '.join(rest)}, expected one material")])
        return cls(spaced(thickness), material)


_USUAL: Mapping[str, Part] = {
    "wall": Part("2 mm", "elastosil-m4601"),
    "floor": Part("2 mm", "combined-base"),
    "sheath": Part("1 mm", "ecoflex-0030"),
}
_SET_IN = Part("1 mm", "combined-base")


@dataclasses.dataclass(frozen=True)
class NewCase:
    """What a new case says.

    Attributes:
        title: a line for the reader.
        section: shape of the section, a key of `SECTIONS`.
        chamber: its dimensions, with units, by the names in `chamber_dimensions`.
        length: of the chamber, with its unit.
        cap: length of each end cap, with its unit.
        parts: those that exist, by name.
        pitch: of the winding, with its unit.
        fiber: a named thread.
        pressure: at the end, with its unit; empty: the angle is given and the pressure found.
        angle: at the end, with its unit, where no pressure is given.
        blocked: the actuator is kept straight and its force asked for.
    """

    title: str
    section: str
    chamber: Mapping[str, str]
    length: str
    cap: str
    parts: Mapping[str, Part]
    pitch: str
    fiber: str
    pressure: str
    angle: str
    blocked: bool

    def text(self) -> str:
        """The case file, 20 lines and some empty ones.

        Raises:
            CaseError: everything that is wrong with it.
        """
        text = "\n".join(self._lines()) + "\n"
        parse_case(yaml.safe_load(text))
        return text

    def _lines(self) -> Iterator[str]:
        yield f"# yaml-language-server: $schema={SCHEMA_FILE}"
        yield f"title: {_quoted(self.title)}"
        yield ""
        yield "actuator:                  # every value with its unit"
        others = [name for name in SECTIONS if name != self.section]
        yield _line(f"  section: {self.section}", f"or {', '.join(others)}")
        for name in chamber_dimensions(self.section):
            yield _line(f"  {name}: {self.chamber[name]}", f"{name} of the chamber")
        yield _line(f"  length: {self.length}", "length of the chamber, between the end caps")
        yield _line(f"  cap: {self.cap}", "length of each of the two solid end caps")
        for name, part in self.parts.items():
            yield _line(f"  {name}: {part.thickness}", f"thickness of the {_MEANING[name]}")
        yield ""
        yield "materials:                 # a name, or {law: yeoh, c1: 0.11 MPa, c2: 0.02 MPa}"
        for name, part in self.parts.items():
            yield f"  {name}: {part.material}"
        yield ""
        yield "effects:                   # what acts, in this order"
        if self.pressure:
            yield f"  - pressure: {{to: {self.pressure}}}   # of the chamber, at the end"
        else:
            yield f"  - pressure: {{angle: {self.angle}}}   # bent so far: the pressure is found"
        yield (
            f"  - winding: {{pattern: double-helix, pitch: {self.pitch}, fiber: {self.fiber}}}"
            "   # pitch: length of a turn"
        )
        if self.blocked:
            yield "  - straight: {stretch: free}   # kept straight: the tip's force is asked for"
        yield ""
        yield "model: auto                # the cheapest that supports all of this; `plan` names it"
        yield ""
        yield "output:"
        yield f"  {self._requests()}"

    def _requests(self) -> str:
        if self.pressure:
            steps = _halves(self.pressure, "pressure")
            return f"at_pressures: [{steps}]   # with pictures and fields"
        return f"at_angles: [{_halves(self.angle, 'angle')}]   # with pictures and fields"


_MEANING = {
    "wall": "wall around the chamber",
    "floor": "stiff floor under the chamber",
    "sheath": "soft sheath around everything",
}


def chamber_dimensions(section: str) -> list[str]:
    """Dimensions of the chamber that a section needs: "radius", or "width" and "height"."""
    common = {field.name for field in dataclasses.fields(Actuator)}
    needed = (f for f in dataclasses.fields(SECTIONS[section]) if f.default is MISSING)
    return [field.name for field in needed if field.name not in {*common, *PARTS}]


def usual_part(name: str, section: str) -> Part:
    """What a part is unless told: as in the paper; a floor that is set into the wall is thinner."""
    needed = {f.name for f in dataclasses.fields(SECTIONS[section]) if f.default is MISSING}
    return _SET_IN if name == "floor" and "floor" not in needed else _USUAL[name]


def known_materials() -> list[str]:
    """Names of materials that a case can use."""
    from materials.named.table import SOLIDS

    return list(SOLIDS)


def schema_beside(path: Path) -> str | None:
    """The JSON schema that belongs beside a case file; None where it is there.

    Raises:
        CaseError: a file of that name is something else.
    """
    target, text = path.parent / SCHEMA_FILE, json.dumps(json_schema(), indent=2) + "\n"
    try:
        there = json.loads(target.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return text
    except (OSError, ValueError):
        there = None
    if not isinstance(there, Mapping) or there.get("title") != json_schema().get("title"):
        text = "is no JSON schema of a case, expected another folder for the new case"
        raise CaseError([Problem(str(target), text)])
    return None if there == json_schema() else text


def _halves(value: str, kind: str) -> str:
    """Half of a quantity, in the unit that was given, and all of it.

    Raises:
        ValueError: not a quantity of this kind.
    """
    parse(value, kind)
    number, unit = _QUANTITY.fullmatch(value.strip()).groups()  # type: ignore[union-attr]
    return f"{float(number) / 2:g} {unit}, {value}"


def _is_length(text: str) -> bool:
    try:
        parse(text, "length")
    except ValueError:
        return False
    return True


def spaced(value: str) -> str:
    """A quantity with a space before its unit, "2mm" as "2 mm"; anything else as it is."""
    match = _QUANTITY.fullmatch(value.strip())
    return f"{match[1]} {match[2]}" if match else value


def _line(left: str, comment: str) -> str:
    return f"{left:<26} # {comment}"


def _quoted(text: str) -> str:
    """A title as YAML gives it back, in one line."""
    dumped: str = yaml.safe_dump(text, allow_unicode=True, width=10_000, default_style=None)
    return dumped.removesuffix("\n").removesuffix("...").strip()

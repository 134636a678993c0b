"""Which column of a test is what, by its name and unit; nothing is guessed."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from fiberbend.schema.units import KINDS, factor

if TYPE_CHECKING:
    from materials.stretches import Floats

Meant = Literal["engineering", "true"]
"""What a strain or a stress is whose column does not say it."""
Quantity = Literal["stretch", "strain", "stress", "displacement", "force"]
_BRACKETS = re.compile(r"(.*?)\s*[\[(]([^\[\]()]*)[\])]\s*")
_TRUE = ("true", "cauchy", "logarithmic", "log", "hencky")
_ENGINEERING = ("engineering", "eng", "nominal", "pk1", "1pk")
_OTHER = ("second", "2nd", "pk2", "2pk", "green", "lagrange", "almansi", "biot")
"""Words of measures that are not known: such columns are none of a strain or a stress."""
_PRESSED = ("compressive", "compression", "compressed")
"""Words of columns that machines count above zero where a specimen is pressed."""
_WORDS: dict[Quantity, tuple[str, ...]] = {
    "stretch": ("stretch", "lambda", "λ"),
    "strain": ("strain", "ε", "epsilon"),
    "stress": ("stress", "σ", "sigma", "pk1", "1pk"),
    "displacement": ("displacement", "extension", "elongation", "crosshead"),
    "force": ("force", "load"),
}
_MEASURES = ("strain", "stress")
"""What is engineering or true; stretches, displacements and forces need no such word."""
_OPTIONS: dict[Quantity, str] = {"displacement": "strain", "force": "stress"}
"""Options that name such columns."""
_PARTS = ("1", "-", "mm/mm", "m/m")
"""Units of a part of the length at rest, beside %."""
STRETCHES = (0.05, 20.0)
"""What a rubber can be stretched to."""
_STRESSES = (1e-9, 1e6)
"""Of the greatest stress of a test, MPa."""
_IMPLAUSIBLE = 20.0
"""A strain from which on a column without a unit is rather in percent."""


@dataclasses.dataclass(frozen=True)
class Column:
    """A column that may be meant.

    Attributes:
        place: among the columns of the table.
        name: as the file has it, with its unit.
        what: the quantity; None: the name does not say.
        meant: engineering or true; None: the name does not say, or it is a stretch.
        unit: of its name; empty: none.
    """

    place: int
    name: str
    what: Quantity | None
    meant: Meant | None
    unit: str

    @property
    def rank(self) -> int:
        """Stretches come first, then engineering strains and stresses, then true ones."""
        known = {"engineering": 1, "true": 2, None: 3}
        return known[self.meant] if self.what in _MEASURES else 0


def strain_of(
    names: Sequence[str], stretch: str, strain: str, meant: Meant | None, gauge: float | None
) -> Column:
    """The column of stretches or strains, or of displacements where the gauge is known.

    Args:
        names: of all columns.
        stretch: what the user calls a column of stretches: its name, with a unit or not, or its
            number; or empty.
        strain: likewise of strains.
        meant: what a strain is whose name does not say.
        gauge: length at rest of what is pulled, mm: the column has displacements.

    Raises:
        ValueError: there is none, or more than one may be meant.
    """
    if gauge is not None:
        if stretch:
            raise ValueError("--stretch and --gauge together, expected one of them")
        if strain:
            return _asked(names, strain, "displacement", meant)
        return _named(names, ("displacement",), meant)
    if stretch and strain:
        raise ValueError("--stretch and --strain together, expected one of them")
    if stretch:
        return _asked(names, stretch, "stretch", meant)
    if strain:
        return _asked(names, strain, "strain", meant)
    return _named(names, ("stretch", "strain"), meant)


def stress_of(names: Sequence[str], stress: str, meant: Meant | None, area: float | None) -> Column:
    """The column of stresses, or of forces where the area at rest is known, likewise."""
    if area is not None:
        if stress:
            return _asked(names, stress, "force", meant)
        return _named(names, ("force",), meant)
    if stress:
        return _asked(names, stress, "stress", meant)
    return _named(names, ("stress",), meant)


def stretches(column: Column, values: Floats, gauge: float | None) -> Floats:
    """Stretches of a column's values.

    Args:
        column: the column.
        values: its values.
        gauge: length at rest of what a displacement has pulled, mm.

    Raises:
        ValueError: its unit is none of a strain, or values that are no stretches.
    """
    import numpy as np

    _signed(column, values)
    if column.what == "displacement" and gauge is not None:
        values = values * _factor(column, "length") / gauge
    elif column.unit == "%":
        values = values / 100
    elif column.unit not in ("", *_PARTS):
        raise ValueError(f"{column.name!r} in {column.unit!r}, expected % or a pure number")
    elif not column.unit and column.what == "strain" and np.abs(values).max() > _IMPLAUSIBLE:
        raise ValueError(
            f"{column.name!r} goes to {values.max():g} and has no unit, expected [%] or [1]"
        )
    if column.what == "stretch":
        found = values
    else:
        found = np.exp(values) if column.meant == "true" else 1 + values
    far = found[~((found >= STRETCHES[0]) & (found <= STRETCHES[1]))]
    if far.size:
        least, most = STRETCHES
        raise ValueError(f"{column.name!r}: stretch {far[0]:g}, expected {least:g} to {most:g}")
    return np.asarray(found, dtype=float)


def stresses(column: Column, values: Floats, stretch: Floats, area: float | None) -> Floats:
    """Nominal stresses in MPa of a column's values.

    Args:
        column: the column.
        values: its values.
        stretch: stretches of the same rows.
        area: area at rest on which a force acts, mm².

    Raises:
        ValueError: no unit, or one of no stress or force.
    """
    import numpy as np

    _signed(column, values)
    if column.what == "force" and area is not None:
        found = values * _factor(column, "force") / area
    else:
        found = values * _factor(column, "modulus")
        found = found / stretch if column.meant == "true" else found
    greatest, (least, most) = float(np.abs(found).max()), _STRESSES
    if not least <= greatest <= most:
        raise ValueError(
            f"{column.name!r} goes to {greatest:g} MPa, expected {least:g} to {most:g} MPa"
        )
    return np.asarray(found)


def _signed(column: Column, values: Floats) -> None:
    """Refuse compression that is counted above zero: it would be read as tension.

    Raises:
        ValueError: a column of compression whose values are mostly above zero.
    """
    pressed = column.what != "stretch" and _words(_apart(column.name)[0]) & set(_PRESSED)
    if pressed and values.sum() > 0:
        raise ValueError(
            f"{column.name!r} counts compression above zero, expected strains and stresses below "
            "zero in compression"
        )


def _factor(column: Column, kind: str) -> float:
    """What one of a column's unit is within the program."""
    if not column.unit:
        shown = KINDS[kind].shown
        raise ValueError(f"{column.name!r} has no unit, expected one such as [{shown}]")
    try:
        # mm2 as machines write mm^2
        return factor(re.sub(r"(?<=m)2\b", "^2", column.unit), kind)
    except ValueError as error:
        raise ValueError(f"{column.name!r}: {error}") from None


def others(names: Sequence[str], column: Column) -> list[Column]:
    """Columns whose names say that they have the same quantity in another measure.

    Args:
        names: of all columns.
        column: the one that is read.
    """
    kinds = ("stress",) if column.what == "stress" else ("stretch", "strain")
    every = (_read(i, name) for i, name in enumerate(names))
    known = [c for c in every if c.what in kinds and (c.what == "stretch" or c.meant)]
    return [c for c in known if (c.what, c.meant) != (column.what, column.meant)]


def _asked(names: Sequence[str], asked: str, what: Quantity, meant: Meant | None) -> Column:
    """The column that a user names, by its name or its number, with or without a unit."""
    bare, unit = _apart(asked)
    wholes = [name.casefold() for name in names]
    bares = [_apart(name)[0].casefold() for name in names]
    numbers = [str(i + 1) for i in range(len(names))]
    for wanted, own in ((asked.casefold(), ""), (bare.casefold(), unit)):
        for known in (wholes, bares, numbers):
            there = [i for i, text in enumerate(known) if text == wanted]
            if len(there) > 1:
                text = " or ".join(numbers[i] for i in there)
                raise ValueError(f"{asked!r} is more than one column, expected its number, {text}")
            if there:
                return _settled(_told(there[0], names[there[0]], own, what), meant)
    raise ValueError(f"no column {asked!r}, found {_listed(names)}")


def _told(place: int, name: str, unit: str, what: Quantity) -> Column:
    """A column that a user calls a quantity, with the unit that he gives where it has none."""
    column = _read(place, name)
    if unit and column.unit and unit != column.unit:
        raise ValueError(f"{name!r} has another unit than {unit!r}, expected none beside it")
    if unit and not column.unit:
        column = dataclasses.replace(_read(place, f"{name} [{unit}]"), name=name)
    if column.what not in (None, what):
        raise ValueError(f"{name!r} is a {column.what}, found under --{what}")
    return dataclasses.replace(column, what=what)


def _named(names: Sequence[str], kinds: Sequence[Quantity], meant: Meant | None) -> Column:
    """The column whose name says that it is of a kind."""
    every = [_read(i, name) for i, name in enumerate(names)]
    there = [column for column in every if column.what in kinds]
    if not there:
        spare = next((c for c in every if _OPTIONS.get(c.what or "stretch") in kinds), None)
        if spare is not None:
            length = spare.what == "displacement"
            need = "--gauge, the length" if length else "--width and --thickness"
            raise ValueError(f"{spare.name!r} is a {spare.what}, expected {need} at rest")
        options = " or ".join(f"--{_OPTIONS.get(kind, kind)} COLUMN" for kind in kinds)
        raise ValueError(
            f"no column of {' or '.join(kinds)}, found {_listed(names)}, expected {options}"
        )
    best = [column for column in there if column.rank == min(c.rank for c in there)]
    if len(best) > 1:
        text = " or ".join(repr(column.name) for column in best)
        option = _OPTIONS.get(kinds[0], best[0].what)
        raise ValueError(f"{text}, expected --{option} with one of them")
    return _settled(best[0], meant)


def _settled(column: Column, meant: Meant | None) -> Column:
    """The column with what it is meant to be.

    Raises:
        ValueError: nobody says it.
    """
    if column.what in _MEASURES and (column.meant or meant) is None:
        raise ValueError(
            f"{column.name!r} is an engineering or a true {column.what}, expected --as engineering "
            "or --as true"
        )
    return dataclasses.replace(column, meant=column.meant or meant)


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - 8} more" if len(names) > 8 else ""
    return ", ".join(map(repr, names[:8])) + more


def _read(place: int, name: str) -> Column:
    bare, unit = _apart(name)
    words = _words(bare)
    meant: Meant | None = "engineering" if words & set(_ENGINEERING) else None
    if words & set(_TRUE):
        # a name that says both says nothing
        meant = None if meant else "true"
    what = next((kind for kind, known in _WORDS.items() if words & set(known)), None)
    if words & set(_OTHER):
        what = None
    if what == "displacement" and "ratio" in words:
        what = "stretch"
    elif what == "displacement" and unit in ("%", *_PARTS):
        what, meant = "strain", "engineering"
    return Column(place, name, what, meant, unit)


def _words(text: str) -> set[str]:
    return set(re.sub(r"[^\w]+|_", " ", text.casefold()).split())


def _apart(name: str) -> tuple[str, str]:
    """A name and its unit: in brackets, or behind a mark as in stress_MPa or stress / MPa."""
    match = _BRACKETS.fullmatch(name)
    if match:
        return match[1].strip(), match[2].strip()
    match = re.fullmatch(r"(.+?)\s*[_/,\s]\s*(%|[kMG]?Pa|psi|bar|N/mm\^?2|N/mm²|[mcµ]?m|m?N)", name)
    return (match[1].strip(), match[2]) if match else (name.strip(), "")

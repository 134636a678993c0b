"""A user's measured points: pressure with bending angle, or pressure with tip force.

A case names the CSV file; with the case is checked that the run can be compared with what is
in the file. numpy is imported where it is used: a case that is wrong fails without it.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from analytic.table import DELIMITERS, Table, read_table
from fiberbend import columns as col
from fiberbend.case.case import Case, MeasuredSpec
from fiberbend.schema.units import factor

if TYPE_CHECKING:
    from geometry.mesh.data import Floats

_UNITS = (
    re.compile(r"(?P<stem>.*?)\s*\[\s*(?P<unit>.+?)\s*\]"),
    re.compile(r"(?P<stem>.*?)\s*\(\s*(?P<unit>.+?)\s*\)"),
)
"""Names of columns that say a unit: "P [kPa]", "pressure (psi)"."""
_PERHAPS = (
    re.compile(r"(?P<stem>.+?)\s*/\s*(?P<unit>[^\s/]+)"),
    re.compile(r"(?P<stem>.+?)\s+in\s+(?P<unit>\S+)"),
    re.compile(r"(?P<stem>.+)_(?P<unit>[^_]+)"),
)
"""Names that say a unit where there is such a one: "p / kPa", "angle in deg", "pressure_kPa"."""


@dataclasses.dataclass(frozen=True)
class Wanted:
    """A column that is looked for.

    Attributes:
        name: as this program writes it.
        kind: of its quantity, a key of `schema.units.KINDS`; also its key in the case.
        words: what else it may be called.
        example: a name with its unit.
        setting: the part of a case that may name its column and its unit; empty: none may.
    """

    name: str
    kind: str
    words: frozenset[str]
    example: str
    setting: str = "output.measured"


PRESSURE = Wanted(col.PRESSURE, "pressure", frozenset({"pressure", "p"}), "P [kPa]")
_ANGLE = Wanted(
    col.ANGLE,
    "angle",
    frozenset({"angle", "theta", "θ", "bending angle", "bending_angle"}),
    "theta [deg]",
)
_FORCE = Wanted(
    col.TIP_FORCE, "force", frozenset({"force", "f", "tip force", "tip_force"}), "F [N]"
)


@dataclasses.dataclass(frozen=True, eq=False)
class Measured:
    """Measured points of one actuator.

    Attributes:
        quantity: what was measured, as its column is called.
        pressure: pressures, (n,), MPa.
        value: bending angles in rad, or tip forces in N, (n,).
        source: name of the file.
        units: of the pressures and of the values in the file; None: kPa, and degrees or N.
    """

    quantity: str
    pressure: Floats
    value: Floats
    source: str
    units: tuple[str, str] | None = None

    def shown(self) -> tuple[Floats, Floats]:
        """The points as plots and tables show them: kPa, and degrees or N, (n,) each."""
        import numpy as np

        value = np.degrees(self.value) if self.quantity == col.ANGLE else self.value
        return 1e3 * self.pressure, value


def expected_quantity(blocked: bool) -> str:
    """The column that a measurement needs beside pressure_kPa."""
    return col.TIP_FORCE if blocked else col.ANGLE


def what_is_wrong(measured: MeasuredSpec, blocked: bool) -> str | None:
    """Why a file cannot be compared with a run.

    Args:
        measured: the file, and what the case says of it.
        blocked: the tip is blocked, so that forces were measured and not angles.

    Returns:
        What was found and what was expected, or None.
    """
    wanted = f"columns pressure_kPa and {expected_quantity(blocked)}"
    try:
        _read(measured, blocked)
    except FileNotFoundError:
        return f'"{measured.file}", no such file, expected a CSV file with {wanted}'
    except OSError as error:
        return f'"{measured.file}", {error.strerror}, expected a CSV file with {wanted}'
    except ValueError as error:
        return str(error) if "expected" in str(error) else f"{error}, expected {wanted}"
    return None


def read_measured(case: Case) -> Measured | None:
    """The measured points that a checked case names, or None.

    Raises:
        ValueError: the file has changed since and has no points any more.
        OSError: the file is gone.
    """
    import numpy as np

    spec = case.output.measured
    if spec is None:
        return None
    rows, factors, units = _read(spec, case.straight)
    pressure, value = np.array(rows).T
    return Measured(
        expected_quantity(case.straight),
        factors[0] * pressure,
        factors[1] * value,
        Path(spec.file).name,
        units,
    )


def _read(
    spec: MeasuredSpec, blocked: bool
) -> tuple[list[list[float]], tuple[float, float], tuple[str, str]]:
    """The points of a file, what one of their units is in the internal one, and these units.

    Raises:
        ValueError: what was found in the file and what was expected.
        OSError: the file cannot be read.
    """
    marks = {name: mark for mark, name in DELIMITERS.items()}
    delimiter = None if spec.delimiter is None else marks[spec.delimiter]
    table = read_table(Path(spec.file), delimiter, spec.decimal)
    value = _FORCE if blocked else _ANGLE
    given = [spec.column(wanted.kind) for wanted in (PRESSURE, value)]
    places = [
        place_of(table, wanted, name)
        for wanted, (name, _) in zip((PRESSURE, value), given, strict=True)
    ]
    if places[0] == places[1]:
        name = table.columns[places[0]]
        raise ValueError(f"{table.source}: {name!r} given twice, expected two columns")
    units = [
        unit_of(table, wanted, table.columns[place], unit)
        for wanted, place, (_, unit) in zip((PRESSURE, value), places, given, strict=True)
    ]
    factors = factor(units[0], PRESSURE.kind), factor(units[1], value.kind)
    return table.values(places), factors, (units[0], units[1])


def place_of(table: Table, wanted: Wanted, name: str | None) -> int:
    """Place of the column of a quantity: by its name in the case, by this program's, or by words.

    Raises:
        ValueError: none, or several.
    """
    columns = table.columns
    if name is not None:
        plain = " ".join(name.split()).casefold()
        ways = [
            [i for i, column in enumerate(columns) if column == name],
            [i for i, column in enumerate(columns) if column.casefold() == plain],
            [i for i, column in enumerate(columns) if _stem(column, wanted) == plain],
        ]
    else:
        ways = [
            [i for i, column in enumerate(columns) if column == wanted.name],
            [i for i, column in enumerate(columns) if _stem(column, wanted) in wanted.words],
        ]
    places: Sequence[int] = next((found for found in ways if found), [])
    if len(places) == 1:
        return places[0]
    if places:
        several = " and ".join(repr(columns[i]) for i in places)
        raise ValueError(
            f"{table.source}: {several}, expected one column of {wanted.kind}s"
            + _or_setting(wanted, ", or its name as")
        )
    what = wanted.name if name is None else repr(name)
    hint = (
        ""
        if name is not None
        else (
            f", expected {wanted.name}, a name such as {wanted.example!r}"
            + _or_setting(wanted, ", or the column's name as")
        )
    )
    expected = hint or ", expected one of them"
    raise ValueError(f"{table.source}: no column {what}, found {table.found}{expected}")


def _or_setting(wanted: Wanted, words: str) -> str:
    """The end of a message where a case may name the column."""
    return f"{words} {wanted.kind} in {wanted.setting}" if wanted.setting else ""


def _stem(column: str, wanted: Wanted) -> str:
    """A column's name without its unit, in small letters."""
    return _cut(column, wanted)[0].casefold()


def _cut(column: str, wanted: Wanted) -> tuple[str, str]:
    """A column's name and the unit that it says, or nothing."""
    for pattern in _UNITS:
        match = pattern.fullmatch(column)
        if match is not None:
            return match["stem"], match["unit"]
    for pattern in _PERHAPS:
        match = pattern.fullmatch(column)
        if match is not None and _is_unit(match["unit"], wanted.kind):
            return match["stem"], match["unit"]
    return column, ""


def _is_unit(text: str, kind: str) -> bool:
    try:
        factor(text, kind)
    except ValueError:
        return False
    return True


def unit_of(table: Table, wanted: Wanted, column: str, given: str | None) -> str:
    """The unit of a column, by its name or by the case.

    Raises:
        ValueError: none, an unknown one, or two that differ.
    """
    _, said = _cut(column, wanted)
    key = f"{wanted.kind}_unit"
    if said and not _is_unit(said, wanted.kind):
        raise ValueError(
            f"{table.source}: column {column!r} in {said!r}, expected a unit of {wanted.kind} such "
            f"as in {wanted.example!r}"
        )
    if not (said or given):
        raise ValueError(
            f"{table.source}: column {column!r} has no unit, expected a name such as "
            f"{wanted.example!r}" + (f", or {key} in {wanted.setting}" if wanted.setting else "")
        )
    if said and given:
        one, other = factor(said, wanted.kind), factor(given, wanted.kind)
        if not math.isclose(one, other, rel_tol=1e-9):
            raise ValueError(
                f"{table.source}: column {column!r} is in {said}, {key} says {given}, expected one "
                "of them"
            )
    return said or str(given)

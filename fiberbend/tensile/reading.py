"""A test of rubber from a file: the points of a loading within a range, as nominal stresses."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from fiberbend.schema.problems import CaseError, Problem
from fiberbend.tensile.columns import (
    STRETCHES,
    Column,
    Meant,
    others,
    strain_of,
    stress_of,
    stresses,
    stretches,
)
from fiberbend.tensile.shipped import near

if TYPE_CHECKING:
    from materials.fit.modes import Measurement
    from materials.stretches import Floats

ModeName = Literal["uniaxial", "pure-shear", "equibiaxial"]
_SAME = 0.02
"""Part of the greatest value by which two columns of one quantity may differ."""
_LIMIT = re.compile(r"(stretch|strain)\s+([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*(%?)")


@dataclasses.dataclass(frozen=True)
class Wanted:
    """What is read of a file.

    Attributes:
        stretch: column of stretches, by name or number, with or without a unit in brackets; empty:
            the one whose name says it.
        strain: column of strains, likewise; one of both at most.
        stress: column of stresses, likewise.
        meant: what a strain or a stress is whose name does not say; None: such names are refused.
        gauge: length at rest of what is pulled, mm: displacements are read in place of strains.
        area: cross-section at rest, mm²: forces are read in place of stresses.
        cycle: which loading, from 1 on; 0: all rows.
        least: least stretch, or None.
        most: greatest of all principal stretches, or None.
        delimiter: a key of `analytic.table.DELIMITERS`, or None: found.
        decimal: "." or ",", or None: found.
    """

    stretch: str = ""
    strain: str = ""
    stress: str = ""
    meant: Meant | None = None
    gauge: float | None = None
    area: float | None = None
    cycle: int = 1
    least: float | None = None
    most: float | None = None
    delimiter: str | None = None
    decimal: str | None = None


@dataclasses.dataclass(frozen=True, eq=False)
class Read:
    """A test that was read.

    Attributes:
        measurement: its points.
        said: what was read, in one line.
    """

    measurement: Measurement
    said: str


def read_test(path: Path, mode: ModeName = "uniaxial", wanted: Wanted | None = None) -> Read:
    """Read a test of rubber.

    Args:
        path: a file of columns; lines above the names of the columns are passed over.
        mode: how the specimen was loaded.
        wanted: what to read of it.

    Raises:
        CaseError: the file cannot be read, or what it says is not clear; one line.
    """
    try:
        return _read(path, mode, wanted or Wanted())
    except OSError as error:
        text = f"{error.strerror}, expected a file{near(path)}"
        raise CaseError([Problem(str(path), text)]) from None
    except ValueError as error:
        text = str(error).removeprefix(path.name).removeprefix(":").strip(" ,")
        # the reader of tables speaks of measured points of a case
        text = text.replace("decimal: ',' in the case", "--decimal ,")
        raise CaseError([Problem(str(path), text)]) from None


def limit(text: str) -> float:
    """A stretch from what a user calls a limit, such as "stretch 1.5" or "strain 50 %".

    Raises:
        ValueError: it is none.
    """
    match = _LIMIT.fullmatch(text.strip())
    if match is None:
        raise ValueError('expected a limit such as "stretch 1.5" or "strain 50 %"')
    kind, number, percent = match.groups()
    try:
        value = float(number) / (100 if percent else 1)
    except ValueError:
        raise ValueError('expected a limit such as "stretch 1.5" or "strain 50 %"') from None
    value = value if kind == "stretch" else 1 + value
    least, most = STRETCHES
    if not least <= value <= most:
        raise ValueError(f"stretch {value:g}, expected {least:g} to {most:g}")
    return value


def _agree(column: Column, values: Floats, other: Column, again: Floats) -> None:
    """Refuse two columns of one quantity that do not say the same, so that one is chosen."""
    import numpy as np

    off = float(np.abs(values - again).max() / max(np.abs(values).max(), 1e-300))
    if off > _SAME:
        raise ValueError(
            f"{column.name!r} and {other.name!r} differ by {100 * off:.2g} % of the greatest, "
            f"expected --{column.what} with one of them"
        )


def _read(path: Path, mode: ModeName, wanted: Wanted) -> Read:
    import numpy as np

    from analytic.table import read_below_preface
    from fiberbend.tensile.cycles import loading
    from materials.fit.modes import MODES, Measurement

    table = read_below_preface(path, wanted.delimiter, wanted.decimal)
    strain = strain_of(table.columns, wanted.stretch, wanted.strain, wanted.meant, wanted.gauge)
    stress = stress_of(table.columns, wanted.stress, wanted.meant, wanted.area)
    numbers = np.array(table.values([strain.place, stress.place]))
    stretch = stretches(strain, numbers[:, 0], wanted.gauge)
    nominal = stresses(stress, numbers[:, 1], stretch, wanted.area)
    if not (wanted.stretch or wanted.strain or wanted.gauge):
        for other in others(table.columns, strain):
            again = stretches(other, np.array(table.values([other.place]))[:, 0], None)
            _agree(strain, stretch - 1, other, again - 1)
    if not (wanted.stress or wanted.area):
        for other in others(table.columns, stress):
            if other.unit:
                values = np.array(table.values([other.place]))[:, 0]
                _agree(stress, nominal, other, stresses(other, values, stretch, None))
    if wanted.cycle:
        rows = loading(stretch, wanted.cycle)
        stretch, nominal = stretch[rows], nominal[rows]
    kind = MODES[mode]
    inside = np.ones(len(stretch), dtype=bool)
    if wanted.most is not None:
        greatest = np.max(kind.stretches(stretch), axis=0)
        inside &= greatest <= wanted.most * (1 + 1e-12)
    if wanted.least is not None:
        inside &= stretch >= wanted.least * (1 - 1e-12)
    if not inside.any():
        raise ValueError("no points in the range asked for")
    measurement = Measurement(kind, stretch[inside], nominal[inside], path.name)
    if measurement.stress @ np.log(measurement.stretch) < 0:
        raise ValueError(
            f"{stress.name!r} acts against {strain.name!r}, expected both above zero in tension "
            "and below zero in compression, where stretches are below 1"
        )
    # 5 of a column without a unit is 500 %, which a column in percent would silently become
    unit = " (1 is 100 %)" if strain.what == "strain" and not strain.unit else ""
    said = (
        f"{path.name}: {mode}, {inside.sum()} of {len(numbers)} points, stretch "
        f"{measurement.stretch.min():.4g} to {measurement.stretch.max():.4g}, from "
        f"{strain.name!r}{unit} and {stress.name!r}"
    )
    return Read(measurement, said)

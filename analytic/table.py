"""Measured data from CSV files; the standard library only, so that a check of a file is quick."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path


def read_columns(path: Path, columns: Sequence[str]) -> list[list[float]]:
    """Read some columns of numbers; other columns are left alone, empty lines passed over.

    Args:
        path: a CSV file with a line of column names.
        columns: names of the columns wanted, c of them.

    Returns:
        The n rows, at least one, of c finite numbers each.

    Raises:
        ValueError: a missing column, a value that is not a finite number, no rows, or no text;
            begins with the file's name.
        OSError: the file cannot be read.
    """
    rows = []
    with path.open(encoding="utf-8-sig", newline="") as file:
        try:
            reader = csv.DictReader(file, skipinitialspace=True)
            missing = [name for name in columns if name not in (reader.fieldnames or ())]
            if missing:
                raise ValueError(f"{path.name}: no column {' or '.join(missing)}")
            for row in reader:
                values = [_number(row[name]) for name in columns]
                for name, value in zip(columns, values, strict=True):
                    if not math.isfinite(value):
                        raise ValueError(
                            f"{path.name}, line {reader.line_num}: {name} expected, "
                            f"not {row[name]!r}"
                        )
                rows.append(values)
        except (csv.Error, UnicodeDecodeError):
            raise ValueError(f"{path.name}: not a CSV file") from None
    if not rows:
        raise ValueError(f"{path.name}: no rows")
    return rows


def _number(text: str | None) -> float:
    try:
        return float(text or "")
    except ValueError:
        return math.nan

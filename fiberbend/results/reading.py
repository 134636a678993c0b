"""Files of a run or a sweep, read as they were written; what is damaged is refused."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from fiberbend import columns as col
from fiberbend.results.folder import ABOUT_SWEEP, RUN_FILE, TABLE
from fiberbend.schema.problems import CaseError, Problem


def read_history(path: Path) -> list[dict[str, float | None]]:
    """The rows of a history.csv; empty cells are None, counts are integers.

    Columns of older versions have their present names.

    Raises:
        CaseError: a file that cannot be read, a column that no version has written, a cell that is
            no number, or a row that is cut off.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            return _rows(path, csv.DictReader(file))
    except (OSError, UnicodeError, csv.Error) as error:
        text = f"cannot be read, {error}, expected the history of a run"
        raise CaseError([Problem(str(path), text)]) from None


def _rows(path: Path, reader: csv.DictReader[str]) -> list[dict[str, float | None]]:
    try:
        names = {key: col.present_name(key) for key in reader.fieldnames or ()}
    except KeyError as error:
        wanted = "expected columns of history.csv, or a run of this version of fiberbend"
        raise CaseError([Problem(str(path), f"{error.args[0]}, {wanted}")]) from None
    rows = []
    for row in reader:
        where = f"{path}, line {reader.line_num}"
        if None in row or None in row.values():
            text = f"not as many cells as the {len(names)} columns, expected a whole row"
            raise CaseError([Problem(where, text)])
        rows.append({name: _number(row[key], name, where) for key, name in names.items() if name})
    return rows


def _number(text: str, name: str, where: str) -> float | None:
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        raise CaseError([Problem(where, f"{name} is {text!r}, expected a number")]) from None
    return int(value) if name in col.COUNTS and value.is_integer() else value


def read_run(path: Path) -> dict[str, Any]:
    """The content of run.json; of a run that was killed before it wrote one, what that means.

    Args:
        path: the run folder.

    Raises:
        CaseError: a file that cannot be read, or no mapping.
    """
    file = path / RUN_FILE
    content = _read_json(file, "the end of a run")
    if content is None:
        return {"status": "interrupted", "reason": f"killed before it wrote {file.name}"}
    return content


def read_about_sweep(path: Path) -> dict[str, Any]:
    """The content of sweep.json in the folder of a sweep; empty without the file.

    Raises:
        CaseError: a file that cannot be read, or no mapping.
    """
    return _read_json(path / ABOUT_SWEEP, "what a sweep asked for") or {}


def _read_json(file: Path, what: str) -> dict[str, Any] | None:
    """A mapping; None without the file."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise CaseError([Problem(str(file), f"{error}, expected {what}")]) from None
    if not isinstance(content, dict):
        raise CaseError([Problem(str(file), f"no mapping, expected {what}")])
    return content


def read_table(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """The columns of a sweep's sweep.csv and its rows as text, one a point; empty cells are "".

    Args:
        path: folder of the sweep.

    Raises:
        CaseError: no such file, one that cannot be read, or a row that is cut off.
    """
    file = path / TABLE
    try:
        with file.open(newline="", encoding="utf-8") as stream:
            reader = csv.DictReader(stream)
            rows = list(reader)
            header = list(reader.fieldnames or ())
    except FileNotFoundError:
        text = "no such file, expected a sweep whose points were solved; start it again"
        raise CaseError([Problem(str(file), text)]) from None
    except (OSError, ValueError, csv.Error) as error:
        text = f"cannot be read, {error}, expected the table of a sweep"
        raise CaseError([Problem(str(file), text)]) from None
    for row in rows:
        if None in row or None in row.values():
            text = f"a row without {len(header)} cells, expected a cell for every column"
            raise CaseError([Problem(str(file), text)])
    return header, rows

"""Tables of measured data; the standard library only, so that a check of a file is quick.

Files come from spreadsheets, instruments and scripts of many countries: the delimiter and the mark
before the decimals are found from the lines, and what could be read in two ways is refused.
"""

from __future__ import annotations

import csv
import dataclasses
import math
import re
from collections.abc import Sequence
from pathlib import Path

DELIMITERS = {"\t": "tab", ";": "semicolon", ",": "comma", "|": "bar", " ": "spaces"}
"""Delimiters that are known, with their names; spaces stand for any number of them."""
_COMMENT = ("#", "%", "//")
_NUMBER = re.compile(r"[+\-−]?(?:\d+(?:[.,]\d+|\.)?|[.,]\d+)(?:[eE][+\-−]?\d+)?", re.ASCII)
_THOUSANDS = re.compile(r"[+\-−]?[1-9]\d{0,2}(?:,\d{3})")
"""A number whose comma may stand before decimals or between thousands."""
_WORD = re.compile(r'"[^"]*"|[^\s"\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)))?|\[[^\]]*\]|\([^)]*\)')
"""A name between spaces, with its unit in brackets behind it."""
_NUMBERS = re.compile(r'(?:[\s.,;|:+\-−eE"]|nan|inf)*\d(?:[\s\d.,;|:+\-−eE"]|nan|inf)*', re.I)
"""A line of numbers."""
_UNIT = re.compile(
    r"[\[(].*[\])]|-|%|mm/mm|m/m|[kMG]?Pa|N/mm\^?2|N/mm²|psi|bar|[mcµ]?m|m?N|m?s|min|°C|"
)
"""A cell of a line of units below the names: in brackets, one of those of such tests, or empty."""
_LISTED = 8


@dataclasses.dataclass(frozen=True)
class Table:
    """A file of columns, as text.

    Attributes:
        source: name of the file.
        columns: names of its columns.
        delimiter: a key of `DELIMITERS`.
        rows: number of the line, and a cell for each column.
        decimal: the mark before decimals where that is given.
    """

    source: str
    columns: tuple[str, ...]
    delimiter: str
    rows: tuple[tuple[int, tuple[str, ...]], ...]
    decimal: str | None = None

    @property
    def found(self) -> str:
        """Its columns and its delimiter in words."""
        names = [repr(name) for name in self.columns[:_LISTED]]
        more = len(self.columns) - len(names)
        names += [f"{more} more"] if more else []
        return f"columns {', '.join(names)} between {_between(self.delimiter)}"

    def values(self, columns: Sequence[int]) -> list[list[float]]:
        """Finite numbers of some columns.

        Args:
            columns: their places among `Table.columns`, c of them.

        Returns:
            The n rows of c numbers each.

        Raises:
            ValueError: a cell that is no finite number, or commas that can be read in two ways;
                begins with the file's name and the line.
        """
        cells = [(line, place, row[place]) for line, row in self.rows for place in columns]
        decimal = self.decimal or self._decimal(cells)
        numbers = [self._number(*cell, decimal) for cell in cells]
        width = len(columns)
        return [numbers[begin : begin + width] for begin in range(0, len(numbers), width)]

    def _decimal(self, cells: Sequence[tuple[int, int, str]]) -> str:
        """The mark before decimals that all numbers share."""
        numbers = [cell for cell in cells if _NUMBER.fullmatch(cell[2])]
        commas = [cell for cell in numbers if "," in cell[2]]
        points = [cell for cell in numbers if "." in cell[2]]
        if not commas:
            return "."
        (line, _, text) = commas[0]
        if points:
            other = f"{points[0][2]!r} in line {points[0][0]}"
            raise ValueError(
                f"{self.source}, line {line}: {text!r} has a comma and {other} a point, expected "
                "one mark before decimals"
            )
        if all(_THOUSANDS.fullmatch(text) for _, _, text in commas):
            plain = text.replace(",", "")
            raise ValueError(
                f"{self.source}, line {line}: {text!r} is {text.replace(',', '.')} or {plain}, "
                "expected a point before decimals, or decimal: ',' in the case"
            )
        return ","

    def _number(self, line: int, place: int, text: str, decimal: str) -> float:
        other = "." if decimal == "," else ","
        if _NUMBER.fullmatch(text) and other not in text:
            value = float(text.replace(decimal, ".").replace("−", "-"))
            if math.isfinite(value):
                return value
        name = self.columns[place]
        shown = repr(text[:40]) if text else "empty"
        raise ValueError(f"{self.source}, line {line}: {name!r} is {shown}, expected a number")


def read_table(path: Path, delimiter: str | None = None, decimal: str | None = None) -> Table:
    """Read a file of columns; empty lines and comments (#, %, //) are passed over.

    The first line has the names of the columns; where it has numbers, the comment above it does.

    Args:
        path: text in UTF-8, UTF-16 with its mark, or Windows' Western code page.
        delimiter: a key of `DELIMITERS`; found from the lines unless given.
        decimal: "." or ","; found from the numbers unless given.

    Raises:
        ValueError: no text, no names, no rows, or rows of another number of cells than the names;
            begins with the file's name.
        OSError: the file cannot be read.
    """
    return _table(path, delimiter, decimal, False)


def read_below_preface(
    path: Path, delimiter: str | None = None, decimal: str | None = None
) -> Table:
    """Read a file of columns as `read_table` does, with lines of other things above the names.

    The names are those in the line above the first numbers, with units in brackets in a line of
    their own or not. A file of numbers alone has the columns 1, 2, ….

    Args:
        path: as of `read_table`.
        delimiter: as there.
        decimal: as there.

    Raises:
        ValueError: as there.
        OSError: the file cannot be read.
    """
    return _table(path, delimiter, decimal, True)


def _table(path: Path, delimiter: str | None, decimal: str | None, preface: bool) -> Table:
    name = path.name
    head, lines, said = _lines(name, _text(path), preface)
    delimiter = delimiter or said
    every = [delimiter] if delimiter is not None else list(DELIMITERS)
    try:
        splits = {mark: _split(mark, head, lines) for mark in every}
    except csv.Error:
        raise ValueError(f"{name}: not a CSV file") from None
    whole = {mark: split for mark, split in splits.items() if _uneven(split) is None}
    if not whole:
        raise ValueError(_refusal(name, splits))
    if len(whole) > 1:
        # spaces come last: names and texts have them too
        whole.pop(" ", None)
    best = max(whole, key=lambda mark: _numeric(whole[mark].rows))
    split = whole[best]
    if not split.rows:
        raise ValueError(f"{name}: no rows")
    return Table(name, split.columns, best, split.rows, decimal)


def read_columns(path: Path, columns: Sequence[str]) -> list[list[float]]:
    """Read columns of numbers by their names; other columns are left alone.

    Args:
        path: a file as of `read_table`.
        columns: names of the columns wanted, c of them.

    Returns:
        The n rows, at least one, of c finite numbers each.

    Raises:
        ValueError: a missing column, a value that is not a finite number, no rows, or no text;
            begins with the file's name.
        OSError: the file cannot be read.
    """
    table = read_table(path)
    missing = [name for name in columns if table.columns.count(name) != 1]
    if missing:
        raise ValueError(f"{path.name}: no column {' or '.join(missing)}, found {table.found}")
    return table.values([table.columns.index(name) for name in columns])


@dataclasses.dataclass(frozen=True)
class _Split:
    """A file cut by a delimiter.

    Attributes:
        columns: names.
        rows: number of the line, and its cells; of any number.
    """

    columns: tuple[str, ...]
    rows: tuple[tuple[int, tuple[str, ...]], ...]


def _text(path: Path) -> str:
    content = path.read_bytes()
    utf16 = content.startswith((b"\xff\xfe", b"\xfe\xff"))
    for encoding in ("utf-16",) if utf16 else ("utf-8-sig", "cp1252"):
        try:
            text = content.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise ValueError(f"{path.name}: not a CSV file")


def _lines(name: str, text: str, preface: bool) -> tuple[str, list[tuple[int, str]], str | None]:
    """The line of names, the numbered lines below it, and the delimiter that a line `sep=` says."""
    comment, said = "", None
    lines: list[tuple[int, str]] = []
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), start=1):
        bare = line.strip(" \ufeff")
        if not bare.strip():
            continue
        if bare.startswith(_COMMENT) and not (preface and lines and _units(bare)):
            comment = comment if lines else bare.lstrip("#%/ ")
        elif not lines and re.fullmatch(r"sep=.", bare):
            said = bare[-1]
        else:
            lines.append((number, bare))
    if said is not None and said not in DELIMITERS:
        raise ValueError(f"{name}: sep={said}, expected one of {', '.join(DELIMITERS.values())}")
    if not lines:
        raise ValueError(f"{name}: no rows, expected a line of names and lines of numbers")
    if preface:
        head, below = _below_preface(comment, lines)
        if not below and len(lines) > 1:
            shown = repr(lines[-1][1][:40])
            raise ValueError(f"{name}: no lines of numbers, the last line is {shown}")
        return head, below, said
    if re.fullmatch(r'[\s\d.,;|:+\-−eE"]+', lines[0][1]):
        if not comment:
            shown = lines[0][1][:40]
            raise ValueError(f"{name}, line {lines[0][0]}: {shown!r}, expected names of columns")
        return comment, lines, said
    return lines[0][1], lines[1:], said


def _units(line: str) -> bool:
    """Whether a line has nothing but units, such as %;kPa, and so is no comment."""
    rows = [line.split(mark) for mark in "\t;,|" if mark in line]
    return any(all(_UNIT.fullmatch(cell.strip()) for cell in row) for row in rows)


def _below_preface(comment: str, lines: list[tuple[int, str]]) -> tuple[str, list[tuple[int, str]]]:
    """The line of names above the first two lines of numbers, and these."""
    numeric = [_NUMBERS.fullmatch(line) is not None for _, line in lines]
    pairs = zip(numeric, [*numeric[1:], True], strict=True)
    first = next((i for i, pair in enumerate(pairs) if all(pair)), len(lines))
    if first == 0 and not comment:
        # of any delimiter as many as there are
        mark = max("\t;,|", key=lambda m: lines[0][1].count(m))
        mark = mark if mark in lines[0][1] else " "
        count = len(_cells(mark, lines[0][1]))
        return mark.join(str(i + 1) for i in range(count)), lines
    if first == 0:
        return comment, lines
    head = lines[first - 1][1]
    marks = [m for m in "\t;,|" if m in head]
    if first > 1 and marks:
        mark = max(marks, key=head.count)
        names, units = (_cells(mark, lines[i][1]) for i in (first - 2, first - 1))
        if len(names) == len(units) and any(units) and all(map(_UNIT.fullmatch, units)):
            shown = [u if u[:1] in ("", "[", "(") else f"[{u}]" for u in units]
            head = mark.join(f"{n} {u}".strip() for n, u in zip(names, shown, strict=True))
    return head, lines[first:]


def _split(delimiter: str, head: str, lines: Sequence[tuple[int, str]]) -> _Split:
    """Cut all lines; empty cells behind the last name go, and lines of empty cells."""
    columns = _cells(delimiter, head)
    if delimiter == " " and lines:
        # names of several words are further apart from each other
        apart = [name.strip('"') for name in re.split(r"\s{2,}|\t", head)]
        if len(_cells(delimiter, lines[0][1])) == len(apart):
            columns = apart
    while columns and not columns[-1]:
        columns.pop()
    rows = []
    for number, line in lines:
        cells = _cells(delimiter, line)
        while len(cells) > len(columns) and not cells[-1]:
            cells.pop()
        if any(cells):
            rows.append((number, tuple(cells)))
    return _Split(tuple(columns), tuple(rows))


def _cells(delimiter: str, line: str) -> list[str]:
    if delimiter != " ":
        (cells,) = csv.reader([line], delimiter=delimiter, skipinitialspace=True)
        return [" ".join(cell.split()) for cell in cells]
    return [cell.strip('"') for cell in _WORD.findall(line)]


def _uneven(split: _Split) -> tuple[int, int] | None:
    """The first line with another number of cells than there are names, and that number."""
    width = len(split.columns)
    if width < 2:
        return 0, width
    return next(((n, len(cells)) for n, cells in split.rows if len(cells) != width), None)


def _numeric(rows: Sequence[tuple[int, tuple[str, ...]]]) -> float:
    """Part of all cells that are numbers."""
    cells = [cell for _, row in rows for cell in row if cell]
    return sum(_NUMBER.fullmatch(cell) is not None for cell in cells) / max(len(cells), 1)


def _refusal(name: str, splits: dict[str, _Split]) -> str:
    """Why no delimiter fits, by the one that fits the names."""
    delimiter = max(splits, key=lambda mark: (len(splits[mark].columns) > 1, mark != " "))
    split = splits[delimiter]
    names = ", ".join(map(repr, split.columns[:_LISTED]))
    if len(split.columns) < 2:
        known = ", ".join(DELIMITERS.values())
        return f"{name}: one column {names}, expected two, and one of {known} between them"
    line, count = _uneven(split) or (0, 0)
    commas = delimiter == "," and count > len(split.columns)
    hint = "; beside decimal commas the delimiter must be another" if commas else ""
    cells = "1 cell" if count == 1 else f"{count} cells"
    return (
        f"{name}, line {line}: {cells} between {_between(delimiter)}, expected "
        f"{len(split.columns)} as there are names ({names}){hint}"
    )


def _between(delimiter: str) -> str:
    name = DELIMITERS[delimiter]
    return name if name.endswith("s") else f"{name}s"

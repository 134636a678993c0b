"""What is wrong with a case: one line per problem, each with the path of the value."""

from __future__ import annotations

import dataclasses
import difflib
import json
from collections.abc import Iterable
from typing import Any

LINES = 20
"""Problems of which a message tells; the others it counts."""
_LONGEST = 1000
"""Characters of a line."""


@dataclasses.dataclass(frozen=True)
class Problem:
    """One thing that is wrong.

    Attributes:
        path: dotted path in the case, or the name of a file.
        text: the rest of the line: what was found, what was expected.
        line: line of the file in which the value stands, where it comes from a file.
    """

    path: str
    text: str
    line: int | None = None

    def __str__(self) -> str:
        """The line that a user reads."""
        where = "" if self.line is None else f" (line {self.line})"
        text = f"{self.path}: {self.text}"
        text = text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
        return printable(text) + where


class CaseError(Exception):
    """A case, a command or a run folder that cannot be used; nothing has been computed.

    Attributes:
        problems: what is wrong, at least one.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        lines = [str(problem) for problem in self.problems[:LINES]]
        more = len(self.problems) - len(lines)
        super().__init__("\n".join([*lines, *([f"… and {more} more"] if more else [])]))

    def __reduce__(self) -> Any:
        """Pickles by its problems, so that MPI can hand it to the other ranks."""
        return type(self), (self.problems,)


def found(value: Any) -> str:
    """A value as a message shows it: short, text in quotes."""
    if value is None:
        return "nothing"
    try:
        text = json.dumps(value, default=str, ensure_ascii=False)
    except (TypeError, ValueError, RecursionError):
        # keys that are no text, a number of 5000 digits, a value within itself
        text = f"something of type {type(value).__name__}"
    return text if len(text) <= 60 else text[:57] + "..."


def printable(text: str) -> str:
    """Text in one line that any terminal shows as it is: other characters as their escapes."""
    if text.isprintable():
        return text
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in text
    )


def meant(word: object, known: Iterable[str]) -> str:
    """The end of a message that names the known word nearest to a wrong one; empty without one."""
    close = difflib.get_close_matches(str(word)[:_LONGEST].lower(), list(known), n=1)
    return f"; did you mean {close[0]}?" if close else ""

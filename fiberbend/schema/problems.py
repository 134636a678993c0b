"""What is wrong with a case: one line per problem, each with the path of the value."""

from __future__ import annotations

import dataclasses
import difflib
import json
from collections.abc import Iterable
from typing import Any


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
        return f"{self.path}: {self.text}{where}"


class CaseError(Exception):
    """A case, a command or a run folder that cannot be used; nothing has been computed.

    Attributes:
        problems: what is wrong, at least one.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(map(str, self.problems)))

    def __reduce__(self) -> Any:
        """Pickles by its problems, so that MPI can hand it to the other ranks."""
        return CaseError, (self.problems,)


def found(value: Any) -> str:
    """A value as a message shows it: short, text in quotes."""
    if value is None:
        return "nothing"
    text = json.dumps(value, default=str, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."


def meant(word: object, known: Iterable[str]) -> str:
    """The end of a message that names the known word nearest to a wrong one; empty without one."""
    close = difflib.get_close_matches(str(word).lower(), list(known), n=1)
    return f"; did you mean {close[0]}?" if close else ""

"""The law of a section as a user sees it: words, files, a picture."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import TYPE_CHECKING

from fiberbend.case.case import Case
from fiberbend.case.symmetry import Symmetry
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw import picture, words
from fiberbend.sectionlaw.path import picture as path_picture
from fiberbend.sectionlaw.path import words as path_words
from fiberbend.sectionlaw.path.make import law_about
from fiberbend.sectionlaw.path.store import PathStore
from fiberbend.sectionlaw.store import Store
from fiberbend.sectionlaw.table import table_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclasses.dataclass(frozen=True)
class Shown:
    """A law of a section.

    Attributes:
        lines: what it is.
        packed: as an npz file.
        text: its states as CSV.
        page: its picture.
    """

    lines: tuple[str, ...]
    packed: bytes
    text: str
    page: Figure


def shown(
    case: Case, error: float, least: float | None, tell: Callable[[str], None] | None = None
) -> Shown:
    """A table of a section that bends in its plane, of others the law about their free states.

    Args:
        case: a checked case of model section or cell.
        error: asked for, in parts.
        least: pressure from which a table is, MPa; zero unless given.
        tell: takes lines of progress.

    Raises:
        CaseError: the law cannot have what the case has, or does not reach the error.
    """
    if Symmetry.of(case.acting).plane:
        tables = Store()
        made = table_of(case, error, least, tables, tell)
        lines = (*words.lines(made), *_notes(tables.remarks))
        return Shown(lines, made.packed(), words.text(made), picture.draw(made))
    if least:
        text = "a section that twists or bends to the side has its law from rest on, expected 0 kPa"
        raise CaseError([Problem("--from", text)])
    laws = PathStore()
    about = law_about(case, error, laws, tell)
    lines = (*path_words.lines(about), *_notes(laws.remarks))
    return Shown(lines, about.packed(), path_words.text(about), path_picture.draw(about))


def _notes(remarks: list[str]) -> tuple[str, ...]:
    return tuple(f"  note: {remark}" for remark in remarks)

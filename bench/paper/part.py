"""A part of the page: a figure or a table of the paper with what we get and the verdicts."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from bench.paper.runs import Runs
from bench.paper.verdict import Verdict


@dataclasses.dataclass(frozen=True)
class Figure:
    """A drawing.

    Attributes:
        name: of its files, "fig8".
        page: a matplotlib figure of at most `draw.WIDTH` inches.
        caption: what it shows.
    """

    name: str
    page: Any
    caption: str


@dataclasses.dataclass(frozen=True)
class Table:
    """Numbers.

    Attributes:
        caption: what they are, with units.
        head: of the columns.
        rows: texts; as many in each as in the head.
        words: cells are sentences, which are wrapped, and not numbers below each other.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    words: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.head):
                raise ValueError(f"{self.caption}: {len(row)} cells, {len(self.head)} expected")


@dataclasses.dataclass(frozen=True)
class Erratum:
    """What the paper prints and what is right.

    Attributes:
        place: equation or section.
        printed: as it is printed, with what that gives.
        right: what is computed here instead.
    """

    place: str
    printed: str
    right: str


@dataclasses.dataclass(frozen=True)
class Found:
    """What a part has to show.

    Attributes:
        words: paragraphs: what the paper shows, what is computed, what is assumed.
        figures: drawings.
        tables: numbers.
        verdicts: on what the paper states.
        errata: of the paper, where a number hangs on them.
        commands: that make its runs by themselves; the page's own command is added.
    """

    words: Sequence[str] = ()
    figures: Sequence[Figure] = ()
    tables: Sequence[Table] = ()
    verdicts: Sequence[Verdict] = ()
    errata: Sequence[Erratum] = ()
    commands: Sequence[str] = ()


@dataclasses.dataclass(frozen=True)
class Part:
    """A part of the page.

    Attributes:
        name: short, of its anchor and of `--only`: "fig8".
        title: its heading.
        make: computes it; asks `Runs` for what has to be solved, so that a part that is made
            again solves nothing again.
    """

    name: str
    title: str
    make: Callable[[Runs], Found]

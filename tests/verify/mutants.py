"""What changes of fem/ the tests did not notice: found by bench/mutants.py, judged by hand."""

from __future__ import annotations

import dataclasses
from textwrap import fill

TITLE = "Lines changed on purpose: what the tests do not notice"
SAMPLE, MISSED = 100, 0
TEXT = ""


@dataclasses.dataclass(frozen=True)
class Mutant:
    """A change that the tests of its area did not notice.

    Attributes:
        source: the file, below fem/.
        change: before and after.
        meaning: what it changes.
        verdict: why it survives, or what now notices it.
    """

    source: str
    change: str
    meaning: str
    verdict: str


def section() -> str:
    """The survivors as a table."""
    lines = [f"## {TITLE}", "", fill(TEXT, 100), ""]
    lines += ["| source | change | what it changes | why it survives |", "| --- | --- | --- | --- |"]
    for m in MUTANTS:
        lines.append(f"| {m.source} | {m.change} | {m.meaning} | {m.verdict} |")
    return "\n".join(lines) + "\n"

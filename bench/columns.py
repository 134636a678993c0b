"""Write the tables of columns in docs/ from `fiberbend.columns`."""

from __future__ import annotations

from pathlib import Path

from fiberbend.columns import table
from fiberbend.models.choice import MODELS

ROOT = Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- columns, by `make docs` -->", "<!-- end of columns -->"
PAGES = {"docs/columns.md": False, "docs/crosscheck.md": True}
"""Pages, and whether they list the columns of other models beside a run or the run's own."""


def written(page: str, beside: bool) -> str:
    """A page with its table as it should be.

    Args:
        page: its path from the root of the repository.
        beside: see `PAGES`.
    """
    text = (ROOT / page).read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    return "\n".join([before + BEGIN, *table(MODELS.values(), beside), END]) + after


if __name__ == "__main__":
    for page, beside in PAGES.items():
        (ROOT / page).write_text(written(page, beside), encoding="utf-8")

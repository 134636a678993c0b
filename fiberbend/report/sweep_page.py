"""report.html of a sweep: what was asked for, maps, trends, the table, and links to its points."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fiberbend.report.page import Picture, beside, citation, inside, link, picture, render
from fiberbend.results.folder import POINTS, REPORT, TABLE, TRENDS, RunFolder
from fiberbend.results.reading import read_about_sweep, read_table
from fiberbend.version import __version__

_POINT, _STATUS, _REASON = "point", "status", "reason"
_QUIET = (_REASON, "solved_by")
"""Columns that are no numbers and are not among the fields."""


def write_sweep_report(folder: RunFolder, title: str = "") -> None:
    """Write report.html into the folder of a sweep.

    Args:
        folder: has sweep.csv, and trends.md, sweep.json and maps as far as there are any.
        title: of the sweep, where no sweep.json gives it.

    Raises:
        CaseError: there is no table.
    """
    folder.write_text(REPORT, sweep_report(folder.path, title))


def sweep_report(path: Path, title: str = "", links: str = "") -> str:
    """The page of a sweep.

    Args:
        path: its folder.
        title: of the sweep, where no sweep.json gives it.
        links: what leads from the page to the folder; empty for a page in the folder itself.

    Raises:
        CaseError: the folder has no table.
    """
    heads, rows = read_table(path)
    about = read_about_sweep(path)
    quantities = about.get("quantities") or []
    failed = about.get("failed") or {
        row[_POINT]: row.get(_REASON, "") for row in rows if row.get(_STATUS) == "failed"
    }
    shown = [head for head in heads if head not in _QUIET and any(row[head] for row in rows)]
    return render(
        "sweep.html",
        title=about.get("title") or title or path.resolve().name,
        folder=path.resolve().name,
        status=Counter(row.get(_STATUS) or "unknown" for row in rows),
        points=len(rows),
        quantities=quantities,
        notes=about.get("notes") or [],
        failed=failed,
        maps=_maps(path, quantities),
        trends=_as_html(path / TRENDS),
        heads=shown,
        rows=[[_cell(row[head]) for head in shown] for row in rows],
        addresses=[_point(path, row.get(_POINT, ""), links) for row in rows],
        downloads=[
            *(inside(path / name, path) for name in (TABLE, TRENDS) if (path / name).exists()),
            *(beside(file, path, links) for file in sorted(path.glob("maps/*"))),
        ],
        cite=citation(),
        version=__version__,
    )


def _maps(path: Path, quantities: Sequence[Mapping[str, Any]]) -> list[Picture]:
    """Maps and curves in the order of what was asked for, then all others."""
    there = sorted(file for file in path.glob("maps/*") if file.suffix in (".png", ".svg"))
    first = [name for each in quantities for name in each.get("pictures") or ()]
    ordered = sorted(there, key=lambda file: first.index(file.name) if file.name in first else 999)
    labels = {name: each.get("label") for each in quantities for name in each.get("pictures") or ()}
    return [
        picture(file, _sentence(labels.get(file.name) or file.stem.replace("_", " ")))
        for file in ordered
    ]


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _as_html(path: Path) -> str:
    """Markdown as HTML; HTML in it stays text."""
    if not path.exists():
        return ""
    from markdown_it import MarkdownIt

    content = MarkdownIt("commonmark", {"html": False}).enable("table")
    text = path.read_text(encoding="utf-8").splitlines()
    # the page has a title of its own
    if text and text[0].startswith("# "):
        text = text[1:]
    return str(content.render("\n".join(text)))


def _point(path: Path, name: str, links: str) -> str:
    """Where the report of a point is; empty where it has none."""
    file = path / POINTS / name / REPORT
    return link(file, path, links) if name and file.exists() else ""


def _cell(text: str) -> str:
    """A cell of the table with as many digits as a reader wants."""
    try:
        value = float(text)
    except ValueError:
        return text
    return f"{value:.5g}".replace("-", "−")

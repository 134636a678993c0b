"""report.html of a design: its answer, what holds it, tables, pictures and files."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

from fiberbend.report.page import beside, citation, inside, link, links_to, picture, render
from fiberbend.results.folder import DESIGN, REPORT, RunFolder
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.version import __version__

_TABLES = ("front.csv", "sensitivity.csv", "tries.csv")
_MOST_ROWS = 400


def write_design_page(folder: Path, out: Path | None = None) -> Path:
    """Write the page of a design.

    Args:
        folder: of the design.
        out: the file; report.html in the folder by default.

    Returns:
        Where it is.

    Raises:
        CaseError: the folder has no design.
    """
    if out is None:
        RunFolder(folder).write_text(REPORT, design_report(folder))
        return folder / REPORT
    page = design_report(folder, links_to(folder, out))
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(page, encoding="utf-8")
    return out


def design_report(path: Path, links: str = "") -> str:
    """The page of a design.

    Args:
        path: its folder.
        links: what leads from the page to the folder; empty for a page in the folder itself.

    Raises:
        CaseError: the folder has no design.
    """
    try:
        about: dict[str, Any] = json.loads((path / DESIGN).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise CaseError([Problem(str(path), f"contains no {DESIGN}, expected a design")]) from None
    models = [
        name
        for name in ("section", "cell", "body")
        if any(name in each["by_model"] for each in about["quantities"])
    ]
    files = [name for name in (*about["cases"], *_TABLES, DESIGN) if (path / name).exists()]
    tables = {name: _table(path / name) for name in _TABLES if (path / name).exists()}
    return render(
        "design.html",
        title=about["title"] or path.resolve().name,
        folder=path.resolve().name,
        about=about,
        models=models,
        tables=tables,
        pictures=[
            picture(file, _caption(file.stem.removeprefix("design_")))
            for file in sorted(path.glob("design_*.png"))
        ],
        cases=[(name, link(path / name, path, links)) for name in about["cases"]],
        shown=_shown,
        downloads=[
            *(inside(path / name, path) for name in files),
            *(beside(file, path, links) for file in sorted(path.glob("design_*.png"))),
        ],
        cite=citation(),
        version=__version__,
    )


def _caption(kind: str) -> str:
    """What a picture shows, by its name."""
    if kind == "front":
        return "The trade-off between both goals."
    return f"{kind[0].upper()}{kind[1:]} over pressure, and what is wanted of it."


def _table(path: Path) -> dict[str, Any]:
    """A CSV file as heads and rows, a long one cut."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    cut = [[_shown(cell) for cell in row] for row in rows[1 : _MOST_ROWS + 1]]
    return {"heads": rows[0], "rows": cut, "left": max(0, len(rows) - 1 - _MOST_ROWS)}


def _shown(value: Any) -> str:
    """A number with as many digits as a reader wants; other text as it is."""
    if value is None:
        return ""
    number, _, unit = str(value).partition(" ")
    try:
        text = f"{float(number):.4g}".replace("-", "−")
    except ValueError:
        return str(value)
    return f"{text} {unit}".strip()

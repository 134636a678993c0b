"""`make paper`: figures and tables of Polygerinos et al. 2015, runs/paper/index.html.

The quick form solves sections and cells, `--full` bodies too, and writes docs/paper.md. What is
solved is kept in runs/paper, and not solved again.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from bench.paper.page import Made, draw, html, markdown, missing, sentence
from bench.paper.part import Part
from bench.paper.parts import PARTS
from bench.paper.runs import ROOT, Runs
from fiberbend.drawing.page import own_style, save

OUT = ROOT / "runs" / "paper"
DOCS = ROOT / "docs"
QUICK, WHOLE = "quick form: closed forms, sections and cells", "full form, bodies too"


def make(runs: Runs, out: Path, parts: Sequence[Part] = PARTS) -> list[Made]:
    """Make parts, draw their figures and write the page.

    Args:
        runs: what is solved.
        out: folder of the page.
        parts: all of them, or some.

    Raises:
        ValueError: all parts leave a stated number without a verdict.
    """
    made = []
    with own_style():
        for part in parts:
            print(f"{part.title} …", flush=True)
            made.append(Made(part, part.make(runs)))
        if tuple(parts) == PARTS and (left := missing(made)):
            raise ValueError(f"no verdict on {', '.join(left)}")
        draw(made, out / "figures")
    page = html(made, out / "figures", WHOLE if runs.bodies else QUICK)
    (out / "index.html").write_text(page, encoding="utf-8")
    return made


def publish(made: Sequence[Made]) -> None:
    """Write docs/paper.md and its pictures."""
    for each in made:
        for figure in each.found.figures:
            save(figure.page, DOCS / "images" / f"paper_{figure.name}.png")
    (DOCS / "paper.md").write_text(markdown(made, WHOLE), encoding="utf-8")


def main() -> None:
    """Make the page."""
    parser = argparse.ArgumentParser(prog="python -m bench.paper", description=__doc__)
    parser.add_argument("--full", action="store_true", help="solve bodies, write docs/paper.md")
    parser.add_argument("--only", nargs="+", choices=[p.name for p in PARTS], default=[])
    parser.add_argument("--jobs", type=int, default=min(2, os.cpu_count() or 1))
    parser.add_argument("--out", type=Path, default=OUT)
    given = parser.parse_args()
    start = time.perf_counter()
    parts = [part for part in PARTS if not given.only or part.name in given.only]
    try:
        made = make(Runs(given.out, given.full, given.jobs), given.out, parts)
    except KeyboardInterrupt:
        sys.exit("interrupted: the same command goes on")
    if given.full and not given.only:
        publish(made)
    print(f"{sentence(made)} {time.perf_counter() - start:.0f} s")
    print(f"open {given.out / 'index.html'}")


if __name__ == "__main__":
    main()

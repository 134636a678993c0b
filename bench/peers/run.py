"""`make peers`: the same actuator in fiberbend, CalculiX, felupe and a plain dolfinx script.

Each run leaves runs/peers/NAME.json and is not done again while that is there. Everything is on one
thread, one run at a time. The page is docs/evidence/peers.md.
"""

from __future__ import annotations

import datetime
import sys
from collections.abc import Sequence
from pathlib import Path

from bench.peers.programs import Rung, measured
from bench.peers.record import Record, load_record
from bench.peers.scene import ROOT
from bench.peers.table import page
from machine.origin import machine

FOLDER = ROOT / "runs" / "peers"
PAGE = ROOT / "docs" / "evidence" / "peers.md"
RUNGS = (
    Rung("fiberbend", 1, 16, 120, 7),
    Rung("fiberbend", 1, 8, 120, 10),
    Rung("fiberbend", 1, 4, 120, 16),
    Rung("fiberbend", 2, 8, 240, 40),
    Rung("fiberbend", 2, 4, 360, 80),
    Rung("fiberbend", 2, 2, 600, 150),
    Rung("calculix-c3d20r", 1, 16, 240, 40),
    Rung("calculix-c3d20r", 1, 8, 240, 100),
    Rung("calculix-c3d20r", 2, 8, 300, 300),
    Rung("calculix-c3d20", 1, 16, 240, 70),
    Rung("dolfinx-taylor-hood", 1, 16, 240, 60),
    Rung("dolfinx-taylor-hood", 1, 8, 240, 110),
    Rung("dolfinx-taylor-hood", 2, 8, 240, 240),
    Rung("dolfinx-dpc1", 1, 16, 240, 60),
    Rung("dolfinx-dpc1", 1, 8, 240, 110),
    Rung("felupe", 1, 16, 240, 110),
    Rung("felupe", 1, 8, 240, 200),
)
"""Programs and meshes, in the order they are run."""


def main(words: Sequence[str]) -> None:
    """Run what is missing, then write the page.

    Args:
        words: names of programs, to run these alone; the page needs fiberbend.
    """
    rungs = [rung for rung in RUNGS if not words or rung.program in words]
    missing = [rung for rung in rungs if not _file(rung).exists()]
    if missing:
        minutes, most = (sum(times) / 60 for times in zip(*map(_times, missing), strict=True))
        print(f"peers: {len(missing)} runs, about {minutes:.0f} minutes, {most:.0f} at most")
    for rung in missing:
        print(f"{rung.name}: about {rung.expected:g} s", flush=True)
        record = measured(rung, FOLDER / rung.name)
        record.save(_file(rung))
        print(f"  {_line(record)}", flush=True)
    records = [load_record(_file(rung)) for rung in RUNGS if _file(rung).exists()]
    here = machine()
    text = page(records, f"{here['processor']}, {here['cores']} cores", datetime.date.today())
    PAGE.write_text(text, encoding="utf-8")
    print(f"peers: {PAGE.relative_to(ROOT)}")


def _times(rung: Rung) -> tuple[float, float]:
    return rung.expected, rung.limit


def _file(rung: Rung) -> Path:
    return FOLDER / f"{rung.name}.json"


def _line(record: Record) -> str:
    """A run in a line."""
    return (
        f"{record.reached:.0f}°, {record.unknowns} unknowns, {record.iterations} iterations, "
        f"{record.cpu:.0f} s of CPU, {record.wall:.0f} s; {record.ended or 'at the goal'}"
    )


if __name__ == "__main__":
    main(sys.argv[1:])

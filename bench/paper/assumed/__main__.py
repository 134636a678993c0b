"""Solve what bench/paper/assumed/record.json holds; minutes. `make paper ASSUME=1` runs it.

The page itself reads the file, and needs none of this.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from bench.paper.assumed.grid import solved
from bench.paper.assumed.record import FILE, made


def main() -> None:
    """Solve the grid, optimise, confirm, and write the record."""
    parser = argparse.ArgumentParser(prog="python -m bench.paper.assumed", description=__doc__)
    parser.add_argument("--out", type=Path, default=FILE, help="the file")
    given = parser.parse_args()
    start = time.perf_counter()

    def tell(line: str) -> None:
        print(f"{time.perf_counter() - start:5.0f} s  {line}", flush=True)

    record = made(solved(tell), tell)
    record.save(given.out)
    print(f"{given.out}: {record.seconds:.0f} s of processor time")


if __name__ == "__main__":
    main()

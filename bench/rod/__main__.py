"""What the rod is by itself, and beside the body.

`python -m bench.rod` prints the numbers of the rod alone that docs/decisions.md quotes;
`python -m bench.rod solve --model body --mesh coarse` solves the scenes and keeps their records;
`python -m bench.rod page` writes docs/evidence/rod.md from the records.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from bench.rod import numerics, page, record
from bench.rod.scenes import BY_NAME, COARSE, MESHES, SCENES
from fiberbend.schema.problems import CaseError


def _solve(given: argparse.Namespace) -> None:
    for name in given.scenes or [scene.name for scene in SCENES]:
        scene = BY_NAME[name]
        file = record.path_of(name, given.model, given.mesh)
        if file.exists() and not given.again:
            continue
        out = None if given.out is None else given.out / f"{name}.{given.model}.{given.mesh}"
        try:
            found = record.solve(scene, given.model, given.mesh, out, given.twice)
        except CaseError as refused:
            print(name, "refused:", refused, flush=True)
            continue
        record.keep(found, file)
        print(name, found.status, found.reason, f"{found.cpu_s:.1f} s", flush=True)


def main() -> None:
    """Read the arguments and do it."""
    parser = argparse.ArgumentParser(prog="python -m bench.rod", description=__doc__)
    commands = parser.add_subparsers(dest="command")
    solve = commands.add_parser("solve", help="solve scenes and keep their records")
    solve.add_argument("scenes", nargs="*", help="names; all of them by default")
    solve.add_argument("--model", default="rod")
    solve.add_argument("--mesh", default=COARSE, choices=MESHES)
    solve.add_argument("--again", action="store_true", help="also those that are kept")
    solve.add_argument("--twice", action="store_true", help="once before, so that tables are made")
    solve.add_argument("--out", type=Path, help="folder for whole runs")
    commands.add_parser("page", help="write docs/evidence/rod.md from the records")
    given = parser.parse_args()
    if given.command == "solve":
        _solve(given)
    elif given.command == "page":
        page.PAGE.write_text(page.page(), encoding="utf-8")
    else:
        numerics.report()


if __name__ == "__main__":
    main()

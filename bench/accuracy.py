"""Write docs/accuracy.md, the page for users on what a percent costs, from ladders and prices.

`make accuracy` makes all that it needs; this alone puts together what lies in runs/.
"""

from __future__ import annotations

import dataclasses
import json
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bench import prices

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "runs"
PAGE = ROOT / "docs" / "accuracy.md"
IMAGES = ROOT / "docs" / "images"

HEAD = """# What accuracy costs

<!-- Written by `make accuracy`; do not edit by hand. -->

How long does an answer take that is right to one percent? This page shows it for two cases: a
finger that bends freely and one whose tip is blocked. `fiberbend accuracy` makes the same for
your own case.

## How to read it

Every point of a picture is one run: a model with a mesh, in a process of its own. To the right
it took longer, upward it is farther off. The red line joins the runs that no other one beats: no
run is both quicker and more exact. Take a point on it.

The error has two parts:

- The **mesh error** falls with smaller elements. It is the distance of a run from the limit of
  its own family, which is the same model with ever finer meshes. The limit is extrapolated from
  three or four meshes in each direction, across the section and along the axis (Richardson's
  extrapolation; Roache 1994, doi 10.1115/1.2910291).
- The **modelling error** stays whatever the mesh. It is the distance between the limit of the
  family and the limit of the finest family, which is the body with every turn of the winding. A
  section leaves out the caps, and unless its winding is calibrated what rubber does between the
  turns. No mesh can show it.

The two are added without their signs. A run in which they cancel is right by luck, and the next
radius has other luck. Of several answers (such as the pressures at three angles) the worst one
counts. The reference is itself known to some percent only: the grey band. Runs in it cannot be
told apart.

The limits are those of equations, not of rubber: how far the model is from an experiment is on
[the cross-check of every run](crosscheck.md). Half and whole body give the same answers; the
whole one shows what the mirror plane saves. Times are those of one process on one core, with
compiled kernels, with the calibration of a winding, without pictures and report.
"""
OWN = """## For your own case

Look first at what it would take. Nothing is solved:

```console
$ fiberbend accuracy cases/free_bending.yaml --dry-run
```

Then leave the machine alone while it works, or take only what is quick. It can be stopped and
goes on when it is started again:

<!-- slow -->
```console
$ fiberbend accuracy cases/free_bending.yaml --within 30s
$ fiberbend accuracy cases/free_bending.yaml
```

The last line is the advice, with the options to type. The folder `runs/accuracy_free_bending`
has the picture `accuracy.png`, the table as `accuracy.csv` and `accuracy.md`, and a file of
every run in `rungs/`. A run is done again when case, program or machine have changed. `--only
section --only cell` solves a part of the ladder; what was solved before counts too. What a model
does not support, what failed and what was skipped is named in `accuracy.md` with its reason.
"""


@dataclasses.dataclass(frozen=True)
class Shown:
    """A ladder on the page.

    Attributes:
        name: of its case file.
        heading: of its part.
        text: what it shows.
    """

    name: str
    heading: str
    text: str


LADDERS = (
    Shown(
        "free_bending",
        "Free bending",
        "The baseline actuator is bent to a full circle. The answers are the pressures at 90, 180 "
        "and 360°.",
    ),
    Shown(
        "blocked_tip",
        "Blocked tip",
        "The same actuator lies between a roof and a post. The answers are the forces of its tip "
        "at 50 to 200 kPa. Only a body has the ends that this needs.",
    ),
)


def part(shown: Shown) -> Iterator[str]:
    """A ladder's picture, advice and tables.

    Raises:
        FileNotFoundError: it has not been made.
    """
    folder = RUNS / f"accuracy_{shown.name}"
    picture = f"accuracy_{shown.name}.png"
    shutil.copyfile(folder / "accuracy.png", IMAGES / picture)
    text = (folder / "accuracy.md").read_text(encoding="utf-8")
    yield f"## {shown.heading}"
    yield ""
    yield f"{shown.text} Made by `fiberbend accuracy cases/{shown.name}.yaml` on {machine(folder)}."
    yield ""
    yield f"![Error against time of every model and mesh]({f'images/{picture}'})"
    yield ""
    yield from re.sub(r"\A# .*\n\n", "", text).rstrip().splitlines()
    yield ""


def machine(folder: Path) -> str:
    """Where the rungs were solved, and with which commit."""
    records = [json.loads(path.read_text()) for path in sorted(folder.glob("rungs/*.json"))]
    keys = {(each["key"]["machine"], each["key"]["commit"][:12]) for each in records}
    if len(keys) > 1:
        raise SystemExit(f"{folder}: rungs of {len(keys)} machines or commits, expected one")
    name, commit = keys.pop()
    known = [each["provenance"].get("blas") or {} for each in records]
    kernels = {str(blas["kernel"]) for blas in known if blas.get("kernel")}
    kernel = f", BLAS kernel {', '.join(sorted(kernels))}" if kernels else ""
    return f"{name}{kernel}, commit {commit}"


def price_list(found: dict[str, Any]) -> Iterator[str]:
    """What each effect adds."""
    yield "## What each effect adds"
    yield ""
    yield (
        "An effect that a case does not have costs nothing: it has no unknowns, no kernels and no "
        "terms. What it costs where it is there shows the baseline's body, half of it but in one "
        f"line, with elements of {found['axial']}, under 50 kPa. Each scene is solved with the "
        f"effect and without it, {found['rounds']} times in turns, and the least processor time of "
        "the load steps counts. Discrete turns add no unknowns, but they need elements of half the "
        "pitch, so that a body has two to three times as many."
    )
    yield ""
    place = f"{found['machine']['processor']}, {found['machine']['usable_cores']} cores"
    yield f"Made by `{found['command']}` on {place}, commit {found['commit'][:12]}."
    yield ""
    yield from prices.table(found)
    yield ""


def main() -> None:
    """Write the page."""
    lines = [HEAD]
    for shown in LADDERS:
        lines += part(shown)
    if prices.TARGET.exists():
        lines += price_list(json.loads(prices.TARGET.read_text(encoding="utf-8")))
    else:
        print(
            f"without the price list: no {prices.TARGET.relative_to(ROOT)}, python -m bench.prices"
        )
    lines.append(OWN)
    PAGE.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()

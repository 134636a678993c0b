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
from fiberbend.results.folder import LADDER, RUNGS

ROOT = Path(__file__).resolve().parent.parent
RUNS = ROOT / "runs"
PAGE = ROOT / "docs" / "accuracy.md"
IMAGES = ROOT / "docs" / "images"

HEAD = """# What accuracy costs

<!-- Written by `make accuracy`; do not edit by hand. -->

How long does an answer take that is right to one percent? This page shows it for two cases: a
finger that bends freely and one whose tip is blocked. `fiberbend accuracy` makes the same for
your own case.

## In short

{short}

## How to read it

Every point of a picture is one run: a model with a mesh, in a process of its own. Together they
are a ladder, and each is a rung. To the right a run took longer, upward it is farther off. The
thick line joins the runs that no other one beats: none is both quicker and more exact. They are
named, and in bold in the table. Take one of them.

A mark says the model and the shape of its elements, a colour how the winding is represented, the
numbers beside it the mesh as the case has it (`mesh.section / mesh.axial`). A hollow mark is a
whole body, a full one half of it. A pale one is never advised: it does not reach all that the
case asks for, or its mesh error is not known. A thin line to the left of a mark is the
calibration of its winding, which is done once and kept for all later runs of the same section.

The error has two parts:

- The **mesh error** falls with smaller elements. It is the distance of a run from the limit of
  its own family, which is the same model with ever finer meshes. The limit is extrapolated from
  several meshes in each direction, across the section and along the axis (Richardson's
  extrapolation; Roache 1994, doi 10.1115/1.2910291). No mesh error is taken as less than what the
  limit itself is unsure of.
- The **modelling error** stays whatever the mesh. It is the distance between the limit of the
  family and the limit of the finest family, which is the body with every turn of the winding. A
  section leaves out the caps, and unless its winding is calibrated what rubber does between the
  turns. No mesh can show it.

The two are added without their signs. A run in which they cancel is right by luck, and the next
radius has other luck. Of several answers, such as the pressures at several angles, the worst one
counts. The limit of the finest family is itself not known exactly: below the dashed line, in the
grey band, runs cannot be told apart. The advice adds what is not known of it to every error.

What is compared is what the case asks for. Of a pressure it is what the actuator may do by its
symmetry: bend, twist, bend to the side; where it can do none of these, how far it lengthens; where
an effect holds a motion, the force or moment on what holds it; of zones what each zone does. Angles
of one state are judged together, in percent of the greatest: of what bends by 90° and twists by 1°,
half a degree more of twist is 0.6 %. Zones, strips and loads at the tip have the rungs of models
that know them, and the ladder says by name what the others refuse. A motion in time has none: a rod
alone moves, and nothing is there to compare it with.

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

At its end stand the advice and the commands that solve its rungs. The folder
`runs/accuracy_free_bending` has the picture `accuracy.png`, the table as `accuracy.csv` and
`accuracy.md`, and a file of every rung in `rungs/`. A rung is solved again when case, program or
machine have changed; the command says so. `--only section --only cell` solves a part of the
ladder; what was solved before counts too. What a model does not support, what failed and what was
left out is named in `accuracy.md` with its reason. A rung that failed counts nowhere; `--retry`
solves it again.
"""


@dataclasses.dataclass(frozen=True)
class Shown:
    """A ladder on the page.

    Attributes:
        name: of its case file.
        heading: of its part.
        text: what it shows.
        changes: to the case, as the command takes them.
    """

    name: str
    heading: str
    text: str
    changes: str = ""


LADDERS = (
    Shown("free_bending", "Free bending", "The baseline actuator bends freely."),
    Shown(
        "blocked_tip",
        "Blocked tip",
        "The same actuator lies between a roof and a post, which keep it straight and feel the "
        "force of its tip. Only a body has the ends that this needs. Up to 100 kPa: beyond that "
        "the sheath wrinkles under the post where a mesh resolves it, and the run ends there. With "
        "two elements through each thickness and every turn it does so at 76 kPa: that mesh, which "
        "would take longer than two minutes, is left out.",
        " --set 'effects.0.pressure.to=100 kPa' "
        "--set 'output.at_pressures=[25 kPa, 50 kPa, 75 kPa, 100 kPa]' --within 2min",
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
    command = f"fiberbend accuracy cases/{shown.name}.yaml{shown.changes}"
    yield f"{shown.text} Made by `{command}` on {machine(folder)}."
    yield ""
    yield f"![Error against time of every model and mesh](images/{picture})"
    yield ""
    # the commands of the advice take as long as the table says
    text = text.replace("```console", "<!-- slow -->\n```console")
    yield from re.sub(r"\A# .*\n\n", "", text).rstrip().splitlines()
    yield ""


def in_short() -> str:
    """The advice of every ladder."""
    lines = []
    for shown in LADDERS:
        path = RUNS / f"accuracy_{shown.name}" / LADDER
        advice = json.loads(path.read_text(encoding="utf-8"))["advice"]
        lines.append(f"- **{shown.heading}.** {advice}")
    return "\n".join(lines)


def machine(folder: Path) -> str:
    """Where the rungs of the table were solved, and with which commit."""
    names = json.loads((folder / LADDER).read_text(encoding="utf-8"))["rungs"]
    # files of another commit, of rungs that are not solved again, may lie beside them
    files = [folder / RUNGS / f"{name}.json" for name in names]
    records = [json.loads(path.read_text(encoding="utf-8")) for path in files]
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
        f"line, with elements of {found['axial']}, under {found['pressure']}. Each scene is solved "
        f"with the effect and without it, {found['rounds']} times in turns, and the least "
        "processor time of the load steps counts. Every turn of the winding by itself adds no "
        "unknowns to a mesh, but it needs elements no longer than half the pitch."
    )
    yield ""
    place = f"{found['machine']['processor']}, {found['machine']['usable_cores']} cores"
    yield f"Made by `{found['command']}` on {place}, commit {found['commit'][:12]}."
    yield ""
    yield from prices.table(found)
    yield ""


def main() -> None:
    """Write the page."""
    lines = [HEAD.format(short=in_short())]
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

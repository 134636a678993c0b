"""Windings by families: the middle of the whole body beside cell and section.

Writes docs/evidence/families.md; every number in it comes from here.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bench.tables import table
from fiberbend import columns as col
from fiberbend import run
from fiberbend.models.result import RunResult

PAGE = Path(__file__).resolve().parent.parent / "docs" / "evidence" / "families.md"
DIAMETER = 0.1778
RIGHT, LEFT = "right", "left"
SMEARED = ("section", "smeared")
CELL = ("cell", "discrete")
BODY = ("body", "discrete")
CALIBRATED = ("section", "calibrated")
BETWEEN = 0.6
"""Part of the pressure between those at which a calibration looks at the cell."""
Kind = tuple[str, str]


@dataclasses.dataclass(frozen=True)
class Example:
    """An actuator and the families around it.

    Attributes:
        title: what it is.
        shape: entry `actuator` of a case.
        materials: of wall and floor.
        pressure: kPa.
        families: without starts' number: helices by angle or pitch, hand and starts.
        axial: length of the elements, mm; whole layers in a period and in the chamber.
        threads: along the axis, at places of their own.
    """

    title: str
    shape: dict[str, str]
    materials: dict[str, str]
    pressure: float
    families: tuple[dict[str, Any], ...]
    axial: float
    threads: tuple[dict[str, Any], ...] = ()

    def case(self, kind: Kind, finer: int = 1, mirrored: bool = False, layers: int = 1) -> Any:
        """A case of it.

        Args:
            kind: model, and how the winding is represented.
            finer: so many times the starts, each thread so many times softer, elements as much
                smaller.
            mirrored: its image across x = 0.
            layers: so many times as many elements along the axis.
        """
        fiber = {"modulus": f"{31067 / finer!r} MPa", "diameter": f"{DIAMETER} mm"}
        laid = [
            family | {"starts": family["starts"] * finer, "fiber": fiber}
            for family in self.families
        ]
        laid += self.threads
        if mirrored:
            laid = [_mirrored(family) for family in laid]
        model, how = kind
        mesh: dict[str, Any] = {"section": 2 if kind == CALIBRATED else finer}
        if model != "section":
            mesh["axial"] = f"{self.axial / finer / layers!r} mm"
        return {
            "title": self.title,
            "actuator": self.shape,
            "materials": self.materials,
            "effects": [
                {"pressure": {"to": f"{self.pressure!r} kPa"}},
                {"winding": {"families": laid, "as": how}},
            ],
            "model": model,
            "mesh": mesh,
            "output": {
                "fields": False,
                "pictures": False,
                "at_pressures": [f"{BETWEEN * self.pressure!r} kPa"],
            },
            "solver": {"tolerance": 1e-10},
        }

    def solved(self, kind: Kind, **how: Any) -> RunResult:
        """Run to its pressure; what is asked is that of `case`.

        Raises:
            RuntimeError: it did not get there.
        """
        result = run(self.case(kind, **how))
        print(self.title, kind, how, result.status, result.run["wall_s"]["solve"], flush=True)
        if result.status != "converged":
            raise RuntimeError(f"{self.title}, {kind}: {result.reason}")
        return result


def _mirrored(family: dict[str, Any]) -> dict[str, Any]:
    """A family's image across x = 0: the other hand, places on the other side."""
    image = dict(family)
    if "hand" in family:
        image["hand"] = LEFT if family["hand"] == RIGHT else RIGHT
    if "at" in family:
        image["at"] = [f"{360 - float(place.split()[0])!r} deg" for place in family["at"]]
    return image


def _tube(length: float) -> dict[str, str]:
    size = {"radius": "5 mm", "wall": "1.5 mm", "length": f"{length!r} mm"}
    return {"section": "circle", **size}


def _helix(starts: int, hand: str, **run_of: str) -> dict[str, Any]:
    return {"starts": starts, "hand": hand, **run_of}


EXAMPLES = {
    # lengths are whole numbers of periods
    "twist": Example(
        "Tube, 6 right starts at 30°",
        _tube(94.318),
        {"wall": "dragon-skin-30"},
        30.0,
        (_helix(6, RIGHT, angle_from_axis="30 deg"),),
        1.965,
    ),
    "braid": Example(
        "Tube, braid of 6 and 6 starts at ±40°",
        _tube(97.344),
        {"wall": "dragon-skin-30"},
        30.0,
        tuple(_helix(6, hand, angle_from_axis="40 deg") for hand in (RIGHT, LEFT)),
        2.028,
    ),
    "unequal": Example(
        "Hemicircle, right pitch 12 mm and 4 starts, left pitch 36 mm and 6 starts",
        {"section": "hemicircle", "radius": "5 mm", "wall": "1.5 mm", "floor": "1.5 mm"}
        | {"length": "72 mm"},
        {"wall": "dragon-skin-30", "floor": "combined-base"},
        40.0,
        (_helix(4, RIGHT, pitch="12 mm"), _helix(6, LEFT, pitch="36 mm")),
        1.0,
    ),
    "aside": Example(
        "Tube, braid of 6 and 6 starts at ±60°, three soft threads along its right side",
        _tube(70.735),
        {"wall": "dragon-skin-30"},
        20.0,
        tuple(_helix(6, hand, angle_from_axis="60 deg") for hand in (RIGHT, LEFT)),
        0.98243,
        (
            {
                "angle_from_axis": "0 deg",
                "at": ["60 deg", "75 deg", "90 deg"],
                "fiber": {"modulus": "30 MPa", "diameter": "0.4 mm"},
            },
        ),
    ),
}
MORE = {
    "one": Example(
        "Tube, 8 right starts at 55°",
        _tube(60.0),
        {"wall": "dragon-skin-30"},
        30.0,
        (_helix(8, RIGHT, angle_from_axis="55 deg"),),
        0.9,
    ),
    "two": Example(
        "Tube, right pitch 24 mm and left pitch 72 mm, 6 starts each",
        _tube(72.0),
        {"wall": "dragon-skin-30"},
        30.0,
        (_helix(6, RIGHT, pitch="24 mm"), _helix(6, LEFT, pitch="72 mm")),
        1.0,
    ),
    "three": Example(
        "Tube, three families: braid of pitch 24 mm, 6 and 6 starts, and right pitch 80 mm, 10",
        _tube(80.0),
        {"wall": "dragon-skin-30"},
        30.0,
        (
            *(_helix(6, hand, pitch="24 mm") for hand in (RIGHT, LEFT)),
            _helix(10, RIGHT, pitch="80 mm"),
        ),
        1.0,
    ),
    "hand": Example(
        "Hemicircle, right pitch 12 mm and 4 starts alone",
        EXAMPLES["unequal"].shape,
        EXAMPLES["unequal"].materials,
        40.0,
        (_helix(4, RIGHT, pitch="12 mm"),),
        1.0,
    ),
}
"""Windings beside which only sections and cells are solved."""
MIDDLE = {
    "angle": (col.ANGLE, col.UNIFORM_ANGLE),
    "side angle": (col.SIDE_ANGLE, col.UNIFORM_SIDE),
    "twist": (col.TWIST, col.UNIFORM_TWIST),
    "stretch": (col.AXIS_STRETCH, col.UNIFORM_STRETCH),
}
"""Columns of a uniform bend, and of the middle half of a body."""
_NOTHING = 1e-3
"""Degrees that count as none."""


def state(result: RunResult, part: float = 1.0) -> dict[str, float]:
    """Angle, side angle, twist in degrees and stretch of what bends uniformly, or of the middle.

    What a model leaves out by its symmetry is zero.

    Args:
        result: of a run to its pressure.
        part: of this pressure.
    """
    asked = part * result.rows[-1][col.PRESSURE]
    row = min(result.rows, key=lambda each: abs(each[col.PRESSURE] - asked))
    which = int(col.UNIFORM_STRETCH in row)
    return {name: float(row.get(keys[which]) or 0.0) for name, keys in MIDDLE.items()}


def off(found: dict[str, float], known: dict[str, float]) -> dict[str, float]:
    """Differences in parts of the known values; none where both are next to nothing."""
    return {
        name: 0.0 if max(abs(found[name]), abs(value)) < _NOTHING else (found[name] - value) / value
        for name, value in known.items()
    }


def _shown(name: str, value: float) -> str:
    return (
        f"{value:.5f}" if name == "stretch" else f"{value:+.3f}" if abs(value) > _NOTHING else "0"
    )


def row(what: str, result: RunResult, known: RunResult | None, part: float = 1.0) -> list[str]:
    """A line of a table: unknowns, seconds, the state, and how far it is from a known one."""
    found = state(result, part)
    apart = [""] * (len(found) + 1)
    if known is not None:
        beside = state(known, part)
        differences = off(found, beside)
        longer, expected = found["stretch"] - 1, beside["stretch"] - 1
        differences["lengthening"] = (longer - expected) / expected
        apart = [f"{100 * value:+.2f} %" if value else "0" for value in differences.values()]
    size = [str(result.run["unknowns"]), f"{result.run['wall_s']['solve']:.1f}"]
    return [what, *size, *(_shown(name, value) for name, value in found.items()), *apart]


HEAD = [
    *("", "unknowns", "s", "angle, °", "side, °", "twist, °", "λ"),
    *("angle off", "side off", "twist off", "λ off", "λ − 1 off"),
]


def models(example: Example) -> list[list[str]]:
    """Section, cell and body of one example; differences are from the cell."""
    section, cell, body = (example.solved(kind) for kind in (SMEARED, CELL, BODY))
    return [
        row("section, smeared", section, cell),
        row("cell, discrete", cell, None),
        row("body, discrete, its middle half", body, cell),
    ]


def halved(example: Example, finest: int = 4) -> list[list[str]]:
    """The cell with threads closer and closer, beside the section of the same mesh."""
    rows = []
    for finer in (2**power for power in range(finest.bit_length())):
        section = example.solved(SMEARED, finer=finer)
        cell = example.solved(CELL, finer=finer, layers=2)
        rows.append(row(f"section, {finer} × the starts", section, None))
        rows.append(row(f"cell, {finer} × the starts", cell, section))
    return rows


def calibrated(example: Example) -> list[list[str]]:
    """The section calibrated by its own cell, beside that cell, at the end and on the way."""
    section, cell = example.solved(CALIBRATED), example.solved(CELL, layers=2)
    numbers = section.run["calibration"]
    given = ", ".join(
        f"{numbers[key]:.3g}" for key in ("normal_MPa", "along_MPa", "across", "pressure")
    )
    name = f"section, calibrated ({given}; {numbers['left_percent']:.2f} % left)"
    return [
        line
        for part in (BETWEEN, 1.0)
        for line in (
            row(f"{name}, {part:.0%} of the pressure", section, cell, part),
            row("cell, discrete", cell, None, part),
        )
    ]


INTRODUCTION = """# Families of threads: body, cell and section

Three windings, and a fourth with threads along one side so that there is a side angle: each as a
section with its threads spread, as a cell and as a whole body with every thread by itself.
`python -m bench.families` makes the page. tests/bench/test_families.py holds its sections and cells
to what the program says now, and solves bodies again by `pytest -m hard`. Chamber radius 5 mm, wall
1.5 mm of dragon-skin-30, on the hemicircle a floor of 1.5 mm of combined-base; threads of 31 GPa,
0.18 mm thick.

Of a body the middle half counts: the columns `uniform_angle_deg`, `uniform_side_angle_deg`,
`uniform_twist_deg` and `uniform_stretch`. Angles are those of the whole length, λ is the stretch of
the centre-line; s is the time of the solution on one core beside other work, an order of
magnitude.

Away from its ends the body is its cell: angle, side angle, twist and stretch differ by 1.1 % at
most, and by 0.3 % but for a bend of 1.5°. The section is not: rubber bulges between threads 3 to
7 mm apart, of which it knows nothing. That takes 1 % of the twist of a tube and 6 % of a braid's
contraction, and on the hemicircle, where two families all but balance, the section has a fifth less
twist. With closer threads the cell comes to the section; the bend of the hemicircle
stays within 0.9 % there and does not settle on these meshes. Calibrated by its own cell, `as:
calibrated`, the section is within 0.7 % of that cell in all of them but the fourth (last part).
"""


CALIBRATIONS = """## Sections calibrated by their own cell

`as: calibrated`: threads sink into the rubber under them and slip along it
([theory](../theory.md)). In brackets k0 and k_s in MPa, a, c, and what the fit leaves. Of two
pressures the first lies between those at which the calibration looks at the cell. The cell has a
layer of elements through the wall and at least six along the distance of two threads. With two
and eight it has 0.2 % less twist with six starts at 30°, 1.5 % less contraction of the braid and
2 % less twist of the hemicircle with unequal families: a section is no better than its cell.

Not caught: three families lock each other, so that all motion is what rubber yields, twenty times
as much as of the smeared section; and threads along the axis that ride on the bulges between
others, which lengthens them the more the higher the pressure. The run says how much is left.
"""


def calibrations() -> str:
    """The part of the page on sections that are calibrated."""
    text = [CALIBRATIONS]
    for example in (*EXAMPLES.values(), *MORE.values()):
        text += [f"### {example.title}: calibrated", "", *table(HEAD, calibrated(example))]
    return "\n".join(text).rstrip() + "\n"


def page() -> str:
    """The page as it should be."""
    text = [INTRODUCTION]
    for example in EXAMPLES.values():
        length, pressure = example.shape["length"], f"{example.pressure:g} kPa"
        text += [
            f"## {example.title}",
            "",
            f"{length} long, at {pressure}. Off: from the cell.",
            "",
        ]
        text += table(HEAD, models(example))
    text += [
        "## Threads closer and closer",
        "",
        "With twice and four times the starts, each thread so much softer, the cell comes to the "
        "section: what rubber bulges between them goes. Elements are as much smaller, and half as "
        "long as above, for the twist of the hemicircle feels their length. Off: from the section "
        "of the same mesh.",
        "",
    ]
    for name in ("twist", "braid", "unequal"):
        text += [f"### {EXAMPLES[name].title}", "", *table(HEAD, halved(EXAMPLES[name]))]
    return "\n".join(text).rstrip() + "\n\n" + calibrations()


def main(arguments: Sequence[str]) -> None:
    """Write the page."""
    if arguments:
        raise SystemExit("bench.families takes no arguments")
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])

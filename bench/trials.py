"""What trials cost: CPU of solves on a scene that is kept, of derivatives, of calibrations.

Writes docs/evidence/trials.md, part by part; names on the command line (solves, slopes,
calibrations) renew only these parts. About two minutes without the last. Times are CPU seconds of
one core, the least of several: another program on the machine does not count.
"""

from __future__ import annotations

import itertools
import math
import re
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from fiberbend.calibration.calibrate import calibrate, with_bulging
from fiberbend.case.case import Case
from fiberbend.reader.reader import read_case
from fiberbend.trial.fields import number, with_number
from fiberbend.trial.loads import bent, straight
from fiberbend.trial.solve import Trials
from fiberbend.trial.wanted import Wanted
from materials.bedding import Bedding
from materials.bulging import Bulging

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "evidence" / "trials.md"
REPEATS = 5
PITCH = "effects.1.winding.pitch"
WANTED = Wanted(tuple(math.radians(angle) for angle in (90, 180, 270)))
FIELDS = ("actuator.wall", "actuator.radius", "actuator.floor", "materials.wall.c1", PITCH)
NEAR, STEP = 0.1, 1e-3
"""Parts by which a number is changed from case to case, and for a difference."""
CHANGES = (
    ("actuator.wall", 1.1),
    ("actuator.wall", 0.9),
    ("actuator.wall", 1.3),
    ("actuator.radius", 1.1),
    ("actuator.radius", 0.9),
    ("actuator.radius", 1.3),
    ("actuator.floor", 1.2),
    ("actuator.sheath", 1.2),
    (PITCH, 1.1),
    (PITCH, 1.3),
    ("materials.wall.c1", 1.2),
    ("materials.wall.c2", 1.5),
    ("effects.1.winding.fiber.modulus", 0.5),
)
ANGLES, AT = tuple(math.radians(angle) for angle in (90, 180, 360)), (0.1,)
"""States by which calibrations are compared: bent, rad, and kept straight, MPa."""
FEW = ((PITCH, 1.1), ("actuator.floor", 1.2), ("actuator.radius", 0.9))
BASES: dict[str, tuple[dict[str, float], tuple[tuple[str, float], ...]]] = {
    "baseline": ({}, CHANGES),
    "pitch 5 mm": ({PITCH: 5.0}, CHANGES),
    "pitch 5, wall 3 mm": ({PITCH: 5.0, "actuator.wall": 3.0}, FEW),
    "radius 5 mm": ({"actuator.radius": 5.0}, FEW),
    "radius 12 mm": ({"actuator.radius": 12.0}, FEW),
}
"""Cases by their numbers, and what is changed of each."""
HEAD = """# What trials cost

Written by `.venv/bin/python bench/trials.py`. cases/section.yaml (882 unknowns: most of a first
solve looks for kernels) and cases/cell.yaml, bent to 90, 180 and 270° in one process, as
`fiberbend.trial` does; CPU seconds of one core.
"""


def baseline(model: str) -> Case:
    """A case of the house."""
    return read_case(ROOT / "cases" / f"{model}.yaml")


def changed(case: Case, path: str, factor: float) -> Case:
    """The case with a number times a factor."""
    return with_number(case, path, factor * number(case, path))


def seconds(action: Callable[[int], object]) -> float:
    """Least CPU time of an action, which takes the number of its repeat."""
    found = []
    for repeat in range(REPEATS):
        begin = time.process_time()
        action(repeat)
        found.append(time.process_time() - begin)
    return min(found)


def solves() -> Iterator[str]:
    """On a scene of its own, and on one that is kept."""
    yield "| case | its first | another wall | another c1 | the same again |"
    yield "|---|---|---|---|---|"
    yield from map(_solves, ("section", "cell"))


def _solves(model: str) -> str:
    case, trials = baseline(model), Trials()
    trials.solve(case, WANTED)
    first = seconds(lambda _: Trials().solve(case, WANTED))
    others = [_others(trials, case, path) for path in ("actuator.wall", "materials.wall.c1")]
    trials.solve(case, WANTED)
    same = seconds(lambda _: trials.solve(case, WANTED))
    return f"| {model} | {' | '.join(f'{t:.3f}' for t in (first, *others, same))} |"


def _others(trials: Trials, case: Case, path: str) -> float:
    """Cases of 10 % more and less in turn."""
    cases = [changed(case, path, 1 + NEAR * (-1) ** n) for n in range(REPEATS)]
    return seconds(lambda n: trials.solve(cases[n], WANTED))


def slopes() -> Iterator[str]:
    """Derivatives by tangents, and by differences of solves that begin at their neighbours."""
    yield "| case | by the tangent | by differences of whole solves | ratio |"
    yield "|---|---|---|---|"
    yield from map(_slopes, ("section", "cell"))


def _slopes(model: str) -> str:
    case, trials = baseline(model), Trials()

    def differences(_: int) -> None:
        for path, step in itertools.product(FIELDS, (1 + STEP, 1 - STEP)):
            trials.solve(changed(case, path, step), WANTED)

    trials.solve(case, WANTED)
    alone = seconds(lambda _: trials.solve(case, WANTED))
    whole = seconds(lambda _: trials.sensitivities(case, WANTED, FIELDS))
    by_tangent = (whole - alone) / len(FIELDS)
    by_solves = seconds(differences) / len(FIELDS)
    return f"| {model} | {by_tangent:.3f} | {by_solves:.3f} | {by_tangent / by_solves:.2f} |"


def calibrations() -> Iterator[str]:
    """What the calibration of a case leaves on cases near it, beside their own."""
    yield "The last column: the greatest of the four at a factor e, over all that the bulge makes."
    yield ""
    yield "| case | changed | factor | P at 90° | 180° | 360° | moment, 100 kPa | over the bulge |"
    yield "|---|---|---|---|---|---|---|---|"
    trials = Trials()
    for name, (numbers, changes) in BASES.items():
        smeared = baseline("section")
        for path, value in numbers.items():
            smeared = with_number(smeared, path, value)
        winding = smeared.effects[1].model_copy(update={"representation": "calibrated"})
        case = smeared.model_copy(update={"effects": (smeared.effects[0], winding)})
        # a case is calibrated for the kind of state that it asks for
        taken = [calibrate(one).found.bulging() for one in (bent(case, ANGLES), straight(case, AT))]
        bulge = _greatest(_off(_told(trials, case, []), _told(trials, smeared, [])))
        for path, factor in changes:
            other = changed(case, path, factor)
            parts = _off(_told(trials, other, []), _told(trials, other, taken))
            rate = _greatest(parts) / abs(math.log(factor)) / bulge
            told = " | ".join(f"{part:+.2f}" for part in parts)
            yield f"| {name} | {path} | {factor:g} | {told} | {rate:.1f} |"


def _told(trials: Trials, case: Case, taken: Sequence[Bulging | Bedding]) -> list[float]:
    """Pressures and the moment, by a case's own calibrations, or by those of another one."""
    free, kept = (with_bulging(case, b) for b in taken) if taken else (case, case)
    pressures = [point.pressure for point in trials.solve(free, Wanted(ANGLES)).free]
    return [*pressures, trials.solve(kept, Wanted(straight=AT)).straight[0].moment]


def _off(right: Sequence[float], other: Sequence[float]) -> list[float]:
    return [100 * (b / a - 1) for a, b in zip(right, other, strict=True)]


def _greatest(parts: Sequence[float]) -> float:
    return max(map(abs, parts))


PARTS: dict[str, tuple[str, Callable[[], Iterator[str]]]] = {
    "solves": ("A solve", solves),
    "slopes": ("Derivatives, a number of the case", slopes),
    "calibrations": ("Calibrations taken over, % off", calibrations),
}


def main(names: list[str]) -> None:
    """Renew the parts that are named, or all."""
    kept = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    text = HEAD
    for name, (title, make) in PARTS.items():
        old = re.search(rf"\n## {title}\n\n(.*?)\n*(?=\n## |\Z)", kept, re.DOTALL)
        again = name in names or not names or old is None
        body = "\n".join(make()) if again or old is None else old[1]
        text += f"\n## {title}\n\n{body}\n"
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])

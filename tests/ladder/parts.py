"""Rungs and records that nobody has solved, with values made up."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping
from pathlib import Path

from fiberbend.ladder.asked import Asked, asked
from fiberbend.ladder.errors import Judgement, Solved, judge
from fiberbend.ladder.record import Record, key_of
from fiberbend.ladder.rungs import Ladder, Rung, ladder
from tests.conftest import ROOT

CASE = ROOT / "cases" / "free_bending.yaml"
Values = Callable[[Rung, Asked], float]


whole = functools.cache(ladder)
"""The ladder of a case, made once."""


@functools.cache
def of_case(path: Path = CASE) -> Ladder:
    """The ladder of a case, calibrated windings left out: two kinds of windings are enough here."""
    found = whole(path)
    rungs = tuple(rung for rung in found.rungs if rung.family.winding != "calibrated")
    return dataclasses.replace(found, rungs=rungs)


def record(rung: Rung, values: Mapping[str, float], wall_s: float | None = None) -> Record:
    """What a rung might have given."""
    wall = rung.seconds if wall_s is None else wall_s
    return Record(
        name=rung.name,
        family=dataclasses.asdict(rung.family),
        mesh={name: float(size) for name, size in rung.mesh.items()},
        unknowns=rung.unknowns,
        values=dict(values),
        status="converged",
        reason="",
        wall_s=wall,
        cpu_s=wall,
        once_s=0.0,
        solve_wall_s=wall / 2,
        solve_cpu_s=wall / 2,
        load_steps=10,
        iterations=40,
        peak_memory_MB=rung.memory_mb,
        key=key_of(rung),
        provenance={},
    )


def truth(rung: Rung, each: Asked) -> float:
    """Values whose limits are known: 100 with turns, 97 without, 130 closed.

    The section adds 2 h², the length of the elements h/10 in mm.
    """
    limit = {"turns": 100.0, "spread": 97.0}[rung.family.winding]
    if rung.family.model == "analytic":
        return 130.0
    if rung.family.model == "body":
        limit *= 0.99
    return limit + 2 * rung.mesh.get("section", 0.0) ** 2 + 0.1 * rung.mesh.get("axial", 0.0)


def solved(values: Values = truth, path: Path = CASE) -> list[Solved]:
    """Every rung of a case, solved by a formula."""
    found = []
    for rung in of_case(path).rungs:
        quantities = asked(rung.case)
        found.append((rung, record(rung, {each.name: values(rung, each) for each in quantities})))
    return found


def judged(values: Values = truth, path: Path = CASE) -> Judgement:
    """All of them, judged."""
    return judge(asked(of_case(path).rungs[0].case), solved(values, path))

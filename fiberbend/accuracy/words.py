"""An accuracy in words: for a plan, an answer and run.json."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fiberbend.accuracy.budget import ENDS, MESH, WINDING, Estimate, estimate, percent
from fiberbend.accuracy.choice import Candidate, cheaper, picked, wound
from fiberbend.accuracy.table import knowledge
from fiberbend.case.case import Case
from fiberbend.models.choice import meshed
from fiberbend.schema.units import show

PAGE = "docs/models.md"
MISSED = "cannot be promised"
MEASURED = "fiberbend accuracy measures it"


def expected_lines(case: Case) -> Iterator[str]:
    """What a plan says of the accuracy of a completed case; nothing where none is asked."""
    if case.accuracy is None:
        return
    found = estimate(case, meshed(case))
    where = "" if found.angle is None else f" at {math.degrees(found.angle):.3g}°"
    verdict = "promised" if found.meets(case.accuracy) else MISSED
    reason = "" if found.meets(case.accuracy) else f": {why_not(found, case)}"
    asked = show(case.accuracy, "accuracy")
    if not found.tells:
        yield f"{asked} asked: {verdict}{reason}"
        return
    yield f"{asked} asked, about {found.short()} expected{where}: {verdict}{reason}"
    if picked(case):
        why = "the cheapest that does" if found.meets(case.accuracy) else "the best affordable"
        yield f"{way_named(case)}: {why}"
        for rival in cheaper(case):
            yield f"{rival.named()} at its best: {rival.estimate.short()}"
    yield from _carried(found)


def _carried(found: Estimate) -> Iterator[str]:
    """How far the table carries, and where it is from."""
    if found.outside:
        yield (
            f"outside of what is known, all of it widened {found.widened:.2g} times: "
            f"{'; '.join(found.outside)}"
        )
    origin = knowledge().origin
    yield f"from {origin['command']}, see {PAGE}"


def way_named(case: Case) -> str:
    """Model, mesh and winding of a completed case."""
    model = meshed(case)
    return Candidate(case, model, 0.0, 0.0, Estimate({}, None)).named()


def ways_differ(cases: Sequence[Case]) -> str:
    """Why the points of a sweep are no one curve: they choose other models or windings."""
    found: dict[str, int] = {}
    for case in cases:
        if picked(case):
            turns = case.turns
            name = case.model if turns is None else f"{case.model}, winding {wound(turns)}"
            found[name] = found.get(name, 0) + 1
    if len(found) < 2:
        return ""
    ways = "; ".join(f"{name}: {number} points" for name, number in found.items())
    return (
        f"the points choose different models, and what they show would jump between them ({ways}), "
        "expected a model, or a winding with `as`"
    )


def why_not(found: Estimate, case: Case) -> str:
    """Why the accuracy that a case asks for cannot be promised."""
    asked = case.accuracy
    assert asked is not None
    reasons = list(found.unknown)
    if reasons and case.inflation is not None:
        reasons[-1] += f" ({MEASURED})"
    if found.tells and found.total > asked:
        remedies = {
            MESH: "shorter or more elements lower it",
            WINDING: _more_turns(case),
            ENDS: "a body has the ends",
        }
        named = {
            part: f"{part} {percent(value)} % ({remedies[part]})"
            for part, value in found.parts.items()
        }
        # each part that is too much by itself, else the greatest
        over = [named[part] for part, value in found.parts.items() if value > asked]
        if over:
            reasons.append(f"{' and '.join(over)} {'is' if len(over) == 1 else 'are'} too much")
        else:
            greatest = max(found.parts, key=lambda part: found.parts[part])
            reasons.append(f"{named[greatest]} is the most of it")
    return "; ".join(reasons)


def _more_turns(case: Case) -> str:
    """What lowers the winding's part."""
    turns, resolved = case.turns, "a cell or a body with as: discrete has the turns"
    if turns is not None and not turns.discrete and not turns.bulges:
        return f"{resolved}, around a curved section as: calibrated has their bulges"
    return resolved


def entry(case: Case, found: Estimate) -> dict[str, Any]:
    """The block `accuracy` of run.json."""
    asked = case.accuracy
    assert asked is not None
    promised = found.meets(asked)
    return {
        "asked": asked,
        "estimated": round(found.total, 3) if found.tells else None,
        "parts": {n: round(value, 3) for n, value in found.parts.items()} if found.tells else {},
        "promised": promised,
        "reason": "" if promised else why_not(found, case),
        "angle_deg": None if found.angle is None else round(math.degrees(found.angle), 3),
        "widened": round(found.widened, 3),
        "outside": list(found.outside),
        "from": dict(found.sources),
    }


def answered(run: Mapping[str, Any]) -> tuple[str, str] | None:
    """The estimated error of a run as an answer has it: value and note; None: none was asked."""
    block = run.get("accuracy")
    if not block:
        return None
    if block["estimated"] is None:
        return "not known", MEASURED
    parts = ", ".join(f"{name} {percent(value)}" for name, value in block["parts"].items())
    return f"{percent(block['estimated'])} %", parts


def verdict(run: Mapping[str, Any]) -> str:
    """For the line of trust: whether the accuracy that was asked for is met; empty: none was."""
    block = run.get("accuracy")
    if not block:
        return ""
    asked = show(block["asked"], "accuracy")
    if block["promised"]:
        return f"the {asked} asked for is met by the estimate"
    return f"the {asked} asked for {MISSED}"

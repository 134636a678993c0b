"""What the zones along the length must fulfil, by themselves and with the rest of a case."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator

from fiberbend.case.case import Case
from fiberbend.case.zones import lengths, path_of, zone_case
from fiberbend.effects.effect import Effect
from fiberbend.effects.records import mirror_breakers
from fiberbend.reader.checks import ValidParts, check
from fiberbend.schema.problems import Problem
from fiberbend.schema.units import show

_ROUND_OFF = 1e-9
"""Part of the chamber's length by which the sum of the zones may miss it."""


def zone_problems(case: Case, known: Collection[Problem]) -> Iterator[Problem]:
    """What is wrong with the zones of a case.

    Args:
        case: with zones, valid value by value.
        known: what is wrong with the rest of it.
    """
    assert case.zones is not None
    if not case.zones:
        yield Problem("zones", "no zone, expected at least one, or no value")
        return
    if case.accuracy is not None:
        text = "nothing is promised of an actuator with zones, expected no value"
        yield Problem("accuracy", f"{text}; fiberbend accuracy measures its error")
    wrong = list(_lengths(case))
    yield from wrong
    yield from _idle(case)
    for path, effect in _named(case):
        if effect.uncalibrated():
            yield Problem(
                path,
                "is to be calibrated, which zones are not: expected bulging, or as: discrete or "
                "as: smeared",
            )
    if case.mesh.symmetry == "half":
        for reason in mirror_breakers(case.acting[len(case.effects) :]):
            yield Problem("mesh.symmetry", f'"half", expected auto or full: {reason}')
    if wrong or known:
        return
    for number in range(len(case.zones)):
        for problem in check(ValidParts.of(zone_case(case, number))):
            path = path_of(case, number, problem.path)
            if path.startswith("zones."):
                yield Problem(path, problem.text)


def _lengths(case: Case) -> Iterator[Problem]:
    """Lengths that are not those of the chamber."""
    assert case.zones is not None
    open_ends = [number for number, zone in enumerate(case.zones) if zone.length is None]
    for number in open_ends[1:]:
        yield Problem(
            f"zones.{number}.length",
            f"missing, expected one zone at most without a length (zones.{open_ends[0]} has none)",
        )
    if len(open_ends) > 1:
        return
    whole = case.actuator.length
    if open_ends:
        (rest,) = (lengths(case)[number] for number in open_ends)
        if rest <= _ROUND_OFF * whole:
            given = show(whole - rest, "length")
            yield Problem(
                f"zones.{open_ends[0]}.length",
                f'nothing is left: the others take "{given}" of actuator.length, '
                f'"{show(whole, "length")}"',
            )
        return
    total = math.fsum(lengths(case))
    if abs(total - whole) > _ROUND_OFF * whole:
        yield Problem(
            "zones",
            f'"{show(total, "length")}" in all, expected actuator.length, '
            f'"{show(whole, "length")}"; one zone may leave out its length',
        )


def _idle(case: Case) -> Iterator[Problem]:
    """Settings that change nothing."""
    assert case.zones is not None
    if not any(zone.effects or zone.materials for zone in case.zones):
        names = [name for name in type(case.zones[0]).model_fields if name != "length"]
        yield Problem("zones", f"no effect without {' or '.join(names)} in one of them")
    everywhere = {effect.name for effect in case.effects}
    for number, zone in enumerate(case.zones):
        for name, effects in zone.effects.items():
            if not effects and name not in everywhere:
                text = f'"none", no effect where the case has no {name}, expected no value'
                yield Problem(f"zones.{number}.{name}", text)
    for index, effect in enumerate(case.effects):
        if all(effect.name in zone.effects for zone in case.zones):
            text = "no effect where every zone has its own, expected no value"
            yield Problem(f"effects.{index}.{effect.name}", text)


def _named(case: Case) -> Iterator[tuple[str, Effect]]:
    yield from ((f"effects.{n}.{effect.name}", effect) for n, effect in enumerate(case.effects))
    for number, zone in enumerate(case.zones or ()):
        for name, effects in zone.effects.items():
            yield from ((f"zones.{number}.{name}", effect) for effect in effects)

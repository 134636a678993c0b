"""Zones along the length: what a case has in each, as a case of that zone alone."""

from __future__ import annotations

import itertools
import math
from typing import Any

from fiberbend.case.case import Case
from fiberbend.effects.effect import Effect

_STEPS = 16
"""Even steps of the pressure at which zones are chained, at least."""
_CLOSE = 1e-6
"""Part of the whole pressure up to which an even step and one that is asked for are one."""


def lengths(case: Case) -> tuple[float, ...]:
    """Length of every zone in mm; without zones that of the chamber.

    A zone without a length is what the others leave, whatever that is.
    """
    if not case.zones:
        return (case.actuator.length,)
    given = [zone.length for zone in case.zones]
    rest = case.actuator.length - sum(length for length in given if length is not None)
    return tuple(rest if length is None else length for length in given)


def bounds(case: Case) -> tuple[float, ...]:
    """z of the ends of all zones, from 0 to the length of the chamber, mm."""
    inner = itertools.accumulate(lengths(case)[:-1])
    return (0.0, *inner, case.actuator.length)


def borders(case: Case) -> tuple[float, ...]:
    """z of the planes between zones, mm; none without zones."""
    return bounds(case)[1:-1]


def differing(case: Case) -> set[str]:
    """Names of the effects of which some zone has its own; all others act all along."""
    return {name for zone in case.zones or () for name in zone.effects}


def effects_of(case: Case, number: int) -> dict[str, Effect]:
    """Effects that act on a zone, by their paths in the case, in the order of the case.

    Args:
        case: with zones.
        number: of the zone, from 0.
    """
    assert case.zones is not None
    own, found = case.zones[number].effects, dict[str, Effect]()
    for index, effect in enumerate(case.effects):
        if effect.name not in own:
            found[f"effects.{index}.{effect.name}"] = effect
    for name, mine in own.items():
        for index, effect in enumerate(mine):
            place = f".{index}" if effect.several else ""
            found[f"zones.{number}.{name}{place}"] = effect
    return found


def zone_case(case: Case, number: int, model: str | None = None) -> Case:
    """The uniform case of one zone: its length, its effects and its materials.

    Args:
        case: with zones.
        number: of the zone, from 0.
        model: that solves it; the case's by default.
    """
    assert case.zones is not None
    zone = case.zones[number]
    update: dict[str, Any] = {
        "actuator": case.actuator.model_copy(update={"length": lengths(case)[number]}),
        "materials": case.materials.model_copy(update=dict(zone.materials)),
        "effects": tuple(effects_of(case, number).values()),
        "zones": None,
    }
    if model is not None:
        update["model"] = model
    return case.model_copy(update=update)


def zone_cases(case: Case, model: str | None = None) -> tuple[Case, ...]:
    """The uniform case of every zone from root to tip; without zones the case itself."""
    if not case.zones:
        return (case,)
    return tuple(zone_case(case, number, model) for number in range(len(case.zones)))


def path_of(case: Case, number: int, path: str) -> str:
    """The path in the case of a path in the case of a zone.

    Args:
        case: with zones.
        number: of the zone, from 0.
        path: within its `zone_case`.
    """
    assert case.zones is not None
    head, _, rest = path.partition(".")
    index, _, tail = rest.partition(".")
    if head == "effects" and index.isdecimal():
        known = list(effects_of(case, number))[int(index)]
        _, _, setting = tail.partition(".")
        return f"{known}.{setting}" if setting else known
    if head == "materials" and index in case.zones[number].materials:
        return f"zones.{number}.{rest}"
    return f"zones.{number}" if head == "actuator" else path


def region_name(part: str, number: int) -> str:
    """The region of a mesh that is a part of the actuator in one zone, "floor_2" in the second.

    Args:
        part: of the actuator.
        number: of the zone, from 0.
    """
    return f"{part}_{number + 1}"


def own_regions(case: Case) -> list[dict[str, str]]:
    """By zone, the regions that replace those of parts with a material of their own."""
    return [
        {part: region_name(part, number) for part in zone.materials}
        for number, zone in enumerate(case.zones or ())
    ]


def shared_pressures(case: Case) -> list[float]:
    """Pressures at which all zones are chained, MPa: even ones and those asked for, the end last.

    Args:
        case: its pressure is given by its value.
    """
    load, output, solver = case.inflation, case.output, case.solver
    assert load is not None
    assert load.to is not None
    number = _STEPS
    if solver.max_step is not None:
        number = max(number, math.ceil(abs(load.to) / solver.max_step - _CLOSE))
    asked = [*output.at_pressures, load.to]
    even = [load.to * k / number for k in range(1, number)]
    close = _CLOSE * abs(load.to)
    kept = [p for p in even if all(abs(p - goal) > close for goal in asked)]
    return sorted({*kept, *asked}, key=abs)


def words(case: Case) -> list[str]:
    """Every zone in words: its length, and what it has in place of the case's."""
    found = []
    resolved = case.resolved().get("zones", [])
    for zone, length in zip(resolved, lengths(case), strict=False):
        own = [f"{name} {_said(value)}" for name, value in zone.items() if name != "length"]
        found.append(f"{length:g} mm: {'; '.join(own) or 'as the case says'}")
    return found


def _said(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{key} {_said(part)}" for key, part in value.items() if part is not False)
    if isinstance(value, list):
        return " and ".join(_said(part) for part in value)
    return str(value)

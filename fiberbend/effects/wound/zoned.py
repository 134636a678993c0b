"""Windings that differ from zone to zone along the length, on the mesh of one body."""

from __future__ import annotations

from collections.abc import Sequence

from fiberbend.effects.records import Built, Requests, Stretch
from fiberbend.schema.quantities import Spec


def unlike(one: Spec, other: Spec) -> str:
    """Why one mesh cannot have a winding in one zone and another one in the next; or nothing."""
    for key in ("representation", "tension_only", "lines"):
        name = type(one).model_fields[key].alias or key
        mine, its = getattr(one, key), getattr(other, key)
        if "calibrated" in (mine, its):
            return "a calibrated winding bulges alike all along, expected discrete or smeared"
        if mine != its:
            return f"{name}: {mine} here and {its} in another zone, expected one for all zones"
    return ""


def build(zones: Sequence[Stretch], requests: Requests, tension_only: bool) -> Built:
    """Of every kind of term one, its pieces of thread with the stiffness of their zone.

    Args:
        zones: those that are wound, from root to tip; none calibrated.
        requests: of the case.
        tension_only: of all of them.
    """
    from fem.effects.winding import SmearedWinding, Winding
    from geometry.bodies.zones import joined

    parts = [(zone.start, zone.effect.build(zone.site, zone.mesh, requests)) for zone in zones]
    terms: list[SmearedWinding | Winding] = []
    for kind in (SmearedWinding, Winding):
        pieces = [
            (term.segments, start, term.stiffness)
            for start, part in parts
            for term in part.terms
            if isinstance(term, kind)
        ]
        if pieces:
            terms.append(kind(*joined(pieces), tension_only))
    return Built(tuple(terms), (), terms[0].segments, parts[0][1].smeared)

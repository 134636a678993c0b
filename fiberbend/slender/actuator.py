"""A case as a rod: pieces, laws, masses, and what acts on it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.zones import lengths, zone_cases
from fiberbend.effects.records import RodRamp, RodSite
from fiberbend.models.rod import MODEL
from fiberbend.slender.laws import (
    SectionLaw,
    along,
    cap_law,
    masses,
    pieces_of,
    section_law,
    strains_of,
    without_shear,
)
from fiberbend.slender.moments import section_of
from rod.contact.touch import Touch
from rod.functions import Floats
from rod.inertia import spread
from rod.layout import Layout
from rod.rod import Level, Rod
from rod.shape import Shape

PIECES, CAP_PIECES = MODEL.pieces, MODEL.cap_pieces
"""Of the chamber and of each cap. Under its weight the baseline's angle and tip are those of twice
as many to 1e-4."""


@dataclasses.dataclass(frozen=True)
class Slender:
    """An actuator as a rod.

    Attributes:
        rod: with all terms.
        site: as its effects see it.
        loads: the load whose value is the amount of each term; without a name it acts whole.
        ramps: loads in the order of the case.
        section: the law of the section between the caps.
        zones: pieces of each zone between the caps.
        obstacles: what it may touch, by names.
    """

    rod: Rod
    site: RodSite
    loads: tuple[str, ...]
    ramps: tuple[RodRamp, ...]
    section: SectionLaw
    zones: tuple[int, ...] = (PIECES,)
    obstacles: tuple[tuple[str, Touch], ...] = ()

    @property
    def chamber(self) -> slice:
        """The pieces between the caps."""
        return slice(CAP_PIECES, CAP_PIECES + sum(self.zones))

    def level(self, values: Mapping[str, float]) -> Level:
        """What acts at given values of the loads."""
        amounts = tuple(values.get(name, 0.0) if name else 1.0 for name in self.loads)
        return Level(values.get("pressure", 0.0), amounts)

    def weights(self, strain: str = "curvature") -> Floats:
        """w with Σ w ε the turn of the line from z = 0 to L, (n, m): see `rod.layout`."""
        out = np.zeros(self.rod.layout.shape)
        if strain in self.rod.layout.strains:
            out[self.chamber] = self.rod.layout.weights(strain)[self.chamber]
        return out

    def tip(self, shape: Shape) -> Floats:
        """The centroid of the tip cap's outer face, (3,), mm."""
        place: Floats = shape.places[-1] + shape.rotations[-1] @ np.array(self.site.tip)
        return place


def slender(
    case: Case, tell: Callable[[str], None] | None = None, touched: bool = False
) -> Slender:
    """The rod of a case of model rod.

    Args:
        case: the case.
        tell: takes lines of progress while the law of its section is made.
        touched: something acts on it that is not in the case.

    Raises:
        fiberbend.schema.problems.CaseError: its section has no law as far as the case goes.
    """
    actuator, section = convert.dimensions(case.actuator), section_of(case)
    cap, strains = actuator.cap, strains_of(case, touched)
    counts = pieces_of(case, PIECES)
    each = [cap, *lengths(case), cap] / np.array([CAP_PIECES, *counts, CAP_PIECES])
    pieces = np.repeat(each, [CAP_PIECES, *counts, CAP_PIECES])
    layout = Layout(pieces, strains, place=np.array([0.0, section.height, -cap]))
    solid = masses(case, section)[1]
    hollow = [masses(zone, section)[0] for zone in zone_cases(case)]
    between = [mass for mass, count in zip(hollow, counts, strict=True) for _ in range(count)]
    parts = [solid] * CAP_PIECES + between + [solid] * CAP_PIECES
    site = RodSite(
        actuator=actuator,
        layout=layout,
        inertia=spread(layout, parts),
        tip=(0.0, actuator.face_height - section.height, 0.0),
        weight=convert.site(case).weight,
        body=convert.site(case),
    )
    made = section_law(case, strains, counts, tell)
    chamber = slice(CAP_PIECES, CAP_PIECES + sum(counts))
    law = along(case, made, cap_law(case, section, without_shear(strains)), layout, chamber)
    found = [effect.on_rod(site) for effect in case.effects]
    terms = [term for each in found for term in each.terms]
    inertia = sum((e.inertia for e in found if e.inertia is not None), site.inertia)
    return Slender(
        rod=Rod(layout, law, inertia, [term for _, term in terms]),
        site=site,
        loads=tuple(name for name, _ in terms),
        ramps=tuple(ramp for each in found for ramp in each.ramps),
        section=made,
        zones=counts,
        obstacles=tuple(pair for each in found for pair in each.obstacles),
    )

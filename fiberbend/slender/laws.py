"""Laws and masses of the pieces of a rod: of the section between the caps, and of the caps."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.case.symmetry import sheared, wound
from fiberbend.case.zones import lengths, zone_cases
from fiberbend.slender.moments import Section, weighed
from fiberbend.slender.torsion import torsion
from materials.material import Material
from rod.functions import Floats
from rod.inertia import SectionMass
from rod.law import Law, Zones
from rod.layout import AT_REST, STRAINS, Layout
from rod.quartic import Quartic

if TYPE_CHECKING:
    from fiberbend.beam.kept import Beam
    from fiberbend.sectionlaw.made import Made
    from fiberbend.sectionlaw.path.made import PathMade

ERROR = 1e-3
"""Of the table of a section, as `fiberbend.sectionlaw.table.law_of` has it."""
ENOUGH = 1e-2
"""The same where something goes slack and finer tables hardly help."""
PLANE = ("stretch", "curvature")
SPACE = (*PLANE, "side_curvature", "twist")
_SHEARS = {PLANE: ("shear_y",), SPACE: ("shear_x", "shear_y")}
_FEW = 6
"""Pieces that a zone has at least."""
_ROUND, _RADIUS = 32, 0.1
"""Points of a circle about a stretch of one, and its radius."""


@dataclasses.dataclass(frozen=True)
class SectionLaw:
    """The law of the section between the caps.

    Attributes:
        law: by the strains of the rod.
        free: pressures, MPa, stretches and curvatures, 1/mm, of the section by itself, which
            trials of it have found, (n, 3); of zones those of the first.
        model: that solved the section.
        states: how many were solved for it.
        seconds: that took, of processor time, whenever that was.
        error: greatest of force, moment and chamber in parts of their range.
        remarks: what casts doubt on it, a line each.
        beam: section and caps with shear; None: the rod does not shear.
    """

    law: Law
    free: Floats
    model: str
    states: int
    seconds: float
    error: float
    remarks: tuple[str, ...]
    beam: Beam | None = None


def strains_of(case: Case, touched: bool = False) -> tuple[str, ...]:
    """Strains of a rod: those of a plane where its sections and all that acts leave it there.

    It shears where anything acts on it but what bends all its sections alike. One that twists by
    itself does not: its law is about free states, its shear is known about rest alone.

    Args:
        case: of model rod.
        touched: something acts on it that is not in the case.
    """
    if twists_by_itself(case):
        return SPACE
    across = any(effect.mirror_breaker() for effect in case.acting)
    own = SPACE if across else PLANE
    return (*_SHEARS[own], *own) if touched or sheared(case) else own


def twists_by_itself(case: Case) -> bool:
    """Whether a section of it twists or bends to the side: laws are about free states then."""
    return not all(wound(zone).plane for zone in zone_cases(case))


def slackens(zone: Case) -> bool:
    """Whether fabric in it may go slack, which leaves kinks: no polynomials about free states."""
    return any(effect.slackens() for effect in zone.effects)


def without_shear(strains: tuple[str, ...]) -> tuple[str, ...]:
    """Strains of which the law of a section is."""
    return tuple(name for name in strains if name in SPACE)


def pieces_of(case: Case, pieces: int) -> tuple[int, ...]:
    """How many pieces each zone has, of so many or a few more in the chamber.

    Args:
        case: the case.
        pieces: between the caps.
    """
    whole = case.actuator.length
    return tuple(max(_FEW, round(pieces * each / whole)) for each in lengths(case))


def section_law(
    case: Case,
    strains: tuple[str, ...],
    counts: tuple[int, ...] = (),
    tell: Callable[[str], None] | None = None,
) -> SectionLaw:
    """The law of the sections of a rod, from the tables that are kept or anew.

    Args:
        case: of model rod.
        strains: of the rod.
        counts: pieces of each zone.
        tell: takes lines of progress while a table is made.

    Raises:
        fiberbend.schema.problems.CaseError: a section has no law that reaches as far as the case.
    """
    from fiberbend.beam.kept import beam_of
    from fiberbend.slender.beside import section_case

    plain, zones = without_shear(strains), zone_cases(case)
    names = zone_names(len(zones))
    made, known_of_cache = _made(case, plain, names, tell)
    remarks = [
        f"{name}: {remark}" if len(made) > 1 else remark
        for name, each in zip(names, made, strict=True)
        for remark in each.remarks
    ]
    laws: list[Law] = [each.law for each in made]
    beam, free = None, np.array([(p, state.stretch, state.curvature) for p, state in made[0].free])
    if plain != strains:
        beams = [beam_of(section_case(zone), float(max(free[:, 0], key=abs))) for zone in zones]
        beam = beams[0]
        laws = [each.beside(law, strains) for each, law in zip(beams, laws, strict=True)]
    pieces = np.repeat(np.arange(len(laws)), counts or 1).tolist()
    known = [each.checked for each in made]
    return SectionLaw(
        law=laws[0] if len(laws) == 1 else Zones(laws, pieces, names),
        free=free,
        model=made[0].model,
        states=sum(each.solved for each in made),
        seconds=sum(each.seconds for each in made),
        error=max(max(each.force, each.moment, each.area) for each in known),
        remarks=tuple(dict.fromkeys(remarks + known_of_cache)),
        beam=beam,
    )


def _made(
    case: Case,
    strains: tuple[str, ...],
    names: Sequence[str],
    tell: Callable[[str], None] | None,
) -> tuple[Sequence[Made | PathMade], list[str]]:
    """The law of each zone, and what is wrong with the cache."""
    from fiberbend.sectionlaw.path.make import law_about
    from fiberbend.sectionlaw.path.store import PathStore
    from fiberbend.sectionlaw.range import loads_on
    from fiberbend.sectionlaw.store import Store
    from fiberbend.sectionlaw.table import law_of
    from fiberbend.slender.beside import section_case

    loads, tables, laws = loads_on(case), Store(), PathStore()
    twists = twists_by_itself(case)
    made: list[Made | PathMade] = []
    for zone, name in zip(zone_cases(case), names, strict=True):
        own = section_case(zone)
        if twists and not slackens(zone):
            made.append(law_about(own, ERROR, laws, tell, loads))
        else:
            more = (tables, tell, loads, ENOUGH, name)
            made.append(law_of(own, strains, ERROR, None, *more))
    return made, tables.remarks + laws.remarks


def along(case: Case, made: SectionLaw, cap: Quartic, layout: Layout, chamber: slice) -> Law:
    """The law of each piece: of chamber and caps, with the turns of their ends under pressure.

    Args:
        case: of model rod.
        made: the law of its section.
        cap: the law of its caps as beams; the clamp makes that at the root stiffer.
        layout: pieces of the rod.
        chamber: those between the caps.

    Raises:
        fiberbend.schema.problems.CaseError: the ends of a short body are not found.
    """
    from fiberbend.sectionlaw.ends import ends_of
    from fiberbend.slender.beside import section_case

    farthest, zones = float(max(made.free[:, 0], key=abs)), zone_cases(case)
    ends = ends_of(section_case(zones[0]), farthest)
    if len(zones) > 1:
        ends = ends.to_tip(ends_of(section_case(zones[-1]), farthest))
    count, place = len(layout.lengths), without_shear(layout.strains).index("curvature")
    beam = float(layout.lengths[: chamber.start].sum()) * np.linalg.inv(cap.stiffness)[place, place]
    caps: list[Law] = [cap.times(beam / ends.flexibility), cap]
    if made.beam is not None:
        caps = [made.beam.beside_cap(law, layout.strains) for law in caps]
    borders = (0, chamber.start, chamber.stop, count)
    pieces = np.repeat(np.arange(3), np.diff(borders)).tolist()
    names = ("the root's cap", "" if len(zones) > 1 else "the chamber", "the tip's cap")
    return ends.offset(Zones((caps[0], made.law, caps[1]), pieces, names), layout, chamber)


def zone_names(count: int) -> tuple[str, ...]:
    """Zones of a chamber in words, from the root on; of one it is the chamber."""
    if count == 1:
        return ("the chamber",)
    return tuple(f"zone {number}" for number in range(1, count + 1))


def cap_law(case: Case, section: Section, strains: tuple[str, ...]) -> Quartic:
    """The law of a solid cap: each material along the axis as in a test of tension.

    A line at (x, y) from the line of centroids stretches by λ + k_x y − k_y x; the materials side
    by side have next to the same Poisson's ratio and press on each other hardly. Far from the floor
    a cap is strained by a tenth, where rubber is softer if it is pulled and stiffer if it is
    pressed: the energy is taken to the fourth order. Twisted, it is Saint-Venant's bar.

    Args:
        case: the case.
        section: its moments.
        strains: of the rod, without shear.
    """
    levers = {"stretch": (0.0, 0.0, 1.0), "curvature": (0.0, 1.0, 0.0)}
    levers |= {"side_curvature": (-1.0, 0.0, 0.0)}
    by = np.array([levers.get(name, (0.0, 0.0, 0.0)) for name in strains])
    materials = convert.site(case).materials
    slopes = {name: pulled(each) for name, each in materials.items()}
    second, third, fourth = (
        weighed(section.fourth, {name: each[order] for name, each in slopes.items()})
        for order in range(3)
    )
    stiffness = np.einsum("ai,bj,ij->ab", by, by, second[2, 2])
    if "twist" in strains:
        moduli = {name: each.initial_shear_modulus for name, each in materials.items()}
        stiffness[strains.index("twist"), strains.index("twist")] = torsion(section.mesh, moduli)
    return Quartic(
        stiffness,
        np.einsum("ai,bj,ck,ijk->abc", by, by, by, third[2]),
        np.einsum("ai,bj,ck,dl,ijkl->abcd", by, by, by, by, fourth),
        AT_REST[[STRAINS.index(name) for name in strains]],
    )


def pulled(material: Material) -> Floats:
    """Second to fourth derivative of the energy by the stretch at rest in a test of tension, MPa.

    The second is E, 3 μ of what cannot be compressed, 9 K μ/(3 K + μ) of what can; the others are
    in the proportion of the incompressible law. By Cauchy's formula on a circle, to round-off.
    """
    around = np.exp(2j * np.pi * np.arange(_ROUND) / _ROUND)
    stretch = 1 + _RADIUS * around
    energy = material.energy(stretch, stretch**-0.5, stretch**-0.5)
    orders = np.arange(2, 5)
    series = np.array([np.mean(energy * around ** -float(order)).real for order in orders])
    slopes: Floats = series / _RADIUS**orders * [2.0, 6.0, 24.0]
    shear, bulk = material.initial_shear_modulus, material.bulk
    return slopes if bulk is None else slopes * 3 * bulk / (3 * bulk + shear)


def masses(case: Case, section: Section) -> tuple[SectionMass, SectionMass]:
    """Of the section between the caps and of a cap; a material without density has no mass."""
    found = convert.site(case).materials
    densities = {name: each.mass_density or 0.0 for name, each in found.items()}
    hollow, cap = (_mass(weighed(parts, densities)) for parts in (section.hollow, section.filled))
    return hollow, cap


def _mass(sums: Floats) -> SectionMass:
    mass = float(sums[2, 2])
    if not mass:
        return SectionMass(0.0)
    x, y = (sums[:2, 2] / mass).tolist()
    about = sums[:2, :2] - mass * np.outer([x, y], [x, y])
    return SectionMass(mass, (x, y), (about[0, 0], about[1, 1], about[0, 1]))

"""Laws and masses of the pieces of a rod: of the section between the caps, and of the caps."""

from __future__ import annotations

import dataclasses

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.slender.moments import Section, weighed
from materials.material import Material
from rod.functions import Floats
from rod.inertia import SectionMass
from rod.law import Law, Linear
from rod.layout import AT_REST, STRAINS

ERROR = 1e-3
"""Of the table of a section, as `fiberbend.sectionlaw.table.law_of` has it."""


@dataclasses.dataclass(frozen=True)
class SectionLaw:
    """The law of the section between the caps.

    Attributes:
        law: by the strains of the rod.
        free: pressures, MPa, stretches and curvatures, 1/mm, of the section by itself, which
            trials of it have found, (n, 3).
        model: that solved the section.
        states: how many were solved for it.
        seconds: that took, of processor time, whenever that was.
        error: greatest of force, moment and chamber in parts of their range.
        remarks: what casts doubt on it, a line each.
    """

    law: Law
    free: Floats
    model: str
    states: int
    seconds: float
    error: float
    remarks: tuple[str, ...]


def section_law(case: Case, strains: tuple[str, ...]) -> SectionLaw:
    """The law of the section of a rod, from the tables that are kept or anew.

    Args:
        case: of model rod.
        strains: of the rod.

    Raises:
        fiberbend.schema.problems.CaseError: the section has no law that reaches as far as the case.
    """
    from fiberbend.sectionlaw.store import Store
    from fiberbend.sectionlaw.table import law_of
    from fiberbend.slender.beside import section_case

    store = Store()
    made = law_of(section_case(case), strains, ERROR, store=store)
    known = made.checked
    return SectionLaw(
        law=made.law,
        free=np.array([(p, state.stretch, state.curvature) for p, state in made.free]),
        model=made.model,
        states=made.solved,
        seconds=made.seconds,
        error=max(known.force, known.moment, known.area),
        remarks=(*made.remarks, *store.remarks),
    )


def cap_law(case: Case, section: Section, strains: tuple[str, ...]) -> Law:
    """The law of a solid cap: each material along the axis by its modulus at rest.

    A line at (x, y) from the line of centroids stretches by λ + k_x y − k_y x; the materials side
    by side have next to the same Poisson's ratio and press on each other hardly. A cap is as thick
    as it is long and strained by parts of a percent: nothing of it beyond the linear is seen.

    Args:
        case: the case.
        section: its moments.
        strains: of the rod.
    """
    moduli = {name: young(each) for name, each in convert.site(case).materials.items()}
    sums = weighed(section.filled, moduli)
    levers = {"stretch": (0.0, 0.0, 1.0), "curvature": (0.0, 1.0, 0.0)}
    levers["side_curvature"] = (-1.0, 0.0, 0.0)
    by = np.array([levers[name] for name in strains])
    return Linear(by @ sums @ by.T, AT_REST[[STRAINS.index(name) for name in strains]])


def young(material: Material) -> float:
    """E at rest, MPa: 3 μ of what cannot be compressed, 9 K μ/(3 K + μ) of what can."""
    shear, bulk = material.initial_shear_modulus, material.bulk
    return 3 * shear if bulk is None else 9 * bulk * shear / (3 * bulk + shear)


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

"""Laws of sections that are still to be made before cases can be solved as rods: for a plan."""

from __future__ import annotations

from collections.abc import Iterable

from fiberbend.case.case import Case
from fiberbend.case.zones import zone_cases
from fiberbend.models.choice import choose_model


def laws_to_make(cases: Iterable[Case]) -> tuple[int, float]:
    """Laws of sections that are not kept yet, each counted once, whoever shares it.

    A winding that waits for its calibration is of a section that is not known yet: it counts.

    Args:
        cases: of any model.

    Returns:
        How many, and the seconds that making them takes.
    """
    from fiberbend.sectionlaw.range import loads_on
    from fiberbend.sectionlaw.store import Store, digest_of
    from fiberbend.slender.beside import section_case
    from fiberbend.slender.laws import ERROR, strains_of, without_shear

    found: dict[str, float] = {}
    for case in cases:
        rod = choose_model(case)[0].slender()
        if rod is not None:
            strains, loads = without_shear(strains_of(case)), loads_on(case)
            for zone in zone_cases(case):
                digest = digest_of(section_case(zone), strains, ERROR, None, loads)
                found[digest] = rod.law_seconds(zone)
    store = Store()
    left = [seconds for digest, seconds in found.items() if store.find(digest) is None]
    return len(left), sum(left)

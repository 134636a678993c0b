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
    from fiberbend.sectionlaw.path.store import PathStore, digest_about
    from fiberbend.sectionlaw.range import loads_on
    from fiberbend.sectionlaw.store import Store, digest_of
    from fiberbend.slender.beside import section_case
    from fiberbend.slender.laws import ERROR, slackens, strains_of, twists_by_itself, without_shear

    tables, laws = Store(), PathStore()
    found: dict[str, tuple[bool, float]] = {}
    for case in cases:
        rod = choose_model(case)[0].slender()
        if rod is not None:
            strains, twists = without_shear(strains_of(case)), twists_by_itself(case)
            loads = loads_on(case)
            for zone in zone_cases(case):
                own = section_case(zone)
                if twists and not slackens(zone):
                    digest = digest_about(own, ERROR, loads)
                    known = laws.find(digest) is not None
                else:
                    digest = digest_of(own, strains, ERROR, None, loads)
                    known = tables.find(digest) is not None
                found[digest] = known, rod.law_seconds(zone)
    left = [seconds for known, seconds in found.values() if not known]
    return len(left), sum(left)

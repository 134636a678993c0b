"""The section or cell whose law a rod has, as a case of its own."""

from __future__ import annotations

import math

from fiberbend.case import convert
from fiberbend.case.case import Case, Output, Solver
from fiberbend.case.section_beside import as_section
from fiberbend.effects.effect import Effect
from fiberbend.effects.pressure import inflate

_FURTHER = 1.15
"""Of an angle or a change of volume that is driven: weight may take the chamber's pressure beyond
that of the section."""
_LEAST = 0.02
"""Change of volume, in parts of that at rest, that a law reaches at least: of next to none its
errors have no size to be measured by."""


def section_case(case: Case) -> Case:
    """The case of the section of a rod; of the cell where every turn of its winding is to lie.

    Args:
        case: of model rod, under a pressure, a volume or an angle.
    """
    section = as_section(case, _load(case))
    if case.turns is None or not case.turns.discrete:
        return section
    wound = tuple(effect for effect in case.effects if effect.beside() is not None)
    update = {"model": "cell", "effects": (section.effects[0], *wound), "mesh": case.mesh}
    return section.model_copy(update={**update, "solver": Solver(), "output": Output()})


def _load(case: Case) -> Effect:
    """The farthest pressure, volume or angle of its chamber."""
    load = case.inflation
    assert load is not None, "refused before"
    if load.to is not None:
        return inflate(to=load.to)
    if load.volume is not None:
        rest = convert.dimensions(case.actuator).chamber_volume
        change = _FURTHER * (load.volume - rest)
        return inflate(volume=rest + math.copysign(max(abs(change), _LEAST * rest), change))
    assert load.angle is not None, "refused before"
    return inflate(angle=_FURTHER * load.angle)

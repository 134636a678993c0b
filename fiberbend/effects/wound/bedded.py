"""Families whose threads sink into the rubber under them, in a section: what they need."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Protocol

from fiberbend.effects.wound.thread import BeddingSpec, BulgingSpec
from fiberbend.schema.problems import Problem

if TYPE_CHECKING:
    from fem.effects.winding import BeddedWinding
    from fiberbend.effects.wound.family import FamilySpec
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats
    from geometry.winding.ribbons import Ribbons
    from geometry.winding.segments import SmearedFibers
    from materials.bedding import Bedding
    from materials.bulging import Bulging


class Said(Protocol):
    """What a winding says of it."""

    families: tuple[FamilySpec, ...] | None
    bulging: BulgingSpec | None
    bedding: BeddingSpec | None
    tension_only: bool


def problems(path: str, winding: Said, calibrated: bool) -> Iterator[Problem]:
    """Numbers of the other kind of winding, and threads that go slack where they are calibrated."""
    if winding.families is None:
        if winding.bedding is not None:
            text = "no effect without families, expected bulging"
            yield Problem(f"{path}.bedding", text)
        return
    if winding.bulging is not None:
        yield Problem(f"{path}.bulging", "no effect beside families, expected bedding")
    if winding.tension_only and calibrated:
        yield Problem(
            f"{path}.tension_only",
            "families whose rubber yields are calibrated taut, expected false, or as: discrete or "
            "smeared",
        )


def entry(numbers: Bulging | Bedding) -> dict[str, Any]:
    """The numbers of a calibration as the keys of a winding that have them."""
    from materials.bulging import Bulging

    if isinstance(numbers, Bulging):
        return {"bulging": BulgingSpec.of(numbers)}
    return {"bedding": BeddingSpec.of(numbers)}


def term(
    over: SmearedFibers,
    stiffness: float | Floats,
    bedding: BeddingSpec,
    laid: Ribbons,
    actuator: Actuator,
) -> BeddedWinding:
    """The threads on rubber that yields.

    Args:
        over: smeared on the outline of a section.
        stiffness: EA, N.
        bedding: of the rubber.
        laid: the families by number.
        actuator: what they are wound around.
    """
    import numpy as np

    from fem.effects.bedded_fibers import Run
    from fem.effects.winding import BeddedWinding

    sine = np.array([family.sine for family in laid.families])[over.family]
    run = Run(sine, actuator.winding_perimeter)
    return BeddedWinding(over, stiffness, bedding.bulging(), run)

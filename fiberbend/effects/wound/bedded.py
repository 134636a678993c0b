"""Families whose threads sink into the rubber under them, in a section: what they need."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from fiberbend.effects.wound.thread import BeddingSpec, BulgingSpec
from fiberbend.schema.problems import Problem

if TYPE_CHECKING:
    from fem.effects.winding import BeddedWinding
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats
    from geometry.winding.ribbons import Ribbons
    from geometry.winding.segments import SmearedFibers
    from materials.bedding import Bedding
    from materials.bulging import Bulging


def problems(
    path: str, families: bool, bulging: bool, bedding: bool, slack: bool
) -> Iterator[Problem]:
    """Numbers of the other kind of winding, and threads that go slack where they are calibrated.

    Args:
        path: of the winding.
        families: it has families.
        bulging: it has these numbers.
        bedding: and these.
        slack: it is calibrated and goes slack.
    """
    if not families and bedding:
        yield Problem(f"{path}.bedding", "no effect without families, expected bulging")
    if families and bulging:
        yield Problem(f"{path}.bulging", "no effect beside families, expected bedding")
    if families and slack:
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

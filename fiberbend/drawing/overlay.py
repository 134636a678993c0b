"""What is drawn beside the curve of a run."""

from __future__ import annotations

import dataclasses

from geometry.mesh.data import Floats

MODELS = ("section", "analytic", "analytic_winding", "analytic_paper")
"""Models that can stand beside a run, as columns of the history and run.json call them."""


@dataclasses.dataclass(frozen=True, eq=False)
class Line:
    """Curve of another model.

    Attributes:
        name: of the model, which always has the same colour; a key of `MODELS`.
        label: what is written beside the curve.
        across: pressures, (n,), kPa.
        up: bending angles in degrees, or tip forces in N, (n,).
    """

    name: str
    label: str
    across: Floats
    up: Floats


@dataclasses.dataclass(frozen=True, eq=False)
class Points:
    """Measured points.

    Attributes:
        label: their name.
        across: pressures, (n,), kPa.
        up: bending angles in degrees, or tip forces in N, (n,).
    """

    label: str
    across: Floats
    up: Floats


@dataclasses.dataclass(frozen=True)
class Overlay:
    """All that is drawn beside one curve.

    Attributes:
        lines: curves of other models.
        points: measured points.
    """

    lines: tuple[Line, ...] = ()
    points: tuple[Points, ...] = ()

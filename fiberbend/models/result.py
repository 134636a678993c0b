"""What every run hands back, and the curve of a uniformly bending actuator."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from geometry.mesh.data import Floats


@dataclasses.dataclass(frozen=True)
class RunResult:
    """What a run has computed.

    Attributes:
        status: 'converged', 'stopped' (a requested output was not reached) or 'failed'.
        reason: why not converged; empty otherwise.
        rows: rows of history.csv, the first at rest.
        run: content of run.json.
        folder: where the results are, or None.
    """

    status: str
    reason: str
    rows: list[dict[str, Any]]
    run: dict[str, Any]
    folder: Path | None

    def last(self, column: str) -> float:
        """Value of a column at the end."""
        return float(self.rows[-1][column])


@dataclasses.dataclass(frozen=True)
class Curve:
    """States of a uniformly bending actuator, from rest on.

    Attributes:
        pressure: MPa, (n,).
        angle: θ = k L, rad, (n,).
        volume: chamber, mm³, (n,).
        reason: why it ends early; empty otherwise.
    """

    pressure: Floats
    angle: Floats
    volume: Floats
    reason: str = ""

    def reaches(self, angle: float) -> bool:
        """Whether it rises from rest to an angle, rad."""
        import numpy as np

        from analytic.inverse import ROUND_OFF

        slack = ROUND_OFF * self.angle[-1]
        rises = np.all(np.diff(self.angle) > 0)
        return bool(rises and -slack <= angle <= self.angle[-1] + slack)

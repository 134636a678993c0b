"""Rubber that bulges between the turns of a winding: a spring in series with the thread."""

from __future__ import annotations

import dataclasses


@dataclasses.dataclass(frozen=True)
class Bulging:
    """Stiffness per area against a bulge of rubber between the turns.

    A thread on a curve of radius r presses with T/r per length; the rubber bulges between the turns
    by b, so that the thread strains by e − b/r where its surface strains by e. The bulge costs
    ½ K_b b² per area, K_b = K0 [1 + a1 (λ_z − 1) + a2 (λ_z − 1)²] with λ_z the stretch along the
    actuator's axis at that point.

    Attributes:
        stiffness: K0, MPa/mm.
        linear: a1.
        quadratic: a2.

    Raises:
        ValueError: a stiffness that is not positive.
    """

    stiffness: float
    linear: float = 0.0
    quadratic: float = 0.0

    def __post_init__(self) -> None:
        if not self.stiffness > 0:
            raise ValueError(f"bulging stiffness {self.stiffness} MPa/mm, expected more than zero")

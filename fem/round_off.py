"""What round-off makes of the forces of a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from fem.scene import Scene

PROBE = 1e-6
"""Part of an element by which nodes are moved to see what a move in their last digit does."""


def solid_noise(scene: Scene) -> float:
    """Norm of the forces inside the solid where nodes are moved in their last digit, N.

    Args:
        scene: at rest, and left there.
    """
    rest, body = scene.w.copy(), scene.body
    moved = rest.copy()
    moved[body.node_dofs[body.owned_nodes]] += PROBE * body.astray()
    scene.set(moved)
    forces = scene.solid_forces()
    scene.set(rest)
    inside = scene.free[: body.owned] & ~scene.volumetric
    return float(np.finfo(float).eps / PROBE * scene.norm(forces[inside]))

"""Whether a rod passes through itself, by its sections as polygons."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem.march.selfcontact import Pose, clearance, directions
from fiberbend.slender.actuator import Slender
from geometry.bodies.quads import section_mesh
from geometry.sections.size import MeshSize
from geometry.sections.table import section_layout
from rod.functions import Floats
from rod.shape import Shape


def passes_itself(rod: Slender, shapes: Sequence[Shape]) -> int | None:
    """Number of the first state in which sections are within others; None: of none.

    Args:
        rod: the rod, wherever it is clamped.
        shapes: its states, the first at rest.
    """
    reach = _reach(rod)
    z = np.concatenate([[0.0], np.cumsum(rod.rod.layout.lengths)])
    outline = np.tile(reach, (len(z), 1))
    for number, shape in enumerate(shapes):
        pose = Pose(z, shape.places, shape.rotations, outline)
        if number and clearance(pose, 0.0) < 0:
            return number
    return None


def _reach(rod: Slender) -> Floats:
    """Of the section at rest from the line of centroids in every direction, (m,), mm."""
    layout = section_layout(rod.site.actuator, MeshSize(half=False))
    nodes = section_mesh(layout).nodes - rod.site.layout.place[:2]
    reach: Floats = (nodes @ directions().T).max(axis=0)
    return reach

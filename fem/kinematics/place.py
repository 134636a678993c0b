"""Where the unknowns of a body lie along its axis, and how it would move as a rigid body."""

from __future__ import annotations

import dataclasses

import numpy as np
import numpy.typing as npt

from fem.kinematics.kinematics import PRESSURE, Kinematics

Floats = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True)
class Place:
    """Where the unknowns lie that this rank owns.

    Attributes:
        low: least z at rest of what an unknown belongs to: of its node, or of its element where
            it is a pressure, mm, (owned,).
        high: the greatest, mm, (owned,).
        ends: z at rest at which elements of this rank begin or end, rising, mm, (m,).
        rigid: displacements by three translations and three small rotations of the body as it
            is, (owned, 6); zero where something is fixed, and of pressures.
    """

    low: Floats
    high: Floats
    ends: Floats
    rigid: Floats


def place(body: Kinematics, free: npt.NDArray[np.bool_]) -> Place:
    """Where the unknowns lie at the present state.

    Args:
        body: a body in space whose pressures belong to one element each.
        free: local dofs that no constraint fixes, (local,).
    """
    owned, nodes = body.owned, body.domain.data.nodes
    low, high = np.zeros((2, body.local))
    rigid = np.zeros((body.local, 6))
    here = np.flatnonzero(body.node_dofs[:, 0] >= 0)
    dofs = body.node_dofs[here]
    x = nodes[here] + body.w.x.array[dofs]
    # the same origin on every rank, near the body
    x = x - nodes.mean(axis=0)
    for i in range(3):
        low[dofs[:, i]] = high[dofs[:, i]] = nodes[here, 2]
        rigid[dofs[:, i], i] = 1.0
        # e_a × x turns x_b towards x_c
        b, c = (i + 1) % 3, (i + 2) % 3
        rigid[dofs[:, c], 3 + i] = x[:, b] / body.span
        rigid[dofs[:, b], 3 + i] = -x[:, c] / body.span
    rigid[~free] = 0.0
    z = nodes[body.domain.data.cells[body.domain.cells], 2]
    first, last = z.min(axis=1), z.max(axis=1)
    pressures = body.dofs(PRESSURE)[:, :, 0]
    low[pressures], high[pressures] = first[:, None], last[:, None]
    ends = np.unique(np.r_[first, last].round(9))
    return Place(low[:owned], high[:owned], ends, rigid[:owned])

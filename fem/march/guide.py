"""Shapes of a body as a section of it bends: what a body's predictor leans on."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from analytic.path import arc
from fem.kinematics.kinematics import Kinematics
from fem.march.frames import Frames, Shape

Floats = npt.NDArray[np.float64]

ROUND_OFF = 1e-9
"""Share of a measure's range by which a body at the range's end may miss it: at rest the fitted
angle is ±1e-15 rad, and its sign is round-off's."""

KEPT = 8
"""Shapes that are kept: of three or four states and of where they lead, by two measures."""


class Guide:
    """A uniformly bent body between rigid caps, from the states of its section.

    Args:
        body: the body's kinematics.
        frames: its stations.
        length: length L between the caps, mm.
        section: nodes of the section's mesh, (n, 2), mm; x ≥ 0 alone will do.
        measures: by name, what the march may drive at each of m states, rising or falling, (m,).
        curvature: k, 1/mm, (m,).
        stretch: λ0, (m,).
        displacement: u, v of the section's nodes, mm, (m, n, 2).
    """

    def __init__(
        self,
        body: Kinematics,
        frames: Frames,
        length: float,
        section: Floats,
        measures: Mapping[str, Floats],
        curvature: Floats,
        stretch: Floats,
        displacement: Floats,
    ) -> None:
        from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

        self._frames, self._length = frames, length
        self._nodes = body.domain.data.nodes[body.owned_nodes]
        self._measures = dict(measures)
        self._last: dict[tuple[str, float], Shape] = {}
        x, y, z = self._nodes.T
        inside = (z >= 0) & (z <= length)
        values, at = displacement.transpose(1, 2, 0), np.column_stack([np.abs(x), y])
        moved = LinearNDInterpolator(section, values)(at)
        # the hull of the nodes leaves out a sliver under curved sides
        outside = np.isnan(moved[:, 0, 0])
        moved[outside] = NearestNDInterpolator(section, values)(at[outside])
        moved[:, 0] *= np.sign(x)[:, None]
        # caps keep their section: fade over half a height
        fade = np.clip(np.minimum(z, length - z) / (np.ptp(section[:, 1]) / 2), 0, 1)
        moved *= (inside * fade**2 * (3 - 2 * fade))[:, None, None]
        self._states = np.concatenate(
            [curvature[None], stretch[None], moved.reshape(-1, len(curvature))]
        ).T

    def covers(self, measure: str, value: float) -> bool:
        """Whether the section's states span a value, its ends included up to round-off."""
        known = self._measures.get(measure)
        if known is None:
            return False
        low, high = sorted((known[0], known[-1]))
        slack = ROUND_OFF * (high - low)
        return bool(low - slack <= value <= high + slack)

    def shape(self, measure: str, value: float) -> Shape:
        """The body's shape where a measure takes a value.

        Raises:
            KeyError: no such measure.
        """
        last = self._last.pop((measure, value), None)
        if last is None:
            last = self._found(measure, value)
        # a step asks for its states anew, the oldest excepted
        self._last[measure, value] = last
        for key in list(self._last)[:-KEPT]:
            del self._last[key]
        return last

    def _found(self, measure: str, value: float) -> Shape:
        from scipy.interpolate import CubicSpline

        known = self._measures[measure]
        # bent by vacuum, pressure, angle and volume fall
        side = 1.0 if known[-1] > known[0] else -1.0
        known, value = side * known, side * value
        at = int(np.clip(np.searchsorted(known, value) - 2, 0, max(len(known) - 4, 0)))
        near = slice(at, at + 4)
        state = CubicSpline(known[near], self._states[near])(value)
        return self._frames.fit(self._displacement(state[0], state[1], state[2:].reshape(-1, 2)))

    def _displacement(self, k: float, stretch: float, moved: Floats) -> Floats:
        """Of the owned nodes, mm, (n, 3): an arc between straight caps.

        Args:
            k: curvature, 1/mm.
            stretch: λ0.
            moved: u, v of the nodes in their section, mm, (n, 2).
        """
        x, y, z = self._nodes.T
        along = np.clip(z, 0.0, self._length)
        ahead, down = arc(k * along, stretch * along, z - along, y + moved[:, 1]).T
        return np.column_stack([x + moved[:, 0], -down, ahead]) - self._nodes

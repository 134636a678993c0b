"""Rotation and centre of the cross-sections along a body, and a state rebuilt from them."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from fem.kinematics.kinematics import Kinematics
from fem.ranks import total

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Floats = npt.NDArray[np.float64]


@dataclasses.dataclass
class Shape:
    """A deformed body as a rod with warped sections.

    Attributes:
        rotation: of every station's section, (k, 3, 3).
        centre: deformed position of the axis point (0, 0, z), mm, (k, 3).
        warp: what is left, in the section's own frame, mm, (owned nodes, 3).
    """

    rotation: Floats
    centre: Floats
    warp: Floats


class Frames:
    """Stations along z with hat-function weights; works for any mesh and any number of ranks.

    Args:
        body: kinematics with the displacement.
        against: parts of the body may bend against each other, so that its bending angle hides
            how far they do.

    Attributes:
        z: reference positions of the stations, mm, (k,).
    """

    def __init__(self, body: Kinematics, against: bool = False) -> None:
        self._body, self._against = body, against
        nodes = body.domain.data.nodes
        low, high = nodes.min(axis=0), nodes.max(axis=0)
        # no station between two planes of nodes, which would weigh none
        gap = float(np.diff(np.unique(nodes[:, 2])).max())
        spacing = max(float(max(high[:2] - low[:2])) / 4, (high[2] - low[2]) / 200, gap)
        count = max(2, int(np.ceil((high[2] - low[2]) / spacing)) + 1)
        self.z = np.linspace(low[2], high[2], count)
        self._nodes: Floats = nodes[body.owned_nodes]
        position = (self._nodes[:, 2] - low[2]) / (self.z[1] - self.z[0])
        self._below = np.clip(position.astype(int), 0, count - 2)
        self._above_share = position - self._below
        section = self._nodes.copy()
        section[:, 2] = 0.0
        self._section = section
        # nodes of a swept body lie in a few planes, which turn as wholes
        self._planes, self._plane = np.unique(self._nodes[:, 2], return_inverse=True)

    def _station_sums(self, values: Floats) -> Floats:
        """Hat-weighted sums over all ranks of nodal values (n, m), (stations, m)."""
        count = len(self.z)
        above = self._above_share[:, None] * values
        sums = np.zeros((count, values.shape[1]))
        for j, (here, there) in enumerate(zip((values - above).T, above.T, strict=True)):
            sums[:, j] = np.bincount(self._below, here, count)
            sums[1:, j] += np.bincount(self._below, there, count)[:-1]
        found: Floats = total(self._body.domain.comm, sums)
        return found

    def _at_nodes(self, rotation: Floats, centre: Floats) -> tuple[Floats, Floats]:
        from scipy.interpolate import CubicSpline
        from scipy.spatial.transform import Rotation, Slerp

        z = self._planes
        spin = Slerp(self.z, Rotation.from_matrix(rotation))
        turned = spin(np.clip(z, self.z[0], self.z[-1])).as_matrix()
        return turned[self._plane], CubicSpline(self.z, centre)(z)[self._plane]

    def fit(self, displacement: Floats) -> Shape:
        """Best-fit rotation (Kabsch) and centre of every station; the rest is warp.

        Args:
            displacement: of the owned nodes, mm, (n, 3).
        """
        x = self._nodes + displacement
        ref = self._nodes
        outer = (ref[:, :, None] * x[:, None, :]).reshape(-1, 9)
        ones = np.ones((len(ref), 1))
        sums = self._station_sums(np.hstack([ones, ref, x, outer]))
        weight = sums[:, :1]
        mean_ref, mean_x = sums[:, 1:4] / weight, sums[:, 4:7] / weight
        moment = (sums[:, 7:] / weight).reshape(-1, 3, 3)
        if self._body.domain.data.half:
            # with the mirror image: a half section alone would seem to turn about y and z
            mean_ref[:, 0] = mean_x[:, 0] = 0.0
            moment[:, 0, 1:] = moment[:, 1:, 0] = 0.0
        moment -= mean_ref[:, :, None] * mean_x[:, None, :]
        left, _, right = np.linalg.svd(moment)
        sign = np.ones((len(weight), 3))
        sign[:, 2] = np.sign(np.linalg.det(left) * np.linalg.det(right))
        rotation = np.einsum("kia,ki,kbi->kab", right, sign, left)
        arm = np.column_stack([np.zeros((len(self.z), 2)), self.z]) - mean_ref
        centre = mean_x + np.einsum("kab,kb->ka", rotation, arm)
        spin, middle = self._at_nodes(rotation, centre)
        warp = np.einsum("nba,nb->na", spin, x - middle) - self._section
        return Shape(rotation, centre, warp)

    def turned(self, shape: Shape) -> float | None:
        """Greatest turn of a station, rad, where the bending angle may hide it; else None.

        Turns about the axes of the sections add up from station to station: further than π too.
        """
        from scipy.spatial.transform import Rotation

        if not self._against:
            return None
        rotation = Rotation.from_matrix(shape.rotation)
        turns = np.cumsum((rotation[:-1].inv() * rotation[1:]).as_rotvec(), axis=0)
        return float(np.linalg.norm(turns, axis=1).max())

    def rebuild(self, shape: Shape) -> Floats:
        """Displacement of the owned nodes of a shape, mm, (n, 3)."""
        spin, middle = self._at_nodes(shape.rotation, shape.centre)
        x: Floats = middle + np.einsum("nab,nb->na", spin, self._section + shape.warp)
        return x - self._nodes

    def extrapolate(
        self, shapes: list[Shape], weights: Floats, guides: list[Shape] | None = None
    ) -> Shape:
        """Weighted sum of shapes (weights add to 1), rotations on the group.

        The centre-line is summed by its steps from station to station in the turning frame, so
        that a bending arc stays an arc.

        Args:
            shapes: the states to extrapolate from.
            weights: one for each.
            guides: shapes of another model at the same loads, and last at the load to reach; what
                is extrapolated is the difference from them. Without: the last shape for all.
        """
        from scipy.spatial.transform import Rotation

        guides = guides or [shapes[-1]] * (len(shapes) + 1)
        goal = guides[-1]
        end = Rotation.from_matrix(goal.rotation)
        turn = np.zeros((len(self.z), 3))
        step, warp, start = self._steps(goal), goal.warp, goal.centre[0]
        for shape, guide, weight in zip(shapes, guides, weights, strict=False):
            relative = (
                Rotation.from_matrix(shape.rotation) * Rotation.from_matrix(guide.rotation).inv()
            )
            turn += weight * relative.as_rotvec()
            step = step + weight * (self._steps(shape) - self._steps(guide))
            warp = warp + weight * (shape.warp - guide.warp)
            start = start + weight * (shape.centre[0] - guide.centre[0])
        rotation = Rotation.from_rotvec(turn) * end
        steps = self._middle(rotation).apply(step)
        centre = np.vstack([start, start + np.cumsum(steps, axis=0)])
        return Shape(rotation.as_matrix(), centre, warp)

    def between(self, old: Shape, new: Shape, share: float) -> Shape:
        """A shape between two others, however far apart: bends and steps station by station.

        Args:
            old: the shape at 0.
            new: the shape at 1; its warp is taken.
            share: from 0 to 1.
        """
        from scipy.spatial.transform import Rotation

        first, bends, steps = np.zeros(3), np.zeros(3), np.zeros(3)
        for shape, weight in ((old, 1 - share), (new, share)):
            rotation = Rotation.from_matrix(shape.rotation)
            first = first + weight * rotation[0].as_rotvec()
            bends = bends + weight * (rotation[:-1].inv() * rotation[1:]).as_rotvec()
            steps = steps + weight * self._steps(shape)
        turned = [Rotation.from_rotvec(first)]
        for bend in np.atleast_2d(bends):
            turned.append(turned[-1] * Rotation.from_rotvec(bend))
        rotation = Rotation.concatenate(turned)
        start = (1 - share) * old.centre[0] + share * new.centre[0]
        along = np.cumsum(self._middle(rotation).apply(steps), axis=0)
        return Shape(rotation.as_matrix(), np.vstack([start, start + along]), new.warp)

    def _steps(self, shape: Shape) -> Floats:
        """Steps of the centre-line from station to station in the turning frame, mm, (k − 1, 3)."""
        from scipy.spatial.transform import Rotation

        middle = self._middle(Rotation.from_matrix(shape.rotation))
        steps: Floats = middle.inv().apply(np.diff(shape.centre, axis=0))
        return steps

    @staticmethod
    def _middle(rotation: Rotation) -> Rotation:
        """Rotation half-way between neighbouring stations."""
        from scipy.spatial.transform import Rotation

        step = (rotation[1:] * rotation[:-1].inv()).as_rotvec()
        return Rotation.from_rotvec(step / 2) * rotation[:-1]

    def greatest(self, shape: Shape, directions: Floats) -> Floats:
        """Greatest extent of every station's section in its own frame along directions, mm.

        Args:
            shape: of the body.
            directions: (m, 2).

        Returns:
            (stations, m).
        """
        extent = (self._section + shape.warp)[:, :2] @ directions.T
        greatest = np.full((len(self.z), len(directions)), -np.inf)
        order = np.argsort(self._below, kind="stable")
        below, first = np.unique(self._below[order], return_index=True)
        if len(below):
            between = np.maximum.reduceat(extent[order], first)
            greatest[below] = between
            greatest[below + 1] = np.maximum(greatest[below + 1], between)
        total: Floats = np.max(self._body.domain.comm.allgather(greatest), axis=0)
        return total

"""Whether a bent body passes through itself, from its stations alone."""

from __future__ import annotations

import dataclasses
import functools
from typing import Protocol

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from analytic.path import CentreLine
from fem.kinematics.kinematics import Kinematics
from fem.kinematics.uniform import STRETCH, Uniform
from fem.march.frames import Frames, Shape
from fem.march.records import State

Floats = npt.NDArray[np.float64]

DIRECTIONS = 24
"""Sides of the polygon that stands for a section's outline."""
HALVINGS = 20
"""Halvings of an increment in which the first contact lies."""


@dataclasses.dataclass(frozen=True)
class Pose:
    """A body in space as n sections, each a convex polygon of `DIRECTIONS` sides.

    Attributes:
        z: reference positions along the axis, mm, rising, (n,).
        centre: deformed positions of the axis, to which `reach` refers, mm, (n, 3).
        rotation: of the sections, (n, 3, 3).
        reach: greatest n · x over a section's own frame for every direction n, mm, (n, m).
    """

    z: Floats
    centre: Floats
    rotation: Floats
    reach: Floats


@functools.cache
def directions() -> Floats:
    """Normals of a polygon's sides, (m, 2)."""
    angle = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    return np.column_stack([np.cos(angle), np.sin(angle)])


def _vertices(reach: Floats) -> Floats:
    """Vertices of the polygons, (n, m, 2): where a side meets the next one."""
    # sides n_i · x = h_i and n_{i+1} · x = h_{i+1}, h the support function, normals δ apart, meet
    # on the first's tangent t_i at x = h_i n_i + [(h_{i+1} − h_i cos δ)/sin δ] t_i
    normal, step = directions(), 2 * np.pi / DIRECTIONS
    along = (np.roll(reach, -1, axis=1) - reach * np.cos(step)) / np.sin(step)
    tangent = np.column_stack([-normal[:, 1], normal[:, 0]])
    vertices: Floats = reach[:, :, None] * normal + along[:, :, None] * tangent
    return vertices


def clearance(pose: Pose, most: float = np.inf) -> float:
    """Least distance of a body's sections from its slices elsewhere, mm; negative: inside.

    A slice lies between two successive sections j and j + 1 and is the set n · x ≤ h of its planes:
    both sections' own (R e_z and −R e_z through their centres c) and one a side of the polygon,
    whose normal n and distance h are the mean of both sections'. The distance of a vertex p from it
    is taken as max(n · p − h) over the planes,

        axial = max(−e_z · R_jᵀ(p − c_j), e_z · R_{j+1}ᵀ(p − c_{j+1})),
        beside = max_i [n_i · ½ (R_jᵀ(p − c_j) + R_{j+1}ᵀ(p − c_{j+1})) − ½ (h_ij + h_i,j+1)],

    in mm: exact where bodies touch, too small far away, as with separating axes (Gottschalk, Lin
    and Manocha 1996, doi 10.1145/237170.237244). None is reported beyond the size of a section.
    Sections closer along the axis than one and a half times that size are not compared.

    Args:
        pose: the body.
        most: mm; greater distances are reported as this one, and cost less.
    """
    vertices = _vertices(pose.reach)
    size = float(np.ptp(vertices, axis=1).max())
    turned = vertices @ pose.rotation[:, :, :2].swapaxes(1, 2)
    points = pose.centre[:, None] + turned
    radius = np.linalg.norm(vertices, axis=2).max()
    middles = points.mean(axis=1)
    wide = np.linalg.norm(points - middles[:, None], axis=2).max(axis=1)
    slices, halves = (middles[1:] + middles[:-1]) / 2, np.maximum(wide[1:], wide[:-1])
    halves = halves + np.linalg.norm(np.diff(middles, axis=0), axis=1) / 2
    least = min(size, most)
    # |m_i − m_j| − r_i − r_j of the balls around section and slice: a bound that most pairs pass,
    # asked of neighbours in space alone, so that memory grows with the length and not its square
    radii = float(wide.max() + halves.max() + least)
    found = cKDTree(slices).query_ball_point(middles, radii)
    i = np.repeat(np.arange(len(found)), [len(others) for others in found])
    j_of = np.concatenate([np.asarray(others, dtype=int) for others in found])
    between = np.linalg.norm(middles[i] - slices[j_of], axis=1) - wide[i] - halves[j_of]
    far = np.abs(pose.z[i] - (pose.z[j_of + 1] + pose.z[j_of]) / 2) > 1.5 * size
    kept = far & (between < least)
    order = np.argsort(j_of[kept], kind="stable")
    i, j_of = i[kept][order], j_of[kept][order]
    hit, first, number = np.unique(j_of, return_index=True, return_counts=True)
    for j, begin, count in zip(hit, first, number, strict=True):
        some = points[i[begin : begin + count]].reshape(-1, 3)
        below = (some - pose.centre[j]) @ pose.rotation[j]
        above = (some - pose.centre[j + 1]) @ pose.rotation[j + 1]
        axial = np.maximum(-below[:, 2], above[:, 2])
        middle = (below[:, :2] + above[:, :2]) / 2
        near = np.maximum(axial, np.linalg.norm(middle, axis=1) - radius) < least
        if not near.any():
            continue
        reach = (pose.reach[j] + pose.reach[j + 1]) / 2
        beside = np.max(middle[near] @ directions().T - reach, axis=1)
        least = min(least, float(np.maximum(axial[near], beside).min()))
    return least


class Rod(Protocol):
    """What a model's states are as rods."""

    def pose(self, old: State, new: State, share: float) -> Pose:
        """Between two states: the old one at 0, the new one at 1; collective."""


class BodyRod:
    """The three-dimensional body, by its stations.

    Args:
        body: its kinematics.
        frames: its stations.
    """

    def __init__(self, body: Kinematics, frames: Frames) -> None:
        self._body, self._frames = body, frames
        self._known: tuple[Floats, Floats] | None = None
        """The last warp and its reach: all between two states have one."""

    def pose(self, old: State, new: State, share: float) -> Pose:
        """Bent station by station."""
        assert old.shape is not None
        assert new.shape is not None
        shape = new.shape
        if share != 1:
            shape = self._frames.between(old.shape, new.shape, share)
        return Pose(self._frames.z, shape.centre, shape.rotation, self._reach(shape))

    def _reach(self, shape: Shape) -> Floats:
        if self._known is None or self._known[0] is not shape.warp:
            self._known = (shape.warp, self._found(shape))
        return self._known[1]

    def _found(self, shape: Shape) -> Floats:
        normal, body = directions(), self._body
        reach = self._frames.greatest(shape, normal)
        if body.domain.data.half:
            mirrored = (DIRECTIONS // 2 - np.arange(DIRECTIONS)) % DIRECTIONS
            reach = np.maximum(reach, reach[:, mirrored])
        return reach


class UniformRod:
    """Section or cell: an arc or helix between straight caps.

    Args:
        body: its kinematics.
        cap: length of each of the caps, mm.
    """

    def __init__(self, body: Uniform, cap: float) -> None:
        self._body = body
        nodes = body.domain.data.nodes
        self._nodes = np.column_stack([nodes[:, :2], np.zeros(len(nodes))])
        self._dofs = body.node_dofs
        spacing = float(np.ptp(self._nodes, axis=0).max()) / 4
        counts = [max(1, int(np.ceil(length / spacing))) for length in (cap, body.length)]
        caps, middle = (np.linspace(0, 1, count + 1) for count in counts)
        length = body.length
        z = [-cap * (1 - caps[:-1]), length * middle, length + cap * caps[1:]]
        self._z = np.concatenate(z)

    def pose(self, old: State, new: State, share: float) -> Pose:
        """Curvature, stretch, twist and section between the states."""
        scalars = {
            name: (1 - share) * old.scalars[name] + share * new.scalars[name]
            for name in self._body.natural
        }
        w = (1 - share) * old.w + share * new.w
        spin = self._body.spin(scalars)
        along = np.clip(self._z, 0.0, self._body.length)
        fit = self._body.fit
        line = CentreLine.of(spin, scalars[STRETCH], *fit.read(w))
        rotation, centre = line.sections(along)
        centre = centre + rotation[:, :, 2] * (self._z - along)[:, None]
        bent = (self._z >= 0) & (self._z <= self._body.length)
        moved = self._nodes.copy()
        moved[:, : self._dofs.shape[1]] += w[self._dofs]
        across = (moved - line.centre) @ line.section
        reach = np.where(bent[:, None], self._reach(across), self._reach(self._nodes - fit.rest))
        return Pose(self._z, centre, rotation, reach)

    def _reach(self, position: Floats) -> Floats:
        x = position[:, :2]
        if self._body.domain.data.half:
            x = np.vstack([x, x * [-1, 1]])
        reach: Floats = (x @ directions().T).max(axis=0)
        return reach


def first_contact(rod: Rod, old: State, new: State) -> float | None:
    """Share of an increment after which a body touches itself first; None where it does not.

    Args:
        rod: the states as rods.
        old: a state that does not touch itself.
        new: the next one.
    """
    if clearance(rod.pose(old, new, 1.0), 0.0) >= 0:
        return None
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if clearance(rod.pose(old, new, middle), 0.0) < 0:
            high = middle
        else:
            low = middle
    return high


def touching(rod: Rod, old: State, new: State) -> dict[str, float] | None:
    """Measures, between those of two states, where a body touches itself first; None: nowhere.

    Args:
        rod: the states as rods.
        old: a state that does not touch itself.
        new: the next one.
    """
    share = first_contact(rod, old, new)
    if share is None:
        return None
    return {
        name: (1 - share) * value + share * new.measures[name]
        for name, value in old.measures.items()
    }

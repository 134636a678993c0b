"""What fails physically where no further increment is found."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from fem import compat
from fem.effects.elastic import Elastic
from fem.effects.embedded_fibers import FiberPotential
from fem.march.limit_points import softens
from fem.march.records import (
    Critical,
    State,
    measure,
)
from fem.ranks import total
from fem.scene import Scene
from fem.solver.newton import Outcome
from materials.laws.law import Law
from materials.stretches import Stretches

Floats = npt.NDArray[np.float64]

PRESSURE, CHAMBER = "pressure", "chamber"
SWOLLEN, EMPTIED = 2.0, 0.7
"""A chamber of so many times its volume has ballooned, or collapses under vacuum."""
SQUEEZED = 0.6
"""det F at a point, where an element can only keep its mean at one, that tells of squeezing."""
MEETING = 0.1
"""Opposite walls so close, in parts of the chamber's height, meet."""
EXHAUSTED = 0.9
"""Part of its limiting stretch from which rubber hardly yields."""
SLACK = 0.5
"""A winding carries nothing where so much of its length is slack."""
WHERE = {"post": "under the post", "roof": "under the roof", "clamp": "at the clamp"}
"""What is said of an element at a named surface."""


@dataclasses.dataclass(frozen=True)
class _Worst:
    """Where a quantity is at its worst.

    Attributes:
        value: of all ranks and points.
        cell: input number of the cell.
    """

    value: float
    cell: int


class Diagnosis:
    """Reads the physical cause of a failure off the last states.

    Args:
        scene: the scene.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._gradient: compat.PointValues | None = None

    def inverted(self) -> str:
        """Where an element is turned inside out at the present iterate; empty where none is."""
        worst = self._worst(np.linalg.det, least=True)
        return f"in {self._place(worst.cell)}" if not worst.value > 0 else ""

    def explain(
        self,
        states: list[State],
        rest: State,
        critical: list[Critical],
        outcome: Outcome,
        inverted: str,
    ) -> str:
        """The reason of a failure in words; collective.

        Args:
            states: the last converged states; at the last one the scene is.
            rest: the state before any load.
            critical: where stability was lost before.
            outcome: how the last attempt ended.
            inverted: where it turned an element inside out.
        """
        causes = [
            *self._chamber(states, rest),
            *self._buckled(critical),
            *self._exhausted(),
            *self._squeezed(),
            *self._winding(),
        ]
        numeric = outcome.reason + (f" {inverted}" if inverted else "")
        if not causes:
            return f"numerical: {numeric}"
        return f"{'; '.join(causes)} ({numeric})"

    # --- causes --------------------------------------------------------------------------------

    def _chamber(self, states: list[State], rest: State) -> list[str]:
        """Ballooning, or collapse."""
        state, name = states[-1], measure("conjugate", PRESSURE)
        if name not in state.measures:
            return []
        ratio = state.measures[name] / rest.measures[name]
        falling = state.measures.get(measure("rate", PRESSURE), 1.0) < 0
        if ratio > SWOLLEN and (falling or softens(states, PRESSURE)):
            worst = self._worst(lambda f: np.linalg.norm(f, 2, axis=(1, 2)), least=False)
            return [
                f"ballooning: the chamber is {ratio:.2g} times its volume, the rubber stretched "
                f"{worst.value:.2g} times in {self._place(worst.cell)}"
            ]
        gap = self._gap()
        found = []
        if ratio < EMPTIED and state.scalars[PRESSURE] < 0:
            found.append(
                f"the chamber collapses under vacuum: {100 * ratio:.0f} % of its volume is left"
            )
        if gap is not None:
            found.append(f"opposite walls of the chamber meet: {gap:.2g} mm apart")
        return found

    def _gap(self) -> float | None:
        """Least distance in mm of opposite points of the chamber's wall, where they meet."""
        from scipy.spatial import KDTree

        body, data = self._scene.body, self._scene.domain.data
        if CHAMBER not in data.facets:
            return None
        nodes = np.intersect1d(self._scene.domain.surface_nodes(CHAMBER), body.owned_nodes)
        shown = min(body.components, data.nodes.shape[1])
        here = data.nodes[nodes].copy()
        moved = here.copy()
        moved[:, :shown] += body.w.x.array[body.node_dofs[nodes]][:, :shown]
        both = np.hstack([here, moved])
        both = np.concatenate(self._scene.domain.comm.allgather(both))
        here, moved = np.split(both, 2, axis=1)
        if data.half:
            flip = np.ones(here.shape[1])
            flip[0] = -1
            here, moved = np.vstack([here, flip * here]), np.vstack([moved, flip * moved])
        height = float(np.ptp(here[:, 1]))
        pairs = KDTree(moved).query_pairs(MEETING * height, output_type="ndarray")
        a, b = pairs.T
        across = np.linalg.norm(here[a] - here[b], axis=1) > height / 2
        if not np.any(across):
            return None
        return float(np.linalg.norm(moved[a] - moved[b], axis=1)[across].min())

    def _buckled(self, critical: list[Critical]) -> list[str]:
        """Stability lost at the last state, to a branch on which nothing rests nearby."""
        if not critical or critical[-1].kind != "bifurcation" or critical[-1].side:
            return []
        return ["buckling: beyond the state before, stability is lost to another branch"]

    def _squeezed(self) -> list[str]:
        """Rubber that leaves its place."""
        worst = self._worst(np.linalg.det, least=True)
        if worst.value > SQUEEZED:
            return []
        return [
            f"rubber is squeezed out: det F is down to {worst.value:.2g} in "
            f"{self._place(worst.cell)}"
        ]

    def _exhausted(self) -> list[str]:
        """Rubber near the limit of its law."""
        found = []
        for effect in self._scene.effects.values():
            if not isinstance(effect, Elastic) or effect.law.exhausted is None:
                continue
            law = effect.law
            for region, parameters in effect.regions.items():
                worst = self._worst(functools.partial(_used, law, parameters), False, region)
                if worst.value > EXHAUSTED:
                    found.append(
                        f"the rubber meets its limiting stretch ({law.name}): it has used "
                        f"{100 * worst.value:.3g} % of it in {self._place(worst.cell)}"
                    )
        return found

    def _winding(self) -> list[str]:
        """Fibers that carry nothing."""
        comm = self._scene.domain.comm
        for item in self._scene.discrete.values():
            if isinstance(item, FiberPotential) and item.thread and item.tension_only:
                lengths = np.array([item.length[item.slack].sum(), item.length.sum()])
                slack, whole = total(comm, lengths)
                if slack > SLACK * whole:
                    return [f"the winding is slack over {100 * slack / whole:.0f} % of its length"]
        return []

    # --- where ---------------------------------------------------------------------------------

    def _worst(
        self, of: Callable[[Floats], Floats], least: bool, region: str | None = None
    ) -> _Worst:
        """Extreme of a function of F, (n, 3, 3) to (n,), over the points of all ranks.

        Args:
            of: the function.
            least: its least value, or its greatest.
            region: only there; None: everywhere.
        """
        domain, body = self._scene.domain, self._scene.body
        if self._gradient is None:
            points = compat.quadrature_points(domain.data.cell_type, domain.degree)
            self._gradient = compat.PointValues(domain.mesh, body.F, points)
        values, cells = self._gradient(), domain.cells
        if region is not None:
            data = domain.data
            inside = data.cell_region[cells[: len(values)]] == data.regions[region]
            values, cells = values[inside], cells[: len(values)][inside]
        found = of(values.reshape(-1, 3, 3)).reshape(len(values), -1)
        sign = 1.0 if least else -1.0
        mine = (np.inf, -1)
        if found.size:
            by_cell = (sign * np.nan_to_num(found, nan=-sign * np.inf)).min(axis=1)
            cell = int(np.argmin(by_cell))
            mine = (float(by_cell[cell]), int(cells[cell]))
        value, cell = min(domain.comm.allgather(mine))
        return _Worst(sign * value, cell)

    def _place(self, cell: int) -> str:
        """Region and position of a cell of the mesh, and what is there."""
        data = self._scene.domain.data
        nodes = data.cells[cell]
        region = next(n for n, i in data.regions.items() if i == data.cell_region[cell])
        middle = data.nodes[nodes].mean(axis=0)
        if len(middle) == 3 and "section_tip" in data.facets:
            ends = [
                data.nodes[self._scene.domain.surface_nodes(name), 2].mean()
                for name in ("section_root", "section_tip")
            ]
            if not ends[0] < middle[2] < ends[1]:
                region += " of the root cap" if middle[2] < ends[0] else " of the tip cap"
        at = ", ".join(f"{axis} = {x:.3g}" for axis, x in zip("xyz", middle, strict=False))
        touched = [
            text
            for name, text in WHERE.items()
            if name in data.facets and np.isin(nodes, data.facet_nodes(name)).any()
        ]
        return " ".join([f"the {region}", *touched, f"at {at} mm"])


def _used(law: Law, parameters: dict[str, float], f: Floats) -> Floats:
    """Part of the limiting stretch of a law that deformations F have used, (n, 3, 3) to (n,)."""
    assert law.exhausted is not None
    stretches = np.linalg.svd(f, compute_uv=False)
    stretches /= np.cbrt(np.prod(stretches, axis=1))[:, None]
    used: Floats = law.exhausted(Stretches(*stretches.T), **parameters)
    return used

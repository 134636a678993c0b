"""How stiff a section is against shear while a pressure bends it: by the tangent of its slice.

About a state of uniform bending, stretch λ and curvature k vary along z by forces across the
section: N' = −k V and M' = λ V, so that (λ, k)' = K⁻¹ (−k, λ) V. What is in the section then is
linear in z: u₁ z in its plane, by which (λ, k)' strain it, and a warping w out of it for which

    E w = L (λ, k)' + (Cᵀ − C) u₁.

E, C, M and L are second derivatives of the energy by displacements and their slopes along z, taken
from a slice one element long whose nodes move so. Where no moment acts the energy is ½ V²/GA with

    1/GA = w·E w + 2 w·C u₁ + u₁·M u₁,

which without pressure is that of `fiberbend.beam.flexibility`. In a stressed section the middle
term hangs on what is reckoned to whom of a slice; with the equation for w it is

    1/GA = 2 w·(L (λ, k)' + Cᵀ u₁) − w·E w + u₁·M u₁.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import splu

from fem.kinematics.uniform import CURVATURE, STRETCH
from fem.matrix import whole
from fiberbend.calibration.calibrate import waits
from fiberbend.case.case import Case
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.sectionlaw.states.held import Held, HeldState
from fiberbend.trial.calibrations import Calibrations
from fiberbend.trial.solve import solve
from fiberbend.trial.wanted import Wanted
from rod.functions import Floats, Ints

_BENT = 0.5
"""Part of the free curvature at which the section is taken: a rod is between free and straight."""
_ROUNDS, _CLOSE = 12, 1e-8
_AXIAL = 100.0
"""Of the elements, mm: one is as long as the slice."""
_SMALL = 1e-9
"""Of a compliance to pressure, mm²/N: what no volume asks for takes none."""
_SAME = 6
"""Digits by which nodes of a slice are above each other, mm."""
_ON = 1e-9
"""Part of the section by which nodes are on its mirror line."""


def shear_stiffness(case: Case, pressures: Sequence[float]) -> Floats:
    """GA in the plane of bending at pressures, and before them at rest, (n + 1,), N.

    Args:
        case: of model section, of a section that keeps to its plane.
        pressures: MPa, rising.

    Raises:
        CaseError: the section has no such state.
    """
    answer = solve(case, Wanted(pressures=tuple(pressures)))
    if not answer.converged:
        raise CaseError([Problem("effects.pressure", f"no such free state: {answer.reason}")])
    ready = Calibrations().ready(case).case if waits(case) else case
    mesh = ready.mesh.model_copy(update={"section": 1, "axial": _AXIAL})
    held = Held(ready.model_copy(update={"model": "cell", "mesh": mesh}), (STRETCH, CURVATURE))
    found = [_stiffness(held, held.rest)]
    length, state = case.actuator.length, held.rest
    for point in answer.free:
        state = _unpulled(held, state, _BENT * point.angle / length, point.pressure)
        found.append(_stiffness(held, state))
    return np.array(found)


def _unpulled(held: Held, state: HeldState, curvature: float, pressure: float) -> HeldState:
    """The state without force along the line."""
    at = np.array([state.at[0], curvature, pressure])
    for _ in range(_ROUNDS):
        found = held.along(state, at)
        if found is None:
            break
        state, step = found, -found.slopes[0] / found.second[0, 0]
        if abs(step) < _CLOSE:
            return state
        at = at + np.array([step, 0.0, 0.0])
    text = f"no state of the section at {1e3 * pressure:.6g} kPa and {1e3 * curvature:.6g} 1/m"
    raise CaseError([Problem("effects.pressure", text)])


def _stiffness(held: Held, state: HeldState) -> float:
    """GA at a state, N."""
    own = _Slice(held, state)
    rates = np.zeros_like(own.pulls)
    rates[own.within] = own.solved(own.within, -own.pulls[own.within])
    turn = np.array([-own.curvature, own.stretch])
    varied = np.linalg.solve(own.stiffness + own.pulls.T @ rates, turn)
    u = rates @ varied
    moved = u[: own.m.shape[0]]
    carried = (own.slopes @ varied + own.c.T @ u)[own.across]
    right = carried - (own.c @ moved)[own.across]
    warping = own.solved(own.across, right)
    return 1 / float(2 * warping @ carried - warping @ right + moved @ (own.m @ moved))


class _Slice:
    """Second derivatives of the energy per length by what a section does, and its slope along z.

    A node of the slice moves by a + z b, z from its middle, where a and b are those of the column
    of nodes it is in: so a matrix of the slice gives E by a, C by both, and M by b.

    Args:
        held: sections whose stretch and curvature are held.
        state: one of them.

    Attributes:
        e: E by a and the pressures in the rubber.
        c: C by them and by b.
        m: M by b.
        pulls: R by λ and k, (·, 2).
        slopes: L by λ and k, (·, 2).
        stiffness: by λ and k alone, (2, 2).
        stretch: λ of the line on which forces and moments are.
        curvature: k, rad/mm.
        within: places of what moves in the plane of the section, and of the pressures.
        across: places of what moves out of it.
    """

    def __init__(self, held: Held, state: HeldState) -> None:
        small = held.small
        scene = small.scene
        small.conditions(state.state, "value", float(state.at[-1]))
        scene.residual()
        matrix = whole(scene.assemble_tangent(free=np.ones_like(scene.free)))
        body, data = scene.body, scene.domain.data
        height = data.nodes[:, 2] - np.mean([data.nodes[:, 2].min(), data.nodes[:, 2].max()])
        places, column = np.unique(np.round(data.nodes[:, :2], _SAME), axis=0, return_inverse=True)
        column = column.ravel()
        nodes = body.node_dofs.ravel()
        moved = (3 * column[:, None] + np.arange(3)).ravel()
        count, size = 3 * len(places), matrix.shape[0]
        others = np.setdiff1d(np.arange(size), nodes)
        rows = np.concatenate([nodes, others])
        columns = np.concatenate([moved, count + np.arange(len(others))])
        ones = csr_matrix((np.ones(len(rows)), (rows, columns)), (size, count + len(others)))
        lever = csr_matrix((np.repeat(height, 3), (nodes, moved)), (size, count))
        part = body.symmetry_factor / held.length
        slack = diags(np.where(np.arange(ones.shape[1]) < count, 0.0, -_SMALL))
        self.e = part * (ones.T @ matrix @ ones)
        self.c = part * (ones.T @ matrix @ lever)
        # a moves with z too: what is left of E by b
        twice = np.ptp(height) ** 2 / 12 * self.e[:count, :count]
        self.m = part * (lever.T @ matrix @ lever) - twice
        self.e = (self.e + slack).tocsr()
        names = (STRETCH, CURVATURE)
        loads = part * np.array([scene.load(name, constrained=True) for name in names]).T
        self.pulls, self.slopes = ones.T @ loads, lever.T @ loads
        self.stiffness = part * np.array(
            [[scene.second_derivative(one, other) for other in names] for one in names]
        )
        self.stretch, self.curvature = (scene.scalar(name) for name in names)
        pin = int(column[data.points["pin"]])
        middle = np.flatnonzero(np.abs(places[:, 0]) < _ON * np.abs(places).max())
        fixed = [*(3 * middle), 3 * pin + 1, 3 * pin + 2]
        free = np.setdiff1d(np.arange(ones.shape[1]), fixed)
        out = (free < count) & (free % 3 == 2)
        self.within, self.across = free[~out], free[out]

    def solved(self, places: Ints, right: Floats) -> Floats:
        """E⁻¹ of what is given at some places."""
        found: Floats = splu(self.e[places][:, places].tocsc()).solve(right)
        return found

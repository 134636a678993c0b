"""Body and fibers in space, of any model: a section extruded, a cell repeated, a body as it is."""

from __future__ import annotations

import functools

import numpy as np

from fiberbend.case.case import Case
from fiberbend.case.symmetry import twists
from fiberbend.models.section import picture_layers
from fiberbend.states.halves import Halves
from fiberbend.states.recovery import NodalFields, SplitNodes, recover, split_nodes
from fiberbend.states.snapshot import ModelMesh, Snapshot
from fiberbend.states.stack import Stack, extruded, repeated, split_alike
from geometry.mesh.data import Floats

_SHORT = 1e-3
"""Part of the length that a picture may lack or have beyond without a word."""


class Space:
    """The length between the ends of the chamber in space; of a body all of it.

    Args:
        case: the case.
        own: mesh, materials and fibers as the model solves them.
        both: add the mirror image in x = 0 of a body of which half is modelled.

    Attributes:
        own: as given.
        length: of the chamber at rest, mm; whole slices come only near to it.
        stack: what the section or cell becomes; None for a body.
        halves: the half in space and its mirror image; None where there is no image.
    """

    def __init__(self, case: Case, own: ModelMesh, both: bool = False) -> None:
        self.own, self.length = own, case.actuator.length
        self.stack = _whole(case, own) if own.uniform else None
        one = own if self.stack is None else self.stack.model_mesh
        self.halves = Halves(one) if both and one.mesh.half else None
        self._one = one

    @property
    def model_mesh(self) -> ModelMesh:
        """Mesh, materials and fibers in space."""
        return self._one if self.halves is None else self.halves.model_mesh

    @property
    def in_slices(self) -> str:
        """What a picture has to say of its length, after a comma; empty where that is the whole."""
        drawn = float(np.ptp(self._one.mesh.nodes[:, 2]))
        if self.stack is None or abs(drawn - self.length) < _SHORT * self.length:
            return ""
        return f", in whole slices: {drawn:.4g} of {self.length:.4g} mm"

    def snapshot(self, state: Snapshot) -> Snapshot:
        """A state of the model as one of the body in space."""
        one = state if self.stack is None else self.stack.snapshot(self.own, state)
        return one if self.halves is None else self.halves.snapshot(one)

    def recovered(self, state: Snapshot) -> NodalFields:
        """Fields of a state at the nodes of its own mesh, copies where regions meet."""
        return recover(self.own, state, self._copies)

    def fields(self, state: Snapshot, recovered: NodalFields | None = None) -> NodalFields:
        """Fields of a state at the nodes in space, as `split_nodes` of that mesh copies them.

        Args:
            state: of the model's own mesh.
            recovered: `recovered` of it, if at hand.
        """
        one = recovered or self.recovered(state)
        if self.stack is not None:
            one = self.stack.fields(self.own, self._copies, one, state)
        return one if self.halves is None else self.halves.fields(one)

    def at_cells(self, state: Snapshot, recovered: NodalFields | None = None) -> Floats:
        """Maximum principal logarithmic strain at the nodes of every cell in space, (m, k)."""
        recovered = recovered or self.recovered(state)
        values: Floats = recovered.log_strain[self._copies.cells]
        if self.stack is not None:
            values = self.stack.at_cells(values)
        return values if self.halves is None else self.halves.at_cells(values)

    @functools.cached_property
    def _copies(self) -> SplitNodes:
        return split_alike(self.own.mesh) if self.own.uniform else split_nodes(self.own.mesh)


def is_section(own: ModelMesh) -> bool:
    """Whether a mesh is a cross-section, not a slice or a body."""
    return own.mesh.cell_type == "quadrilateral"


def _whole(case: Case, own: ModelMesh) -> Stack:
    """The whole length; a cell's as near as whole slices come."""
    length = case.actuator.length
    if not is_section(own):
        return repeated(own, max(1, round(length / float(np.ptp(own.mesh.nodes[:, 2])))))
    turned = own.mesh.half and twists(case)
    return extruded(own, length, picture_layers(case), turned=turned)

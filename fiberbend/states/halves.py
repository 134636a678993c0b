"""A half body in space with its mirror image in the plane x = 0."""

from __future__ import annotations

import dataclasses
import functools
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fiberbend.states.recovery import NodalFields, SplitNodes, split_nodes
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Ints
from geometry.mesh.mirror import (
    BothHalves,
    both_halves,
    facet_images,
    reflect,
    reflected_vectors,
)
from geometry.winding.segments import EmbeddedFibers

T = TypeVar("T", bound=np.generic)

_ACROSS = (-1.0, 1.0, 1.0)


class Halves:
    """Both halves of a body of which one is modelled.

    Args:
        half: mesh, materials and fibers of the half.

    Attributes:
        model_mesh: those of the whole body.

    Raises:
        ValueError: the body is whole.
    """

    def __init__(self, half: ModelMesh) -> None:
        self._half = half
        self._whole: BothHalves = both_halves(half.mesh)
        self._segment: Ints | None = None
        fibers = None
        if half.lines is not None:
            self._segment, fibers = _both_windings(half, half.lines)
        self.model_mesh = dataclasses.replace(half, mesh=self._whole.mesh, fibers=fibers)

    def snapshot(self, state: Snapshot) -> Snapshot:
        """A state of the half as one of the whole: (u, v, w) becomes (−u, v, w) in its image."""
        force, segment = state.fiber_force, self._segment
        sign = np.where(self._whole.image[:, None], _ACROSS, 1.0)
        return dataclasses.replace(
            state,
            displacement=state.displacement[self._whole.node] * sign,
            multiplier=self.at_cells(state.multiplier),
            fiber_force=None if force is None or segment is None else force[segment],
        )

    def fields(self, fields: NodalFields) -> NodalFields:
        """Recovered fields of the half as those of the whole, as `split_nodes` copies its nodes.

        The stress σ becomes M σ M with M = diag(−1, 1, 1): σxy and σxz change sign, and vanish in
        the mirror plane.

        Args:
            fields: of the half, as `split_nodes` copies its nodes.
        """
        whole, source = self._whole, self._source
        stress = fields.cauchy[source]
        shear = np.where(whole.image, -1.0, np.where(whole.plane, 0.0, 1.0))
        shear = shear[self._copies.node]
        stress[:, 0, 1:] *= shear[:, None]
        stress[:, 1:, 0] *= shear[:, None]
        return NodalFields(
            jacobian=fields.jacobian[source],
            stretches=fields.stretches[source],
            cauchy=stress,
            multiplier=fields.multiplier[source],
            volume_error=fields.volume_error[whole.cell],
        )

    def at_cells(self, values: NDArray[T]) -> NDArray[T]:
        """Values at the nodes of every cell of the whole from those of the half, (m, k, ...)."""
        found: NDArray[T] = values[self._whole.cell[:, None], self._whole.order]
        return found

    @functools.cached_property
    def _copies(self) -> SplitNodes:
        return split_nodes(self._whole.mesh)

    @functools.cached_property
    def _source(self) -> Ints:
        """The copy of a node of the half that each copy of the whole is an image of."""
        source = np.empty(len(self._copies.node), dtype=np.int64)
        cells = self.at_cells(split_nodes(self._half.mesh).cells)
        source[self._copies.cells.ravel()] = cells.ravel()
        return source


def _both_windings(model_mesh: ModelMesh, fibers: EmbeddedFibers) -> tuple[Ints, EmbeddedFibers]:
    """Segments of both halves, sorted by curve and z, and what each one is an image of.

    The image of a right-handed helix is left-handed: of a double helix, line j of helix h goes on
    as line j of helix 1 − h. The images of other windings get numbers of their own.
    """
    half = model_mesh.mesh
    kind, count = half.cell_type, len(fibers.cell)
    lines = round(1 / float(fibers.share[0]))
    curves = int(fibers.curve.max()) + 1
    double = curves == 2 * lines
    other = (fibers.curve + lines) % curves if double else fibers.curve + curves
    image = dataclasses.replace(
        fibers,
        cell=fibers.cell + len(half.cells),
        facet=facet_images(kind)[fibers.facet],
        points=reflect(kind, fibers.points),
        tangents=reflected_vectors(kind, fibers.tangents),
        curve=other,
        s=-fibers.s,
        family=model_mesh.images(fibers.family),
    )
    both = {
        field.name: np.concatenate([getattr(fibers, field.name), getattr(image, field.name)])
        for field in dataclasses.fields(fibers)
    }
    order = np.lexsort((both["z"], both["curve"]))
    sorted_fibers = EmbeddedFibers(**{name: values[order] for name, values in both.items()})
    return np.tile(np.arange(count), 2)[order], sorted_fibers

"""Strain and stress at the points of the surfaces that the page of a run draws."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fiberbend.drawing.page import nice_above
from fiberbend.states.recovery import SplitNodes, recover
from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.mesh.data import Floats, Ints

_STRESS = ("stress", "von Mises stress (MPa)", 4)
"""Name, label, and powers of ten of a logarithmic scale or 0: floor and sheath differ in stress by
a factor of a thousand."""
_TOP = 255
_QUANTILE = 0.995
"""The colours end short of single peaks, as those of the pictures do."""


class Fields:
    """Quantities as numbers from 0 to 255; each surface has its own greatest value.

    Args:
        own: the model's own mesh.
        nodes: of the recovered fields.
        surfaces: of each surface, place of every point among the recovered fields, and the places
            that are seen from the side.

    Attributes:
        quantities: name, label, and powers of ten of a logarithmic scale or 0, in the order of all
            lists.
    """

    def __init__(
        self, own: ModelMesh, nodes: SplitNodes, surfaces: Sequence[tuple[Ints, Ints]]
    ) -> None:
        self._own, self._nodes, self._surfaces = own, nodes, surfaces
        strain = ("strain", own.strain_named, 0)
        self.quantities = (strain,) if own.carried else (strain, _STRESS)

    def at(self, state: Snapshot) -> list[Floats]:
        """The quantities of a state at all recovered nodes."""
        found = recover(self._own, state, self._nodes)
        both = (found.log_strain, found.von_mises)[: len(self.quantities)]
        # between the points at which an extreme state was solved there may be no stress
        return [np.nan_to_num(values) for values in both]

    def tops(self, values: Sequence[Sequence[Floats]]) -> list[list[float]]:
        """What 255 stands for, of each surface and quantity: the most of all steps that is seen.

        On a logarithmic scale it is the same for all surfaces, a power of ten.

        Args:
            values: of every step, as `at` gives them.
        """
        found = [
            [
                nice_above(max(float(np.quantile(step[i][seen], _QUANTILE)) for step in values))
                for i in range(len(self.quantities))
            ]
            for _, seen in self._surfaces
        ]
        for i, (_, _, powers) in enumerate(self.quantities):
            if powers:
                most = 10.0 ** np.ceil(np.log10(max(tops[i] for tops in found)))
                for tops in found:
                    tops[i] = float(most)
        return found

    def scaled(
        self, values: Sequence[Sequence[Floats]], number: int, tops: Sequence[float]
    ) -> list[NDArray[np.uint8]]:
        """Each quantity at the points of a surface in all steps, (steps, n).

        Args:
            values: of every step, as `at` gives them.
            number: of the surface.
            tops: what 255 stands for, of each quantity.
        """
        place, found = self._surfaces[number][0], []
        for i, (top, (_, _, powers)) in enumerate(zip(tops, self.quantities, strict=True)):
            share = np.stack([step[i][place] for step in values]) / top
            if powers:
                share = 1 + np.log10(np.maximum(share, 10.0**-powers)) / powers
            found.append(np.rint(np.clip(share, 0, 1) * _TOP).astype(np.uint8))
        return found

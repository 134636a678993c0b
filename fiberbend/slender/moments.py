"""Integrals over a section, by its mesh: what caps and masses follow from."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from fiberbend.case import convert
from fiberbend.case.case import Case
from geometry.bodies.quads import section_mesh
from geometry.mesh.centroid import winding_weights
from geometry.mesh.data import MeshData
from geometry.mesh.reference import cell_rule, shape_functions
from geometry.sections.size import MeshSize
from geometry.sections.table import section_layout
from rod.functions import Floats

_FINE = 3
"""Quads of second order through a thickness: moments of arcs to 1e-6."""


@dataclasses.dataclass(frozen=True)
class Section:
    """∫ (x, y, 1) ⊗ (x, y, 1) dA of each region about the line of centroids.

    Attributes:
        height: y of the line, the centroid of all inside the winding, mm.
        hollow: between the caps, (3, 3) by region; mm⁴, mm³ and mm².
        filled: in the caps.
        fourth: the same of four factors, in the caps, (3, 3, 3, 3) by region.
        mesh: of the section in the caps.
    """

    height: float
    hollow: Mapping[str, Floats]
    filled: Mapping[str, Floats]
    fourth: Mapping[str, Floats]
    mesh: MeshData


def section_of(case: Case) -> Section:
    """The moments of a case's section."""
    actuator = convert.dimensions(case.actuator)
    layout = section_layout(actuator, MeshSize(section=_FINE, half=False))
    mesh = section_mesh(layout)
    (_, height) = winding_weights(section_mesh(layout.without_fill()))[1].tolist()
    points, weights = cell_rule("quadrilateral")
    values, slopes = shape_functions("quadrilateral", points)
    nodes = mesh.nodes[mesh.cells] - [0.0, height]
    places = np.einsum("qa,cai->cqi", values, nodes)
    area = np.linalg.det(np.einsum("qaj,cai->cqij", slopes, nodes)) * weights
    arms = np.concatenate([places, np.ones((*places.shape[:2], 1))], axis=2)
    each = np.einsum("cq,cqi,cqj->cij", area, arms, arms)
    counts = [block.divisions[0] * block.divisions[1] for block in layout.blocks]
    fill = np.repeat([block.fill for block in layout.blocks], counts)
    found: list[dict[str, Floats]] = [{}, {}]
    for sums, there in zip(found, (~fill, np.full(len(fill), True)), strict=True):
        for name, number in mesh.regions.items():
            sums[name] = each[there & (mesh.cell_region == number)].sum(axis=0)
    higher = np.einsum("cq,cqi,cqj,cqk,cql->cijkl", area, *[arms] * 4)
    fourth = {
        n: higher[mesh.cell_region == number].sum(axis=0) for n, number in mesh.regions.items()
    }
    return Section(height, found[0], found[1], fourth, mesh)


def weighed(parts: Mapping[str, Floats], by: Mapping[str, float]) -> Floats:
    """Σ of the regions, each times a number of its own, (3, 3)."""
    return np.sum([by[name] * part for name, part in parts.items()], axis=0)

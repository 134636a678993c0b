"""What a state of a run hands to files and pictures: plain arrays, free of the solver."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import IO

import numpy as np

from fiberbend.states.labels import short_number
from geometry.mesh.data import Floats, Ints, MeshData
from geometry.winding.segments import EmbeddedFibers
from materials.material import Material

Target = Path | IO[bytes]
"""A path, or a file open for writing bytes."""

Write = Callable[[str, Callable[[IO[bytes]], object]], None]
"""Takes a name and a function that fills the file of that name, as `RunFolder.write` does."""


@dataclasses.dataclass(frozen=True)
class FamilyLook:
    """How pictures tell a family of threads from others.

    Attributes:
        name: its angle and hand.
        image: number of the family that its mirror image is; its own where there is none.
    """

    name: str
    image: int


@dataclasses.dataclass(frozen=True)
class ModelMesh:
    """What all states of a run share.

    Attributes:
        mesh: hexahedra or tetrahedra of the body; of a section quadrilaterals, of a cell a slice.
        materials: material of each region.
        fibers: segments of the winding, or None without one.
        smeared: True when the segments stand for a membrane and form no lines.
        title: title of the case.
        uniform: the mesh is a section or a slice that goes on alike along the axis; its states are
            given in the turning frame.
        families: of the winding, by the numbers that its segments have; empty where pictures do not
            tell them apart.
        carried: sections are those at rest, carried along by a line: what is strained is that along
            the axis, and no stress is known.

    Raises:
        ValueError: a region without material, or a section that is taken for a solid.
    """

    mesh: MeshData
    materials: Mapping[str, Material]
    fibers: EmbeddedFibers | None
    smeared: bool
    title: str
    uniform: bool = False
    families: tuple[FamilyLook, ...] = ()
    carried: bool = False

    @property
    def strain_named(self) -> str:
        """What its strain is, as pictures call it."""
        if self.carried:
            return "logarithmic strain along the axis, of sections as at rest"
        return "maximum principal logarithmic strain"

    def __post_init__(self) -> None:
        if self.mesh.nodes.shape[1] != 3 and not self.uniform:
            raise ValueError("the mesh of a section is no body in space: expected a solid")
        bare = sorted(set(self.mesh.regions) - set(self.materials))
        if bare:
            raise ValueError(f"region {bare[0]!r} has no material")

    @property
    def lines(self) -> EmbeddedFibers | None:
        """The segments that form lines, or None."""
        return None if self.smeared else self.fibers

    def images(self, family: Ints) -> Ints:
        """Families of the mirror images of threads, by those of the threads, (n,)."""
        if not self.families:
            return family
        found: Ints = np.array([look.image for look in self.families])[family]
        return found


@dataclasses.dataclass(frozen=True)
class Snapshot:
    """One converged state of n nodes and m cells with k nodes each.

    Attributes:
        label: short name for files, such as "90deg"; letters, digits, ".", "-" and "_".
        step: number of the load step.
        pressure_kpa: chamber pressure in kPa.
        angle_deg: bending angle in degrees.
        displacement: by input node number, (n, 3), mm.
        multiplier: p of W = ψ(Ī1, Ī2) + p (J − 1) at the nodes of each cell, (m, k), MPa.
        fiber_force: axial force of each segment, (segments,), N, or None without a winding.
        curvature: k of a model of uniform bending, 1/mm; its displacement, (n, 2) or (n, 3), has
            components in the frame that turns with the section.
        stretch: λ0 of the axis there.
        twist: τ there, rad/mm.
        side_curvature: of the section's own y there, 1/mm.
        remark: what every picture of it has to say, such as that the body passes through itself;
            empty where there is nothing.

    Raises:
        ValueError: a label that no file can bear.
    """

    label: str
    step: int
    pressure_kpa: float
    angle_deg: float
    displacement: Floats
    multiplier: Floats
    fiber_force: Floats | None
    curvature: float = 0.0
    stretch: float = 1.0
    twist: float = 0.0
    side_curvature: float = 0.0
    remark: str = ""

    def __post_init__(self) -> None:
        if not self.label or not all(c.isalnum() or c in ".-_" for c in self.label):
            raise ValueError(f"label {self.label!r}: expected letters, digits, '.', '-' or '_'")

    @property
    def caption(self) -> str:
        """Pressure and angle in words."""
        return f"P = {short_number(self.pressure_kpa)} kPa,  θ = {short_number(self.angle_deg)}°"

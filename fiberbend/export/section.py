"""The section of a case as other programs take it: rest strains and stiffness by pressure."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import numpy as np

from fiberbend.export.ends import Caps
from rod.functions import Floats
from rod.inertia import SectionMass

STRAINS = ("stretch", "curvature", "side_curvature", "twist")
"""Of a line of the section, as `rod.layout` names them: λ, k_x, k_y and τ."""
_STRETCH, _BEND, _SIDE = 0, 1, 2


@dataclasses.dataclass(frozen=True)
class Section:
    """States without load and the stiffness about them, by the line of the centroids.

    Attributes:
        pressures: MPa, (n,), from the least one on.
        rest: strains at which no force acts, (n, 4), 1 and rad/mm.
        stiffness: second derivatives of the energy per length there, (n, 4, 4): N, N mm, N mm².
        areas: of the chamber at rest, (n,), mm²; its volume per length.
    """

    pressures: Floats
    rest: Floats
    stiffness: Floats
    areas: Floats

    def __post_init__(self) -> None:
        n = len(self.pressures)
        if self.rest.shape != (n, 4) or self.stiffness.shape != (n, 4, 4):
            raise ValueError(f"{n} states of four strains expected, not {self.rest.shape}")
        if np.any(np.diff(self.pressures) <= 0):
            raise ValueError("pressures: in rising order expected")


@dataclasses.dataclass(frozen=True)
class Axis:
    """The section by a line through its elastic centre, where stretch and bending part.

    A program that has no coupling of force and curvature loses little by that line: of stiff
    floors it lies far from the centroids and hardly moves with the pressure. Bending and twisting
    stiffness are those of a line on which no force acts: exact for what is not held at both ends.

    Attributes:
        x, y: of the line, from the line of the centroids, mm.
        pressures: MPa, (n,).
        rest: strains of this line without load, (n, 4).
        axial: stiffness against stretch, (n,), N.
        bending: against curvatures and twist, (n, 3, 3), N mm².
        off: greatest distance of the elastic centre from the line, mm: a force along the line
            bends as if it acted so far beside.
        twisted: greatest square of the coupling of stretch with twist, which no line takes away,
            in parts of both stiffnesses.
    """

    x: float
    y: float
    pressures: Floats
    rest: Floats
    axial: Floats
    bending: Floats
    off: float
    twisted: float

    @property
    def diagonal(self) -> Floats:
        """Bending, side bending and twisting stiffness, each alone, (n, 3), N mm².

        The others are free: a moment about one axis turns the section by itself over this.
        """
        compliance = np.linalg.inv(self.bending)
        out: Floats = 1.0 / np.diagonal(compliance, axis1=1, axis2=2)
        return out

    @property
    def mixed(self) -> float:
        """Greatest square of a coupling of curvatures and twist, in parts of both stiffnesses."""
        return _greatest(self.bending)


def axis_of(section: Section) -> Axis:
    """The line of a section on which a force bends it least, over all pressures."""
    x, y = (float(part.max() + part.min()) / 2 for part in _centres(section))
    return about(section, x, y)


def _centres(section: Section) -> tuple[Floats, Floats]:
    """x and y of the elastic centre from the centroids, (n,) each, mm."""
    pull = section.stiffness[:, _STRETCH]
    # λ = λ' − y k_x + x k_y for a line at x, y
    return -pull[:, _SIDE] / pull[:, _STRETCH], pull[:, _BEND] / pull[:, _STRETCH]


def about(section: Section, x: float, y: float) -> Axis:
    """A section by the line at x, y from the centroids, mm."""
    turn = np.eye(4)
    turn[_STRETCH, _BEND], turn[_STRETCH, _SIDE] = -y, x
    stiffness = turn.T @ section.stiffness @ turn
    axial, coupling = stiffness[:, 0, 0], stiffness[:, 0, 1:]
    bending = stiffness[:, 1:, 1:]
    centre_x, centre_y = _centres(section)
    parts = coupling[:, :, None] * coupling[:, None, :] / axial[:, None, None]
    return Axis(
        x=x,
        y=y,
        pressures=section.pressures,
        rest=np.linalg.solve(turn, section.rest.T).T,
        axial=axial,
        bending=bending - parts,
        off=float(np.hypot(centre_x - x, centre_y - y).max()),
        twisted=float((coupling[:, 2] ** 2 / (axial * bending[:, 2, 2])).max()),
    )


def _greatest(matrices: Floats) -> float:
    own = np.diagonal(matrices, axis1=1, axis2=2)
    square = matrices**2 / (own[:, :, None] * own[:, None, :])
    return float((square * (1 - np.eye(matrices.shape[1]))).max())


@dataclasses.dataclass(frozen=True)
class Handed:
    """All that is handed over.

    Attributes:
        section: of the chamber.
        cap: stiffness of a solid cap about its line of centroids, (4, 4).
        mass: of the chamber's section; None where it is not known.
        cap_mass: of a cap's.
        no_mass: what to write so that masses are known; empty where they are.
        length: of the chamber, mm.
        cap_length: of each cap, mm.
        outline: outer line of the section, (k, 2), from the centroids, mm.
        caps: what they make of the chamber's ends.
        about: provenance, law, range and errors, as the file has them.
        retardation: τ of Kelvin and Voigt, s; 0: no damping is known.
        shear: stiffness of the chamber against shear along x and y by the pressure, (n, 2), N.
        cap_shear: of a cap, (2,), N.
        shear_centre: y of the centre of shear from the centroids, mm.
    """

    section: Section
    cap: Floats
    mass: SectionMass | None
    cap_mass: SectionMass | None
    no_mass: str
    length: float
    cap_length: float
    outline: Floats
    caps: Caps
    shear: Floats
    cap_shear: Floats
    shear_centre: float
    about: Mapping[str, object]
    retardation: float = 0.0

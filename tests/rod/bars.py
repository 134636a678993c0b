"""Bars whose stiffness and inertia are known in closed form; mm, N, MPa, t, s."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from rod.functions import Floats
from rod.inertia import SectionMass, spread
from rod.law import Linear
from rod.layout import STRAINS, Layout
from rod.loads import NO_LOAD, TipForce, TipMoment, Vector, Weight
from rod.rod import Rod
from rod.term import Term

PLANE = ("stretch", "curvature")
SPACE = STRAINS[2:]
DOWN = (0.0, -9810.0, 0.0)


@dataclasses.dataclass(frozen=True)
class Bar:
    """A straight bar of a rectangular section of linear rubber, ν = ½.

    Attributes:
        length: L, mm.
        width: along x, mm.
        height: along y, mm.
        young: E, MPa.
        density: ρ, t/mm³.
    """

    length: float = 120.0
    width: float = 16.0
    height: float = 10.0
    young: float = 1.0
    density: float = 1.1e-9

    @property
    def area(self) -> float:
        """mm²."""
        return self.width * self.height

    @property
    def second(self) -> float:
        """∫ Y² dA, mm⁴."""
        return self.width * self.height**3 / 12

    @property
    def side(self) -> float:
        """∫ X² dA, mm⁴."""
        return self.height * self.width**3 / 12

    @property
    def shear(self) -> float:
        """GA by 5/6 of the area, N."""
        return self.young / 3 * self.area * 5 / 6

    def stiffnesses(self) -> dict[str, float]:
        """Of every strain, N and N mm²."""
        return {
            "shear_x": self.shear,
            "shear_y": self.shear,
            "stretch": self.young * self.area,
            "curvature": self.young * self.second,
            "side_curvature": self.young * self.side,
            "twist": self.young / 3 * 0.2 * self.width * self.height**3,
        }

    def mass(self) -> SectionMass:
        """Of a section, its rotary inertia too."""
        second = (self.density * self.side, self.density * self.second, 0.0)
        return SectionMass(self.density * self.area, second=second)

    def layout(self, pieces: int, strains: tuple[str, ...] = PLANE) -> Layout:
        """Equal pieces."""
        return Layout(np.full(pieces, self.length / pieces), strains)

    def law(self, strains: tuple[str, ...]) -> Linear:
        """Of its strains, unstrained where it is straight."""
        stiffness = np.diag([self.stiffnesses()[name] for name in strains])
        rest = np.array([1.0 if name == "stretch" else 0.0 for name in strains])
        return Linear(stiffness, rest)

    def rod(
        self,
        pieces: int,
        strains: tuple[str, ...] = PLANE,
        tip: Sequence[Term] = (),
        gravity: tuple[float, float, float] = DOWN,
    ) -> Rod:
        """The bar as a rod: its first term is its weight."""
        layout = self.layout(pieces, strains)
        masses = spread(layout, [self.mass()])
        return Rod(layout, self.law(strains), masses, (Weight(masses, gravity), *tip))


def both(
    force: Vector,
    moment: Vector,
    follows: bool = False,
    arm: Vector = NO_LOAD,
) -> tuple[Term, Term]:
    """A force and a moment at the tip."""
    return TipForce(force, follows, arm), TipMoment(moment, follows)


def bent(layout: Layout, seed: int = 1, most: float = 0.3) -> Floats:
    """Strains of a rod that is bent at random: stretches by `most`, angles of pieces too."""
    rng = np.random.default_rng(seed)
    turning = np.array(["curvature" in name or name == "twist" for name in layout.strains])
    each = np.where(turning, 1 / layout.lengths[:, None], 1.0)
    return layout.at_rest() + most * rng.uniform(-1, 1, layout.shape) * each

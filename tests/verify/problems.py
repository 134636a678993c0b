"""The exact solutions that are climbed."""

from __future__ import annotations

import dataclasses
import math
from typing import ClassVar

import numpy as np

from fem.effects.chamber_pressure import ChamberPressure
from fem.effects.effect import Effect
from fem.effects.supports import Symmetry
from fem.effects.winding import SmearedWinding
from fem.kinematics.domain import Domain
from fem.scene import Scene
from fem.solver.newton import Newton, Outcome
from geometry.mesh.data import MeshData
from materials.material import Material
from tests.exact.solids import box, cylinder, tube_sector
from tests.exact.solutions import Flexure, LayeredTube, Torsion, Tube, closed_tube, wound_tube
from tests.verify.hoops import hoops
from tests.verify.ladder import (
    YEOH,
    Ladder,
    VolumeRatio,
    balanced_pressure,
    end_load,
    volume_at_rest,
)

LAW = Material("yeoh", YEOH).principal
SOFT = {"c1": 0.0011, "c2": 0.0002}
SOFT_LAW = Material("yeoh", SOFT).principal
ORIGIN = np.zeros(3)
HOOPS = 1e6
"""EA of hoops that all but cannot stretch, N; they move p by 2e-6."""


class TubeLadder(Ladder):
    """A quarter of a tube 8/10 mm, 2 mm long, inflated to a/A = 1.25."""

    title = "Thick tube, plane strain"
    text = (
        "A = 8, B = 10, a/A = 1.25. A quarter, 2 mm long; the cavity's volume is given and the "
        "pressure found."
    )
    levels: ClassVar = {"hexahedron": (1, 2, 4), "tetrahedron": (1, 2, 4)}
    reference: ClassVar = {"p [MPa]": (0.02710791, 3e-6)}
    exact = Tube(LAW, 8.0, 10.0, 10.0)
    length = 2.0

    def mesh(self, n: int) -> MeshData:
        """n elements through the wall, 4 n around the quarter."""
        return tube_sector(8.0, 10.0, math.pi / 2, self.length, (n, 4 * n, n))

    def effects(self, domain: Domain) -> list[Effect]:
        """Mirror planes, and the pressure."""
        return [
            ChamberPressure("inner"),
            Symmetry("start", 1),
            Symmetry("end", 0),
            Symmetry("bottom", 2),
        ]

    def held(self) -> dict[str, tuple[int, ...]]:
        """The other end keeps its axial displacement."""
        return {"top": (2,)}

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """The pressure that belongs to the volume."""
        ratio = (self.exact.deformed_inner / self.exact.inner) ** 2 * self.exact.stretch
        condition = VolumeRatio(scene, volume_at_rest(scene), ratio)
        scene.set_scalar("pressure", self.exact.pressure)
        outcome = newton.solve(scene.w.copy(), ["pressure"], [condition])
        return outcome, {"p [MPa]": scene.scalar("pressure")}


class ClosedTubeLadder(TubeLadder):
    """The same tube with closed free ends, a/A = 1.1."""

    title = "Thick tube, closed free ends"
    text = (
        "A = 8, B = 10, a/A = 1.1. Volume and exact axial stretch 1.00417997 are given; the axial "
        "force, here over the thrust p π a², must vanish."
    )
    reference: ClassVar = {"p [MPa]": (0.01347609, 2e-6), "1 + force / thrust": (1.0, 1e-6)}
    exact = closed_tube(LAW, 8.0, 10.0, 8.8)

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """Pressure and what is left of the axial force."""
        outcome, values = super().find(scene, newton)
        force, _ = end_load(scene, "top", ORIGIN)
        thrust = scene.scalar("pressure") * math.pi * self.exact.deformed_inner**2 / 4
        return outcome, {**values, "1 + force / thrust": 1 + float(force[2]) / thrust}


class WoundTubeLadder(TubeLadder):
    """The tube with smeared hoops that all but cannot stretch, λz = 1.5."""

    title = "Hoop-wound extending tube, hoops smeared over the surface"
    text = (
        "A = 8, B = 10, λz = 1.5, closed free ends. Hoops of EA = 10⁶ N, one per mm of "
        "length, on the outer surface; the pressure is found at which the axial force vanishes."
    )
    reference: ClassVar = {"p [MPa]": (0.12667995, 5e-6)}
    exact = wound_tube(LAW, 8.0, 10.0, 1.5, HOOPS)

    def effects(self, domain: Domain) -> list[Effect]:
        """Hoops in addition."""
        return [*super().effects(domain), SmearedWinding(hoops(domain.data, "outer"), HOOPS)]

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """The pressure of axial balance."""
        outcome, pressure = balanced_pressure(
            scene,
            lambda: newton.solve(scene.w.copy()),
            lambda: float(end_load(scene, "top", ORIGIN)[0][2]),
            self.exact.pressure,
        )
        return outcome, {"p [MPa]": pressure}


class LayeredTubeLadder(TubeLadder):
    """The tube with an outer half a hundred times softer than the inner one."""

    title = "Thick tube of two rubbers, plane strain"
    text = (
        "A = 8, B = 10, a/A = 1.25; beyond R = 9 the rubber is a hundred times softer. The mean "
        "stress p jumps there; n = 1 has one element through each rubber."
    )
    reference: ClassVar = {"p [MPa]": (0.01539523191, 5e-8)}
    rubbers: ClassVar = {"inner": YEOH, "outer": SOFT}
    # `find` is its own, so that nothing asks it for what a single tube has
    exact = LayeredTube.inflated(  # type: ignore[assignment]
        (LAW, SOFT_LAW), (8.0, 9.0, 10.0), 10.0
    )

    def mesh(self, n: int) -> MeshData:
        """n elements through each rubber, 4 n around the quarter."""
        mesh = tube_sector(8.0, 10.0, math.pi / 2, self.length, (2 * n, 4 * n, n))
        middle = mesh.nodes[mesh.cells].mean(axis=1)
        beyond = np.hypot(middle[:, 0], middle[:, 1]) > 9.0
        return dataclasses.replace(
            mesh, regions={"inner": 0, "outer": 1}, cell_region=beyond.astype(np.int64)
        )

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """The pressure that belongs to the volume."""
        ratio = (self.exact.within.deformed_inner / self.exact.within.inner) ** 2
        condition = VolumeRatio(scene, volume_at_rest(scene), ratio)
        scene.set_scalar("pressure", self.exact.pressure)
        outcome = newton.solve(scene.w.copy(), ["pressure"], [condition])
        return outcome, {"p [MPa]": scene.scalar("pressure")}


class FlexureLadder(Ladder):
    """A block 2 mm thick and 62.83 mm long, bent until its ends meet."""

    title = "Flexure to 360°, plane strain"
    text = (
        "H = 2, α = 10, length 62.83. Both end faces have their exact displacement; the curved "
        "faces are free. M is the moment of the end face's reactions per depth."
    )
    levels: ClassVar = {"hexahedron": (2, 4, 8), "tetrahedron": (2, 4, 8)}
    reference: ClassVar = {"M [N]": (0.05847868, 2e-4)}
    exact = Flexure(LAW, 2.0, 10.0)
    width = 1.0

    def mesh(self, n: int) -> MeshData:
        """n elements through the thickness, 8 n along the length."""
        return box((self.width, 2.0, 20 * math.pi), (1, n, 8 * n))

    def effects(self, domain: Domain) -> list[Effect]:
        """Plane strain."""
        return [Symmetry("left", 0), Symmetry("right", 0)]

    def held(self) -> dict[str, tuple[int, ...]]:
        """Both ends."""
        return {"bottom": (1, 2), "top": (1, 2)}

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """The moment about the centre of curvature."""
        outcome = newton.solve(scene.w.copy())
        _, moment = end_load(scene, "top", np.array([0.0, -10.0, 0.0]))
        return outcome, {"M [N]": float(moment[0]) / self.width}


class TorsionLadder(Ladder):
    """A round bar twisted at constant length."""

    title = "Torsion of a solid cylinder"
    text = (
        "R = 10, ψ = 0.05 rad/mm, 5 mm long. Both end faces have their exact displacement, the "
        "lateral face is free. M and N are the reactions of an end face."
    )
    levels: ClassVar = {"hexahedron": (1, 2, 4), "tetrahedron": (1, 2, 4)}
    reference: ClassVar = {"M [N mm]": (183.259571, 1e-4), "N [N]": (-4.581489, 4e-3)}
    exact = Torsion(LAW, 10.0, 0.05)

    def mesh(self, n: int) -> MeshData:
        """2 n elements along the radius, n along the length."""
        return cylinder(10.0, 5.0, n, n, quarter=False)

    def held(self) -> dict[str, tuple[int, ...]]:
        """Both ends."""
        return {"bottom": (0, 1, 2), "top": (0, 1, 2)}

    def find(self, scene: Scene, newton: Newton) -> tuple[Outcome, dict[str, float]]:
        """Torque and axial force."""
        outcome = newton.solve(scene.w.copy())
        force, moment = end_load(scene, "top", ORIGIN)
        return outcome, {"M [N mm]": float(moment[2]), "N [N]": float(force[2])}


LADDERS: tuple[type[Ladder], ...] = (
    TubeLadder,
    ClosedTubeLadder,
    LayeredTubeLadder,
    FlexureLadder,
    TorsionLadder,
    WoundTubeLadder,
)

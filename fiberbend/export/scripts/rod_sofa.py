"""An actuator as a scene for SofaPython3 and the plugin Cosserat, from rod.json beside this file.

    runSofa rod_sofa.py

NOT RUN BY ITS AUTHORS: SOFA is no package of PyPI. The file is compiled, its scene is built with a
recorder in SOFA's place and held to the names and fields of the plugin's source
(BeamHookeLawForceFieldRigid, DiscreteCosseratMapping); what SOFA makes of it is not known.

Units: m, kg, s, N. SOFA's x runs along the rod: its x, y, z are z, x, y of rod.json. The strains of
the plugin are torsion, bending about y and z, elongation and two shears; the sections' rest strains
follow the pressure, their stiffness is the mean over the pressures, for the plugin knows one. The
caps are rigid: the root's is the base, the tip's a mass at the last frame.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import Sofa.Core

MM = 1e-3
SECTIONS = 20
PRESSURE_KPA = None
"""At the end of the ramp; None: the greatest of rod.json."""
RAMP = 1.0
"""In s."""
GRAVITY = (0.0, 0.0, 0.0)
"""In the scene's axes, m/s²; the weight of one that lies with its crown up is along -z."""
RAYLEIGH = 0.02
"""Damping over stiffness, s: an assumption where rod.json has no damping."""
PLUGINS = [
    "Cosserat",
    "Sofa.Component.AnimationLoop",
    "Sofa.Component.LinearSolver.Direct",
    "Sofa.Component.Mapping.Linear",
    "Sofa.Component.Mass",
    "Sofa.Component.ODESolver.Backward",
    "Sofa.Component.SolidMechanics.Spring",
    "Sofa.Component.StateContainer",
]


class Rod:
    """The numbers of rod.json in SOFA's axes and units.

    Args:
        path: of rod.json.
    """

    def __init__(self, path: Path) -> None:
        data = json.loads(path.read_text(encoding="utf-8"))
        if (data["format"], data["version"]) != ("fiberbend-rod", 2):
            raise ValueError(f"{path}: version 2 of the format fiberbend-rod expected")
        if not data["mass"]["known"]:
            raise ValueError(f"{path}: without masses nothing moves: {data['mass']['missing']}")
        axis, geometry, mass = data["axis"], data["geometry"], data["mass"]
        self.length = geometry["chamber_length_mm"] * MM
        self.radius = geometry["radius_mm"] * MM
        self.mass = mass["section"]["per_length_kg_per_mm"] / MM * self.length
        self.cap_mass = mass["cap"]["per_length_kg_per_mm"] * geometry["cap_length_mm"]
        self.pressures = np.array(data["section"]["pressure_kPa"])
        curvature, side, twist = (
            np.array(axis[f"rest_{name}_1_per_mm"]) / MM
            for name in ("curvature", "side_curvature", "twist")
        )
        nothing = np.zeros_like(twist)
        stretch = np.array(axis["rest_stretch"]) - 1
        rest = np.column_stack([twist, curvature, side, stretch, nothing, nothing])
        self._rest = np.tile(rest[:, None], (1, SECTIONS, 1)) + self._ends(data)
        known = data["damping"]
        self.damping = RAYLEIGH if known is None else float(known["retardation_time_s"])
        compliance = np.linalg.inv(np.array(axis["bending_stiffness_N_mm2"]) * MM**2)
        bending = 1 / np.diagonal(compliance, axis1=1, axis2=2)
        self.bending, self.side, self.twist = (float(part) for part in bending.mean(axis=0))
        self.axial = float(np.mean(axis["axial_stiffness_N"]))
        # one number for both ways: that of the plane of bending
        self.shear = float(np.mean(np.array(data["shear"]["section_N"])[:, 1]))

    def _ends(self, data: dict[str, Any]) -> np.ndarray:
        """Strains of the sections near the caps, which are rigid and turn with them."""
        ends, axis, each = data["ends"], data["axis"], self.length / SECTIONS
        near = max(1, min(round(ends["zone_mm"] * MM / each), SECTIONS // 2))
        added = np.zeros((len(self.pressures), SECTIONS, 6))
        for there, parts in (
            (slice(0, near), ("root_cap", "root_end")),
            (slice(SECTIONS - near, SECTIONS), ("tip_end", "tip_cap")),
        ):
            longer, turn, side, twist = (
                sum(np.array(ends[part][key]) for part in parts)
                for key in ("lengthening_mm", "turn_rad", "side_turn_rad", "twist_rad")
            )
            longer = MM * (longer + axis["y_mm"] * turn - axis["x_mm"] * side)
            nothing = np.zeros_like(turn)
            rows = np.column_stack([twist, turn, side, longer, nothing, nothing])
            added[:, there] += rows[:, None] / (near * each)
        return added

    def lump(self, mass: float) -> str:
        """A mass on a frame: kg, a volume that nothing reads, and its inertia over the mass, m²."""
        across, along = self.radius**2 / 4, self.radius**2 / 2
        rows = np.diag([along, across, across]).ravel()
        return " ".join(f"{part:.10g}" for part in (mass, 1.0, *rows))

    def rest(self, kpa: float) -> list[list[float]]:
        """Strains of the sections without load, in the plugin's order.

        Args:
            kpa: within the range of rod.json.
        """
        low, high = self.pressures[[0, -1]]
        if not low <= kpa <= high:
            raise ValueError(f"{kpa:g} kPa: rod.json reaches from {low:g} to {high:g} kPa")
        place = int(np.searchsorted(self.pressures, kpa, "right"))
        place = min(place, len(self.pressures) - 1)
        one, other = self.pressures[place - 1 : place + 1]
        part = (kpa - one) / (other - one)
        rows: list[list[float]] = (
            (1 - part) * self._rest[place - 1] + part * self._rest[place]
        ).tolist()
        return rows


class Pressure(Sofa.Core.Controller):
    """Moves the rest strains with a pressure that rises and stays.

    Args:
        rod: the numbers.
        strains: mechanical object of the sections' strains.
        root: of the scene.
        kpa: pressure at the end.
    """

    def __init__(self, rod: Rod, strains: Any, root: Any, kpa: float) -> None:
        super().__init__(name="pressure")
        self._rod, self._strains, self._root, self._kpa = rod, strains, root, kpa

    def onAnimateBeginEvent(self, _event: Any) -> None:
        """Before each step."""
        least = float(self._rod.pressures[0])
        part = min(1.0, float(self._root.time.value) / RAMP)
        rest = self._rod.rest(least + part * (self._kpa - least))
        with self._strains.rest_position.writeable() as places:
            places[:] = rest


def createScene(root: Any) -> Any:
    """What runSofa calls."""
    rod = Rod(Path(__file__).with_name("rod.json"))
    root.gravity, root.dt = list(GRAVITY), 1e-3
    root.addObject("RequiredPlugin", name="plugins", pluginName=PLUGINS)
    root.addObject("DefaultAnimationLoop")
    solver = root.addChild("solver")
    solver.addObject("EulerImplicitSolver", rayleighMass=0.0, rayleighStiffness=0.0)
    solver.addObject("SparseLDLSolver", template="CompressedRowSparseMatrixd")
    base = solver.addChild("base")
    place = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    frame = base.addObject("MechanicalObject", name="base", template="Rigid3d", position=[place])
    base.addObject(
        "RestShapeSpringsForceField",
        template="Rigid3d",
        stiffness=1e6,
        angularStiffness=1e6,
        points=[0],
    )
    at = np.linspace(0.0, rod.length, SECTIONS + 1).tolist()
    first = rod.rest(float(rod.pressures[0]))
    sections = solver.addChild("sections")
    strains = sections.addObject(
        "MechanicalObject",
        name="strains",
        template="Vec6d",
        position=first,
        rest_position=first,
    )
    sections.addObject(
        "BeamHookeLawForceFieldRigid",
        crossSectionShape="circular",
        radius=rod.radius,
        length=[rod.length / SECTIONS] * SECTIONS,
        useInertiaParams=True,
        GI=rod.twist,
        EIy=rod.bending,
        EIz=rod.side,
        EA=rod.axial,
        GA=rod.shear,
        rayleighStiffness=rod.damping,
    )
    frames = base.addChild("frames")
    sections.addChild(frames)
    places = frames.addObject(
        "MechanicalObject",
        name="frames",
        template="Rigid3d",
        position=[[s, *place[1:]] for s in at],
    )
    frames.addObject("UniformMass", vertexMass=rod.lump(rod.mass / (SECTIONS + 1)))
    frames.addObject(
        "DiscreteCosseratMapping",
        curv_abs_input=at,
        curv_abs_output=at,
        input1=strains.getLinkPath(),
        input2=frame.getLinkPath(),
        output=places.getLinkPath(),
        debug=False,
        radius=rod.radius,
    )
    cap = frames.addChild("cap")
    cap.addObject("MechanicalObject", name="cap", template="Rigid3d")
    cap.addObject("UniformMass", vertexMass=rod.lump(rod.cap_mass), indices=[SECTIONS])
    cap.addObject("IdentityMapping")
    kpa = float(rod.pressures[-1]) if PRESSURE_KPA is None else PRESSURE_KPA
    root.addObject(Pressure(rod, strains, root, kpa))
    return root

"""An actuator in exact circular bending about the middle of its floor: a state without a solver."""

from __future__ import annotations

import numpy as np

from fiberbend.states.snapshot import ModelMesh, Snapshot
from geometry.bodies.extrude import hexahedral_body
from geometry.mesh.data import Floats
from geometry.sections.hemicircle import HemicircleActuator
from geometry.sections.size import MeshSize
from geometry.winding.embed import embed
from geometry.winding.helix import Winding
from materials.material import Material

BASELINE = HemicircleActuator(radius=8, length=160, wall=2, floor=2, sheath=1, cap=15)
SHORT = HemicircleActuator(radius=8, length=24, wall=2, floor=2, sheath=1, cap=4)
MATERIALS = {
    "wall": Material("yeoh", {"c1": 0.11, "c2": 0.02}),
    "floor": Material("yeoh", {"c1": 7.9}),
    "sheath": Material("neo-hooke", {"mu": 0.03}),
}


def model_mesh(
    actuator: HemicircleActuator = SHORT,
    axial: float = 4.0,
    half: bool = True,
    element: str = "hexahedron",
    width: float = 0.38,
) -> ModelMesh:
    """The actuator with its double helix at a pitch of 3 mm."""
    from geometry.mesh.tets import to_tetrahedra

    mesh = hexahedral_body(actuator, MeshSize(axial=axial, half=half))
    if element == "tetrahedron":
        mesh = to_tetrahedra(mesh)
    fibers = embed(mesh, actuator, Winding("double-helix", 3.0, width))
    return ModelMesh(mesh, MATERIALS, fibers, smeared=False, title="Pure bending")


def bent(nodes: Floats, length: float, angle: float, axis: float = 1.0) -> Floats:
    """Positions in mm after bending 0 ≤ z ≤ `length` by `angle` (rad) about y = `axis`."""
    if angle == 0:
        return nodes.copy()
    phi = angle * np.clip(nodes[:, 2], 0, length) / length
    beyond = nodes[:, 2] - np.clip(nodes[:, 2], 0, length)
    radius = length / angle + nodes[:, 1] - axis
    y = radius * np.cos(phi) - length / angle + axis - beyond * np.sin(phi)
    z = radius * np.sin(phi) + beyond * np.cos(phi)
    return np.column_stack([nodes[:, 0], y, z])


def snapshot(scene: ModelMesh, degrees: float) -> Snapshot:
    """The state at an angle, with a made-up pressure and fiber force."""
    mesh, fibers = scene.mesh, scene.fibers
    length = mesh.nodes[mesh.cells[mesh.facets["winding"][:, 0]].ravel(), 2].max()
    displacement = bent(mesh.nodes, length, np.radians(degrees)) - mesh.nodes
    force = None if fibers is None else degrees / 100 * (2 + np.cos(fibers.s / 5)) * fibers.share
    return Snapshot(
        label=f"{degrees:.0f}deg",
        step=int(degrees // 30),
        pressure_kpa=degrees / 2,
        angle_deg=degrees,
        displacement=displacement,
        multiplier=np.zeros(mesh.cells.shape),
        fiber_force=force,
    )

"""A bent body with discrete fibers on however many ranks there are; prints what it found."""

from __future__ import annotations

import json
import sys

import numpy as np
from mpi4py import MPI

from fem.kinematics.domain import Domain
from fem.march.march import Ramp
from fem.results.volume import VolumeProbe
from geometry.bodies.extrude import hexahedral_body
from geometry.mesh.tets import to_tetrahedra
from geometry.sections.size import MeshSize
from tests.fem.parts import SHORT, bender, set_positions

ANGLE = np.deg2rad(4.0)


def measure(comm: MPI.Comm, cell: str = "hexahedron") -> dict[str, float]:
    """Bend the short actuator to an angle and by a pressure."""
    mesh = hexahedral_body(SHORT, MeshSize(axial=6, section=1, half=True))
    domain = Domain(to_tetrahedra(mesh) if cell == "tetrahedron" else mesh, comm)
    body = bender(domain=domain)
    report = body.run([Ramp("pressure", 0.03, largest=0.01, at=(ANGLE,))])
    assert report.status == "converged", report.reason
    bent = next(s for s in body.states if abs(s.measures["control"] - ANGLE) < 1e-9)
    low, high = body.scene.discrete["SmearedWinding"].force_range()  # type: ignore[attr-defined]
    tip = body.tip.position()
    found = {
        "pressure at the angle": bent.scalars["pressure"],
        "angle": body.angle.value(),
        "tip y": float(tip[1]),
        "tip z": float(tip[2]),
        "volume": body.scene.conjugate("pressure"),
        "least fiber force": low,
        "greatest fiber force": high,
        "least det F": body.scene.det_f(),
        "energy": sum(body.scene.energies().values()),
        "unknowns": float(body.scene.body.size),
    }
    # widened away from the one end, then from the other: the greatest error is on either rank
    probe = VolumeProbe.of(body.scene)
    assert probe is not None
    z = domain.data.nodes[:, 2]
    for end, start in (("tip", z.min()), ("root", z.max())):
        wide = domain.data.nodes.copy()
        wide[:, 0] *= 1 + 1e-3 * (z - start)
        set_positions(body.scene, wide)
        kept = probe.read()
        found[f"volume error of an element, {end}"] = kept.element
        found[f"volume error, {end}"] = kept.whole
    return found


if __name__ == "__main__":
    found = measure(MPI.COMM_WORLD, *sys.argv[1:])
    if MPI.COMM_WORLD.rank == 0:
        print(json.dumps(found))

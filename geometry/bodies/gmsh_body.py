"""The actuator's body meshed by gmsh, in a subprocess because gmsh can hang."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from geometry.mesh.data import Floats, MeshData
from geometry.mesh.errors import NO_MESH, MeshError
from geometry.sections.shape import ShapedActuator
from geometry.sections.size import MeshSize, Strips, check_size, in_unit, own_unit

_LAST_LINES = 5
_ATTEMPTS = (
    *((seed, False, False) for seed in (1, 2, 3, 4)),
    (1, True, False),
    (1, False, True),
)
"""Seeds of gmsh's random numbers for tetrahedra, whether surfaces are adapted triangles, and
whether Delaunay's algorithm fills them instead of HXT, one attempt after another. On some walls
that are thinner than a third of an edge HXT puts points onto the boundary and crashes: gmsh 4.8
with the first seed, 4.15 with every seed on its own surfaces, and it may refuse adapted ones."""
_WHAT_MAY_DO = "shorter elements or hexahedra may do"
_MPI_VARIABLES = ("OMPI_", "PMIX_", "PMI_", "MPI_", "HYDRA_", "MPIEXEC_")


class ChanceError(MeshError):
    """gmsh crashed, or found no tetrahedra, which may be otherwise with other numbers."""


def build_body(
    actuator: ShapedActuator,
    size: MeshSize,
    strips: Strips | None = None,
    winding: Sequence[Floats] | None = None,
    msh_path: Path | None = None,
    time_limit: float = 120.0,
) -> MeshData:
    """Mesh the whole body with gmsh.

    Surfaces are those of `geometry.bodies.stations.body_stations`; regions "wall", "floor",
    "layer", "sheath". Hexahedra are sorted along z.

    Args:
        actuator: dimensions.
        size: fineness, element type, half or full body.
        strips: strips for a blocked tip.
        winding: points (n, 3) in mm of each fiber, drawn into the .msh as group "winding".
        msh_path: where to save gmsh's own file, or None.
        time_limit: seconds after which gmsh is killed.

    Raises:
        ValueError: dimensions that this mesh cannot resolve.
        MeshError: gmsh failed, or crashed or found no mesh in every attempt, or did not end in
            time.
    """
    check_size(actuator, size, strips)
    unit = own_unit(actuator)  # gmsh's tolerances are lengths: it never sees mm of an odd size
    with tempfile.TemporaryDirectory(prefix="fiberbend-mesh-") as folder:
        spec, out = Path(folder) / "spec.json", Path(folder) / "mesh.npz"
        description = {
            "unit": unit,
            "actuator": {
                "section": actuator.section,
                **dataclasses.asdict(in_unit(actuator, unit)),
            },
            "size": dataclasses.asdict(in_unit(size, unit)),
            "strips": dataclasses.asdict(in_unit(strips, unit)) if strips else None,
            "winding": [(curve / unit).tolist() for curve in winding or ()],
            "msh_path": str(Path(msh_path).resolve()) if msh_path else None,
        }
        # -P: a file gmsh.py in the working folder is not gmsh
        worker = [sys.executable, "-P", "-m", "geometry.bodies.gmsh_worker", str(spec), str(out)]
        end = time.monotonic() + time_limit
        for seed, adapted, delaunay in _ATTEMPTS:
            attempt = {"seed": seed, "adapted": adapted, "delaunay": delaunay}
            spec.write_text(json.dumps(description | attempt))
            try:
                _run(worker, time_limit, end - time.monotonic())
                break
            except ChanceError:
                # of hexahedra nothing is random
                if size.element == "hexahedron" or (seed, adapted, delaunay) == _ATTEMPTS[-1]:
                    raise
        mesh = MeshData.load(out)
        return dataclasses.replace(mesh, nodes=unit * mesh.nodes)


def _run(command: list[str], time_limit: float, left: float) -> None:
    """Run gmsh.

    Args:
        command: its command line.
        time_limit: seconds that it has, with those before.
        left: seconds that are left of them.
    """
    # gmsh may be linked with MPI, and a child of a rank must not join that rank's job
    env = {k: v for k, v in os.environ.items() if not k.startswith(_MPI_VARIABLES)}
    root = str(Path(__file__).resolve().parents[2])
    # more threads, and the same body gives another mesh now and then, with a flat tetrahedron in it
    env["OMP_NUM_THREADS"] = "1"
    # an empty entry stands for the working folder
    given = env.get("PYTHONPATH", "").split(os.pathsep)
    env["PYTHONPATH"] = os.pathsep.join([root, *(path for path in given if path)])
    try:
        done = subprocess.run(
            command,
            env=env,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=left,
        )
    except subprocess.TimeoutExpired as error:
        raise MeshError(f"gmsh did not finish within its time limit of {time_limit:g} s") from error
    if done.returncode != 0:
        lines = [line for line in done.stdout.splitlines() if line.strip()]
        last = " | ".join(lines[-_LAST_LINES:])
        if done.returncode < 0:
            how = f"gmsh crashed by signal {-done.returncode}; {_WHAT_MAY_DO}"
            raise ChanceError(f"{how}: {last}")
        if done.returncode == NO_MESH:
            raise ChanceError(f"gmsh found no mesh; {_WHAT_MAY_DO}: {last}")
        raise MeshError(f"gmsh ended with code {done.returncode}: {last}")

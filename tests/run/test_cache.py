"""A compiler that was killed must not block the next run."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

from tests.conftest import ROOT

PROGRAM = """
import ufl
from mpi4py import MPI
from fem import compat
from tests.exact.solids import box
mesh = box((1.0, 1.0, 1.0), (1, 1, 1))
m = compat.create_mesh(MPI.COMM_WORLD, mesh.cell_type, mesh.nodes, mesh.cells)
x = ufl.SpatialCoordinate(m)
form = compat.compile_form(m, sum(x[0] ** i * ufl.sin(i * x[1]) for i in range(9)) * ufl.dx)
print("compiled", compat.assemble_scalar(form))
"""


def test_killed_compiler_leaves_nothing_in_the_way(tmp_path: Path) -> None:
    """A source without the mark that it is compiled: dolfinx waits 10 s for the mark, then dies."""
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-c", PROGRAM]
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)

    def unfinished() -> list[Path]:
        found = tmp_path.rglob("*.c")
        return [c for c in found if not c.with_suffix(".c.cached").exists()]

    while process.poll() is None and not unfinished():
        time.sleep(0.001)
    process.kill()
    process.wait()
    assert unfinished(), "the compiler was not caught at work"
    done = subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert "compiled" in done.stdout
    assert not unfinished()

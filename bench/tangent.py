"""What one assembly of the tangent costs: `python bench/tangent.py CASE COUNT [PATH=VALUE …]`.

Prints user seconds, which other processes of the machine hardly move, and the greatest memory.
"""

from __future__ import annotations

import resource
import sys

import numpy as np
from mpi4py import MPI

from fiberbend.models.choice import meshed
from fiberbend.reader.reader import read_case
from fiberbend.running.assembly import assemble


def main() -> None:
    """Assemble the tangent of a case near rest, as often as asked."""
    case = read_case(sys.argv[1], sys.argv[3:])
    scene = assemble(case, meshed(case).mesh(case), MPI.COMM_WORLD).scene
    scene.set(1e-3 * np.sin(np.arange(scene.body.owned)))
    count = int(sys.argv[2])
    before = resource.getrusage(resource.RUSAGE_SELF)
    for _ in range(count):
        scene.predict(None)  # else the fibers take their last answer again
        scene.assemble_tangent()
    after = resource.getrusage(resource.RUSAGE_SELF)
    spent = (after.ru_utime - before.ru_utime) / count
    print(f"{scene.body.size} unknowns: {1e3 * spent:.2f} ms of user time a tangent, ", end="")
    print(f"{after.ru_maxrss / 1024:.0f} MB, norm {scene.matrix.norm():.12e}")


if __name__ == "__main__":
    main()

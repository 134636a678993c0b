"""The command `fiberbend mesh`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from fiberbend.process import signals
from fiberbend.reader.arguments import CaseFile, Changes
from fiberbend.running import launch

_OUT = (
    "File to write, lengths in mm: .msh (gmsh: a physical group for each name), .vtu (VTK: an "
    "array of zeros and ones for each name) or .inp (Abaqus, CalculiX: element sets, surfaces by "
    "faces, node sets, fibers as trusses)."
)


def mesh(
    case: CaseFile,
    /,
    *,
    out: Annotated[Path, Parameter(help=_OUT)],
    settings: Changes = (),
    overwrite: Annotated[bool, Parameter(help="Replace a file that is there.")] = False,
) -> int:
    """Write the mesh of a case's model with its regions, surfaces and fibers.

    A section writes its quadrilaterals, a cell its slice, a body its hexahedra or tetrahedra; where
    half is modelled, that half.
    """
    from fiberbend.reader.reader import read_case
    from fiberbend.results.mesh_file import check_target, write_mesh_file

    check_target(out, overwrite)
    checked = read_case(case, settings)
    try:
        with signals.raising():
            lines = write_mesh_file(checked, out, overwrite)
    except KeyboardInterrupt as error:
        return launch.stopped(signals.stop_of(error))
    for line in lines:
        launch.say(line)
    return 0

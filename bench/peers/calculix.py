"""The actuator in CalculiX: its deck from fiberbend's .inp, hoops as springs, and what it answers.

CalculiX has no hybrid elements, so that the rubbers are slightly compressible; its answer to
locking is C3D20R. *DSLOAD is a follower load under NLGEOM. Increments are chosen
by the program, and so is the solver (SPOOLES in Debian's build).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.peers.arrays import Body, Floats, Ints, bending_angles
from bench.peers.scene import BULK, REGIONS, YEOH, the_case

_FIRST, _LEAST, _MOST = 0.05, 1e-5, 0.05
"""First, least and greatest increment, as parts of the whole pressure."""
_DIGITS = 9
_STA_COLUMNS = 7
_TABLE = re.compile(r"displacements .* for set (\S+) and time\s+(\S+)", re.IGNORECASE)


def with_element(mesh: str, element: str) -> str:
    """The mesh's file with another element of the same nodes."""
    return mesh.replace("TYPE=C3D20,", f"TYPE={element},")


def deck(body: Body, mesh: str, pressure: float) -> Iterator[str]:
    """Lines of a deck.

    Args:
        body: the actuator.
        mesh: name of the file with nodes, elements, sets and surfaces, from `fiberbend mesh`.
        pressure: in the chamber at the end, MPa.
    """
    yield f"*INCLUDE, INPUT={mesh}"
    for name, (c1, c2) in ((name, YEOH[name]) for name in REGIONS):
        yield f"*MATERIAL, NAME={name}"
        yield "*HYPERELASTIC, YEOH"
        yield f"{c1:g}, {c2:g}, 0., {2 / (2 * c1 * BULK):.{_DIGITS}g}, 1e10, 1e10"
        yield f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"
    yield from springs(body, len(body.cells))
    yield "*BOUNDARY"
    yield "clamp, 1, 3"
    yield "symmetry, 1, 1"
    yield "*STEP, NLGEOM, INC=2000"
    yield "*STATIC"
    yield f"{_FIRST:g}, 1., {_LEAST:g}, {_MOST:g}"
    yield "*DSLOAD"
    yield f"chamber, P, {pressure:.{_DIGITS}g}"
    for name in ("section_root", "section_tip"):
        yield f"*NODE PRINT, NSET={name}"
        yield "U"
    yield "*END STEP"


def springs(body: Body, last: int) -> Iterator[str]:
    """Hoops as springs along the nodes, one stiffness for all that share it.

    Args:
        body: the actuator.
        last: number of the last element so far.
    """
    label = labels(body)
    pieces, ea = body.plain_hoops, body.plain_stiffness
    length = np.linalg.norm(np.diff(body.points[pieces], axis=1)[:, 0], axis=1)
    stiffness = np.array([float(f"{value:.{_DIGITS}g}") for value in ea / length])
    for number, value in enumerate(np.unique(stiffness), start=1):
        yield f"*ELEMENT, TYPE=SPRINGA, ELSET=hoop_{number}"
        for first, second in label[pieces[stiffness == value]]:
            last += 1
            yield f"{last}, {first}, {second}"
        yield f"*SPRING, ELSET=hoop_{number}"
        yield ""
        yield f"{value:.{_DIGITS}g}"


def labels(body: Body) -> Ints:
    """Number in the mesh's file of every node that a 20-node hexahedron has, others 0, (n,)."""
    used = np.unique(body.cells[:, :20])
    label = np.zeros(len(body.points), dtype=np.int64)
    label[used] = np.arange(1, len(used) + 1)
    return label


def prepare(
    section: int, axial: float, body: Body, element: str, pressure: float, folder: Path
) -> None:
    """Write mesh.inp, by `fiberbend mesh`, and run.inp to a folder; see `scene.settings`, `deck`.

    Args:
        section: elements through each thickness.
        axial: length of the elements, mm.
        body: the same mesh as arrays.
        element: of 20 nodes.
        pressure: at the end, MPa.
        folder: the folder.
    """
    from fiberbend.results.mesh_file import write_mesh_file

    mesh = folder / "mesh.inp"
    write_mesh_file(the_case(section, axial), mesh, True)
    mesh.write_text(with_element(mesh.read_text(), element))
    lines = "\n".join(deck(body, mesh.name, pressure))
    (folder / "run.inp").write_text(lines + "\n")


def curve(body: Body, dat: str, pressure: float) -> tuple[Floats, Floats]:
    """Pressures in MPa and angles in rad of the increments in a .dat file."""
    label = labels(body)
    node = np.zeros(label.max() + 1, dtype=np.int64)
    node[label] = np.arange(len(label))
    states: dict[float, Floats] = {}
    x: Floats | None = None
    for line in dat.splitlines():
        if found := _TABLE.search(line):
            x = states.setdefault(float(found[2]), body.points.copy())
        elif x is not None and line.strip():
            words = line.split()
            place = node[int(words[0])]
            x[place] = body.points[place] + np.array(words[1:4], dtype=float)
    times = sorted(states)
    root, tip = body.root[:, :8], body.tip[:, :8]
    angles = bending_angles(body.points, [states[time] for time in times], root, tip)
    return pressure * np.array(times), angles


def increments(sta: str) -> list[tuple[bool, int]]:
    """Whether each increment of a .sta file was kept, and iterations up to its end."""
    rows = [line.split() for line in sta.splitlines()]
    rows = [row for row in rows if len(row) == _STA_COLUMNS and row[0].isdigit()]
    total = np.cumsum([int(row[3]) for row in rows])
    return [(not row[2].endswith("U"), int(count)) for row, count in zip(rows, total, strict=True)]

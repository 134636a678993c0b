"""docs/evidence/peers.md from the records of `make peers`."""

from __future__ import annotations

import dataclasses
import datetime
from collections.abc import Iterator, Sequence

import numpy as np

from bench.peers.record import GOALS, Record

OURS = "fiberbend"
NAMES = {
    OURS: "fiberbend",
    "calculix-c3d20r": "CalculiX, C3D20R",
    "calculix-c3d20": "CalculiX, C3D20",
    "dolfinx-taylor-hood": "plain dolfinx, Q2–Q1",
    "dolfinx-dpc1": "plain dolfinx, Q2–P1 discontinuous",
    "felupe": "felupe, Q2–Q1–Q1 discontinuous",
}
HEAD = """# Beside other programs

Made by `make peers` on {machine}, {today}: one program at a time, each in a process of its own, on
one thread and one rank. Half of the baseline actuator bends to {goal}° with hoops that have the
stiffness of its winding per length (in fiberbend a double helix of a pitch of 0.6 mm and a fifth of
the thread). Every rubber has a bulk modulus of 200 times its shear modulus, since CalculiX has no
incompressible element. All meshes are fiberbend's own. Kernels are compiled before the time is
taken.

The angle is that of the section z = L against z = 0, by least squares over its area, in every
program; a pressure at an angle is read off a cubic spline through all load steps. CPU time to an
angle is the share of the iterations until then, start-up included.
"""
IDLE = 1.5
"""Load average above which a machine does something else too."""
BUSY = """The machine was busy with other work (load average up to {load:.0f}). CPU times, which are
compared, are somewhat longer for it; wall times say little, and limits of time ended runs early.
"""
OTHERWISE = """## What each model has otherwise

- fiberbend: 27-node hexahedra with linear discontinuous pressures; hoops are a membrane on the
  winding's surface. Load steps, extrapolation and the angle to end at are the program's own.
- CalculiX: 20-node hexahedra from the .inp of `fiberbend mesh`, without pressures as unknowns;
  hoops are springs along all rows of nodes, so polygons. Increments, tolerances and solver
  (SPOOLES) are its own.
- Plain dolfinx (bench/peers/plain_dolfinx.py): the same hexahedra and membrane; equal load steps,
  `NewtonSolver` and MUMPS as they come, and OpenBLAS with the kernel that it takes by itself.
  Nothing is cut back: a step that fails ends the run.
- felupe (bench/peers/felupe_peer.py): the same hexahedra with felupe's own fields of pressure and
  volume, hoops as trusses along all rows of nodes; equal load steps, cut back by its plugin; the
  solver is pypardiso.
- On one mesh, fiberbend and plain dolfinx with discontinuous pressures have the same elements:
  their pressures differ by what sets a helix of 0.6 mm apart from hoops.
- Turns one by one are in none of these: they want elements of half a pitch in every program
  ([accuracy of a discrete winding](winding.md)).
"""
WANTED = 10.0
"""Times faster that fiberbend wants to be than CalculiX and the plain script."""
_ASKED = ("calculix-c3d20r", "calculix-c3d20", "dolfinx-taylor-hood", "dolfinx-dpc1")


@dataclasses.dataclass(frozen=True)
class Point:
    """Error and cost of one record at one angle.

    Attributes:
        record: the run.
        error: of the pressure against the reference, with its sign.
        seconds: of CPU until the angle.
    """

    record: Record
    error: float
    seconds: float


@dataclasses.dataclass(frozen=True)
class Reference:
    """The pressure that errors are measured against.

    Attributes:
        kPa: of fiberbend's finest mesh.
        record: the run.
        apart: how far fiberbend's next mesh is from it, relative.
    """

    kPa: float
    record: Record
    apart: float


def reference_of(records: Sequence[Record], goal: float) -> Reference:
    """fiberbend's finest value at an angle.

    Raises:
        ValueError: fewer than two runs of fiberbend have reached it.
    """
    ours = [r for r in records if r.program == OURS and r.pressure(goal) is not None]
    if len(ours) < 2:
        raise ValueError(f"fiberbend has reached {goal:g}° on {len(ours)} meshes, expected two")
    *_, next_, finest = sorted(ours, key=lambda r: r.unknowns)
    value, other = finest.pressure(goal), next_.pressure(goal)
    assert value is not None
    assert other is not None
    return Reference(value, finest, abs(other / value - 1))


def points_of(
    records: Sequence[Record], program: str, goal: float, reference: Reference
) -> list[Point]:
    """A program's ladder at an angle, coarse first; without the reference itself."""
    points = []
    for record in sorted(records, key=lambda r: r.unknowns):
        pressure, share = record.pressure(goal), record.share(goal)
        if record.program != program or record == reference.record:
            continue
        if pressure is not None and share is not None:
            points.append(Point(record, pressure / reference.kPa - 1, share * record.cpu))
    return points


def seconds_at(points: Sequence[Point], error: float) -> float | None:
    """Seconds for an error, along the meshes that no cheaper one beats.

    Between two of them log time is linear in log error. An error above that of the cheapest mesh
    costs as much as that mesh; one below all of them has no answer.

    Args:
        points: the ladder.
        error: absolute value.
    """
    best: list[Point] = []
    for point in sorted(points, key=lambda p: p.seconds):
        if not best or abs(point.error) < abs(best[-1].error):
            best.append(point)
    if not best or error < abs(best[-1].error):
        return None
    errors = np.log([max(abs(p.error), 1e-9) for p in best])
    times = np.log([p.seconds for p in best])
    return float(np.exp(np.interp(np.log(error), errors[::-1], times[::-1])))


def ratios(records: Sequence[Record], program: str, goal: float) -> list[tuple[Record, float]]:
    """Times fiberbend is faster at the error of every mesh of a program, where that is known."""
    reference = reference_of(records, goal)
    ours = points_of(records, OURS, goal, reference)
    found = []
    for point in points_of(records, program, goal, reference):
        seconds = seconds_at(ours, abs(point.error))
        if seconds is not None:
            found.append((point.record, point.seconds / seconds))
    return found


def page(records: Sequence[Record], machine: str, today: datetime.date) -> str:
    """The page.

    Args:
        records: of all programs.
        machine: name of the processor, and its cores.
        today: date of the run.
    """
    head = HEAD.format(machine=machine, today=f"{today:%d %B %Y}", goal=f"{GOALS[-1]:g}")
    busy = max(record.load for record in records)
    if busy > IDLE:
        head += "\n" + BUSY.format(load=busy)
    return "\n".join([head, *_runs(records), *_equal(records), OTHERWISE])


def _runs(records: Sequence[Record]) -> Iterator[str]:
    references = {goal: reference_of(records, goal) for goal in GOALS}
    yield "## Every run"
    yield ""
    for goal, found in references.items():
        yield (
            f"- {goal:g}°: {found.kPa:.3f} kPa, fiberbend on its finest mesh "
            f"({found.record.unknowns} unknowns); its next mesh is {100 * found.apart:.2f} % away."
        )
    yield ""
    pressures = " | ".join(f"P at {goal:g}° [kPa] | error" for goal in GOALS)
    yield (
        f"| program | mesh | unknowns | reached | {pressures} | steps | iterations "
        "| CPU [s] | wall [s] | memory [MB] | ended |"
    )
    yield "|" + "---|" * (10 + 2 * len(GOALS))
    for record in sorted(records, key=lambda r: (list(NAMES).index(r.program), r.unknowns)):
        cells = []
        for goal, found in references.items():
            pressure = record.pressure(goal)
            cells += (
                ["–", "–"]
                if pressure is None
                else [f"{pressure:.2f}", f"{100 * (pressure / found.kPa - 1):+.2f} %"]
            )
        yield (
            f"| {NAMES[record.program]} {record.version} | {record.section} × {record.axial:g} mm "
            f"| {record.unknowns} | {record.reached:.0f}° | {' | '.join(cells)} "
            f"| {len(record.kPa)} | {record.iterations} | {record.cpu:.1f} | {record.wall:.1f} "
            f"| {record.memory:.0f} | {record.ended or 'at the goal'} |"
        )
    yield ""
    yield "A mesh of n × h has n elements through each thickness and elements of length h."
    yield ""


def _equal(records: Sequence[Record]) -> Iterator[str]:
    yield "## At equal accuracy"
    yield ""
    yield "Times fiberbend is faster at the error of each run: its own time for that error is read"
    yield "off its ladder, log time linear in log error; where the other's error is above that of"
    yield "fiberbend's coarsest mesh, the time of that mesh counts."
    yield ""
    yield "| program | mesh | " + " | ".join(f"at {goal:g}°" for goal in GOALS) + " |"
    yield "|---|---|" + "---|" * len(GOALS)
    found_at: dict[str, list[float]] = {name: [] for name in NAMES}
    for program in (name for name in NAMES if name != OURS):
        found = {goal: ratios(records, program, goal) for goal in GOALS}
        for record in sorted(records, key=lambda r: r.unknowns):
            if record.program != program:
                continue
            cells = []
            for goal in GOALS:
                here = [ratio for other, ratio in found[goal] if other == record]
                cells.append(f"{here[0]:.1f}" if here else "–")
                found_at[program] += here
            name = f"{NAMES[program]} | {record.section} × {record.axial:g} mm"
            yield f"| {name} | {' | '.join(cells)} |"
    yield ""
    for program in _ASKED:
        yield f"- {NAMES[program]}: {_verdict(found_at[program])}."
    yield ""


def _verdict(found: Sequence[float]) -> str:
    """Whether all ratios are what is wanted."""
    if not found:
        return "no run that can be compared"
    wide = (
        f"{min(found):.1f} to {max(found):.1f} times" if len(found) > 1 else f"{found[0]:.1f} times"
    )
    met = sum(ratio >= WANTED for ratio in found)
    where = {len(found): "everywhere", 0: "nowhere"}.get(met, f"in {met} of {len(found)}")
    return f"{wide}; {WANTED:g} times {where}"

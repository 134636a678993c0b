"""Whether the memory that a run needs is free, asked before anything is meshed."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.schema.problems import CaseError, Problem

RANK_MB = 200.0
"""Memory of a further rank beside its part of the problem: libraries, kernels, buffers."""
_ALONE_MB = 250.0
"""Of a run without elements, its plots among it."""
_PICTURES_MB = 300.0
"""Of VTK and matplotlib."""
_DRAWN_MB = 0.009
"""Of an element in space that is drawn: measured on sections and cells 160 mm to 4 m long."""
_MB = 1e-6
_UNLIMITED = 2**60
"""A limit of a control group from here on is none."""


@dataclasses.dataclass(frozen=True)
class Room:
    """Memory that a process may still take.

    Attributes:
        mb: how much, MB.
        source: what bounds it.
    """

    mb: float
    source: str


def needed_mb(case: Case, ranks: int = 1, folder: bool = True) -> float:
    """Greatest memory of a run, of all its ranks together, MB; an estimate, nothing is meshed.

    Args:
        case: the case.
        ranks: how many solve it.
        folder: the run has one, and leaves pictures and fields there.
    """
    model = choose_model(case)[0].elements()
    if model is None:
        return _ALONE_MB
    size = model.size(case)
    # solution and pictures one after the other, and the solution's memory is not given back
    drawing = _drawing_mb(case, model.drawn(case, size)) if folder else 0.0
    return model.memory_mb(size) + drawing + RANK_MB * (ranks - 1)


def _drawing_mb(case: Case, elements: float) -> float:
    output = case.output
    if not (output.pictures or output.fields):
        return 0.0
    return (_PICTURES_MB if output.pictures else 0.0) + _DRAWN_MB * elements


def room(root: Path = Path("/")) -> Room | None:
    """The memory that is free here: the system's, or less where a control group has a limit.

    What the system would give back from its caches counts as free.

    Args:
        root: where `proc` and `sys` lie.

    Returns:
        None where the system does not say.
    """
    found = [*_system(root), *_groups(root)]
    return min(found, key=lambda item: item.mb, default=None)


def _system(root: Path) -> Iterator[Room]:
    for line in _read(root / "proc/meminfo").splitlines():
        name, _, value = line.partition(":")
        if name == "MemAvailable":
            yield Room(int(value.split()[0]) * 1024 * _MB, "of this machine")


def _groups(root: Path) -> Iterator[Room]:
    """What the control groups of this process leave, versions 1 and 2, with those around them."""
    for line in _read(root / "proc/self/cgroup").splitlines():
        _, controllers, path = line.split(":", 2)
        if controllers and "memory" not in controllers.split(","):
            continue
        first = "sys/fs/cgroup/memory" if controllers else "sys/fs/cgroup"
        top = root / first
        inside = Path(path.lstrip("/"))
        # in a container the path is often that on its host, and the group is the top itself
        for group in (inside, *inside.parents):
            yield from _group(top / group, bool(controllers))


def _group(folder: Path, first_version: bool) -> Iterator[Room]:
    names = ("memory.max", "memory.current", "inactive_file")
    if first_version:
        names = ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
    limit, used = (_read(folder / name).strip() for name in names[:2])
    if not (limit.isdecimal() and used.isdecimal()) or int(limit) >= _UNLIMITED:
        return
    words = (line.split() for line in _read(folder / "memory.stat").splitlines())
    cached = next((int(w[1]) for w in words if len(w) == 2 and w[0] == names[2]), 0)
    free = max(int(limit) - max(int(used) - cached, 0), 0)
    yield Room(free * _MB, "under the limit of its control group")


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError:
        return ""


def shortage(needs: Sequence[float], free: Room | None, what: str = "the run") -> str | None:
    """Why what is to run at once does not fit, or None.

    Args:
        needs: memory of each process that runs at once, MB.
        free: what there is; None: not known, and nothing is refused.
        what: what needs it.
    """
    total = math.fsum(needs)
    if free is None or total <= free.mb:
        return None
    each = f" ({len(needs)} at once)" if len(needs) > 1 else ""
    return (
        f"{what} needs about {gigabytes(total)}{each}, {gigabytes(free.mb)} are free "
        f"{free.source}: expected a coarser or smaller problem, fewer "
        "pictures and fields, or --force"
    )


def refuse_shortage(case: Case, comm: Any, folder: bool) -> None:
    """Refuse a case whose run would not fit into what is free; collective, the same on all ranks.

    Args:
        case: the case.
        comm: communicator of mpi4py whose ranks solve it, on one machine or several.
        folder: the run has one, and leaves pictures and fields there.

    Raises:
        CaseError: with both figures.
    """
    from mpi4py import MPI

    here = comm.Split_type(MPI.COMM_TYPE_SHARED)
    share = needed_mb(case, comm.size, folder) * here.size / comm.size
    # one rank of each machine asks, for the others begin to take memory meanwhile
    mine = shortage([share], room()) if here.rank == 0 else None
    here.Free()
    text = next((text for text in comm.allgather(mine) if text is not None), None)
    if text is not None:
        raise CaseError([Problem("memory", text)])


def fits(case: Case, comm: Any, folder: bool) -> bool:
    """Whether there is memory for a case; collective, the same on all ranks."""
    try:
        refuse_shortage(case, comm, folder)
    except CaseError:
        return False
    return True


def gigabytes(mb: float) -> str:
    """A memory in words, two digits."""
    value = mb / 1000
    digits = 1 - math.floor(math.log10(value)) if value > 0 else 1
    return f"{round(value, max(digits, 1)) if digits > 0 else round(value, digits):g} GB"

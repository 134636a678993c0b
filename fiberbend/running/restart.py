"""The checkpoint of a run: written after every step, read to go on after a kill."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fem.march.position import Position
from fem.results.checkpoint import Archive
from fiberbend import columns as col
from fiberbend.results.folder import (
    CHECKPOINT,
    CHECKPOINT_BEFORE,
    FIBERS,
    MESH,
    RunFolder,
    checkpoints,
)
from fiberbend.results.states import LAST, STEP, read_snapshot, snapshot_paths
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.states.snapshot import Snapshot
from geometry.mesh.data import MeshData
from machine.folders import DAMAGED


@dataclasses.dataclass(frozen=True)
class Saved:
    """What a run goes on from.

    Attributes:
        position: where its march stood.
        rows: its history.
        snapshots: those it had taken.
        warnings: what it had warned of.
    """

    position: Position
    rows: list[dict[str, Any]]
    snapshots: list[Snapshot]
    warnings: list[str]


def save(
    folder: RunFolder,
    archive: Archive,
    position: Position,
    rows: list[dict[str, Any]],
    warnings: Sequence[str],
) -> None:
    """Write all that is needed to go on from here, and the history; collective.

    The checkpoint before stays, for when this one is damaged.

    Args:
        folder: the run folder.
        archive: moves states to rank 0.
        position: where the march stands.
        rows: rows of the history so far.
        warnings: what was warned of so far; not all of it is seen again.
    """
    arrays = archive.pack(position)
    history = np.array(json.dumps(rows, default=float))
    folder.replace(CHECKPOINT, CHECKPOINT_BEFORE)
    warned = np.array(json.dumps(list(warnings)))
    folder.write_arrays(CHECKPOINT, rows=history, warnings=warned, **arrays)
    folder.write_history(rows)


def load(folder: RunFolder, archive: Archive, say: Callable[[str], None]) -> Saved | None:
    """The last checkpoint that is whole; None where there is none; collective.

    The scene is left in the last state.

    Args:
        folder: the run folder.
        archive: moves states from rank 0.
        say: takes a line for the user where a checkpoint is damaged.
    """
    comm = archive.comm
    arrays: dict[str, Any] | None = None
    if comm.rank == 0:
        arrays = _newest(folder.path, say)
    arrays = comm.bcast(arrays)
    if arrays is None:
        return None
    rows, warnings = (json.loads(str(arrays.pop(name, "[]"))) for name in ("rows", "warnings"))
    if not rows or not all(map(col.is_column, rows[-1])):
        text = "of another version of fiberbend, cannot be resumed: expected --overwrite"
        raise CaseError([Problem(str(folder.path / CHECKPOINT), text)])
    snapshots = []
    asked = (p for p in snapshot_paths(folder.path) if not p.stem.startswith(STEP))
    for shot in asked:
        snapshot = read_snapshot(shot, say)
        if snapshot and snapshot.step <= rows[-1][col.STEP] and snapshot.label != LAST:
            snapshots.append(snapshot)
    snapshots.sort(key=lambda snapshot: snapshot.step)
    return Saved(archive.unpack(arrays), rows, snapshots, warnings)


def mesh(folder: RunFolder) -> MeshData | None:
    """The mesh of a run; None where it was killed before it had one, or where it is damaged."""
    try:
        return MeshData.load(folder.path / MESH)
    except (FileNotFoundError, *DAMAGED):
        return None


def discard(folder: RunFolder) -> None:
    """Remove what a run would be resumed from."""
    paths = (*checkpoints(folder.path), *snapshot_paths(folder.path))
    for name in (MESH, FIBERS, *(str(path.relative_to(folder.path)) for path in paths)):
        folder.remove(name)


def _newest(path: Path, say: Callable[[str], None]) -> dict[str, Any] | None:
    for name, instead in ((CHECKPOINT, "the one before"), (CHECKPOINT_BEFORE, "the beginning")):
        try:
            with np.load(path / name) as file:
                return dict(file)
        except FileNotFoundError:
            continue
        except DAMAGED:
            say(f"{path / name} is damaged: goes on from {instead}")
    return None

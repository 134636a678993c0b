"""The checkpoint of a run: written after every step, read to go on after a kill."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np

from fem.march.position import Position
from fem.results.checkpoint import Archive
from fiberbend import columns as col
from fiberbend.running.folder import CHECKPOINT, RunFolder
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.states.snapshot import Snapshot


@dataclasses.dataclass(frozen=True)
class Saved:
    """What a run goes on from.

    Attributes:
        position: where its march stood.
        rows: its history.
        snapshots: those it had taken.
    """

    position: Position
    rows: list[dict[str, Any]]
    snapshots: list[Snapshot]


def save(
    folder: RunFolder, archive: Archive, position: Position, rows: list[dict[str, Any]]
) -> None:
    """Write all that is needed to go on from here, and the history; collective.

    Args:
        folder: the run folder.
        archive: moves states to rank 0.
        position: where the march stands.
        rows: rows of the history so far.
    """
    arrays = archive.pack(position)
    history = np.array(json.dumps(rows, default=float))
    folder.write_arrays(CHECKPOINT, rows=history, **arrays)
    folder.write_history(rows)


def load(folder: RunFolder, archive: Archive) -> Saved | None:
    """The checkpoint; None where the run was killed before its first step; collective.

    The scene is left in the last state.
    """
    path = folder.path / CHECKPOINT
    if not path.exists():
        return None
    with np.load(path) as file:
        arrays = dict(file)
    if "rows" not in arrays:
        text = "of another version of fiberbend, cannot be resumed: expected --overwrite"
        raise CaseError([Problem(str(path), text)])
    rows = json.loads(str(arrays.pop("rows")))
    snapshots = []
    for shot in sorted((folder.path / "snapshots").glob("*.npz")):
        with np.load(shot) as file:
            entries = {k: file[k] if file[k].ndim else file[k].item() for k in file.files}
        snapshot = Snapshot(**{"fiber_force": None, **entries})
        if snapshot.step <= rows[-1][col.STEP] and snapshot.label != "last":
            snapshots.append(snapshot)
    return Saved(
        archive.unpack(arrays), rows, sorted(snapshots, key=lambda snapshot: snapshot.step)
    )

"""The checkpoint of a run: written after every step, read to go on after a kill."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np

from fem.march.march import March
from fem.march.records import Report
from fem.results.checkpoint import Archive
from fiberbend.running.folder import RunFolder
from fiberbend.running.history import Recorder
from fiberbend.states.snapshot import Snapshot

CHECKPOINT = "checkpoint.npz"


def save(folder: RunFolder, archive: Archive, march: March, rows: list[dict[str, Any]]) -> None:
    """Write all that is needed to go on from here, and the history; collective."""
    packed = [archive.pack(state) for state in march.states]
    position = {
        "ramp": march.ramp,
        "increment": march.increment,
        "report": dataclasses.asdict(march.report),
        "rows": rows,
    }
    arrays = {
        f"{i}|{name}": value
        for i, state in enumerate(packed)
        for name, value in (state or {}).items()
    }
    text = json.dumps(position, default=float)
    folder.write_arrays(CHECKPOINT, position=np.array(text), **arrays)
    folder.write_history(rows)


def load(folder: RunFolder, archive: Archive, march: March, recorder: Recorder) -> list[Snapshot]:
    """Put march and recorder where the checkpoint left them; collective.

    Returns:
        The snapshots that the run had taken; none when it was killed before its first step.
    """
    path = folder.path / CHECKPOINT
    if not path.exists():
        return []
    with np.load(path) as file:
        position = json.loads(str(file["position"]))
        states: dict[str, dict[str, Any]] = {}
        for key in file.files:
            number, _, name = key.partition("|")
            if name:
                states.setdefault(number, {})[name] = file[key]
    march.states = [archive.unpack(states[number]) for number in sorted(states)]
    march.equilibrium.restore(march.states[-1])
    march.ramp = position["ramp"]
    march.increment = position["increment"]
    march.report = Report(**position["report"])
    recorder.rows = position["rows"]
    last = recorder.rows[-1]["step"]
    snapshots = []
    for shot in sorted((folder.path / "snapshots").glob("*.npz")):
        with np.load(shot) as file:
            entries = {k: file[k] if file[k].ndim else file[k].item() for k in file.files}
        snapshot = Snapshot(**{"fiber_force": None, **entries})
        if snapshot.step <= last and snapshot.label != "last":
            snapshots.append(snapshot)
    return sorted(snapshots, key=lambda snapshot: snapshot.step)

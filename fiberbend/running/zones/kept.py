"""Zones that are solved, as files of a run: taken up where it goes on after a kill."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fiberbend import columns as col
from fiberbend.results.folder import ZONES, RunFolder
from fiberbend.running.zones.march import Solved, ZoneMarch
from machine.folders import DAMAGED


def save(folder: RunFolder, zone: ZoneMarch) -> None:
    """Write all that a zone's march through the shared pressures has found.

    Args:
        folder: of the run.
        zone: solved.
    """
    solved = zone.solved()
    about = {"pressures": solved.pressures, "rows": solved.rows, "walls": solved.walls}
    text = np.array(json.dumps(about, default=float))
    folder.write_arrays(_name(zone), about=text, **zone.archive.pack(solved.position))


def take_up(
    folder: RunFolder, zone: ZoneMarch, pressures: Sequence[float], say: Callable[[str], None]
) -> bool:
    """Put a zone where its march of an earlier process ended.

    Args:
        folder: of the run.
        zone: at rest.
        pressures: that it was to reach, MPa.
        say: takes a line for the user where its file is damaged.

    Returns:
        Whether there was such a march; else it is still at rest.
    """
    path = folder.path / _name(zone)
    try:
        with np.load(path) as file:
            arrays: dict[str, Any] = dict(file)
        about = json.loads(str(arrays.pop("about")))
    except FileNotFoundError:
        return False
    except DAMAGED:
        say(f"{path} is damaged: {zone.name} is solved again")
        return False
    known = all(map(col.is_column, about["rows"][-1]))
    if not known or not {*about["pressures"]} <= {0.0, *pressures}:
        say(f"{path} is of another version of fiberbend: {zone.name} is solved again")
        return False
    position = zone.archive.unpack(arrays)
    zone.take_up(Solved(position, about["pressures"], about["rows"], about["walls"]))
    return True


def _name(zone: ZoneMarch) -> str:
    return f"{ZONES}/zone_{zone.number + 1}.npz"

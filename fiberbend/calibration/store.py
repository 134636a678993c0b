"""Calibrations that were found before, a small file each in the user's own cache."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from fiberbend.calibration import record
from fiberbend.calibration.record import Calibration
from fiberbend.process.kept import Kept

FOLDER = "calibrations"
"""Within the cache."""
_SUM = "sum"


class Store(Kept):
    """Calibrations by the digest of what enters them.

    Args:
        path: the folder, which need not be there; None: the user's own.
    """

    def __init__(self, path: Path | None = None) -> None:
        super().__init__(FOLDER, "calibrations", ".json", path)

    def find(self, digest: str) -> Calibration | None:
        """The calibration of a digest, or None where there is none that is whole."""
        return self.read(digest, lambda content: _read(json.loads(content), digest))

    def keep(self, digest: str, found: Calibration, content: dict[str, Any]) -> None:
        """Write a calibration, whole or not at all; where it cannot be kept, that is a remark.

        Args:
            digest: of what enters.
            found: the calibration.
            content: what enters, for a reader of the file.
        """
        entry = {"digest": digest, "found": found.entries(), "of": content}
        entry[_SUM] = _sum(entry)
        self.write(digest, json.dumps(entry, indent=1).encode())


def _read(entry: Any, digest: str) -> Calibration:
    if not isinstance(entry, dict) or not isinstance(entry.get("found"), dict):
        raise ValueError("it holds no calibration")
    if entry.pop(_SUM, None) != _sum(entry):
        raise ValueError("its content is not what was written")
    if entry["digest"] != digest:
        raise ValueError("it is of another section")
    return record.read(entry["found"])


def _sum(entry: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(entry, sort_keys=True).encode()).hexdigest()

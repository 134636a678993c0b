"""Tables that were made before, a file each in the user's own cache, by what enters them."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import tempfile
from pathlib import Path

from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.sectionlaw.made import Made, unpacked
from fiberbend.trial.calibrations import flat
from machine import folders

FOLDER = "tables"
"""Within the cache."""
_CODE = (
    *("fem", "rod", "geometry", "materials", "analytic"),
    *(f"fiberbend/{name}" for name in ("calibration", "case", "effects", "models", "schema")),
    *(f"fiberbend/{name}" for name in ("sectionlaw", "trial", "uniform")),
)
"""Folders whose files say what a number means."""
_KINDS = (".py", ".c", ".yaml", ".json")
_DIGITS = 16


def digest_of(case: Case, error: float, least: float | None, wide: float = 1.0) -> str:
    """A hash of section, rubber, winding, range, error and code; titles and output do not enter."""
    parts = {"actuator": case.actuator, "materials": case.materials}
    parts |= {f"effect {number}": effect for number, effect in enumerate(case.effects)}
    content = {
        "case": [(path, repr(value)) for name in parts for path, value in flat(parts[name], name)],
        "kinds": [effect.name for effect in case.effects],
        "mesh": case.mesh.model_dump_json(),
        "model": choose_model(case)[0].name,
        "solver": case.solver.model_dump_json(),
        "error": repr(error),
        "least": repr(least),
        "wide": repr(wide),
        "code": _code(),
    }
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()[:_DIGITS]


@functools.cache
def _code() -> str:
    root, found = Path(__file__).resolve().parents[2], hashlib.sha256()
    for folder in _CODE:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in _KINDS:
                name = str(file.relative_to(root)).encode()
                found.update(name + b"\0" + file.read_bytes())
    return found.hexdigest()


class Store:
    """Tables by their digest.

    Args:
        path: the folder, which need not be there; None: the user's own.

    Attributes:
        remarks: what was wrong with the folder or with a file in it, for the user.
    """

    def __init__(self, path: Path | None = None) -> None:
        self.remarks: list[str] = []
        self._path: Path | None = None
        try:
            wanted = folders.cache_root().path / FOLDER if path is None else path
        except folders.MachineError as error:
            self.remarks.append(str(error))
            return
        if why := folders.refusal(wanted):
            self.remarks.append(f"{wanted} is not used for tables: {why}")
        else:
            self._path = wanted

    def find(self, digest: str) -> Made | None:
        """The table of a digest, or None where there is none that is whole."""
        if self._path is None:
            return None
        file = self._path / f"{digest}.npz"
        try:
            found = unpacked(file.read_bytes())
            if found.digest != digest:
                raise ValueError("it is of another section")
        except FileNotFoundError:
            return None
        except (OSError, ValueError) as error:
            self.remarks.append(f"{file} is damaged and made anew: {error}")
            return None
        return found

    def keep(self, made: Made) -> None:
        """Write a table, whole or not at all; where it cannot be kept, that is a remark."""
        if self._path is None:
            return
        try:
            folders.make_private(self._path)
            handle, draft = tempfile.mkstemp(prefix=f".{made.digest}.", dir=self._path)
            try:
                with os.fdopen(handle, "wb") as file:
                    file.write(made.packed())
                os.replace(draft, self._path / f"{made.digest}.npz")
            except BaseException:
                Path(draft).unlink(missing_ok=True)
                raise
        except (OSError, folders.MachineError) as error:
            self.remarks.append(f"{self._path}: the table is not kept: {error}")

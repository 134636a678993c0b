"""Tables that were made before, a file each in the user's own cache, by what enters them."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

from fiberbend.case.case import Case
from fiberbend.models.choice import choose_model
from fiberbend.process.kept import Kept
from fiberbend.sectionlaw.made import Made, unpacked
from fiberbend.trial.calibrations import flat

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


def digest_of(
    case: Case,
    strains: tuple[str, ...],
    error: float,
    least: float | None,
    loads: Sequence[float],
) -> str:
    """A hash of section, rubber, winding, range, error and code; titles and output do not enter."""
    parts = {"actuator": case.actuator, "materials": case.materials}
    parts |= {f"effect {number}": effect for number, effect in enumerate(case.effects)}
    content = {
        "case": [(path, repr(value)) for name in parts for path, value in flat(parts[name], name)],
        "kinds": [effect.name for effect in case.effects],
        "mesh": case.mesh.model_dump_json(),
        "model": choose_model(case)[0].name,
        "solver": case.solver.model_dump_json(),
        "strains": strains,
        "error": repr(error),
        "least": repr(least),
        "loads": [repr(load) for load in loads],
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


class Store(Kept):
    """Tables by their digest.

    Args:
        path: the folder, which need not be there; None: the user's own.
    """

    def __init__(self, path: Path | None = None) -> None:
        super().__init__(FOLDER, "tables", ".npz", path)

    def find(self, digest: str) -> Made | None:
        """The table of a digest, or None where there is none that is whole."""

        def parse(content: bytes) -> Made:
            found = unpacked(content)
            if found.digest != digest:
                raise ValueError("it is of another section")
            return found

        return self.read(digest, parse)

    def keep(self, made: Made) -> None:
        """Write a table, whole or not at all; where it cannot be kept, that is a remark."""
        self.write(made.digest, made.packed())

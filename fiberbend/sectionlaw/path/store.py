"""Laws about free states that were made before, beside the tables in the user's own cache."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fiberbend.case.case import Case
from fiberbend.process.kept import Kept
from fiberbend.sectionlaw.path.law import SPACE
from fiberbend.sectionlaw.path.made import KIND, PathMade, unpacked
from fiberbend.sectionlaw.store import FOLDER, digest_of


def digest_about(case: Case, error: float, loads: Sequence[float]) -> str:
    """A hash of section, rubber, winding, range, error and code, as that of a table."""
    return digest_of(case, (*SPACE, KIND), error, None, loads)


class PathStore(Kept):
    """Laws by their digest.

    Args:
        path: the folder, which need not be there; None: the user's own.
    """

    def __init__(self, path: Path | None = None) -> None:
        super().__init__(FOLDER, "laws of sections", ".npz", path)

    def find(self, digest: str) -> PathMade | None:
        """The law of a digest, or None where there is none that is whole."""

        def parse(content: bytes) -> PathMade:
            found = unpacked(content)
            if found.digest != digest:
                raise ValueError("it is of another section")
            return found

        return self.read(digest, parse)

    def keep(self, made: PathMade) -> None:
        """Write a law, whole or not at all; where it cannot be kept, that is a remark."""
        self.write(made.digest, made.packed())

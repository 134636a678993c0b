"""Folders of results that one process makes at once: designs and hands."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from fiberbend.process import remains
from fiberbend.process.lock import FolderLock, HeldError
from fiberbend.results.folder import FILES, RunFolder
from fiberbend.schema.problems import CaseError, Problem

_CRASHED = ("error.log", "error.rank*.log")


@contextlib.contextmanager
def held(path: Path, mark: str, kind: str, overwrite: bool) -> Iterator[RunFolder]:
    """A folder that is new, empty or that of one of the kind, which is replaced.

    Args:
        path: the folder.
        mark: the file by which it is of that kind.
        kind: a design, a hand.
        overwrite: replace one that is there.

    Raises:
        CaseError: it is not, or cannot be made.
    """
    try:
        names = remains.entries(path) if path.exists() else []
        # of one that has crashed before it wrote anything
        crashed = all(remains.matches(name, _CRASHED) for name in names)
        if names and not overwrite and not crashed:
            text = "exists, expected a new folder, or --overwrite"
            raise CaseError([Problem(str(path), text)])
        if not crashed and mark not in names:
            text = f"contains no {kind}, expected the folder of a {kind}"
            raise CaseError([Problem(str(path), text)])
        path.mkdir(parents=True, exist_ok=True)
        lock = FolderLock(path)
    except HeldError as error:
        text = f"{error}, expected its end, or another folder by --out"
        raise CaseError([Problem(str(path), text)]) from None
    except OSError as error:
        raise CaseError([Problem(str(path), f"{error.strerror}, expected a folder")]) from None
    try:
        for old in remains.found(path, FILES):
            old.unlink(missing_ok=True)
        yield RunFolder(path)
    finally:
        lock.release()

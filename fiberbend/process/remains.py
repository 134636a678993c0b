"""What a killed process leaves in a folder, and what of it may be removed."""

from __future__ import annotations

import contextlib
import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path

from fiberbend.process.lock import LOCK_FILE

ASIDE = ".fiberbend-replaced"
"""Where files of a run are while new ones take their place."""
_SUFFIX = ".part"
_PART = re.compile(r"\..+\.[a-z0-9_]{8}\.part")


def begin(target: Path) -> tuple[int, str]:
    """Open a file beside a target that is renamed to it when it is whole; descriptor and path."""
    return tempfile.mkstemp(prefix=f".{target.name}.", suffix=_SUFFIX, dir=target.parent)


def let_others_read(path: Path | str) -> None:
    """Give a file of `begin`, which only its owner can read, the rights of any new file."""
    mask = os.umask(0)
    os.umask(mask)
    os.chmod(path, 0o666 & ~mask)


def matches(name: str, patterns: Sequence[str]) -> bool:
    """Whether a path within a folder is one of those named; '*' stands for no '/'."""
    parts = name.split("/")
    return any(
        len(parts) == len(wanted)
        and all(fnmatchcase(part, pattern) for part, pattern in zip(parts, wanted, strict=True))
        for wanted in (pattern.split("/") for pattern in patterns)
    )


def entries(folder: Path) -> list[str]:
    """Names in a folder but what a start has left that was killed at once."""
    return [
        entry.name
        for entry in folder.iterdir()
        if entry.name not in (LOCK_FILE, ASIDE) and not _PART.fullmatch(entry.name)
    ]


def found(folder: Path, patterns: Sequence[str]) -> list[Path]:
    """The files of a folder that are named, sorted."""
    # each folder is read once: glob reads it again for every pattern
    places: dict[str, list[str]] = {}
    for pattern in patterns:
        place, _, name = pattern.rpartition("/")
        places.setdefault(place, []).append(name)
    there: set[Path] = set()
    for place, names in places.items():
        with contextlib.suppress(FileNotFoundError, NotADirectoryError):
            for entry in os.listdir(folder / place):
                if any(fnmatchcase(entry, name) for name in names):
                    there.add(folder / place / entry)
    return sorted(there)


def clear(folder: Path, first: str, patterns: Sequence[str]) -> None:
    """Remove parts of files, and finish or undo a replacement; by who holds the folder.

    Args:
        folder: the folder.
        first: the file that is moved aside last and written first.
        patterns: what is written there.
    """
    for place in {folder, *((folder / pattern).parent for pattern in patterns)}:
        for part in place.glob(f".*{_SUFFIX}"):
            if _PART.fullmatch(part.name):
                part.unlink()
    aside = folder / ASIDE
    if not aside.is_dir():
        return
    if not (aside / first).exists():
        _move(aside, folder, found(aside, patterns))
    _remove(aside, patterns)


@contextlib.contextmanager
def aside(folder: Path, first: str, patterns: Sequence[str]) -> Iterator[None]:
    """Move what is named aside, and remove it at the end; put it back where that is an error.

    All within the folder, which may be a mount point or the current folder. What is not named
    stays. Killed meanwhile, `clear` ends it either way.

    Args:
        folder: the folder.
        first: the file that makes the others a run: moved last.
        patterns: what is moved.
    """
    old, store = found(folder, patterns), folder / ASIDE
    if not old:
        yield
        return
    store.mkdir()
    try:
        _move(folder, store, [path for path in old if path != folder / first])
        _move(folder, store, [path for path in old if path == folder / first])
        yield
    except BaseException:
        _move(store, folder, found(store, patterns))
        _remove(store, patterns)
        raise
    _remove(store, patterns)


def _move(source: Path, target: Path, paths: Sequence[Path]) -> None:
    for path in paths:
        goal = target / path.relative_to(source)
        goal.parent.mkdir(parents=True, exist_ok=True)
        os.replace(path, goal)


def _remove(store: Path, patterns: Sequence[str]) -> None:
    for path in found(store, patterns):
        path.unlink()
    # deepest first; a folder with something else in it stays
    for place in sorted({(store / name).parent for name in patterns}, reverse=True):
        with contextlib.suppress(OSError):
            place.rmdir()
    with contextlib.suppress(OSError):
        store.rmdir()

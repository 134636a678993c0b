"""Folders for compiled kernels, settings and temporary files, where the environment names bad ones.

Compiled kernels are executed: a folder that others can write is theirs, not ours.
"""

from __future__ import annotations

import dataclasses
import functools
import os
import tempfile
import zipfile
import zlib
from pathlib import Path

_OTHERS, _GROUP, _STICKY = 0o002, 0o020, 0o1000
CACHE = "XDG_CACHE_HOME"
DAMAGED = (zipfile.BadZipFile, zlib.error, ValueError, EOFError, KeyError, NotImplementedError)
"""How reading a file of arrays ends that is cut off or changed: zip has a check sum of each."""


class MachineError(Exception):
    """This computer lacks what a run needs; the message says what to install or to set."""


@dataclasses.dataclass(frozen=True)
class Chosen:
    """A folder, and why it is not the first choice; empty where it is.

    Attributes:
        path: the folder, which may not be there yet.
        remark: a line for the user.
    """

    path: Path
    remark: str = ""


def refusal(folder: Path) -> str:
    """Why a folder can hold nothing that is executed later; empty where it can.

    Args:
        folder: a folder that is there, or that is to be made.
    """
    path = Path(os.path.realpath(folder))
    if os.path.exists(path):
        if not path.is_dir():
            return "it is no folder"
        status = path.stat()
        if status.st_uid != os.geteuid():
            return "another user owns it"
        if status.st_mode & (_OTHERS | _GROUP):
            return "others can write it"
    there = _there(path)
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        return "it cannot be written"
    for parent in (there, *there.parents):
        mode = parent.stat().st_mode
        if mode & _OTHERS and not mode & _STICKY:
            return f"others can write {parent}"
    return ""


def make_private(folder: Path) -> None:
    """Make a folder and what it lies in, for this user alone.

    Raises:
        MachineError: it cannot be made.
    """
    try:
        for path in (*reversed(folder.parents), folder):
            if not os.path.exists(path):
                path.mkdir(mode=0o700, exist_ok=True)
    except OSError as error:
        raise MachineError(f"{folder}: {error.strerror}; set {CACHE} to another folder") from None


def cache_root() -> Chosen:
    """The folder of compiled kernels: under XDG_CACHE_HOME, the home or the temporary folder.

    Raises:
        MachineError: none of them can be used.
    """
    return _cache_root(os.environ.get(CACHE, ""), os.environ.get("HOME"), os.geteuid())


@functools.lru_cache
def _cache_root(named: str, _home: str | None, user: int) -> Chosen:
    candidates = []
    if os.path.isabs(named):
        candidates.append(Path(named) / "fiberbend")
    else:
        home = _home_folder()
        candidates += [home / ".cache" / "fiberbend"] if home else []
    if (temporary := temporary_folder()) is not None:
        candidates.append(temporary / f"fiberbend-{user}")
    against: list[str] = []
    for folder in candidates:
        why = refusal(folder)
        if not why:
            taken = f"; {folder} is taken, set {CACHE} to choose another"
            return Chosen(folder, "; ".join(against) + taken if against else "")
        against.append(f"{folder} is not used for compiled kernels: {why}")
    wanted = f"set {CACHE} to a folder that only you can write"
    raise MachineError("; ".join([*against, wanted]))


def temporary_folder() -> Path | None:
    """A folder for temporary files, or None where none can be written."""
    try:
        return Path(tempfile.gettempdir())
    except FileNotFoundError:
        return None


def settle() -> list[str]:
    """Give libraries usable folders in the variables that they read, where those name none.

    Open MPI ends without a temporary folder, dolfinx without a home, and matplotlib, which cannot
    write its settings, looks for fonts in every run.

    Returns:
        Lines for the user, where what the environment says is not followed.

    Raises:
        MachineError: no folder can be used.
    """
    lines = []
    given, found = os.environ.get("TMPDIR"), temporary_folder()
    if found is None:
        raise MachineError("no folder for temporary files: set TMPDIR to one that you can write")
    if given and Path(os.path.abspath(given)) != found:
        lines.append(f"TMPDIR={given} cannot be written, {found} is taken")
    if given or found != Path("/tmp"):
        os.environ["TMPDIR"] = str(found)
    home = _home_folder()
    if home is None:
        home = cache_root().path
        os.environ["HOME"] = str(home)
    settings = home / ".config"
    if "MPLCONFIGDIR" not in os.environ and not os.access(_there(settings), os.W_OK | os.X_OK):
        os.environ["MPLCONFIGDIR"] = str(cache_root().path / "matplotlib")
    return lines


def _home_folder() -> Path | None:
    """The home that HOME or the list of users names; None where there is neither."""
    try:
        return Path.home()
    except RuntimeError:
        return None


def _there(path: Path) -> Path:
    """A path, or the nearest folder around it that is there."""
    return next(part for part in (path, *path.parents) if os.path.exists(part))

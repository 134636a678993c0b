"""Where numbers come from: the computer, its linear algebra, and the commit of the source."""

from __future__ import annotations

import contextlib
import ctypes
import functools
import os
import platform
import re
from pathlib import Path
from typing import Any

_COMMIT = re.compile(r"[0-9a-f]{40,64}")
_LIBRARIES = {
    "openblas": "OpenBLAS",
    "blis": "BLIS",
    "mkl": "MKL",
    "atlas": "ATLAS",
    "libblas": "reference BLAS",
}
"""Parts of the names of libraries, and what they are."""
_NAMES = tuple(
    f"{before}openblas_{{}}{after}" for before in ("", "scipy_") for after in ("", "64_", "_64")
)
"""What builds of OpenBLAS call their functions."""


@functools.cache
def machine() -> dict[str, Any]:
    """Processor, cores and system of this computer; starts no process."""
    affinity = getattr(os, "sched_getaffinity", None)
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "usable_cores": len(affinity(0)) if affinity else os.cpu_count(),
        "system": f"{platform.system()} {platform.release()} {platform.machine()}",
    }


def blas() -> dict[str, Any] | None:
    """The BLAS that this process has loaded: library, kernel and threads; None before it has.

    The kernel decides in which order sums are taken, and so about the last digits.
    """
    path = blas_file()
    if path is None:
        return None
    kind = next(name for part, name in _LIBRARIES.items() if part in path.name)
    found: dict[str, Any] = {"library": kind, "kernel": None, "threads": None}
    return found | _openblas(path) if kind == "OpenBLAS" else found


def blas_file() -> Path | None:
    """The library of it; None before this process has loaded one."""
    return next(iter(_loaded()), None)


def commit(source: Path) -> str | None:
    """The git commit of a source tree, read without git; None where it is not one.

    What has been changed since that commit does not show.

    Args:
        source: folder that has `.git` in it.
    """
    with contextlib.suppress(OSError, UnicodeDecodeError):
        place = source / ".git"
        if place.is_file():
            # a work tree beside its repository
            place = source / place.read_text(encoding="utf-8").removeprefix("gitdir:").strip()
        head = (place / "HEAD").read_text(encoding="utf-8").strip()
        if head.startswith("ref:"):
            head = _reference(place, head.removeprefix("ref:").strip())
        return head if _COMMIT.fullmatch(head) else None
    return None


def _reference(place: Path, name: str) -> str:
    """The commit that a branch points to; empty where it is not found."""
    common = place
    if (place / "commondir").exists():
        common = place / (place / "commondir").read_text(encoding="utf-8").strip()
    for folder in (place, common):
        if (folder / name).exists():
            return (folder / name).read_text(encoding="utf-8").strip()
    packed = common / "packed-refs"
    text = packed.read_text(encoding="utf-8") if packed.exists() else ""
    pairs = (line.split() for line in text.splitlines() if not line.startswith(("#", "^")))
    return next((pair[0] for pair in pairs if pair[1:] == [name]), "")


def _processor() -> str:
    """Its name, as Linux has it; elsewhere its kind."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return " ".join(value.split())
    return platform.machine()


def _loaded() -> list[Path]:
    """Shared libraries of this process, the one that the solver uses first.

    OpenBLAS stands before names that may be a link to it, and behind it what the wheels of numpy
    and scipy bring for themselves.
    """
    with contextlib.suppress(OSError):
        text = Path("/proc/self/maps").read_text(encoding="utf-8")
        found = {line.split(maxsplit=5)[5] for line in text.splitlines() if ".so" in line}
        kinds = list(_LIBRARIES)
        maybe = (Path(name) for name in found if any(kind in name for kind in kinds))
        known = [path for path in maybe if any(kind in path.name for kind in kinds)]

        def order(path: Path) -> tuple[int, bool, str]:
            kind = next(i for i, part in enumerate(kinds) if part in path.name)
            return kind, "scipy_openblas" in path.name, str(path)

        return sorted(known, key=order)
    return []


def _openblas(path: Path) -> dict[str, Any]:
    """Version, kernel and threads, asked of the library itself."""
    found: dict[str, Any] = {}
    with contextlib.suppress(OSError):
        library = ctypes.CDLL(str(path))
        for name in _NAMES:
            with contextlib.suppress(AttributeError):
                core = getattr(library, name.format("get_corename"))
                core.restype = ctypes.c_char_p
                found["kernel"] = core().decode()
                threads = getattr(library, name.format("get_num_threads"))
                found["threads"] = int(threads())
                config = getattr(library, name.format("get_config"))
                config.restype = ctypes.c_char_p
                version = re.search(r"\d+\.\d+[.\d]*", config().decode())
                if version:
                    found["library"] = f"OpenBLAS {version[0]}"
                break
    return found

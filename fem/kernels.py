"""Compiled kernels: where they are kept, with which flags they are made, one compiler at a time."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
import logging
import os
import platform
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import dolfinx
import ffcx
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc

COMPILER_FLAGS = [
    *("-O3", "-march=native", "-g0"),
    # sums over quadrature points may be reordered, so that they vectorise; NaN stays NaN
    *("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math", "-fno-math-errno"),
    "-freciprocal-math",
]

for _name in ("FFCx", "ffcx", "UFL", "UFL_LEGACY"):
    logging.getLogger(_name).setLevel(logging.ERROR)


@functools.cache
def _processor() -> str:
    """What tells processors apart that cannot run each other's kernels."""
    with contextlib.suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return "".join(s for s in lines[:30] if s.startswith(("model name", "flags")))
    return platform.processor()


def cache_folder() -> Path:
    """Folder of compiled kernels, keyed by versions, compiler flags and processor."""
    key = "|".join([dolfinx.__version__, ffcx.__version__, ufl.__version__, np.__version__])
    digest = hashlib.sha1(f"{key}|{COMPILER_FLAGS}|{_processor()}".encode()).hexdigest()[:12]
    root = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return root / "fiberbend" / digest


_locked: list[Path] = []


@contextlib.contextmanager
def compiling(comm: MPI.Comm) -> Iterator[None]:
    """Let one process group at a time compile, and clear what a killed compiler left.

    A source without the mark that it is compiled makes the next process wait for the mark, and
    die. What compiles takes the lock by itself; around several compilations it saves time.
    """
    folder = cache_folder()
    if comm.rank != 0 or folder in _locked:
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        names = {entry.name for entry in os.scandir(folder)}
        for name in names:
            if name.endswith(".c") and f"{name}.cached" not in names:
                (folder / name).unlink()
        _locked.append(folder)
        try:
            yield
        finally:
            _locked.remove(folder)


def compiled(comm: MPI.Comm, make: Callable[[dict[str, Any]], Any]) -> Any:
    """What `make` compiles with the options of the compiler that it is given; collective."""
    options = {
        "cache_dir": str(cache_folder()),
        "cffi_extra_compile_args": COMPILER_FLAGS,
        "timeout": 3600,
    }
    previous = logging.root.manager.disable
    logging.disable(logging.INFO)  # the C compiler's calls
    try:
        with compiling(comm):
            return make(options)
    finally:
        logging.disable(previous)


def versions() -> dict[str, str]:
    """Versions of what computes."""
    major, minor, micro = PETSc.Sys.getVersion()
    return {
        "dolfinx": dolfinx.__version__,
        "petsc": f"{major}.{minor}.{micro}",
        "numpy": np.__version__,
    }

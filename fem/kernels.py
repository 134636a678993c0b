"""Forms derived and kernels compiled: where they are kept, by which flags, each of them once."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
import io
import logging
import os
import platform
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import cffi
import dolfinx
import dolfinx.jit
import ffcx
import numpy as np
import ufl
from ffcx.codegeneration import jit
from mpi4py import MPI
from petsc4py import PETSc
from ufl.corealg.traversal import traverse_unique_terminals

from fem import libraries
from machine import folders
from machine.folders import MachineError

COMPILER_FLAGS = [
    *("-O3", "-march=native", "-g0"),
    # sums over quadrature points may be reordered, so that they vectorise; NaN stays NaN
    *("-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math", "-fno-math-errno"),
    "-freciprocal-math",
]

_SUM = ".sum"
_MADE = (".c", ".c.cached", ".o", libraries.SUFFIX)
"""Endings of what the compiler makes: a folder of hundreds of kernels is slow to list."""

for _name in ("FFCx", "ffcx", "UFL", "UFL_LEGACY"):
    logging.getLogger(_name).setLevel(logging.ERROR)


@functools.cache
def _processor() -> str:
    """What tells processors apart that cannot run each other's kernels."""
    with contextlib.suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return "".join(s for s in lines[:30] if s.startswith(("model name", "flags")))
    return platform.processor()


@functools.cache
def _key() -> str:
    """What tells kernels apart that do not replace each other."""
    versions = [dolfinx.__version__, ffcx.__version__, ufl.__version__, np.__version__]
    key = "|".join([*versions, str(COMPILER_FLAGS), _processor(), _SUM])
    return hashlib.sha1(key.encode()).hexdigest()[:12]


def cache_folder() -> Path:
    """Folder of compiled kernels, keyed by versions, compiler flags and processor.

    Raises:
        MachineError: there is none that only this user can write.
    """
    return folders.cache_root().path / _key()


_told: set[str] = set()


def _prepare(comm: MPI.Comm) -> None:
    """Make the folder of kernels where there is none.

    Raises:
        MachineError: others could write in it.
    """
    if comm.rank != 0:
        return
    folder = cache_folder()
    _tell(folders.cache_root().remark)
    folders.make_private(folder)
    if why := folders.refusal(folder):
        raise MachineError(f"{folder} holds no kernels that can be trusted: {why}; remove it")


@contextlib.contextmanager
def _alone(folder: Path, name: str) -> Iterator[None]:
    """Let one process at a time compile a library; a process that is killed leaves no lock.

    Raises:
        MachineError: nothing can be locked in the folder.
    """
    path = folder / f"{name}.lock"
    while True:
        lock = None
        try:
            lock = path.open("w")
            fcntl.flock(lock, fcntl.LOCK_EX)
        except OSError as error:
            if lock is not None:
                lock.close()
            text = f"{folder} cannot be locked: {error.strerror}"
            raise MachineError(f"{text}; set {folders.CACHE} to another folder") from None
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(lock.fileno()), path.stat()):
                break
        # whoever had it has removed the file: it is no lock for those that come now
        lock.close()
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        lock.close()


def compiled(comm: MPI.Comm, make: Callable[[dict[str, Any]], Any]) -> Any:
    """What FFCx compiles in `make` with the options of the compiler that it is given; collective.

    Raises:
        MachineError: no C compiler, or it failed.
    """
    known = library(comm, [], libraries.declarations(), "#include <ufcx.h>", "types")
    with libraries.plain(known.ffi):
        return _compiled(comm, make)


def _compiled(comm: MPI.Comm, make: Callable[[dict[str, Any]], Any]) -> Any:
    """What `make` compiles, each file once and whole; see `compiled`."""
    options = {
        "cache_dir": str(cache_folder()),
        "cffi_extra_compile_args": COMPILER_FLAGS,
        "timeout": 3600,
    }
    previous = logging.root.manager.disable
    logging.disable(logging.INFO)  # the C compiler's calls
    try:
        _prepare(comm)
        with _only_sound() if comm.rank == 0 else contextlib.nullcontext():
            return make(options)
    except (cffi.VerificationError, RuntimeError) as error:
        # on several ranks dolfinx hands on the text of the error only
        if "compil" not in f"{type(error).__name__} {error}".lower():
            raise
        name = libraries.compiler()[0]
        if shutil.which(name) is None:
            text = f"no C compiler: {name} is not found; install gcc, or set CC or PATH"
            raise MachineError(text) from error
        what = str(error).splitlines()[0]
        raise MachineError(f"no kernel compiled in {options['cache_dir']}: {what}") from error
    finally:
        logging.disable(previous)


def library(
    comm: MPI.Comm, sources: Sequence[Path], declarations: str, head: str = "", title: str = ""
) -> Any:
    """C files of ours as a cffi module with `lib` and `ffi`, kept beside the forms; collective.

    Args:
        comm: communicator.
        sources: the C files, compiled as one, in this order.
        declarations: of its functions and types, for cffi.
        head: C before the files.
        title: how its name begins; else that of the last file.

    Raises:
        MachineError: no C compiler, or it failed.
    """
    text = "\n".join([head, *(source.read_text() for source in sources)])
    title = title or sources[-1].stem
    name = f"{title}_{hashlib.sha1((declarations + text).encode()).hexdigest()}"

    @dolfinx.jit.mpi_jit_decorator
    def load(options: dict[str, Any]) -> Any:
        folder = Path(options["cache_dir"])
        found = jit.get_cached_module(name, [], folder, options["timeout"])
        if found[0] is None:
            builder = cffi.FFI()
            flags = options["cffi_extra_compile_args"]
            place = [ffcx.codegeneration.get_include_path()]
            builder.set_source(name, text, extra_compile_args=flags, include_dirs=place)
            builder.cdef(declarations)
            with contextlib.redirect_stdout(io.StringIO()):
                builder.compile(tmpdir=str(folder), verbose=True)
            (folder / f"{name}.c.cached").touch(exist_ok=False)
            found = jit._load_objects(folder, name, [])
        return found[1]

    return _compiled(comm, lambda options: load(comm, options))


@contextlib.contextmanager
def _only_sound() -> Iterator[None]:
    """Kernels are loaded as they were compiled, or compiled anew, by one process each.

    A truncated library kills the process that loads it. Beside each stands the sum of its bytes;
    one without a sum was not finished, or is being compiled by who has its lock.
    """
    original, fresh = jit.get_cached_module, []
    with contextlib.ExitStack() as held:

        def checked(name: str, objects: Any, place: Any, timeout: int) -> Any:
            folder = Path(place)
            if not _sound(folder, name):
                held.enter_context(_alone(folder, name))
                if not _sound(folder, name):
                    _clear(folder, name)
            result = original(name, objects, place, timeout)
            if result[0] is None:
                fresh.append((folder, name))
            return result

        jit.get_cached_module = checked
        try:
            yield
        finally:
            jit.get_cached_module = original
        for folder, name in fresh:
            files, record = _files(folder, name)
            library = next(file for file in files if file.suffix == ".so")
            draft = folder / f"{record.name}.draft"
            draft.write_text(_sum(library))
            draft.replace(record)


def _sound(folder: Path, name: str) -> bool:
    """Whether a library is there as it was compiled."""
    files, record = _files(folder, name)
    library = next((file for file in files if file.suffix == ".so"), None)
    return library is not None and record.exists() and record.read_text() == _sum(library)


def _clear(folder: Path, name: str) -> None:
    """Remove what a compiler has not finished, or what was damaged since."""
    files, record = _files(folder, name)
    if record.exists():
        _tell(f"compiled kernels in {folder} were damaged: they are compiled anew")
        record.unlink()
    for file in files:
        file.unlink()


def _files(folder: Path, name: str) -> tuple[list[Path], Path]:
    """What the compiler makes of a module, and the file with the sum of its library."""
    files = (folder / f"{name}{ending}" for ending in _MADE)
    return [file for file in files if file.exists()], folder / f"{name}{_SUM}"


def _sum(library: Path) -> str:
    return hashlib.blake2b(library.read_bytes()).hexdigest()


def _tell(line: str) -> None:
    """A line for the user, once."""
    if line and line not in _told:
        _told.add(line)
        print(f"fiberbend: {line}", file=sys.stderr, flush=True)


def versions() -> dict[str, str]:
    """Versions of what computes."""
    major, minor, micro = PETSc.Sys.getVersion()
    return {
        "dolfinx": dolfinx.__version__,
        "petsc": f"{major}.{minor}.{micro}",
        "numpy": np.__version__,
    }


def differentiate(form: Any, variable: Any) -> Any:
    """∂/∂q of a lowered form for a global scalar q, by integrals; None where q is absent.

    Args:
        form: with its algebra lowered.
        variable: q, a UFL variable.
    """
    label = variable.label()
    # UFL takes as long to find that an integrand without q has no derivative as to derive one
    parts = [
        integral.reconstruct(ufl.diff(integral.integrand(), variable))
        for integral in form.integrals()
        if label in traverse_unique_terminals(integral.integrand())
    ]
    result = ufl.algorithms.apply_derivatives.apply_derivatives(ufl.Form(parts))
    return None if result.empty() else result


def upper_tangent(potential: Any, w: Any) -> Any:
    """∂²Π/∂w² by components of a mixed space: what is on and above the diagonal of blocks only.

    Entries below follow by symmetry: kernels take two thirds of the time.

    Args:
        potential: Π, a form.
        w: the unknowns, a function on a mixed space of scalar elements.
    """
    space = w.ufl_function_space()
    rows, columns = (ufl.split(make(space)) for make in (ufl.TestFunction, ufl.TrialFunction))
    count, zero = len(rows), ufl.constantvalue.Zero()
    result = ufl.Form([])
    for i in range(count):
        row = ufl.as_vector([rows[j] if j == i else zero for j in range(count)])
        above = ufl.as_vector([columns[j] if j >= i else zero for j in range(count)])
        result += ufl.derivative(ufl.derivative(potential, w, row), w, above)
    return result

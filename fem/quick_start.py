"""Imports of PETSc, ufl and ffcx: quicker, not steered by the working folder, and forgetful."""

from __future__ import annotations

import contextlib
import functools
import sys
import types
from collections.abc import Iterator
from importlib import metadata
from types import TracebackType
from typing import Any

from machine import folders, world

_FAILED, _INTERRUPTED = 1, 130
"""Exit codes of Python, and of a shell after Ctrl-C."""


def start_petsc() -> None:
    """Start MPI and PETSc; a file .petscrc of the working folder sets nothing.

    PETSc would take SIGTERM, SIGHUP, SIGPIPE and more, print a page and end the process, also that
    of a notebook.

    From here on an error that nobody catches ends all ranks, unless somebody sees to such errors:
    a rank that ends alone waits in MPI's own end for the others, which wait for it.

    Raises:
        MachineError: the folders that MPI and dolfinx need cannot be used.
    """
    folders.settle()
    with world.starting():
        from mpi4py import MPI

    if MPI.COMM_WORLD.size > 1 and sys.excepthook is sys.__excepthook__:
        sys.excepthook = _end_all
    import petsc4py

    comm = MPI.COMM_SELF if world.parted() else None
    petsc4py.init(["fiberbend", "-skip_petscrc", "-no_signal_handler"], comm=comm)


def _end_all(kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
    """Print an error that nobody has caught, and end all ranks."""
    from mpi4py import MPI

    sys.__excepthook__(kind, error, trace)
    code = _INTERRUPTED if issubclass(kind, KeyboardInterrupt) else _FAILED
    world.end_all(MPI.COMM_WORLD, code)


class _Versions(types.ModuleType):
    """Stands for pkg_resources, which ufl and ffcx load for their version alone; takes 0.3 s."""

    @staticmethod
    def get_distribution(name: str) -> Any:
        """A thing with the version of a package."""
        return types.SimpleNamespace(version=metadata.version(name))


@contextlib.contextmanager
def without_pkg_resources() -> Iterator[None]:
    """What is imported meanwhile gets the version of a package from the standard library."""
    if "pkg_resources" in sys.modules:
        yield
        return
    sys.modules["pkg_resources"] = _Versions("pkg_resources")
    try:
        yield
    finally:
        del sys.modules["pkg_resources"]


class _Forgetful(functools.singledispatchmethod):  # type: ignore[type-arg]
    """A method that holds on to no object that it was called for."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        vars(self)["_method_cache"] = None


@contextlib.contextmanager
def without_method_caches() -> Iterator[None]:
    """What is imported meanwhile forgets the objects of its methods that go by a type.

    Python 3.13.0 and 3.13.1 keep each of them for ever, and ufl's have whole forms in them.
    """
    usual = functools.singledispatchmethod
    functools.singledispatchmethod = _Forgetful  # type: ignore[assignment, misc]
    try:
        yield
    finally:
        functools.singledispatchmethod = usual  # type: ignore[misc]


def without_settings_files(reader: str, *modules: Any) -> None:
    """Let dolfinx and ffcx read no settings from JSON files of the home or the working folder.

    Args:
        reader: name of the function that reads them.
        modules: those that have it.
    """
    for module in modules:
        assert callable(getattr(module, reader)), "another function reads the settings"
        setattr(module, reader, lambda: ({}, {}))

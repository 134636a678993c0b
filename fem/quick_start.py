"""A quicker import of ufl and ffcx."""

from __future__ import annotations

import contextlib
import sys
import types
from collections.abc import Iterator
from importlib import metadata
from typing import Any


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

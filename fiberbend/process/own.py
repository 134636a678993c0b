"""Whether this program's packages are its own: their names are words that others use too.

Imported before anything of them.
"""

from __future__ import annotations

import importlib.util
import os
import sys

NAMES = ("analytic", "fem", "geometry", "machine", "materials", "rod")
"""Packages beside fiberbend that belong to it."""
_MARK = b"Part of fiberbend."
"""In the docstring of each: another package that was installed into the same folder has it not."""


def shadowed() -> str:
    """Which package of another program would be imported in place of one of these, as a line.

    Returns:
        The line; empty where all are this program's own.
    """
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
    for name in NAMES:
        own, found = os.path.join(root, name, "__init__.py"), _place(name)
        if found is None or not _same(own, found):
            what = "is not there" if found is None else f"is {found}"
        elif not _marked(own):
            what = "is that of another program"
        else:
            continue
        return (
            f"fiberbend: package {name} {what}, expected {own}: fiberbend wants an "
            "environment of its own, and no folder of that name before it in sys.path"
        )
    return ""


def _place(name: str) -> str | None:
    """The file of a package that has been imported or would be."""
    module = sys.modules.get(name)
    if module is not None:
        return str(getattr(module, "__file__", None) or "another module")
    spec = importlib.util.find_spec(name)
    if spec is None:
        return None
    return spec.origin or "another module"


def _same(own: str, found: str) -> bool:
    try:
        return own == found or os.path.samefile(own, found)
    except OSError:
        return False


def _marked(own: str) -> bool:
    try:
        with open(own, "rb") as file:
            return _MARK in file.read()
    except OSError:
        return False

"""`python -m fiberbend` and the installed command `fiberbend`."""

from __future__ import annotations

import atexit
import gc
import os
from typing import NoReturn

from fiberbend.process import signals

NEW_OBJECTS = 50_000
"""Objects made beyond those freed before Python looks for unreachable cycles among them."""


def entry() -> NoReturn:
    """The command; signals are taken before anything slow is loaded."""
    signals.install()
    # imports and the derivation of forms make many objects that stay: looked at after every 700
    # of them, Python's default, a run of a section takes 3 % longer
    gc.set_threshold(NEW_OBJECTS)
    # Python looks for cycles among all that is left when it ends, which the system frees anyway:
    # an eighth of a run of a section. Registered first, this comes last
    atexit.register(gc.freeze)
    # pydantic would look through every installed package for plugins, which nothing here uses
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from fiberbend.cli import entry as command

    command()


if __name__ == "__main__":
    entry()

"""`python -m fiberbend` and the installed command `fiberbend`."""

from __future__ import annotations

import atexit
import gc
import os
import sys
from typing import NoReturn

from fiberbend.process import own, ranks, signals

_WRONG_INPUT = 1
"""The exit code, as of the command line."""

NEW_OBJECTS = 50_000
"""Objects made beyond those freed before Python looks for unreachable cycles among them."""


def entry() -> NoReturn:
    """The command; signals are taken before anything slow is loaded."""
    signals.install()
    line = own.shadowed()
    if line:
        if ranks.rank() == 0:
            print(line, file=sys.stderr)
        sys.exit(_WRONG_INPUT)
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

"""A place under the cell of a notebook that is running, where what is shown changes."""

from __future__ import annotations

import sys
from typing import Any


def shown() -> bool:
    """Whether this process serves a notebook: its shell has a kernel that others talk to."""
    if "IPython" not in sys.modules:
        return False
    from IPython import get_ipython

    return getattr(get_ipython(), "kernel", None) is not None


class Place:
    """It is there with the first thing that it shows.

    Every front end of notebooks can do that; what rich draws by itself there needs ipywidgets, and
    a terminal.
    """

    def __init__(self) -> None:
        self._handle: Any = None

    def show(self, what: Any) -> None:
        """Show an object that has HTML of its own, in place of what was there."""
        if self._handle is None:
            from IPython.display import display

            self._handle = display(what, display_id=True)
        else:
            self._handle.update(what)

    def clear(self) -> None:
        """Show nothing; what is shown next has a new place, below."""
        handle, self._handle = self._handle, None
        if handle is not None:
            handle.update({"text/plain": ""}, raw=True)

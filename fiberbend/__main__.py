"""`python -m fiberbend` and the installed command `fiberbend`."""

from __future__ import annotations

from typing import NoReturn

from fiberbend.process import signals


def entry() -> NoReturn:
    """The command; signals are taken before anything slow is loaded."""
    signals.install()
    from fiberbend.cli import entry as command

    command()


if __name__ == "__main__":
    entry()

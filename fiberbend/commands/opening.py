"""Opening of a file in the program that the desktop has for it."""

from __future__ import annotations

import os
import sys
import webbrowser
from pathlib import Path

from fiberbend.running.launch import say


def open_file(path: Path) -> bool:
    """Open a page or a picture in the user's browser or viewer.

    The variable BROWSER chooses the program, as of every command. Where there is no desktop and
    no such program, a line on standard error says so, and where the file is.

    Args:
        path: the file.

    Returns:
        Whether a program was started.

    Raises:
        FileNotFoundError: there is no such file.
    """
    whole = path.resolve(strict=True)
    if _has_desktop() and webbrowser.open(whole.as_uri()):
        return True
    say(f"{path}: no program to open it was found, expected a desktop or BROWSER", sys.stderr)
    return False


def _has_desktop() -> bool:
    """Whether windows can be shown; a browser of text would take the terminal."""
    if os.environ.get("BROWSER") or sys.platform in ("darwin", "win32"):
        return True
    return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))

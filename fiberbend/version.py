"""The version of the installed program."""

from __future__ import annotations

from importlib import metadata

__version__ = metadata.version("fiberbend")

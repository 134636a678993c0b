"""Parts of run.json."""

from __future__ import annotations

import platform

from fem import compat
from fiberbend.version import __version__


def versions() -> dict[str, str]:
    """Versions that a result depends on."""
    return {
        "fiberbend": __version__,
        "python": platform.python_version(),
        **compat.versions(),
    }

"""Fields, pictures and plots of a run."""

from __future__ import annotations


def draw(*_args: object) -> None:
    """Placeholder while the output is being written."""

"""Writes docs/evidence/iterative.md from what bench/iterative.py has measured."""

from __future__ import annotations

from typing import Any


def page(rows: list[dict[str, Any]], version: Any) -> None:
    print(len(rows), version)

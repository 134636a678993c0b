"""The laws, by the names that a case uses.

A law is one file of this folder, and one line here.
"""

from __future__ import annotations

import importlib

from materials.laws.law import Law

_FILES = (
    "yeoh",
    "neo_hooke",
    "mooney_rivlin",
    "ogden",
    "gent",
)

_ALL: tuple[Law, ...] = tuple(
    importlib.import_module(f"materials.laws.{name}").LAW for name in _FILES
)

LAWS: dict[str, Law] = {law.name: law for law in _ALL}
"""Every law by its name."""

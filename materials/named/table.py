"""All named materials by their names, and which of them disagree."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator

from materials.fiber import Fiber
from materials.material import Material
from materials.named.entry import Entry, Kind, Rubber, Sheet, Thread
from materials.named.published import PUBLISHED
from materials.named.sheets import SHEETS
from materials.named.tensile import TENSILE
from materials.named.threads import THREADS

APART = 1.1
"""Ratio of the stiffnesses from which two measurements of one product are said to disagree."""


def by_name(entries: Iterable[Entry]) -> dict[str, Entry]:
    """Entries by their names.

    Raises:
        ValueError: a name twice.
    """
    found: dict[str, Entry] = {}
    for entry in entries:
        if entry.name in found:
            raise ValueError(f"{entry.name} is there twice")
        found[entry.name] = entry
    return found


ENTRIES: dict[str, Entry] = by_name((*PUBLISHED, *TENSILE, *THREADS, *SHEETS))
"""Every named material."""
RUBBERS: dict[str, Rubber] = {n: e for n, e in ENTRIES.items() if isinstance(e, Rubber)}
"""Those of walls, floors, sheaths and layers."""
THREADS_BY_NAME: dict[str, Thread] = {n: e for n, e in ENTRIES.items() if isinstance(e, Thread)}
"""Those of windings."""
SHEETS_BY_NAME: dict[str, Sheet] = {n: e for n, e in ENTRIES.items() if isinstance(e, Sheet)}
"""Those of strips, and of layers."""
SOLIDS: dict[str, Rubber | Sheet] = {**RUBBERS, **SHEETS_BY_NAME}
"""Those that a part of the body may be made of."""


def named_material(name: str) -> Material:
    """The material of a name.

    Raises:
        ValueError: an unknown name; says which are near.
    """
    if name not in SOLIDS:
        raise ValueError(f"material {name!r} is unknown: expected {hint(name, SOLIDS)}")
    return SOLIDS[name].material


def named_thread(name: str, diameter: float | None = None) -> Fiber:
    """The thread of a name.

    Args:
        name: of a thread.
        diameter: mm, of one that is made in many.

    Raises:
        ValueError: an unknown name, or none or two diameters.
    """
    if name not in THREADS_BY_NAME:
        raise ValueError(f"fiber {name!r} is unknown: expected {hint(name, THREADS_BY_NAME)}")
    return THREADS_BY_NAME[name].fiber(diameter)


def hint(name: str, known: Iterable[str]) -> str:
    """What is expected in place of an unknown name: the nearest ones, and where all are listed."""
    names = list(known)
    near = difflib.get_close_matches(name.lower()[:100], names, n=3, cutoff=0.5)
    if name in ENTRIES:
        return f"another kind than a {ENTRIES[name].kind}, such as {(near or names)[0]}"
    shown = ", ".join(near or names[:3])
    return f"{shown} or another that `fiberbend materials` lists"


def disagreements(entry: Entry) -> Iterator[str]:
    """Other measurements of the same product whose stiffness at rest differs, a sentence each."""
    for other in alike(entry):
        ratio = other.stiffness / entry.stiffness
        if max(ratio, 1 / ratio) > APART:
            way = f"{ratio:.2g} times as stiff" if ratio > 1 else f"{1 / ratio:.2g} times as soft"
            yield f"sources disagree: {other.name} is {way} at rest"


def alike(entry: Entry) -> list[Entry]:
    """Other measurements of the same product."""
    every = (other for other in ENTRIES.values() if other is not entry)
    return [e for e in every if (e.product, e.kind) == (entry.product, entry.kind)]


def of_kind(kind: Kind | None) -> list[Entry]:
    """Entries of a kind, or all, sorted by name."""
    found = (e for e in ENTRIES.values() if kind is None or e.kind == kind)
    return sorted(found, key=lambda e: e.name)

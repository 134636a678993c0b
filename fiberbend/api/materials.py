"""Named materials in words: rubbers, threads, fabrics and papers, each with its source."""

from __future__ import annotations

from collections.abc import Iterator
from typing import get_args

from fiberbend.notebook import blocks
from fiberbend.schema.problems import CaseError, Problem, found, meant
from materials.named.entry import Entry, Kind, Rubber, Sheet, Thread
from materials.named.table import ENTRIES, disagreements, of_kind

_KINDS: tuple[Kind, ...] = get_args(Kind)


class Materials(tuple[Entry, ...]):
    """Named materials; shown as what each is, its numbers, tests, source and licence."""

    __slots__ = ()

    @property
    def names(self) -> list[str]:
        """Their names, as a case has them."""
        return [entry.name for entry in self]

    def __str__(self) -> str:
        return "\n".join(line for entry in self for line in lines(entry))

    def _repr_html_(self) -> str:
        """A table as a notebook shows it."""
        head = ("name", "what", "numbers", "at rest", "tests", "source")
        rows = [
            (e.name, e.product, numbers(e), stiffness(e), tests(e), f"{e.source}; {e.licence}")
            for e in self
        ]
        return blocks.block("Named materials", blocks.table(head, rows, len(rows) or 1))


def materials(kind: str | None = None) -> Materials:
    """Named materials that a case can use.

    Args:
        kind: rubber, thread, fabric or paper; all of them by default.

    Raises:
        CaseError: another kind.
    """
    if kind is not None and kind not in _KINDS:
        text = f"{found(kind)}, expected one of {', '.join(_KINDS)}{meant(kind, _KINDS)}"
        raise CaseError([Problem("kind", text)])
    return Materials(e for e in of_kind(None) if kind in (None, e.kind))


def material(name: str) -> Entry:
    """A named material.

    Args:
        name: as a case has it.

    Raises:
        CaseError: there is none of this name.
    """
    if name not in ENTRIES:
        text = f"{found(name)}, expected one that `fiberbend materials` lists"
        raise CaseError([Problem("name", text + meant(name, ENTRIES))])
    return ENTRIES[name]


def lines(entry: Entry) -> Iterator[str]:
    """An entry of the list: its name, then its numbers, tests, source, and what disagrees."""
    yield f"{entry.name}  ({entry.kind}: {entry.product})"
    weight = "density not known" if entry.density is None else f"{entry.density:g} kg/m³"
    yield f"    {numbers(entry)}; {stiffness(entry)} at rest; {weight}"
    yield f"    {tests(entry)}"
    yield f"    {entry.source}; {entry.licence}"
    yield from (f"    {text}" for text in disagreements(entry))


def whole(entry: Entry) -> list[tuple[str, str]]:
    """All that is known of an entry, a name and words each."""
    rows = [
        ("kind", entry.kind),
        ("what", entry.product),
        ("numbers", numbers(entry)),
        ("at rest", f"Young's modulus {stiffness(entry)}"),
    ]
    if isinstance(entry, Rubber):
        rows.append(("", f"shear modulus {entry.stiffness / 3:.4g} MPa; it keeps its volume"))
    if entry.density is None:
        rows.append(("density", "not known: gravity needs one in the case"))
    else:
        rows.append(("density", f"{entry.density:g} kg/m³, {entry.density_source}"))
    rows += [
        ("tests", entry.tested),
        ("range", _range(entry)),
        ("source", str(entry.source)),
        ("licence", entry.licence),
    ]
    if isinstance(entry, Rubber) and entry.fitted is not None:
        fit = entry.fitted
        files = ", ".join(file for _, file in fit.tests)
        where = "comes with the program" if fit.shipped else "not part of the program"
        rows.insert(
            3, ("fit", f"{fit.law}, rms {100 * fit.rms:.2g} % of the greatest stress; {files}")
        )
        rows.insert(4, ("", f"{where}; fitted again by bench/rubbers.py"))
    rows += [("note", entry.note)] if entry.note else []
    rows += [("but", text) for text in disagreements(entry)]
    rows.append(("in a case", _usage(entry)))
    return rows


def numbers(entry: Entry) -> str:
    """The law with its coefficients, or modulus and size."""
    if isinstance(entry, Rubber):
        units = entry.units
        given = entry.coefficients.items()
        return f"{entry.law}: {', '.join(f'{k} = {v:g}{units[k]}' for k, v in given)}"
    if isinstance(entry, Thread):
        size = "any diameter" if entry.diameter is None else f"diameter {entry.diameter:g} mm"
        part = "" if entry.radius_factor == 1 else f", {entry.radius_factor:g} of the radius"
        return f"Young's modulus {entry.modulus:g} MPa, {size}{part}"
    assert isinstance(entry, Sheet)
    size = "any thickness" if entry.thickness is None else f"thickness {entry.thickness:g} mm"
    return f"Young's modulus {entry.modulus:g} MPa, {size}"


def stiffness(entry: Entry) -> str:
    """Young's modulus at rest."""
    value = float(f"{entry.stiffness:.4g}")
    return f"{value:,.0f} MPa" if value >= 1e4 else f"{value:g} MPa"


def tests(entry: Entry) -> str:
    """How far it was tested, and how."""
    return f"{_range(entry)}; {entry.tested}"


def _range(entry: Entry) -> str:
    if not isinstance(entry, Rubber):
        return "small strains"
    if entry.stretches is None:
        return "range of the tests not stated"
    least, most = entry.stretches
    return f"stretch {least:g} to {most:g}"


def _usage(entry: Entry) -> str:
    if isinstance(entry, Rubber):
        return f"materials: {{wall: {entry.name}}}"
    if isinstance(entry, Thread):
        named = f"{{name: {entry.name}, diameter: 0.3 mm}}"
        return f"fiber: {entry.name if entry.diameter else named}"
    assert isinstance(entry, Sheet)
    size = "" if entry.thickness else ", thickness: 0.1 mm"
    return f"strip: {{at: bottom, width: 10 mm, fabric: {entry.name}{size}}}"

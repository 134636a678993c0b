"""Rungs, times and errors in words."""

from __future__ import annotations

import math
import shlex
import textwrap
from collections.abc import Sequence

from fiberbend.answer.numbers import number as _number
from fiberbend.case.shapes import SHAPES
from fiberbend.ladder.rungs import AXIAL, SECTION, Family, Rung
from fiberbend.schema.units import show

WINDINGS = {
    "": "",
    "spread": "spread winding",
    "calibrated": "calibrated winding",
    "turns": "every turn",
}
"""How a winding is represented, in the words of tables and sentences."""


_LONGEST = 200
"""Letters of a reason; the record of a rung has the whole."""


def title(family: Family) -> str:
    """A family in words, such as "body, every turn, hexahedra, half"."""
    winding = WINDINGS.get(family.winding, f"{family.winding} winding")
    element = SHAPES[family.element].plural if family.element else ""
    half = {True: "half", False: "whole", None: ""}[family.half]
    return ", ".join(filter(None, (family.model, winding, element, half)))


def full_name(rung: Rung) -> str:
    """A rung as the table and the advice call it: its family and its mesh."""
    return ", ".join(filter(None, (title(rung.family), mesh_words(rung))))


def mesh_words(rung: Rung) -> str:
    """The mesh of a rung as its case has it: "mesh.section 2, mesh.axial 8 mm"."""
    parts = []
    if SECTION in rung.mesh:
        parts.append(f"mesh.section {rung.case.mesh.section}")
    if AXIAL in rung.mesh:
        parts.append(f"mesh.axial {show(rung.case.mesh.axial, 'length')}")
    return ", ".join(parts)


def short(*rungs: Rung) -> str:
    """Rungs of one family on a picture: model, winding and meshes in few letters."""
    family = rungs[0].family
    element = SHAPES[family.element].short if family.element else ""
    parts = [family.model, family.winding, element]
    if family.half is False:
        parts.append("whole")
    return " ".join(filter(None, [*parts, ", ".join(map(short_mesh, rungs))]))


def short_mesh(rung: Rung) -> str:
    """The mesh of a rung on a picture: mesh.section / mesh.axial."""
    parts = []
    if SECTION in rung.mesh:
        parts.append(str(rung.case.mesh.section))
    if AXIAL in rung.mesh:
        parts.append(show(rung.case.mesh.axial, "length"))
    return " / ".join(parts)


def settings(rung: Rung, before: Sequence[str] = ()) -> str:
    """The options of a rung as they are typed, after others that the case was changed by."""
    return " ".join(f"--set {shlex.quote(setting)}" for setting in (*before, *rung.settings))


def brief(reason: str) -> str:
    """A reason in a line or two: what other programs have said may be long."""
    return textwrap.shorten(reason, _LONGEST, placeholder=" …")


def number(value: float) -> str:
    """Two or three digits, as a person writes them."""
    return _number(value, digits=3) if value < 100 else f"{value:.0f}"


def percent(value: float) -> str:
    """An error, one or two digits; no more of it is known."""
    if not math.isfinite(value):
        return "an unknown error"
    digits = 2 if value < 9.95 else 3
    return f"{_number(value, 5, digits)} %"


def seconds(value: float) -> str:
    """A time: tenths up to ten seconds, minutes from two on."""
    if value < 10:
        return f"{value:.1f} s"
    if value < 120:
        return f"{value:.0f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes} min {rest} s" if minutes < 10 else f"{minutes} min"

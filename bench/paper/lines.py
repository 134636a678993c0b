"""The closed forms that are drawn, and what every figure looks like."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from analytic.bending import Hemicircle
from analytic.stress import effective, wound
from bench.paper.facts import BASELINE, CAP, MODULUS, STATED
from bench.paper.runs import Key
from fiberbend.drawing.style import empty
from geometry.mesh.data import Floats
from materials.named.table import named_material

WIDTH = 9.6
"""Of a figure in inches; 100 pixels each are shown on the page at 100 %."""
FLOOR = 2.0
"""Thickness of the floor in mm: not stated, assumed."""
BLUE, RED, GREEN, BROWN, GRAY = "#1f5a99", "#c0392b", "#2e7d32", "#a8641a", "#6b6b6b"
_LETTERS = 11.0


@dataclasses.dataclass(frozen=True)
class Look:
    """How a model is drawn, the same in every figure.

    Attributes:
        label: in the legend.
        color: of the line.
        style: of the line.
        mark: of points.
    """

    label: str
    color: str
    style: str = "-"
    mark: str = "o"

    def line(self) -> dict[str, Any]:
        """Arguments of a line."""
        return {"color": self.color, "ls": self.style, "lw": 1.8, "label": self.label}

    def points(self) -> dict[str, Any]:
        """Arguments of points."""
        return {"color": self.color, "ls": "none", "marker": self.mark, "ms": 6.5, "mfc": "none"}


PAPER = Look("eq. (19), μ̄ = 0.314 MPa", BLUE)
ZERO_FIT = Look("zero-fit: (19), rubbers' own laws", BROWN, "--")
SECTION = Look("section, winding spread", GREEN, "-.", "s")
CELL = Look("cell, every turn", RED, ":", "o")
BODY = Look("body, every turn", "black", "-", "^")
LOOKS = {"section": SECTION, "cell": CELL, "body": BODY}


def paper(key: Key, modulus: float = MODULUS.value, floor: float = FLOOR) -> Hemicircle:
    """Eq. (19) without its extra factor L.

    Args:
        key: (a, L, t) in mm.
        modulus: μ̄, MPa.
        floor: b, mm.
    """
    radius, length, wall = key
    return Hemicircle(radius, floor, wall, length, stress=effective(modulus))


def printed(key: Key = BASELINE) -> Hemicircle:
    """Eq. (19) with the extra factor L of (14)."""
    radius, length, wall = key
    return Hemicircle(radius, FLOOR, wall, length, paper=True)


def zero_fit(key: Key, floor: float = FLOOR) -> Hemicircle:
    """Eq. (19) with the wall's own Yeoh law and the sheath instead of μ̄: nothing is fitted.

    The floor enters as rubber of the wall, as in (14): its layer keeps y = 0 from stretching.
    """
    radius, length, wall = key
    own, soft = (wound(named_material(name).principal) for name in ("elastosil-m4601", SOFT))
    sheath = STATED["sheath"].value
    return Hemicircle(radius, floor, wall, length, stress=own, sheath=sheath, sheath_stress=soft)


SOFT = "ecoflex-0030"
CLOSED: dict[str, tuple[Look, Callable[[Key], Hemicircle]]] = {
    "eq. (19)": (PAPER, paper),
    "zero-fit": (ZERO_FIT, zero_fit),
}
"""Closed forms by their names in tables."""


def kpa(form: Hemicircle, degrees: Floats | float) -> Floats:
    """P in kPa of a closed form at bending angles in degrees."""
    return 1e3 * form.pressure(np.radians(degrees))


def force(form: Hemicircle, pressure: Floats | float) -> Floats:
    """F in N of eq. (20) at pressures in kPa, with the cap as L_f."""
    return form.force(1e-3 * np.asarray(pressure, dtype=float), CAP.value)


def empty_page(height: float) -> Any:
    """A figure as wide as the page, of a height in inches, without panels."""
    return empty((WIDTH, height), 100)


def page(height: float, **grid: Any) -> tuple[Any, Any]:
    """A figure as wide as the page, and its panels.

    Args:
        height: in inches.
        grid: as of `Figure.subplots`.
    """
    figure = empty_page(height)
    panels = figure.subplots(**grid)
    for panel in np.ravel(panels):
        panel.grid(color="0.9", linewidth=0.8)
        panel.set_axisbelow(True)
        panel.tick_params(labelsize=_LETTERS)
        panel.spines[["top", "right"]].set_visible(False)
    return figure, panels


def named(panel: Any, across: str, up: str = "", title: str = "") -> None:
    """Names of the axes and a title, in letters that are read at 100 %."""
    panel.set_xlabel(across, fontsize=_LETTERS)
    if up:
        panel.set_ylabel(up, fontsize=_LETTERS)
    if title:
        panel.set_title(title, fontsize=_LETTERS + 0.5, loc="left")


def legend(figure: Any, panel: Any, columns: int, above: float) -> None:
    """One legend for all panels, on top of the figure.

    Args:
        figure: the figure; its panels are fitted below.
        panel: whose lines it names.
        columns: of the legend.
        above: height that it takes, inches.
    """
    handles, labels = panel.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="upper center", ncols=columns, fontsize=_LETTERS, frameon=False
    )
    figure.tight_layout(rect=(0, 0, 1, 1 - above / figure.get_size_inches()[1]))

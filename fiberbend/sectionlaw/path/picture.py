"""Free states of a law and its stiffnesses over the pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fiberbend.drawing.page import any_sign, own_style
from fiberbend.drawing.style import Style
from fiberbend.sectionlaw.path.made import PathMade

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE = Style(width=280.0, height=105.0, font_size=11.0)
_POINTS = 60
_TURNS = ("curvature", "side curvature", "twist")
_TITLES = ("free: bent and twisted (1/m)", "free: stretch", "stiffness over that at rest")
_NONE = 1e-9
"""Curvature in 1/mm that is not drawn."""


def draw(made: PathMade, style: Style = STYLE) -> Figure:
    """Strains of the free states and stiffnesses there, by the pressure.

    A dot is a free state which a trial of the same section found.

    Args:
        made: the law.
        style: of the page.
    """
    law = made.law
    pressures = np.linspace(*law.pressures, _POINTS)
    free = np.array([law.free_at(pressure) for pressure in pressures.tolist()])
    stiff = np.array(
        [
            np.diag(law.hessian(at[None], pressure)[0])
            for at, pressure in zip(free, pressures.tolist(), strict=True)
        ]
    )
    with own_style(), any_sign():
        page = style.figure()
        panels = page.subplots(1, 3, gridspec_kw={"wspace": 0.32})
        kilopascals = 1e3 * pressures
        for number, name in enumerate(_TURNS, 1):
            if np.abs(free[:, number]).max() > _NONE:
                panels[0].plot(kilopascals, 1e3 * free[:, number], label=name, lw=1.6)
        panels[1].plot(kilopascals, free[:, 0], lw=1.6)
        for number, name in enumerate(("stretching", "bending", "bending to the side", "twist")):
            panels[2].plot(kilopascals, stiff[:, number] / stiff[0, number], label=name, lw=1.6)
        for pressure, state in made.free:
            strains = np.array(state)
            for number in range(1, len(strains)):
                if abs(strains[number]) > _NONE:
                    panels[0].plot(1e3 * pressure, 1e3 * strains[number], "o", color="black", ms=4)
            panels[1].plot(1e3 * pressure, strains[0], "o", color="black", ms=4)
        for axes, title in zip(panels, _TITLES, strict=True):
            _look(axes, title, style)
        page.suptitle(
            f"Law of the section: {made.title or made.model}", fontsize=1.1 * style.font_size
        )
        page.subplots_adjust(left=0.07, right=0.98, top=0.85, bottom=0.15)
    return page


def _look(axes: Any, title: str, style: Style) -> None:
    axes.set_xlabel("pressure (kPa)", fontsize=style.font_size)
    axes.set_title(title, fontsize=style.font_size, loc="left")
    axes.tick_params(labelsize=0.9 * style.font_size)
    axes.grid(alpha=0.25)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(frameon=False, fontsize=0.85 * style.font_size)

"""Force, moment and energy of a table over the curvature, for some pressures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fiberbend.drawing.page import any_sign, own_style
from fiberbend.drawing.style import Style
from fiberbend.sectionlaw.made import Made
from rod.functions import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STYLE = Style(width=280.0, height=105.0, font_size=11.0)
_POINTS = 120
_FROM, _TO = 0.15, 0.85
"""Of the colour map."""
_CURVES = 4
"""About so many, beside that at rest."""
_TITLES = ("moment without force (N mm)", "stretch without force", "energy per length (N)")


def draw(made: Made, style: Style = STYLE) -> Figure:
    """Moment, stretch and energy over the curvature where no force pulls along the line.

    A dot at each curve is the free state, which a trial of the same section found.

    Args:
        made: the table.
        style: of the page.
    """
    import matplotlib as mpl

    low, high = made.section.table.axes[-1].lines[[0, -1]].tolist()
    free = [(pressure, state) for pressure, state in made.free if low <= pressure <= high]
    free = free[:: -max(1, len(free) // _CURVES)]
    pressures = sorted({min(low, high, key=abs), *(pressure for pressure, _ in free)})
    colors = mpl.colormaps["viridis"](np.linspace(_FROM, _TO, len(pressures)))
    with own_style(), any_sign():
        page = style.figure()
        panels = page.subplots(1, 3, gridspec_kw={"wspace": 0.32})
        for pressure, color in zip(pressures, colors, strict=True):
            curve = _without_force(made, pressure)
            moments = made.law.gradient(curve, pressure)[:, 1]
            rows = (moments, curve[:, 0], made.law.value(curve, pressure))
            for axes, row in zip(panels, rows, strict=True):
                label = f"{1e3 * pressure:.3g} kPa"
                axes.plot(1e3 * curve[:, 1], row, color=color, lw=1.6, label=label)
        for pressure, state in free:
            here = np.array([[state.stretch, state.curvature]])
            heights = (0.0, state.stretch, made.law.value(here, pressure)[0])
            for axes, height in zip(panels, heights, strict=True):
                axes.plot(1e3 * state.curvature, height, "o", color="black", ms=4)
        for axes, title in zip(panels, _TITLES, strict=True):
            _look(axes, title, style)
        panels[0].plot([], [], "o", color="black", ms=4, label="free, by a trial")
        handles, labels = panels[0].get_legend_handles_labels()
        page.legend(
            handles,
            labels,
            loc="lower center",
            ncols=len(labels),
            frameon=False,
            fontsize=0.9 * style.font_size,
        )
        page.suptitle(
            f"Law of the section: {made.title or made.model}", fontsize=1.1 * style.font_size
        )
        page.subplots_adjust(left=0.07, right=0.98, top=0.88, bottom=0.25)
    return page


def _look(axes: Any, title: str, style: Style) -> None:
    axes.set_xlabel("curvature (1/m)", fontsize=style.font_size)
    axes.set_title(title, fontsize=style.font_size, loc="left")
    axes.tick_params(labelsize=0.9 * style.font_size)
    axes.grid(alpha=0.25)


def _without_force(made: Made, pressure: float) -> Floats:
    """λ and k of all curvatures at which N = 0 within the table, (n, 2)."""
    law = made.section
    e = law.table.axes[0].lines
    found = []
    for u in np.linspace(0.0, 1.0, _POINTS).tolist():
        tries = np.column_stack(
            [np.linspace(e[0], e[-1], _POINTS), np.full(_POINTS, u), np.full(_POINTS, pressure)]
        )
        strains = law.chart.strains(tries)
        forces = law.gradient(strains, pressure)[:, 0]
        change = np.flatnonzero((forces[1:] > 0) & (forces[:-1] <= 0))
        if len(change):
            at = int(change[0])
            share = -forces[at] / (forces[at + 1] - forces[at])
            found.append(strains[at] + share * (strains[at + 1] - strains[at]))
    return np.array(found).reshape(-1, 2)

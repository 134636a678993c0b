"""The stress of a named rubber over its stretch, beside its tests."""

from __future__ import annotations

from typing import Any

import numpy as np

from fiberbend.drawing.page import any_sign, literal, own_style
from fiberbend.drawing.style import Style
from materials.fit.modes import MODES, Mode
from materials.named.entry import Rubber
from materials.named.table import alike
from materials.stretches import Floats

STYLE = Style(width=200.0, height=125.0, font_size=11.0)
COLORS = {"uniaxial": "#0072b2", "pure-shear": "#009e73", "equibiaxial": "#d55e00"}
_FAR = 2.0
"""Stretch up to which a rubber is drawn that does not say how far it was tested."""
_POINTS = 40
"""Of a test that are drawn."""


def draw(entry: Rubber) -> Any:
    """Nominal stress in the three ways to load it, a matplotlib figure.

    Lines are the law within the range of its tests; points are the tests where these come with the
    program; thin lines are other measurements of the same product that are pulled.
    """
    with own_style(), any_sign():
        page = STYLE.figure()
        axes = page.add_axes((0.1, 0.12, 0.87, 0.78))
        least, most = entry.stretches or (1.0, _FAR)
        for mode in MODES.values():
            stretch = np.linspace(1.0, most, 120)
            axes.plot(
                stretch,
                _stress(entry, mode, stretch),
                color=COLORS[mode.name],
                linewidth=2.0,
                label=mode.name.replace("-", " "),
            )
        if least < 1:
            pressed = np.linspace(least, 1.0, 60)
            axes.plot(pressed, _stress(entry, MODES["uniaxial"], pressed), COLORS["uniaxial"])
        _tests(axes, entry)
        for other in alike(entry):
            assert isinstance(other, Rubber)
            far = np.linspace(1.0, other.stretches[1] if other.stretches else _FAR, 80)
            axes.plot(
                far,
                _stress(other, MODES["uniaxial"], far),
                color="0.45",
                linestyle="--",
                linewidth=1.2,
                label=f"{other.name}, uniaxial",
            )
        axes.set_title(literal(f"{entry.name}: {entry.product}"), fontsize=STYLE.font_size * 1.2)
        axes.set_xlabel("stretch", fontsize=STYLE.font_size)
        axes.set_ylabel("engineering stress (kPa)", fontsize=STYLE.font_size)
        axes.grid(color="0.9")
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=STYLE.font_size * 0.85)
    return page


def _stress(entry: Rubber, mode: Mode, stretch: Floats) -> Floats:
    """Nominal stress, kPa."""
    along, _, free = entry.material.principal(*mode.stretches(stretch))
    return np.asarray(1e3 * (along - free) / stretch)


def _tests(axes: Any, entry: Rubber) -> None:
    shipped = None if entry.fitted is None else entry.fitted.shipped
    for way, path in shipped or ():
        from fiberbend.tensile.reading import Wanted, read_test

        assert entry.fitted is not None
        test = read_test(path, way, Wanted(most=entry.fitted.upto)).measurement
        some = slice(None, None, max(1, len(test.stretch) // _POINTS))
        axes.plot(
            test.stretch[some],
            1e3 * test.stress[some],
            "o",
            markersize=3.5,
            markerfacecolor="none",
            color=COLORS[way],
            label=f"{way.replace('-', ' ')}, measured",
        )

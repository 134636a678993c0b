"""Tests, fits, residuals, and modes that were not measured, in one figure; P(θ) in another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fiberbend.drawing.page import any_sign, literal, own_style
from fiberbend.drawing.style import Style
from materials.fit.modes import MODES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from fiberbend.fit.band import Band
    from fiberbend.fit.comparison import Comparison
    from fiberbend.tensile.reading import Read
    from materials.fit.modes import Measurement

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f")
"""Told apart by all eyes, after M. Okabe and K. Ito."""
STYLE = Style(width=280.0, height=150.0, font_size=11.0)
_ASTRAY = 2.5
"""Times what is measured, or what most laws say, up to where stresses are shown."""
_PART = 0.3
"""Of the height of curves that residuals have."""


def draw(found: Comparison, style: Style = STYLE) -> Figure:
    """Stress over stretch with residuals below, a column for each mode.

    Args:
        found: the fits.
        style: of the page.
    """
    with own_style(), any_sign():
        page = style.figure()
        panels = page.subplots(
            2,
            len(MODES),
            sharex="col",
            squeeze=False,
            gridspec_kw={"height_ratios": [1, _PART], "hspace": 0.08, "wspace": 0.25},
        )
        for column, mode in enumerate(MODES.values()):
            top, low = panels[0][column], panels[1][column]
            _curves(top, found, mode.name, style)
            _residuals(low, found, mode.name, style)
            for axes in (top, low):
                _look(axes, style)
            low.set_xlabel("stretch", fontsize=style.font_size)
        panels[0][0].set_ylabel("engineering stress (kPa)", fontsize=style.font_size)
        panels[1][0].set_ylabel("residual (%)", fontsize=style.font_size)
        handles, labels = panels[0][0].get_legend_handles_labels()
        page.legend(
            handles,
            labels,
            loc="lower center",
            ncols=min(len(labels), 4),
            fontsize=style.font_size * 0.85,
            frameon=False,
        )
        rows = -(-len(labels) // 4)
        page.subplots_adjust(left=0.07, right=0.98, top=0.93, bottom=0.12 + 0.045 * rows)
    return page


def _curves(axes: Any, found: Comparison, mode: str, style: Style) -> None:
    fitted = mode in found.measured
    tests, others = _tests(found.reads, mode), _tests(found.beside, mode)
    low = min([1.0, *(float(test.stretch.min()) for test in (*tests, *others))])
    stretch = np.linspace(low, found.end(mode), 201)
    note = "" if fitted else (", not fitted" if others else ", not measured")
    axes.set_title(f"{mode}{note}", fontsize=style.font_size)
    for test in tests:
        dots = {"markersize": 3.5, "color": "black", "markerfacecolor": "none", "zorder": 2}
        axes.plot(test.stretch, 1e3 * test.stress, "o", **dots)
    for test in others:
        axes.plot(test.stretch, 1e3 * test.stress, "x", markersize=4, color="0.3", zorder=2)
    ends = []
    for index, fit in enumerate(found.fits):
        color, stress = COLORS[index % len(COLORS)], 1e3 * fit.stress(MODES[mode], stretch)
        error = 1.96e3 * fit.stress_error(MODES[mode], stretch)
        label = literal(fit.form.name)
        axes.plot(stretch, stress, "-" if fitted else "--", color=color, lw=1.5, label=label)
        within = {"color": color, "alpha": 0.12, "lw": 0}
        axes.fill_between(stretch, stress - error, stress + error, **within)
        ends.append(float(np.nanmax(stress)))
    known = [1e3 * test.stress for test in (*tests, *others)]
    # a law that goes astray, or near its limit, hides no other
    most = float(np.concatenate(known).max()) if known else float(np.median(ends))
    least = min([0.0, *(float(values.min()) for values in known)])
    axes.set_ylim(1.05 * least, 1.08 * min(max(ends), _ASTRAY * most))


def _residuals(axes: Any, found: Comparison, mode: str, style: Style) -> None:
    fitted = mode in found.measured
    tests = _tests(found.reads, mode) or _tests(found.beside, mode)
    if not tests:
        axes.set_ylim(-1, 1)
        axes.set_yticks([])
        where = {"transform": axes.transAxes, "ha": "center", "va": "center"}
        axes.text(0.5, 0.5, "no test", fontsize=style.font_size * 0.85, color="0.4", **where)
        return
    most = max(float(np.abs(test.stress).max()) for test in tests) or 1.0
    axes.axhline(0.0, color="0.5", lw=0.8)
    greatest = []
    for index, fit in enumerate(found.fits):
        color = COLORS[index % len(COLORS)]
        for test in tests:
            ordered = test.sorted()
            rest = 100 * fit.residuals(ordered) / most
            axes.plot(ordered.stretch, rest, "-" if fitted else "--", color=color, lw=1.2)
            greatest.append(float(np.nanmax(np.abs(rest))))
    if max(greatest) > 3 * float(np.median(greatest)):
        edge = 3 * float(np.median(greatest))
        axes.set_ylim(-edge, edge)


def _tests(reads: Sequence[Read], mode: str) -> list[Measurement]:
    """Those of a mode."""
    return [read.measurement for read in reads if read.measurement.mode.name == mode]


def draw_band(band: Band, others: dict[str, np.ndarray], style: Style | None = None) -> Figure:
    """P(θ) with its band, refits within it, and other laws.

    Args:
        band: of the law.
        others: pressures of other laws at the same angles, kPa, by their names.
        style: of the page.
    """
    style = style or Style(width=160.0, height=115.0, font_size=11.0)
    angles = np.rad2deg(band.angles)
    with own_style(), any_sign():
        page = style.figure()
        axes = page.add_subplot()
        low, high = (1e3 * (band.pressure + sign * 1.96 * band.error) for sign in (-1, 1))
        for index, row in enumerate(band.refits):
            label = "refits to resampled tests" if index == 0 else None
            axes.plot(angles, 1e3 * row, "-", color="0.6", lw=0.6, label=label, zorder=1)
        axes.fill_between(angles, low, high, color=COLORS[0], alpha=0.25, lw=0, label="95 % band")
        axes.plot(angles, 1e3 * band.pressure, "o-", color=COLORS[0], ms=4, label=band.law)
        for index, (name, values) in enumerate(others.items(), start=1):
            axes.plot(angles, values, "--", color=COLORS[index % len(COLORS)], lw=1.2, label=name)
        axes.set_xlabel("bending angle (°)", fontsize=style.font_size)
        axes.set_ylabel("pressure (kPa)", fontsize=style.font_size)
        _look(axes, style)
        axes.legend(fontsize=style.font_size * 0.85, frameon=False)
        page.tight_layout()
    return page


def _look(axes: Any, style: Style) -> None:
    axes.tick_params(labelsize=style.font_size * 0.85)
    axes.grid(color="0.9", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)

"""Natural frequencies over the pressure, and the lowest modes as lines seen from the side."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np

from fiberbend.drawing.axes import BLUE, RED
from fiberbend.drawing.page import figure, literal, save
from fiberbend.states.snapshot import Target
from geometry.mesh.data import Floats

SIZE = (1400, 620)
"""Width and height in pixels."""
_COLORS = (BLUE, "#2e7d32", "#b8860b", "#7b4fa3", "#444444", "#a8641a")
_SHOWN = 3
"""Modes that are drawn as lines."""


def plot_modes(
    pressures: Floats,
    frequencies: Floats,
    lines: Sequence[Floats],
    moved: Sequence[Floats],
    target: Target,
    title: str = "",
) -> None:
    """Draw frequencies over the pressure, and modes about the first and the last state.

    Args:
        pressures: (n,), kPa.
        frequencies: (n, k), Hz; below zero where unstable.
        lines: places of the sections in each state, (m, 3) each, mm.
        moved: displacements of them in each mode, (k, m, 3) each, mm.
        target: a path, or a file open for writing bytes.
        title: of the case.
    """
    page = figure(SIZE)
    shown = textwrap.shorten(title, 100, placeholder=" …")
    page.text(0.5, 0.95, literal(shown), ha="center", fontsize=15)
    left = page.add_axes((0.065, 0.12, 0.3, 0.74))
    _frequencies(left, pressures, frequencies)
    ends = [0] if len(lines) == 1 else [0, len(lines) - 1]
    for number, end in enumerate(ends):
        axes = page.add_axes((0.43 + 0.29 * number, 0.12, 0.25, 0.74))
        _lines(axes, lines[end], moved[end][:_SHOWN], frequencies[end])
        axes.set_ylabel("" if number else "y (mm)", fontsize=13)
        axes.set_title(f"at {pressures[end]:.4g} kPa", fontsize=13)
    save(page, target)


def _frequencies(axes: Any, pressures: Floats, frequencies: Floats) -> None:
    for mode, values in enumerate(frequencies.T):
        color = _COLORS[mode % len(_COLORS)]
        stable = np.where(values >= 0, values, np.nan)
        axes.plot(pressures, stable, "o-", color=color, linewidth=1.6, markersize=5)
        unstable = values < 0
        axes.plot(pressures[unstable], 0 * pressures[unstable], "x", color=RED, markersize=9)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("pressure (kPa)", fontsize=13)
    axes.set_ylabel("natural frequency (Hz)", fontsize=13)
    _look(axes)


def _lines(axes: Any, line: Floats, moved: Floats, frequencies: Floats) -> None:
    axes.plot(line[:, 2], line[:, 1], color="black", linewidth=2.2, label="at rest")
    for mode, (way, frequency) in enumerate(zip(moved, frequencies, strict=False)):
        name = f"{frequency:.4g} Hz" if frequency >= 0 else "unstable"
        for sign in (1.0, -1.0):
            at = line + sign * way
            axes.plot(
                at[:, 2],
                at[:, 1],
                "-" if sign > 0 else "--",
                color=_COLORS[mode],
                linewidth=1.4,
                label=name if sign > 0 else None,
            )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("z (mm)", fontsize=13)
    axes.legend(fontsize=11, framealpha=0.85, edgecolor="none", loc="best")
    _look(axes)


def _look(axes: Any) -> None:
    axes.tick_params(labelsize=11)
    axes.grid(color="0.92")
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)

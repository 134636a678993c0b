"""Drawings of what is open: its price, and what is stated against it."""

from __future__ import annotations

from typing import Any

import numpy as np

from bench.paper.assumed.flat import SLACK, Profile
from bench.paper.assumed.grid import Grid
from bench.paper.assumed.record import Record
from bench.paper.assumptions import (
    DEFAULT,
    LAYER,
    LEVER,
    PITCH,
    RANGES,
    THICKNESS,
    Combination,
    Range,
)
from bench.paper.combination import OURS, alone, band, predict
from bench.paper.facts import BASELINE, STATED
from bench.paper.lines import BLUE, BROWN, GRAY, GREEN, RED, named, page
from bench.paper.priced import Line, line
from bench.paper.verdict import FLAT

_SMALL = 10.0
SHORT = {
    "pitch": "pitch, mm",
    "floor": "floor, mm",
    "layer": "layer under 2 mm of rubber, mm",
    "lever": "L_f, mm",
}
FULL = STATED["full_circle"].value


def prices(grid: Grid) -> Any:
    """P(360°) and force over what is open between numbers, one at a time."""
    figure, panels = page(6.4, nrows=2, ncols=3)
    for panel, each in zip(panels[0], (PITCH, THICKNESS, LAYER), strict=True):
        _pressure(panel, line(grid, each), first=each is PITCH)
    for panel, each in zip(panels[1], (PITCH, THICKNESS, LEVER), strict=True):
        _force(panel, grid, line(grid, each), first=each is PITCH)
    panels[0][0].legend(fontsize=_SMALL, frameon=False, loc="upper left")
    panels[1][0].legend(fontsize=_SMALL, frameon=False, loc="upper left")
    figure.tight_layout()
    return figure


def _pressure(panel: Any, of: Line, first: bool) -> None:
    panel.axhspan((1 - OURS) * FULL, (1 + OURS) * FULL, color="0.9", lw=0)
    panel.axhline(FULL, color=GRAY, lw=1, label="196 kPa (Fig. 6)")
    falls = np.ma.masked_where(of.radius > -FLAT, of.pressure)
    panel.plot(of.across, of.pressure, color=GREEN, ls=":", lw=1.8, label="∪, — or ↑ with radius")
    panel.plot(of.across, falls, color=GREEN, lw=2.6, label="↓ with radius (Table II)")
    _ours(panel, of, of.pressure)
    panel.set_ylim(160, 260)
    named(panel, SHORT[of.of.key], "P(360°), kPa" if first else "")


def _force(panel: Any, grid: Grid, of: Line, first: bool) -> None:
    low, high = band(STATED["force_solid"].value, STATED["force_closed"].value)
    panel.fill_between(
        of.across, low * of.formula, high * of.formula, color="0.9", lw=0, label="stated errors"
    )
    panel.plot(of.across, of.formula, color=BLUE, lw=1.8, label="eq. (20)")
    panel.plot(of.across, of.force, color=GREEN, ls="-.", lw=1.8, label="kept straight, M/L_f")
    held = of.force * of.lever * grid.guided / STATED["cap"].value
    panel.plot(of.across, held, color="black", lw=1.8, label="held by a strip")
    _ours(panel, of, of.force)
    panel.set_ylim(0, 29)
    named(panel, SHORT[of.of.key], "F at 200 kPa, N" if first else "")


def _ours(panel: Any, of: Line, values: Any) -> None:
    if of.of is not LAYER:
        at = float(np.interp(of.of.default, of.across, values))
        panel.plot([of.of.default], [at], "o", color=RED, ms=6, label="elsewhere on this page")


def best(record: Record) -> Any:
    """Why not everything can hold, and how well each open number is determined."""
    figure, panels = page(6.6, nrows=2, ncols=2)
    _conflict(panels[0][0], record)
    least = record.best[0].misfit
    by_key = {each.key: each for each in RANGES}
    places = (panels[0][1], panels[1][0], panels[1][1])
    shown = [
        profile
        for profile in record.profiles
        if profile.key in ("pitch", record.best[0].given.base, "lever")
    ]
    for panel, letter, profile in zip(places, "bcd", shown, strict=True):
        _profile(panel, letter, profile, by_key[profile.key], record.best[0].given, least)
    figure.tight_layout()
    return figure


def _conflict(panel: Any, record: Record) -> None:
    floors = np.linspace(*THICKNESS.bounds, 61)
    for pitch, color, style in ((1.5, BLUE, "--"), (3.0, GREEN, "-"), (6.0, BROWN, "-.")):
        whole = np.full(len(floors), pitch)
        lever = np.full(len(floors), DEFAULT.lever)
        found = predict(record.grid, DEFAULT.readings, (whole, floors, lever))
        steps = 100 * found.steps("radius").max(axis=0)
        pressure = found.pressures[BASELINE]
        panel.plot(pressure, steps, color=color, ls=style, lw=1.8, label=f"pitch {pitch:g} mm")
        marks = [int(np.argmin(np.abs(floors - value))) for value in (1.5, 2.0, 2.5, 3.0)]
        panel.plot(pressure[marks], steps[marks], "o", color=color, ms=4)
        if pitch == PITCH.high:
            for mark, aside in zip(marks, ((6, 2), (-25, -4), (5, 5), (-10, 7)), strict=True):
                panel.annotate(
                    f"{floors[mark]:.1f}",
                    (pressure[mark], steps[mark]),
                    aside,
                    textcoords="offset points",
                    fontsize=_SMALL,
                    color=color,
                )
    panel.fill_betweenx([-9, -100 * FLAT], (1 - OURS) * FULL, (1 + OURS) * FULL, color="0.85", lw=0)
    panel.text(
        FULL, -2.2, "stated", ha="center", va="top", fontsize=_SMALL, color=GRAY, rotation=90
    )
    found = alone(record.grid, record.best[0].given)
    at = 100 * float(found.steps("radius").max(axis=0))
    panel.plot([float(found.pressures[BASELINE])], [at], "*", color=RED, ms=12, label="best")
    panel.axhline(0, color="0.6", lw=0.8)
    panel.set_xlim(165, 260)
    panel.set_ylim(-6, 11)
    panel.legend(fontsize=_SMALL, frameon=False, loc="upper right")
    named(panel, "P(360°) of the baseline, kPa", "greatest step over radius, %", "(a)")


def _profile(
    panel: Any, letter: str, profile: Profile, of: Range, given: Combination, least: float
) -> None:
    allowed = profile.allowed(least)
    if allowed is not None:
        panel.axvspan(*allowed, color="0.9", lw=0, label="one scale more at most")
    panel.plot(profile.across, profile.misfit, color=GREEN, lw=2, label="all others free")
    panel.axhline(np.sqrt(least**2 + SLACK), color=GRAY, lw=0.8, ls=":")
    panel.plot([getattr(given, of.key)], [least], "*", color=RED, ms=12, label="best")
    panel.set_ylim(0, min(2.2 * max(least, 1.5), 1.15 * max(profile.misfit) + 0.5))
    if letter == "b":
        panel.legend(fontsize=_SMALL, frameon=False, loc="lower right")
    named(panel, SHORT[of.key], "misfit", f"({letter})")

"""Fig. 10: angle over pressure of six actuators."""

from __future__ import annotations

from typing import Any

import numpy as np

from analytic.calibration import calibrate
from bench.paper.facts import ANGLES, FIG_10, MODULUS
from bench.paper.figures.fig8 import solved
from bench.paper.lines import CLOSED, LOOKS, kpa, legend, named, page, paper
from bench.paper.part import Figure, Found, Table
from bench.paper.runs import Key, Runs, Solved
from bench.paper.verdict import Verdict, unknown

KEYS: tuple[Key, ...] = tuple((float(a), float(length), float(t)) for a, length, t in FIG_10)
LETTERS = "abcdef"


def found(runs: Runs) -> Found:
    """The curves, and the μ̄ that (19) would need for each of ours."""
    every = solved(runs)
    fits = {key: {name: fit(done, key) for name, done in every.items()} for key in KEYS}
    words = (
        "The paper draws both of its models and measured angles, without numbers. The 'zero-fit' "
        "line is (19) with the wall's own Yeoh law and the sheath instead of μ̄: nothing in it is "
        "fitted.",
        "As the paper fits μ̄ to its experiments, so (19) is fitted to our curves below.",
    )
    return Found(
        words=words,
        figures=[
            Figure(
                "fig10",
                _draw(every),
                "Bending angle over pressure: (a) to (c) radius 8 mm, (d) to (f) radius 6 mm, "
                "lengths 160, 130 and 100 mm, wall 2 mm.",
            )
        ],
        tables=[_table(every, fits)],
        verdicts=verdicts(fits),
        commands=[done.command for done in every.values()],
    )


def fit(done: Solved, key: Key) -> float:
    """μ̄ in MPa with which (19) comes nearest to a curve, by least squares in the pressures."""
    curve = done.sizes[key]
    bent = curve.angle > 0
    return calibrate(1e-3 * curve.pressure[bent], np.radians(curve.angle[bent]), paper(key)).modulus


def verdicts(fits: dict[Key, dict[str, float]]) -> list[Verdict]:
    """On μ̄, and on its being the same for all actuators."""
    made = []
    for name in fits[KEYS[0]]:
        values = [fits[key][name] for key in KEYS]
        ours = f"{fits[KEYS[0]][name]:.3f} MPa, {min(values):.3f} to {max(values):.3f} over all six"
        why = (
            f"{MODULUS.value} MPa is fitted to measured points, which are not published; this one "
            "to our curve"
        )
        made.append(unknown("modulus", name, ours, why))
    return made


def _table(every: dict[str, Solved], fits: dict[Key, dict[str, float]]) -> Table:
    rows = []
    for letter, key in zip(LETTERS, KEYS, strict=True):
        for degrees in ANGLES:
            first = degrees == ANGLES[0]
            values = [float(kpa(form(key), degrees)) for _, form in CLOSED.values()]
            values += [done.sizes[key].at_angle(degrees) for done in every.values()]
            name = f"({letter}) a = {key[0]:g}, L = {key[1]:g} mm" if first else ""
            fitted = [f"{fits[key][model]:.3f}" if first else "" for model in every]
            rows.append([name, f"{degrees:g}°", *(f"{v:.1f}" for v in values), *fitted])
    head = ("", "", *CLOSED, *every, *(f"μ̄ of {name}" for name in every))
    return Table("Pressure, kPa; μ̄ in MPa that fits (19) to a model", head, rows)


def _draw(every: dict[str, Solved]) -> Any:
    figure, panels = page(6.6, nrows=2, ncols=3, sharey=True)
    angles = np.linspace(0.0, 360.0, 121)
    for panel, letter, key in zip(panels.flat, LETTERS, KEYS, strict=True):
        for look, form in CLOSED.values():
            panel.plot(kpa(form(key), angles), angles, **look.line())
        for name, done in every.items():
            look, curve = LOOKS[name], done.sizes[key]
            panel.plot(curve.pressure, curve.angle, color=look.color, ls=look.style, lw=1.2)
            marks = [int(np.argmin(np.abs(curve.angle - a))) for a in ANGLES]
            panel.plot(curve.pressure[marks], curve.angle[marks], **look.points(), label=look.label)
        across = "pressure, kPa" if letter in "def" else ""
        up = "bending angle, °" if letter in "ad" else ""
        named(panel, across, up, f"({letter}) a = {key[0]:g}, L = {key[1]:g} mm")
        panel.set_ylim(0, 375)
        panel.set_yticks(range(0, 361, 90))
        panel.set_xlim(left=0)
    legend(figure, panels.flat[0], 3, 0.65)
    return figure

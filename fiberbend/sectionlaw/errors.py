"""Errors of a table at states that are not fitted, by what they make of the strains of a rod."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.law import SectionLaw
from fiberbend.sectionlaw.made import Checked
from fiberbend.sectionlaw.range import Reach
from rod.functions import Floats
from rod.spline import Samples

_SOFT = 0.2
"""Part of the usual stiffness below which none counts: an error makes no strain without bounds."""


def sizes(chart: Chart) -> Callable[[Samples], Floats]:
    """What errors of slopes are measured by, for `rod.table.tabulate`.

    An error of a force is as large as the strain that it makes, ∂²Φ/∂u² times a part of a range:
    of curvatures and twist of theirs at that pressure, of the stretch of all stretches in the
    table, as next to the one that goes with its curvature it may be moved by little only.
    """

    def of(samples: Samples) -> Floats:
        assert samples.second is not None, "held states have second derivatives"
        stiff = np.diagonal(samples.second, axis1=1, axis2=2)
        found = np.maximum(stiff, _SOFT * np.median(stiff, axis=0))
        pressures = samples.points[:, -1]
        stretches = float(np.ptp(chart.strains(samples.points)[:, 0]))
        found[:, 0] *= stretches / chart.sizes(pressures)[:, 0]
        found[:, -1] = np.ptp(samples.slopes[:, -1])
        return found

    return of


def checked(law: SectionLaw, samples: Samples, reach: Reach) -> Checked:
    """Errors at states that are not fitted, and at the free ones.

    Args:
        law: by its table.
        samples: all states, by u and P.
        reach: with the free states.
    """
    fitted = {tuple(point) for point in law.table.samples.points.tolist()}
    held_out = np.array([tuple(point) not in fitted for point in samples.points.tolist()])
    told = np.empty_like(samples.slopes)
    for number, point in enumerate(samples.points):
        here = point[None, :-1]
        told[number, :-1] = law.table.gradient(here, point[-1])[0]
        told[number, -1] = -law.table.chamber(here, point[-1])[0]
    off = (np.abs(told - samples.slopes) / sizes(law.chart)(samples))[held_out].max(axis=0)
    softest, place, pressure = min(
        ((*law.table.softest(pressure), pressure) for pressure in _fine(law)),
        key=lambda found: found[0],
    )
    return Checked(
        states=int(held_out.sum()),
        force=float(off[0]),
        moment=float(off[1:-1].max()),
        area=float(off[-1]),
        angle=_angle_error(law, reach),
        softest=softest,
        where=(*law.chart.strains(np.array([[*place, pressure]]))[0].tolist(), pressure),
    )


def _fine(law: SectionLaw) -> list[float]:
    """Pressures at which convexity is looked at."""
    lines = law.table.axes[-1].lines
    found: list[float] = np.linspace(lines[0], lines[-1], 4 * len(lines)).tolist()
    return found


def _angle_error(law: SectionLaw, reach: Reach) -> float:
    """Of the free states, in parts of the greatest curvature or twist, or of the stretch."""
    worst = 0.0
    turns = max(float(np.abs(state[1:]).max()) for _, state in reach.free)
    bends = turns * reach.height > 1e-6
    size = turns if bends else max(abs(state.stretch - 1.0) for _, state in reach.free)
    low, high = law.table.axes[-1].lines[[0, -1]].tolist()
    for pressure, state in reach.free:
        if not low <= pressure <= high:
            continue
        off = np.array(law.free(pressure, state)) - np.array(state)
        worst = max(worst, float(np.abs(off[1:] if bends else off[:1]).max()) / size)
    return worst

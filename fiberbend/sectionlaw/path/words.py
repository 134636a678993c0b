"""A law about free states in words and as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from fiberbend.sectionlaw.path.made import PathMade

COLUMNS = (
    *("stretch", "curvature_1_per_m", "side_curvature_1_per_m", "twist_1_per_m"),
    *("pressure_kPa", "energy_Nmm_per_mm"),
    *("force_N", "moment_Nmm", "side_moment_Nmm", "torque_Nmm", "chamber_area_mm2", "fitted"),
)
"""Of the CSV; energy is that of section and air, whose slopes are forces and chamber."""

_ROUND_OFF = 1e-6


def lines(made: PathMade) -> Iterator[str]:
    """What a law is: range, states, errors, seconds."""
    law, known = made.law, made.checked
    low, high = law.pressures
    yield f"Law of the section about its free states: {made.title or made.model}"
    yield (
        "  energy per length Φ(stretch, curvature, side curvature, twist; pressure), by model "
        f"{made.model}"
    )
    yield f"  pressure   {1e3 * low:.4g} to {1e3 * high:.4g} kPa"
    free, sizes = law.free_at(high), law.chart.at(high)
    for name, size in zip(law.strains[1:], sizes[1:].tolist(), strict=True):
        value = getattr(free, name)
        # by symmetry it has none, but for round-off
        value = value if abs(value) > _ROUND_OFF * size else 0.0
        yield (
            f"  {name.replace('_', ' '):<14} ±{1e3 * size:.4g} 1/m about the free one, 0 to "
            f"{1e3 * value:.4g} 1/m: {np.degrees(value * made.length):.4g}° over {made.length:g} mm"
        )
    yield f"  stretch        ±{sizes[0]:.3g} by forces along the line, free 1 to {free.stretch:.4g}"
    if law.chart.least < 1:
        share = 100 * law.chart.least
        yield f"  at rest    {share:.3g} % of these ranges, which grow with the pressure"
    if law.alike:
        yield "  bent alike in all directions"
    yield (
        f"  states     {len(made.samples.values)}, {known.states} of them not fitted; degree "
        f"{law.degree}, {len(law.coefficients.lines) - 1} splines by the pressure; "
        f"{made.seconds:.1f} s of processor time"
    )
    yield (
        "  errors     at those, by what they make of the strains of a rod: stretch "
        f"{_percent(known.force)}, curvatures and twist {_percent(known.moment)}; chamber "
        f"{_percent(known.area)}; asked for {_percent(made.error)}"
    )
    yield f"  free       beside trials, of the greatest: {_percent(known.angle)}"
    if known.softest > 0:
        yield "  convex     in all strains, everywhere in the range"
    else:
        *where, pressure = known.where
        turned = ", ".join(
            f"{name.replace('_', ' ')} {1e3 * value:.4g} 1/m"
            for name, value in zip(law.strains[1:], where[1:], strict=True)
        )
        yield (
            f"  not convex at stretch {where[0]:.4g}, {turned}, {1e3 * pressure:.4g} kPa and "
            "about it: a rod may lose its stability there"
        )
    for remark in made.remarks:
        yield f"  note: {remark}"


def text(made: PathMade) -> str:
    """All states as CSV, by pressure."""
    samples, out = made.samples, io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    factors = np.array([1.0, 1e3, 1e3, 1e3, 1e3])
    for row in np.argsort(samples.points[:, 4], kind="stable").tolist():
        forces = samples.slopes[row] * np.array([1.0, 1.0, 1.0, 1.0, -1.0])
        numbers = [*(factors * samples.points[row]), samples.values[row], *forces]
        own = "yes" if samples.fitted[row] else "no"
        writer.writerow([*(f"{number:.12g}" for number in numbers), own])
    return out.getvalue()


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"

"""A table in words and as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from fiberbend.sectionlaw.made import Made

COLUMNS = (
    *("stretch", "curvature_1_per_m", "pressure_kPa", "energy_Nmm_per_mm"),
    *("force_N", "moment_Nmm", "chamber_area_mm2", "fitted"),
)
"""Of the CSV; energy is that of section and air, whose slopes the next three are."""


def lines(made: Made) -> Iterator[str]:
    """What a table is: range, states, errors, seconds."""
    law, checked = made.law, made.checked
    low, high = law.table.axes[-1].lines[[0, -1]].tolist()
    ends = [
        law.chart.strains(np.array([[e, u, pressure]]))[0, 1]
        for pressure in (low, high)
        for e in law.table.axes[0].lines[:1]
        for u in (0.0, 1.0)
    ]
    yield f"Law of the section by a table: {made.title or made.model}"
    yield f"  energy per length Φ(stretch, curvature; pressure), by model {made.model}"
    yield f"  pressure   {1e3 * low:.4g} to {1e3 * high:.4g} kPa"
    for pressure, (least, most) in ((low, ends[:2]), (high, ends[2:])):
        angles = [np.degrees(k * made.length) for k in (least, most)]
        yield (
            f"  curvature  {1e3 * least:.4g} to {1e3 * most:.4g} 1/m at {1e3 * pressure:.4g} kPa: "
            f"{angles[0]:.4g} to {angles[1]:.4g}° over {made.length:g} mm"
        )
    stretch = law.table.axes[0].lines[[0, -1]]
    yield (
        f"  stretch    {stretch[0]:.4g} to {stretch[1]:.4g}, "
        f"{law.chart.lever:.3g} mm below the line of centroids"
        if abs(law.chart.lever) > 1e-6
        else f"  stretch    {stretch[0]:.4g} to {stretch[1]:.4g}"
    )
    yield (
        f"  states     {len(made.samples.values)}, {checked.states} of them not fitted; "
        f"{made.seconds:.1f} s of processor time"
    )
    yield (
        f"  errors     at those, of the range: force {_percent(checked.force)}, moment "
        f"{_percent(checked.moment)}, chamber {_percent(checked.area)}; asked for "
        f"{_percent(made.error)}"
    )
    yield f"  free       beside trials, of the greatest: {_percent(checked.angle)}"
    if checked.softest > 0:
        yield "  convex     in stretch and curvature, everywhere in the range"
    else:
        where, curvature, pressure = checked.where
        yield (
            f"  not convex at stretch {where:.4g}, curvature {1e3 * curvature:.4g} 1/m, "
            f"{1e3 * pressure:.4g} kPa and about it: a rod may lose its stability there"
        )
    for remark in made.remarks:
        yield f"  note: {remark}"


def text(made: Made) -> str:
    """All states as CSV, by pressure, curvature and stretch."""
    points, strains, forces = made.samples.points, made.strains, made.forces
    fitted = {tuple(point) for point in made.law.table.samples.points.tolist()}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in np.lexsort((strains[:, 0], strains[:, 1], points[:, 2])).tolist():
        numbers = [
            strains[row, 0],
            1e3 * strains[row, 1],
            1e3 * points[row, 2],
            made.samples.values[row],
            *forces[row],
        ]
        own = "yes" if tuple(points[row].tolist()) in fitted else "no"
        writer.writerow([*(f"{number:.12g}" for number in numbers), own])
    return out.getvalue()


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"

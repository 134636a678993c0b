"""A table in words and as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from fiberbend.sectionlaw.made import Made
from rod.functions import Floats

_NAMES = {
    "stretch": ("stretch", "force_N"),
    "curvature": ("curvature_1_per_m", "moment_Nmm"),
    "side_curvature": ("side_curvature_1_per_m", "side_moment_Nmm"),
    "twist": ("twist_1_per_m", "torque_Nmm"),
}
"""Columns of a strain and of its conjugate."""


def columns(made: Made) -> tuple[str, ...]:
    """Of the CSV; energy is that of section and air, whose slopes are forces and chamber."""
    names = [_NAMES[name] for name in made.section.strains]
    return (
        *(strain for strain, _ in names),
        *("pressure_kPa", "energy_Nmm_per_mm"),
        *(force for _, force in names),
        *("chamber_area_mm2", "fitted"),
    )


def lines(made: Made) -> Iterator[str]:
    """What a table is: range, states, errors, seconds."""
    law, known = made.section, made.checked
    low, high = law.table.axes[-1].lines[[0, -1]].tolist()
    variables = ", ".join(name.replace("_", " ") for name in law.strains)
    yield f"Law of the section by a table: {made.title or made.model}"
    yield f"  energy per length Φ({variables}; pressure), by model {made.model}"
    yield f"  pressure   {1e3 * low:.4g} to {1e3 * high:.4g} kPa"
    for pressure in (low, high):
        ends = _ends(made, pressure)
        for number, name in enumerate(law.strains[1:], 1):
            least, most = ends[:, number].tolist()
            angles = [np.degrees(k * made.length) for k in (least, most)]
            yield (
                f"  {name.replace('_', ' '):<10} {1e3 * least:.4g} to {1e3 * most:.4g} 1/m at "
                f"{1e3 * pressure:.4g} kPa: {angles[0]:.4g} to {angles[1]:.4g}° over "
                f"{made.length:g} mm"
            )
    pulls = [law.chart.sizes(pressure)[0] / 2 for pressure in (low, high)]
    yield (
        f"  stretch    ±{pulls[0]:.3g} at {1e3 * low:.4g} kPa, ±{pulls[1]:.3g} at "
        f"{1e3 * high:.4g} kPa, about that without a force"
    )
    yield (
        f"  states     {len(made.samples.values)}, {known.states} of them not fitted; "
        f"{made.seconds:.1f} s of processor time"
    )
    turns = "curvature" if len(law.strains) == 2 else "curvatures and twist"
    yield (
        f"  errors     at those, by what they make of the strains of a rod: stretch "
        f"{_percent(known.force)}, {turns} {_percent(known.moment)}; chamber "
        f"{_percent(known.area)}; asked for {_percent(made.error)}"
    )
    yield f"  free       beside trials, of the greatest: {_percent(known.angle)}"
    if known.softest > 0:
        yield f"  convex     in {variables}, everywhere in the range"
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


def _ends(made: Made, pressure: float) -> Floats:
    """Least and greatest strains at a pressure, (2, m)."""
    ends = np.array([[0.0], [1.0]]) * np.ones(len(made.section.strains))
    return made.section.chart.strains(np.column_stack([ends, [pressure, pressure]]))


def text(made: Made) -> str:
    """All states as CSV, by pressure, curvature and stretch."""
    points, strains, forces = made.samples.points, made.strains, made.forces
    fitted = {tuple(point) for point in made.section.table.samples.points.tolist()}
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns(made))
    for row in np.lexsort((*strains.T, points[:, -1])).tolist():
        numbers = [
            strains[row, 0],
            *(1e3 * strains[row, 1:]),
            1e3 * points[row, -1],
            made.samples.values[row],
            *forces[row],
        ]
        own = "yes" if tuple(points[row].tolist()) in fitted else "no"
        writer.writerow([*(f"{number:.12g}" for number in numbers), own])
    return out.getvalue()


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"

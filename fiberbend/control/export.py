"""What a control run leaves for others: the loop as CSV, the filter as CSV and as a C header."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping

import numpy as np

from analytic.control.filter import AngleFilter, LinearTable
from analytic.control.loop import Trace
from fiberbend.version import __version__

COLUMNS = (
    "run",
    "time_s",
    "desired_deg",
    "filtered_deg",
    "plant_deg",
    "error_deg",
    "dead_zone_deg",
    "valves",
    "pressure_kPa",
    "measured_kPa",
)
"""Columns of control.csv; valves: −1 vent, 0 hold, 1 fill."""

TABLE_ERROR = 1e-3
"""Greatest error that a short table may add, rad: a seventieth of the dead zone."""
_MOST_POINTS = 1025

_HEADER = """\
/* Bending angle of a soft actuator from the gauge pressure in its chamber.
 *
 * {title}
 * {source}
 *
 * {points} points from {first} to {last} kPa in equal steps, straight in between; beyond the
 * ends the angle stays. Largest difference from the model, in between: {error:.2g} rad.
 * Written by fiberbend {version}. C99.
 */
#ifndef ANGLE_FILTER_H
#define ANGLE_FILTER_H

#define ANGLE_FILTER_POINTS {points}
#define ANGLE_FILTER_FIRST_KPA {first}f
#define ANGLE_FILTER_LAST_KPA {last}f
#define ANGLE_FILTER_MAX_ERROR_RAD {error:.3g}f

/* Angles in rad. */
static const float angle_filter_table[ANGLE_FILTER_POINTS] = {{
{values}
}};

/* Angle in rad at a gauge pressure in kPa; not a number at a pressure that is none. */
static inline float angle_filter_rad(float pressure_kpa)
{{
    const float steps = (float)(ANGLE_FILTER_POINTS - 1);
    const float x = (pressure_kpa - ANGLE_FILTER_FIRST_KPA)
                    * (steps / (ANGLE_FILTER_LAST_KPA - ANGLE_FILTER_FIRST_KPA));
    int i;

    if (x != x)
        return x;
    if (x <= 0.0f)
        return angle_filter_table[0];
    if (x >= steps)
        return angle_filter_table[ANGLE_FILTER_POINTS - 1];
    i = (int)x;
    return angle_filter_table[i]
           + (x - (float)i) * (angle_filter_table[i + 1] - angle_filter_table[i]);
}}

#endif
"""


def trace_csv(traces: Mapping[str, Trace]) -> str:
    """control.csv: every sample of every run, angles in degrees."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for name, trace in traces.items():
        angles = (trace.desired, trace.filtered, trace.angle, trace.error, trace.half)
        columns = [trace.time, *map(np.degrees, angles), trace.valves]
        columns += [1e3 * trace.pressure, 1e3 * trace.measured]
        for row in zip(*columns, strict=True):
            time, *degrees, valves, pressure, measured = row
            shown = [f"{value:.6g}" for value in (time, *degrees)]
            writer.writerow([name, *shown, int(valves), f"{pressure:.6g}", f"{measured:.6g}"])
    return text.getvalue()


def short_table(angle_filter: AngleFilter, highest: float) -> LinearTable:
    """The shortest table of 2ᵏ + 1 points from 0 to a pressure in MPa that keeps `TABLE_ERROR`.

    It ends at the filter's own end where that comes first, and never has more than 1025 points.
    """
    highest = min(highest, angle_filter.high)
    points = 9
    while True:
        table = angle_filter.linear_table(max(0.0, angle_filter.low), highest, points)
        if table.error <= TABLE_ERROR or points >= _MOST_POINTS:
            return table
        points = 2 * points - 1


def table_csv(table: LinearTable) -> str:
    """filter.csv: the points of a table."""
    rows = ["pressure_kPa,angle_rad,angle_deg"]
    rows += [
        f"{1e3 * pressure:.7g},{angle:.9g},{np.degrees(angle):.7g}"
        for pressure, angle in zip(table.pressure, table.angle, strict=True)
    ]
    return "\n".join(rows) + "\n"


def table_header(table: LinearTable, title: str, source: str) -> str:
    """angle_filter.h: a table with its look-up in C.

    Args:
        table: the table.
        title: title of the case.
        source: what the filter inverts, one line.
    """
    values = [f"{angle:.9g}" for angle in table.angle]
    # a C float needs a point or an exponent
    values = [f"{v}f" if set(v) & set(".e") else f"{v}.0f" for v in values]
    lines = ["    " + ", ".join(values[i : i + 6]) for i in range(0, len(values), 6)]
    return _HEADER.format(
        title=_comment(title),
        source=_comment(source),
        points=len(values),
        first=_kilopascals(table.pressure[0]),
        last=_kilopascals(table.pressure[-1]),
        error=table.error,
        values=",\n".join(lines),
        version=__version__,
    )


def shown_time(seconds: float) -> str:
    """A time as text; nan is a step that did not converge."""
    return "not within the hold" if math.isnan(seconds) else f"{1e3 * seconds:.0f} ms"


def _kilopascals(pressure: float) -> str:
    text = f"{1e3 * pressure:.7g}"
    return text if set(text) & set(".e") else f"{text}.0"


def _comment(text: str) -> str:
    """Text as plain ASCII for a comment."""
    plain = text.replace("μ̄", "mu").replace("θ", "theta").replace("°", " deg").replace("±", "+/-")
    return " ".join(plain.encode("ascii", "replace").decode().replace("*/", "* /").split())

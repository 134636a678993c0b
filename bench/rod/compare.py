"""Two histories of one scene beside each other, at equal loads."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

from bench.rod.record import Record

Floats = npt.NDArray[np.float64]
PRESSURE = "pressure_kPa"
TIP = ("tip_x_mm", "tip_y_mm", "tip_z_mm")
_SAME = 1e-9


@dataclasses.dataclass(frozen=True)
class Difference:
    """Of a quantity along a history.

    Attributes:
        scale: greatest value of the reference.
        greatest: greatest difference, without its sign.
        last: difference where the loads of both are greatest; of a distance without a sign.
    """

    scale: float
    greatest: float
    last: float

    @property
    def share(self) -> float:
        """The greatest difference in parts of the scale."""
        return self.greatest / self.scale

    @property
    def last_share(self) -> float:
        """The last one in parts of it."""
        return self.last / self.scale


def progress(record: Record, greatest: float) -> Floats:
    """How far the loads of each row have come: a load that is on whole counts one, (n,).

    Loads follow one another, so that a number tells the state.

    Args:
        record: a run.
        greatest: pressure that counts one, kPa.
    """
    loads = [name for name in record.columns if name.startswith("load_")]
    shares = [np.array(record.column(name)) for name in loads]
    along: Floats = np.array(record.column(PRESSURE)) / greatest
    for share in shares:
        along = along + np.nan_to_num(share)
    return along


def _greatest(*records: Record) -> float:
    return max(max(record.column(PRESSURE)) for record in records)


def at_loads(record: Record, name: str, along: Floats, greatest: float) -> Floats:
    """A column at the loads of another run, (n,); NaN where it was not there.

    Between its rows it is interpolated by Fritsch's and Carlson's cubics, each load by itself.

    Args:
        record: a run.
        name: of the column.
        along: progress of the loads.
        greatest: pressure that counts one, kPa.
    """
    own, values = progress(record, greatest), np.array(record.column(name))
    out = np.full(len(along), math.nan)
    for phase in range(math.ceil(own[-1] - _SAME)):
        inside = (own > phase - _SAME) & (own < phase + 1 + _SAME) & np.isfinite(values)
        here = (along > phase - _SAME) & (along < phase + 1 + _SAME)
        here &= along < own[-1] + _SAME
        places, first = np.unique(own[inside], return_index=True)
        if len(places) > 1:
            curve = PchipInterpolator(places, values[inside][first])
            out[here] = curve(np.clip(along[here], places[0], places[-1]))
    return out


def difference(reference: Record, found: Record, name: str) -> Difference | None:
    """Of a column; None where one of them does not have it."""
    if name not in reference.columns or name not in found.columns:
        return None
    greatest = _greatest(reference, found)
    along = progress(reference, greatest)
    wanted = np.array(reference.column(name))
    return _told(wanted, at_loads(found, name, along, greatest) - wanted)


def tips(reference: Record, found: Record) -> Difference:
    """Of the tip's place: a distance; its scale is the way that the tip goes."""
    greatest = _greatest(reference, found)
    along = progress(reference, greatest)
    place = np.array([reference.column(name) for name in TIP])
    other = np.array([at_loads(found, name, along, greatest) for name in TIP])
    way = np.linalg.norm(place - place[:, :1], axis=0)
    return _told(way, np.linalg.norm(other - place, axis=0))


def _told(values: Floats, off: Floats) -> Difference:
    known = np.isfinite(off)
    if not known.any():
        return Difference(math.nan, math.nan, math.nan)
    last = float(off[np.flatnonzero(known)[-1]])
    scale = float(np.nanmax(np.abs(values)))
    return Difference(scale, float(np.nanmax(np.abs(off[known]))), last)


def touch(record: Record, obstacle: str) -> float:
    """Pressure at which the gap to an obstacle closes first, kPa; NaN: never, or at rest."""
    name = f"contact_{obstacle}_gap_mm"
    if name not in record.columns:
        return math.nan
    gap, pressure = np.array(record.column(name)), record.column(PRESSURE)
    across, along = (np.array(record.column(f"contact_{obstacle}_{axis}_N")) for axis in "yz")
    force = np.hypot(across, along)
    known = np.isfinite(gap)
    closed = np.flatnonzero(force > 0)
    if not len(closed):
        return math.nan
    # the gap before, carried on: behind the touch it is no gap
    before = np.flatnonzero(known[: closed[0]])[-3:]
    if len(before) < 2:
        # it touches from rest on
        return math.nan
    curve = np.polyfit(gap[before], np.array(pressure)[before], len(before) - 1)
    return float(np.polyval(curve, 0.0))


def forces(reference: Record, found: Record, obstacle: str) -> Difference | None:
    """Of the force of an obstacle, without its direction; where both know it."""
    names = [f"contact_{obstacle}_{axis}_N" for axis in "yz"]
    if obstacle in reference.columns:
        names = [obstacle]
    if any(name not in record.columns for name in names for record in (reference, found)):
        return None
    greatest = _greatest(reference, found)
    along = progress(reference, greatest)
    own = np.linalg.norm([reference.column(name) for name in names], axis=0)
    other = np.linalg.norm([at_loads(found, name, along, greatest) for name in names], axis=0)
    return _told(own, other - own)

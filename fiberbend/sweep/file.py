"""A sweep file: a base case, the fields that vary, and what is reported.

The classes check the file's own values. `fiberbend.sweep.points.read_sweep` reads a file: it also
checks the case of every point, and reports every problem at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator
from pydantic_core import PydanticCustomError

from fiberbend.columns import COLUMNS, column
from fiberbend.schema.problems import Problem, found, meant
from fiberbend.schema.quantities import Angle, Pressure, SignedPressure, Spec

MapKind = Literal["pressure", "angle", "blocked-force", "stretch", "history"]

Values = Annotated[tuple[Any, ...], Field(strict=False)]

MOST_POINTS = 10_000
"""A grid with more points is taken for a mistake."""


class ReportSpec(Spec):
    """Content of the table and the maps of a sweep beside status, angle and time."""

    angles: tuple[Angle, ...] = Field(default=(), strict=False)
    """Bending angles at which the pressure is reported; every point hits them exactly."""
    pressures: tuple[SignedPressure, ...] = Field(default=(), strict=False)
    """Pressures at which the motion is reported, bending angle, twist and side angle as symmetry
    allows, else the stretch; every point hits them exactly."""
    force_at: Pressure | None = None
    """Pressure at which the blocked force is reported; none by default."""
    history: tuple[str, ...] = Field(default=(), strict=False)
    """Further columns of history.csv, at the end of each point."""
    maps: tuple[MapKind, ...] = Field(
        default=("pressure", "angle", "blocked-force", "stretch"), strict=False
    )
    """Quantities that are drawn, where the table has them."""


class SweepFile(Spec):
    """A sweep file."""

    title: str = ""
    """A line for the reader."""
    case: Any
    """The base case: the path of a case file, seen from the sweep file, or a case itself."""
    set: dict[str, Any] = Field(default={})
    """Changes to the base case that all points share, by dotted path."""
    vary: dict[str, Values] = Field(default={})
    """Values of each field, by dotted path; every combination is a point."""
    zip: dict[str, Values] = Field(default={})
    """Values of fields that change together: the first of each, the second of each, …"""
    points: tuple[dict[str, Any], ...] = Field(default=(), strict=False)
    """Points one by one, each as dotted paths with values."""
    report: ReportSpec = ReportSpec()
    """What is reported."""

    @field_validator("case")
    @classmethod
    def _path_or_mapping(cls, case: Any) -> Any:
        if not isinstance(case, str | dict):
            raise PydanticCustomError("case", "expected the path of a case file, or a case")
        return case


def contradictions(file: SweepFile) -> Iterator[Problem]:
    """What is wrong with a sweep file beyond its single values."""
    for part, fields in (("vary", file.vary), ("zip", file.zip)):
        for path, values in fields.items():
            if not values:
                yield Problem(f"{part}.{path}", "no value, expected at least one")
    for index, name in enumerate(file.report.history):
        try:
            column(name)
        except KeyError:
            known = [each.name for each in COLUMNS]
            text = f"no column of history.csv{meant(name, known)}"
            yield Problem(f"report.history.{index}", f"{found(name)}, {text}")
    for index, settings in enumerate(file.points):
        if not settings:
            yield Problem(f"points.{index}", "nothing set, expected paths with values")
    parts: Mapping[str, set[str]] = {
        "points": {path for settings in file.points for path in settings},
        "zip": {*file.zip},
        "vary": {*file.vary},
    }
    seen: dict[str, str] = {}
    for part, paths in parts.items():
        for path in sorted(paths):
            if path in seen:
                yield Problem(f"{part}.{path}", f"given under {seen[path]} too, expected once")
            seen.setdefault(path, part)
    if not seen:
        yield Problem("vary", "nothing varies, expected fields under vary, zip or points")
    lengths = {path: len(values) for path, values in file.zip.items()}
    first = next(iter(lengths), "")
    for path, length in lengths.items():
        if length != lengths[first]:
            yield Problem(
                f"zip.{path}", f"{length} values, expected {lengths[first]} as zip.{first} has"
            )
    count = max(len(file.points), 1) * max(lengths.get(first, 1), 1)
    for values in file.vary.values():
        count *= max(len(values), 1)
    if count > MOST_POINTS:
        yield Problem("vary", f"{count} points, expected at most {MOST_POINTS}")

"""A table as it was made: the law, its states, and what is known of its errors."""

from __future__ import annotations

import dataclasses
import io
import json
from typing import Any

import numpy as np

from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.law import Free, SectionLaw
from fiberbend.sectionlaw.polynomial import Polynomial
from fiberbend.sectionlaw.side import Side
from fiberbend.sectionlaw.space import Round, Space
from machine.folders import DAMAGED
from rod.functions import Floats
from rod.spline import Axis, Samples
from rod.table import Table


@dataclasses.dataclass(frozen=True)
class Checked:
    """Errors at states that are not fitted, as strains that they make in parts of their ranges.

    Attributes:
        states: number of those.
        force: of N, as the stretch that it makes, in parts of all stretches.
        moment: of moments, as curvature or twist, in parts of those at the same pressure.
        area: of that of the chamber, in parts of its range.
        angle: of free states found by trials, in parts of the greatest curvature, or stretch.
        softest: least eigenvalue of ∂²Φ by the strains in parts of their ranges, N; below zero a
            rod may lose its stability by its section alone.
        where: that is: the strains, curvatures in rad/mm, and pressure in MPa.
    """

    states: int
    force: float
    moment: float
    area: float
    angle: float
    softest: float
    where: tuple[float, ...]

    @property
    def worst(self) -> float:
        """Greatest of the errors."""
        return max(self.force, self.moment, self.area, self.angle)


@dataclasses.dataclass(frozen=True)
class Made:
    """A table with where it comes from.

    Attributes:
        section: the law by the table.
        checked: its errors.
        samples: all states that were asked for: Φ and its slopes by e, u and P.
        error: asked for.
        digest: of all that enters.
        title: of the case.
        model: that solved the states.
        length: of the actuator, mm, to which its angles belong.
        free: pressures in MPa with the free states that trials have found.
        solved: states that were solved, those on the way too.
        seconds: of processor time.
        remarks: what casts doubt on it, a line each.
        side: what it does beside, where strains were asked for that are not in the table.
    """

    section: SectionLaw
    checked: Checked
    samples: Samples
    error: float
    digest: str
    title: str
    model: str
    length: float
    free: tuple[tuple[float, Free], ...]
    solved: int
    seconds: float
    remarks: tuple[str, ...] = ()
    side: Side | None = None

    @property
    def worst(self) -> float:
        """Greatest of its errors."""
        return self.checked.worst

    @property
    def law(self) -> SectionLaw | Round | Space:
        """The law of a rod."""
        return self.section if self.side is None else self.side.law(self.section)

    @property
    def strains(self) -> Floats:
        """Those of all states, (n, m)."""
        return self.section.chart.strains(self.samples.points)

    @property
    def forces(self) -> Floats:
        """N, moments and the area of the chamber at all states, (n, m + 1)."""
        found = self.section.chart.forces(self.samples.points, self.samples.slopes)
        return found * np.array([1.0] * len(self.section.strains) + [-1.0])

    def packed(self) -> bytes:
        """As an npz file."""
        table, about = self.section.table, dataclasses.asdict(self)
        for name in ("section", "samples", "side"):
            del about[name]
        about["chart"] = dataclasses.asdict(self.section.chart)
        about["strains"] = self.section.strains
        beside: dict[str, Floats] = {}
        if self.side is not None:
            about["side"] = dataclasses.asdict(self.side)
            beside["side_coefficients"] = about["side"].pop("coefficients")
        about["degrees"] = [axis.degree for axis in table.axes]
        arrays = {f"lines_{number}": axis.lines for number, axis in enumerate(table.axes)}
        fitted = {"fitted_" + f.name: getattr(table.samples, f.name) for f in _OF_SAMPLES}
        asked = {f.name: getattr(self.samples, f.name) for f in _OF_SAMPLES}
        readable: dict[str, Floats] = {}
        for number, name in enumerate(self.section.strains):
            readable[name + UNITS[name][0]] = self.strains[:, number]
            readable[UNITS[name][1]] = self.forces[:, number]
        readable["pressure_MPa"] = self.samples.points[:, -1]
        readable["chamber_area_mm2"] = self.forces[:, -1]
        file = io.BytesIO()
        np.savez_compressed(
            file,
            about=np.array(json.dumps(about, ensure_ascii=False)),
            coefficients=table.coefficients,
            errors=table.errors,
            **arrays,
            **beside,
            **fitted,
            **asked,
            **readable,
        )
        return file.getvalue()


_OF_SAMPLES = dataclasses.fields(Samples)
UNITS = {
    "stretch": ("", "force_N"),
    "curvature": ("_1_per_mm", "moment_Nmm"),
    "side_curvature": ("_1_per_mm", "side_moment_Nmm"),
    "twist": ("_1_per_mm", "torque_Nmm"),
}
"""What ends the name of each strain in a file, and the name of its conjugate."""


def unpacked(content: bytes) -> Made:
    """A table from an npz file; nothing in it is executed.

    Raises:
        ValueError: it is none.
    """
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            given = {name: file[name] for name in file.files}
        about: dict[str, Any] = json.loads(str(given["about"]))
        axes = tuple(
            Axis(given[f"lines_{number}"], degree)
            for number, degree in enumerate(about.pop("degrees"))
        )
        fitted = Samples(*(given["fitted_" + f.name] for f in _OF_SAMPLES))
        table = Table(axes, given["coefficients"], fitted, given["errors"])
        law = SectionLaw(table, _chart(about.pop("chart")), tuple(about.pop("strains")))
        samples = Samples(*(given[f.name] for f in _OF_SAMPLES))
        free = tuple((pressure, Free(*state)) for pressure, state in about.pop("free"))
        known = about.pop("checked")
        checked = Checked(**known | {"where": tuple(known["where"])})
        remarks = tuple(about.pop("remarks"))
        beside, side = about.pop("side", None), None
        if beside is not None:
            beside["pairs"] = tuple((i, j) for i, j in beside["pairs"])
            beside["lines"] = tuple(tuple(line) for line in beside["lines"])
            for name in ("small", "limits", "degrees"):
                beside[name] = tuple(beside[name])
            side = Side(coefficients=given["side_coefficients"], **beside)
        return Made(
            section=law,
            checked=checked,
            samples=samples,
            free=free,
            remarks=remarks,
            side=side,
            **about,
        )
    except (*DAMAGED, TypeError, OSError) as error:
        raise ValueError(f"no table: {error}") from None


def _chart(given: dict[str, Any]) -> Chart:
    unpulled = given.pop("unpulled")
    powers = tuple(tuple(row) for row in unpulled.pop("powers"))
    polynomial = Polynomial(powers=powers, **{k: tuple(v) for k, v in unpulled.items()})
    return Chart(polynomial, **{name: tuple(values) for name, values in given.items()})

"""A table as it was made: the law, its states, and what is known of its errors."""

from __future__ import annotations

import dataclasses
import io
import json
from typing import Any

import numpy as np

from fiberbend.sectionlaw.chart import Chart
from fiberbend.sectionlaw.law import Free, SectionLaw
from machine.folders import DAMAGED
from rod.functions import Floats
from rod.spline import Axis, Samples
from rod.table import Table


@dataclasses.dataclass(frozen=True)
class Checked:
    """Errors at states that are not fitted, in parts of the ranges over the table.

    Attributes:
        states: number of those.
        force: of N.
        moment: of M.
        area: of that of the chamber.
        angle: of free states found by trials, in parts of the greatest curvature, or stretch.
        softest: least eigenvalue of ∂²Φ by the strains in parts of their ranges, N; below zero a
            rod may lose its stability by its section alone.
        where: that is: stretch, curvature in rad/mm and pressure in MPa.
    """

    states: int
    force: float
    moment: float
    area: float
    angle: float
    softest: float
    where: tuple[float, float, float]


@dataclasses.dataclass(frozen=True)
class Made:
    """A table with where it comes from.

    Attributes:
        law: the law.
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
    """

    law: SectionLaw
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

    @property
    def strains(self) -> Floats:
        """λ and k of all states, (n, 2)."""
        return self.law.chart.strains(self.samples.points)

    @property
    def forces(self) -> Floats:
        """N, M and the area of the chamber at all states, (n, 3)."""
        return self.law.chart.forces(self.samples.points, self.samples.slopes)

    def packed(self) -> bytes:
        """As an npz file."""
        table, about = self.law.table, dataclasses.asdict(self)
        for name in ("law", "samples"):
            del about[name]
        about["chart"] = dataclasses.asdict(self.law.chart)
        about["degrees"] = [axis.degree for axis in table.axes]
        arrays = {f"lines_{number}": axis.lines for number, axis in enumerate(table.axes)}
        fitted = {"fitted_" + f.name: getattr(table.samples, f.name) for f in _OF_SAMPLES}
        asked = {f.name: getattr(self.samples, f.name) for f in _OF_SAMPLES}
        readable = {
            "stretch": self.strains[:, 0],
            "curvature_1_per_mm": self.strains[:, 1],
            "pressure_MPa": self.samples.points[:, 2],
            "force_N": self.forces[:, 0],
            "moment_Nmm": self.forces[:, 1],
            "chamber_area_mm2": self.forces[:, 2],
        }
        file = io.BytesIO()
        np.savez_compressed(
            file,
            about=np.array(json.dumps(about, ensure_ascii=False)),
            coefficients=table.coefficients,
            errors=table.errors,
            **arrays,
            **fitted,
            **asked,
            **readable,
        )
        return file.getvalue()


_OF_SAMPLES = dataclasses.fields(Samples)


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
        law = SectionLaw(table, Chart(**about.pop("chart")))
        samples = Samples(*(given[f.name] for f in _OF_SAMPLES))
        free = tuple((pressure, Free(*state)) for pressure, state in about.pop("free"))
        known = about.pop("checked")
        checked = Checked(**known | {"where": tuple(known["where"])})
        remarks = tuple(about.pop("remarks"))
        return Made(law=law, checked=checked, samples=samples, free=free, remarks=remarks, **about)
    except (*DAMAGED, TypeError, OSError) as error:
        raise ValueError(f"no table: {error}") from None

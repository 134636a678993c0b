"""A law about free states as it was made: kept in a file, and what is known of its errors."""

from __future__ import annotations

import dataclasses
import io
import json
from typing import Any

import numpy as np

from fiberbend.sectionlaw.law import Free
from fiberbend.sectionlaw.made import UNITS, Checked
from fiberbend.sectionlaw.path.chart import PathChart
from fiberbend.sectionlaw.path.curve import Curve
from fiberbend.sectionlaw.path.law import SPACE, PathLaw
from machine.folders import DAMAGED
from rod.functions import Floats

KIND = "about free states"
"""What tells its file from a table's."""


@dataclasses.dataclass(frozen=True)
class States:
    """What was solved for it.

    Attributes:
        points: strains and pressures, (n, 5): 1, rad/mm and MPa.
        values: Φ, (n,), N.
        slopes: N, moments and torque, and minus the area of the chamber, (n, 5).
        fitted: 1 where the law is fitted to it, (n,), and 0 where it is compared with it.
    """

    points: Floats
    values: Floats
    slopes: Floats
    fitted: Floats


@dataclasses.dataclass(frozen=True)
class PathMade:
    """A law about free states with where it comes from; as `fiberbend.sectionlaw.made.Made`.

    Attributes:
        law: of a rod.
        checked: its errors.
        samples: all states.
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

    law: PathLaw
    checked: Checked
    samples: States
    error: float
    digest: str
    title: str
    model: str
    length: float
    free: tuple[tuple[float, Free], ...]
    solved: int
    seconds: float
    remarks: tuple[str, ...] = ()

    def packed(self) -> bytes:
        """As an npz file."""
        about = dataclasses.asdict(self)
        for name in ("law", "samples"):
            del about[name]
        law, samples = self.law, self.samples
        about["kind"] = KIND
        about["law"] = {
            "sizes": law.chart.sizes,
            "least": law.chart.least,
            "degree": law.degree,
            "alike": law.alike,
            "degrees": [law.chart.path.degree, law.coefficients.degree],
        }
        readable: dict[str, Floats] = {}
        for number, name in enumerate(SPACE):
            readable[name + UNITS[name][0]] = samples.points[:, number]
            readable[UNITS[name][1]] = samples.slopes[:, number]
        readable["pressure_MPa"] = samples.points[:, 4]
        readable["chamber_area_mm2"] = -samples.slopes[:, 4]
        file = io.BytesIO()
        np.savez_compressed(
            file,
            about=np.array(json.dumps(about, ensure_ascii=False)),
            path_lines=law.chart.path.lines,
            path=law.chart.path.coefficients,
            lines=law.coefficients.lines,
            coefficients=law.coefficients.coefficients,
            values=samples.values,
            fitted=samples.fitted,
            **readable,
        )
        return file.getvalue()


def unpacked(content: bytes) -> PathMade:
    """A law from an npz file; nothing in it is executed.

    Raises:
        ValueError: it is none.
    """
    try:
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            about: dict[str, Any] = json.loads(str(file["about"]))
            if about.pop("kind") != KIND:
                raise ValueError("a table")
            given = {name: file[name] for name in file.files}
        own = about.pop("law")
        degrees = own.pop("degrees")
        path = Curve(given["path_lines"], degrees[0], given["path"])
        chart = PathChart(path, tuple(own.pop("sizes")), own.pop("least"))
        curve = Curve(given["lines"], degrees[1], given["coefficients"])
        law = PathLaw(chart, own["degree"], curve, own["alike"])
        points = [given[name + UNITS[name][0]] for name in SPACE] + [given["pressure_MPa"]]
        slopes = [given[UNITS[name][1]] for name in SPACE] + [-given["chamber_area_mm2"]]
        samples = States(
            np.column_stack(points), given["values"], np.column_stack(slopes), given["fitted"]
        )
        known = about.pop("checked")
        return PathMade(
            law=law,
            checked=Checked(**known | {"where": tuple(known["where"])}),
            samples=samples,
            free=tuple((pressure, Free(*state)) for pressure, state in about.pop("free")),
            remarks=tuple(about.pop("remarks")),
            **about,
        )
    except (*DAMAGED, TypeError, OSError) as error:
        raise ValueError(f"no law: {error}") from None

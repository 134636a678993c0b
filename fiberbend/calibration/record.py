"""What a calibration has found, and how it is said and kept."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from materials.bedding import Bedding
    from materials.bulging import Bulging

DOUBTFUL = 0.5
"""Percent left between calibrated section and cell that a user is told of."""
DOUBTFUL_FAMILIES = 1.5
"""The same of families."""


@dataclasses.dataclass(frozen=True, kw_only=True)
class Calibration:
    """Numbers with which a section gives what its cell gives, and how well.

    Attributes:
        bent_percent: greatest difference between section and cell in the pressure for an angle; of
            families in any turn, in the lengthening and in the pressure.
        straight_percent: the same in the moment that keeps them straight; 0 where that is not
            looked at.
        states: number of states of the cell.
        strain: greatest k H of these states: curvature times height of the winding.
        pressure: greatest pressure of these states, MPa.
        growth: greatest chamber area of these states over that at rest.
        whole: the cell came to the end of what was asked of it.
        seconds: that cell and fit have taken.
    """

    bent_percent: float
    straight_percent: float
    states: int
    strain: float
    pressure: float
    growth: float
    whole: bool
    seconds: float

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not isinstance(value, int | float) or not math.isfinite(value):
                raise ValueError(f"{name} = {value!r}, expected a finite number")

    def bulging(self) -> Bulging | Bedding:
        """The numbers as the finite-element code takes them."""
        raise NotImplementedError

    def entries(self) -> dict[str, Any]:
        """As a mapping of plain values."""
        return dataclasses.asdict(self)


@dataclasses.dataclass(frozen=True, kw_only=True)
class OfPattern(Calibration):
    """Of a pattern of one pitch.

    Attributes:
        stiffness: K0, MPa/mm.
        linear: a1.
        quadratic: a2.
    """

    stiffness: float
    linear: float
    quadratic: float

    def bulging(self) -> Bulging:
        """The three numbers."""
        from materials.bulging import Bulging

        return Bulging(self.stiffness, self.linear, self.quadratic)


@dataclasses.dataclass(frozen=True, kw_only=True)
class OfFamilies(Calibration):
    """Of families of threads.

    Attributes:
        normal: k0, MPa.
        along: k_s, MPa.
        across: a.
        by_pressure: c.
    """

    normal: float
    along: float
    across: float
    by_pressure: float

    def bulging(self) -> Bedding:
        """The four numbers."""
        from materials.bedding import Bedding

        return Bedding(self.normal, self.along, self.across, self.by_pressure)


def read(entries: Mapping[str, Any]) -> Calibration:
    """A calibration from its entries.

    Raises:
        ValueError: they are of none.
    """
    kind = OfFamilies if "normal" in entries else OfPattern
    try:
        return kind(**entries)
    except TypeError as error:
        raise ValueError(str(error)) from None


def named(numbers: Bulging | Bedding) -> dict[str, float]:
    """Numbers as run.json names them."""
    from materials.bulging import Bulging

    if isinstance(numbers, Bulging):
        return {
            "stiffness_MPa_per_mm": numbers.stiffness,
            "linear": numbers.linear,
            "quadratic": numbers.quadratic,
        }
    return {
        "normal_MPa": numbers.normal,
        "along_MPa": numbers.along,
        "across": numbers.across,
        "pressure": numbers.pressure,
    }


def words(numbers: Bulging | Bedding) -> str:
    """Numbers with their names and units."""
    from materials.bulging import Bulging

    if isinstance(numbers, Bulging):
        return (
            f"K0 {numbers.stiffness:.3g} MPa/mm, a1 {numbers.linear:.3g}, "
            f"a2 {numbers.quadratic:.3g}"
        )
    return (
        f"k0 {numbers.normal:.3g} MPa, k_s {numbers.along:.3g} MPa, a {numbers.across:.3g}, "
        f"c {numbers.pressure:.3g}"
    )


@dataclasses.dataclass(frozen=True)
class Calibrated:
    """A calibration of a case, and where it comes from.

    Attributes:
        found: what was found.
        digest: of all that enters.
        straight: it is for an actuator kept straight.
        kept: it was found before and kept.
        remarks: what casts doubt on it, a line each.
    """

    found: Calibration
    digest: str
    straight: bool
    kept: bool
    remarks: tuple[str, ...] = ()

    @property
    def left_percent(self) -> float:
        """Greatest difference between section and cell in what the case asks for."""
        return self.found.straight_percent if self.straight else self.found.bent_percent

    def line(self) -> str:
        """One line for the user."""
        how = "before" if self.kept else f"in {self.found.seconds:.1f} s"
        numbers = words(self.found.bulging())
        return f"winding: calibrated by the cell {how} ({numbers}; left {self.left_percent:.2f} %)"

    def entry(self) -> dict[str, Any]:
        """The entry 'calibration' of run.json."""
        found = self.found
        return {
            **named(found.bulging()),
            "left_percent": self.left_percent,
            "bent_percent": found.bent_percent,
            "straight_percent": found.straight_percent,
            "states": found.states,
            "up_to_kPa": 1e3 * found.pressure,
            "digest": self.digest,
            "kept": self.kept,
            "seconds": 0.0 if self.kept else found.seconds,
            "took_seconds": found.seconds,
            "text": self.line(),
        }

"""What Polygerinos et al. 2015 leave open of their simulations: our value, bounds and the reason.

Each open matter has one field of `Combination`; a combination is what a case needs to be solved.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

from bench.paper.facts import BASELINE, CAP, STATED
from bench.paper.runs import Key

RUBBER, BASE = "elastosil-m4601", "combined-base"
FLOOR = 2.0
"""b in mm of (a, b, t, L) = (8, 2, 2, 160) in IV-B: of the actuator that was calibrated, and of the
analytical model; whether of the simulations too is not said."""


@dataclasses.dataclass(frozen=True)
class Range:
    """A matter that is open between two numbers.

    Attributes:
        key: field of `Combination`.
        what: of what it is.
        unit: of its numbers.
        low: least value.
        high: greatest value.
        reason: why these bounds.
        fields: of a case that it changes.
    """

    key: str
    what: str
    unit: str
    low: float
    high: float
    reason: str
    fields: str

    def __post_init__(self) -> None:
        if not self.low <= self.default <= self.high:
            raise ValueError(f"{self.key}: {self.default:g} is outside its bounds")

    @property
    def default(self) -> float:
        """Our value elsewhere on the page."""
        return float(getattr(DEFAULT, self.key))

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and greatest value."""
        return self.low, self.high

    def words(self, value: float) -> str:
        """A value of it."""
        return f"{value:.3g} {self.unit}"


@dataclasses.dataclass(frozen=True)
class Choice:
    """A matter that is open between two readings of the paper.

    Attributes:
        key: field of `Combination`.
        what: of what it is.
        names: of the readings, by the field's value; ours elsewhere on the page is the first.
        reason: what the paper says and does not.
        fields: of a case that it changes.
    """

    key: str
    what: str
    names: Mapping[bool, str]
    reason: str
    fields: str

    @property
    def default(self) -> bool:
        """Our reading elsewhere on the page."""
        return bool(getattr(DEFAULT, self.key))

    def words(self, value: bool) -> str:
        """A reading of it."""
        return self.names[value]


@dataclasses.dataclass(frozen=True)
class Readings:
    """A reading of every matter that is open between two.

    Attributes:
        layered: a floor of the wall's rubber, b = 2 mm, over a layer of C = 7.9 MPa; otherwise the
            whole floor is of it.
        capped: the stated L includes both caps.
        whole: the beams carry with the fiber's whole radius.
        bare: no sheath under the floor.
        guided: the actuator is kept straight by a strip along its crown, as a body, and not by the
            plane section's own curvature being zero.
    """

    layered: bool = False
    capped: bool = False
    whole: bool = False
    bare: bool = False
    guided: bool = False


@dataclasses.dataclass(frozen=True)
class Combination(Readings):
    """A value for everything that is open; the defaults are ours elsewhere on the page.

    Attributes:
        pitch: of the winding, mm.
        floor: thickness of the floor of C = 7.9 MPa, mm; not used where `layered`.
        layer: thickness of the layer of C = 7.9 MPa, mm; only where `layered`.
        lever: L_f of eq. (20), mm.
    """

    pitch: float = 3.0
    floor: float = FLOOR
    layer: float = 1.0
    lever: float = CAP.value

    @property
    def readings(self) -> Readings:
        """Without its numbers."""
        names = [field.name for field in dataclasses.fields(Readings)]
        return Readings(**{name: getattr(self, name) for name in names})

    @property
    def thickness(self) -> float:
        """Of what has C = 7.9 MPa, mm."""
        return self.layer if self.layered else self.floor

    @property
    def base(self) -> str:
        """Field of that thickness."""
        return "layer" if self.layered else "floor"

    def chamber(self, length: float) -> float:
        """Length of the chamber in mm of an actuator of a stated length L."""
        return length - 2 * CAP.value if self.capped else length

    def settings(self, key: Key = BASELINE, winding: str = "smeared") -> dict[str, Any]:
        """Changes to cases/section.yaml, or to another case of its actuator.

        The sheath under the floor is no field of a case: see `bench.paper.assumed.under`.

        Args:
            key: (a, L, t) in mm as the paper states them.
            winding: how the winding enters.
        """
        radius, length, wall = key
        share = 1.0 if self.whole else STATED["halved"].value
        young, thread = STATED["young"].value, STATED["thread"].value
        changes: dict[str, Any] = {
            "actuator.radius": f"{radius:g} mm",
            "actuator.length": f"{self.chamber(length):g} mm",
            "actuator.wall": f"{wall:g} mm",
            "actuator.floor": f"{self.floor:.6g} mm",
            "effects.1.winding.pitch": f"{self.pitch:.6g} mm",
            "effects.1.winding.as": winding,
            "effects.1.winding.fiber": {
                "modulus": f"{young:g} MPa",
                "diameter": f"{thread:g} mm",
                "radius_factor": share,
            },
            "compare": [],
        }
        if self.layered:
            changes |= {
                "actuator.floor": f"{FLOOR:g} mm",
                "actuator.layer": f"{self.layer:.6g} mm",
                "materials.floor": RUBBER,
                "materials.layer": BASE,
            }
        return changes


DEFAULT = Combination()
"""Ours elsewhere on the page."""

PITCH = Range(
    "pitch",
    "pitch of the double helix",
    "mm",
    1.5,
    6.0,
    "Figs. 1 and 6 show single turns: at least four diameters of the fiber; at most three "
    "thicknesses of the wall, as far as calibrations are known (docs/evidence/calibration.md)",
    "effects.1.winding.pitch",
)
THICKNESS = Range(
    "floor",
    "floor of the combined material, thickness",
    "mm",
    1.5,
    3.0,
    "b = 2 mm in IV-B is of the calibrated actuator; the simulation's floor may leave out a part "
    "of the rubber, or have fabric and glue on it; 3 mm is the wall once and a half",
    "actuator.floor",
)
LAYER = Range(
    "layer",
    "layer of the combined material under rubber, thickness",
    "mm",
    0.25,
    2.0,
    "a woven glass fabric is a quarter of a millimetre or less; a layer meshed with tetrahedra is "
    "as thick as the wall at most",
    "actuator.layer",
)
LEVER = Range(
    "lever",
    "L_f of eq. (20)",
    "mm",
    7.5,
    15.0,
    "'distal cap length': the cap is 15 mm (II); the middle of the cap where the force is spread "
    "over all of it",
    "none: it enters eq. (20), and the moment of a section that is kept straight",
)
RANGES = (PITCH, THICKNESS, LAYER, LEVER)

CHOICES = (
    Choice(
        "layered",
        "what has C = 7.9 MPa",
        {False: "the whole floor", True: "a layer under 2 mm of rubber"},
        "'the bottom layer of the actuator, consisting of an inextensible layer, was modeled as an "
        "elastomer' (III-C): with or without the rubber above it",
        "actuator.floor, actuator.layer, materials.floor, materials.layer",
    ),
    Choice(
        "capped",
        "length L",
        {False: "of the chamber", True: "with both caps of 15 mm"},
        "'160.0-mm length' (V-A): not said of what",
        "actuator.length",
    ),
    Choice(
        "whole",
        "radius of the beams that carries",
        {False: "half of the fiber's", True: "the whole"},
        "'reduced by a factor of 2' for bending, 'insignificant change in tensile strength' "
        "(III-C): EA of a quarter, or made up for",
        "effects.1.winding.fiber.radius_factor",
    ),
    Choice(
        "bare",
        "sheath under the floor",
        {False: "as all around", True: "none"},
        "the sheath 'encapsulates the actuator body' (II); the simulation's is not described",
        "none: its elements are left out",
    ),
    Choice(
        "guided",
        "how it is kept at 0°",
        {False: "curvature zero all along", True: "a strip along the crown holds the body"},
        "'the bending deformation of the actuator was also constrained' (III-C); Fig. 11 shows a "
        "plate above it",
        "effects.2.blocked-tip",
    ),
)


def ranges(readings: Readings) -> tuple[Range, Range, Range]:
    """What is open between numbers under given readings: pitch, thickness, L_f."""
    return PITCH, LAYER if readings.layered else THICKNESS, LEVER


def combined(readings: Readings, values: tuple[float, float, float]) -> Combination:
    """A combination of readings and the numbers of `ranges`."""
    given = Combination(**dataclasses.asdict(readings))
    for each, value in zip(ranges(readings), values, strict=True):
        given = changed(given, each.key, value)
    return given


def changed(given: Combination, key: str, value: float | bool) -> Combination:
    """A combination with another value of one field."""
    change: dict[str, Any] = {key: value}
    return dataclasses.replace(given, **change)

"""Cases of model rod, and laws in closed form in place of tables."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from fiberbend.case.case import Case
from fiberbend.reader.reader import parse_case
from fiberbend.slender import actuator
from fiberbend.slender.laws import SectionLaw, strains_of, without_shear
from rod.functions import Floats
from rod.law import Law, Linear, Zones
from rod.layout import Layout

WOUND = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
RUBBER = {"law": "neo-hooke", "mu": "0.3 MPa"}
DENSITY = "1100 kg/m^3"
QUIET = {"pictures": False, "report": False}
BASE: dict[str, Any] = {
    "actuator": {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "100 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "cap": "10 mm",
    },
    "materials": {"wall": RUBBER, "floor": {"name": "combined-base"}},
    "effects": [{"pressure": {"to": "20 kPa"}}, {"winding": WOUND}],
    "model": "rod",
    "output": QUIET,
}
ROUND: dict[str, Any] = {
    "actuator": {
        "section": "circle",
        "radius": "5 mm",
        "length": "100 mm",
        "wall": "2 mm",
        "cap": "10 mm",
    },
    "materials": {"wall": RUBBER},
}
"""A tube that is alike above and below."""
STIFFNESS = np.diag([60.0, 1500.0])
"""EA in N and EI in N mm² of a made-up section."""


def spec(*effects: dict[str, Any], **changes: Any) -> dict[str, Any]:
    """A case with effects in place of its own where some are given; what is heavy has a density."""
    data = copy.deepcopy(BASE | changes)
    if effects:
        data["effects"] = [*effects, {"winding": WOUND}]
    if "time" in data or any("gravity" in effect for effect in data["effects"]):
        for material in data["materials"].values():
            material.setdefault("density", DENSITY)
    return data


def case(*effects: dict[str, Any], **changes: Any) -> Case:
    """The same, read."""
    return parse_case(spec(*effects, **changes))


def linear(thrust: Sequence[float] = (0.0, 0.0), scale: float = 1.0) -> Linear:
    """A linear law: areas of a pressure that stretches and bends it, all lengths scaled."""
    by = np.diag([scale, scale**2])
    return Linear(
        by @ STIFFNESS @ by,
        np.array([1.0, 0.0]),
        area=70.0 * scale**2,
        thrust=np.array([scale**2, scale**3]) * thrust,
    )


@dataclasses.dataclass(frozen=True)
class Softening(Linear):
    """Its moment EI (k − k³/(3 k₀²)) is greatest at k₀."""

    top: float = 0.01

    def value(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        out: Floats = super().value(strains, pressure)
        return out - self.stiffness[1, 1] * strains[:, 1] ** 4 / (12 * self.top**2)

    def gradient(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        out = super().gradient(strains, pressure).copy()
        out[:, 1] -= self.stiffness[1, 1] * strains[:, 1] ** 3 / (3 * self.top**2)
        return out

    def hessian(self, strains: Floats, pressure: float) -> Floats:
        """See `Law`."""
        out = super().hessian(strains, pressure).copy()
        out[:, 1, 1] -= self.stiffness[1, 1] * strains[:, 1] ** 2 / self.top**2
        return out


def without_ends(_case: Case, made: SectionLaw, cap: Law, layout: Layout, chamber: slice) -> Zones:
    """Caps are beams, and no pressure turns the ends of the chamber."""
    pieces = np.zeros(len(layout.lengths), dtype=int)
    pieces[chamber] = 1
    return Zones((cap, made.law), pieces.tolist())


def strains_without_shear(case: Case, _touched: bool = False) -> tuple[str, ...]:
    """Those that a law in closed form has here."""
    return without_shear(strains_of(case))


@pytest.fixture
def by_law(monkeypatch: pytest.MonkeyPatch) -> Callable[[Law], None]:
    """Puts a law in the place of the table of any section, without shear and without its ends."""

    def put(law: Law) -> None:
        made = SectionLaw(law, np.empty((0, 3)), "section", 0, 0.0, 0.0, ())
        monkeypatch.setattr(actuator, "section_law", lambda *_of: made)
        monkeypatch.setattr(actuator, "along", without_ends)
        monkeypatch.setattr(actuator, "strains_of", strains_without_shear)

    return put

"""Hard cases as data: what makes each hard, which models hold it, how it has to end."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping
from typing import Any

from fiberbend.reader import put

MODELS = ("section", "cell", "body")

BASE: dict[str, Any] = {
    "actuator": {
        "section": "hemicircle",
        "radius": "8 mm",
        "length": "80 mm",
        "wall": "2 mm",
        "floor": "2 mm",
        "sheath": "1 mm",
        "cap": "10 mm",
    },
    "materials": {"wall": "elastosil-m4601", "floor": "combined-base", "sheath": "ecoflex-0030"},
    "effects": [
        {"pressure": {"to": "180 kPa"}},
        {"winding": {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar"}},
    ],
    "mesh": {},
    "solver": {},
    "output": {"pictures": False, "fields": False},
}
"""The paper's actuator at half its length: 180° are as hard as 360° of the whole."""

OWN: dict[str, dict[str, Any]] = {
    "section": {},
    "cell": {},
    "body": {
        "mesh.axial": "8 mm",
        "effects.1.winding.as": "smeared",
        "solver.max_turn": "30 deg",
    },
}
"""What each model adds: a body is coarse, its winding spread, its steps short enough for ∫ P dV."""

TO, ANGLE = "effects.0.pressure.to", "effects.0.pressure.angle"
WINDING, FIBER = "effects.1.winding", "effects.1.winding.fiber"
BY_ANGLE = {TO: None}
"""Take the pressure's end away."""


def thread(factor: float) -> dict[str, Any]:
    """Kevlar, so many times stiffer."""
    return {"modulus": f"{31076 * factor:g} MPa", "diameter": "0.38 mm", "radius_factor": 0.5}


def bulky(ratio: float) -> dict[str, Any]:
    """Every material with a bulk modulus of so many times its shear modulus 2 c1."""
    rubbers = {
        "wall": {"c1": 0.11, "c2": 0.02},
        "floor": {"c1": 7.9},
        "sheath": {"c1": 0.012662},
    }
    return {
        f"materials.{part}": {
            "law": "yeoh",
            **{name: f"{value:g} MPa" for name, value in rubber.items()},
            "bulk": f"{2 * rubber['c1'] * ratio:g} MPa",
        }
        for part, rubber in rubbers.items()
    }


@dataclasses.dataclass(frozen=True)
class Hard:
    """A hard case.

    Attributes:
        name: unique, of letters, digits and dashes.
        why: what is hard about it.
        changes: to `BASE`, by dotted path; None takes a key away.
        models: those that hold it.
        absent: why not the others.
        own: further changes by model; a key that is None there keeps what `OWN` has not.
        refused: by model, a word that the reason has to contain; reached where it is not named.
        warns: words, each in some warning of every model.
        beside: least and greatest pressure over that of the section at the same angle, by model.
        procedure: name of what is done with it in tests/hard/procedures.py.
        fast: models that take less than ten seconds.
        stable: no unstable mode at the end of what is reached.
        balance: greatest relative gap of ∫ P dV (and what other loads do) from the stored energy.
    """

    name: str
    why: str
    changes: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    models: tuple[str, ...] = MODELS
    absent: str = ""
    own: Mapping[str, Mapping[str, Any]] = dataclasses.field(default_factory=dict)
    refused: Mapping[str, str] = dataclasses.field(default_factory=dict)
    warns: tuple[str, ...] = ()
    beside: Mapping[str, tuple[float, float]] = dataclasses.field(default_factory=dict)
    procedure: str = "plain"
    fast: tuple[str, ...] = ("section",)
    stable: bool = True
    balance: float = 3e-3

    def case(self, model: str) -> dict[str, Any]:
        """The case for one of its models, as YAML would hold it."""
        data = copy.deepcopy(BASE) | {"title": self.name, "model": model}
        for changes in (OWN[model], self.changes, self.own.get(model, {})):
            for path, value in changes.items():
                if value is None:
                    _drop(data, path)
                else:
                    put(data, path, copy.deepcopy(value))
        return data


def _drop(data: Any, path: str) -> None:
    *keys, last = path.split(".")
    for key in keys:
        data = data[int(key) if isinstance(data, list) else key]
    del data[int(last) if isinstance(data, list) else last]


SOFT = {
    "actuator.sheath": None,
    "materials": {
        "wall": {"law": "neo-hooke", "mu": "0.22 MPa"},
        "floor": {"law": "neo-hooke", "mu": "0.5 MPa"},
    },
    "effects": [{"pressure": {"to": "100 kPa"}}],
}
"""Nothing holds it together, and its floor is only twice as stiff as its wall."""

HARD: tuple[Hard, ...] = (
    Hard("base", "what the others are measured by"),
    Hard("wall-1", "thin wall", {"actuator.wall": "1 mm"}),
    Hard("wall-05", "thinner than the sheath, elements 1 : 8", {"actuator.wall": "0.5 mm"}),
    Hard("wall-4", "thick wall", {"actuator.wall": "4 mm", TO: "450 kPa"}),
    Hard(
        "radius-6",
        "the crown at 1.75 times its length",
        {"actuator.radius": "6 mm", "actuator.length": "100 mm", **BY_ANGLE, ANGLE: "360 deg"},
        warns=("passes through itself",),
    ),
    Hard(
        "turns-2",
        "two full turns: the crown at twice its length, the body through itself",
        {"actuator.length": "160 mm", **BY_ANGLE, ANGLE: "720 deg"},
        warns=("passes through itself",),
    ),
    Hard(
        "one-step",
        "the whole pressure in the first step",
        {"solver.first_step": "180 kPa", "solver.max_turn": "720 deg"},
        balance=1.0,
    ),
    Hard("fiber-0.001", "fibers softer than the wall", {FIBER: thread(1e-3)}),
    Hard("fiber-0.1", "soft fibers", {FIBER: thread(0.1)}),
    Hard("fiber-10", "stiff fibers", {FIBER: thread(10)}),
    Hard("fiber-1000", "fibers 3e8 times as stiff as the wall", {FIBER: thread(1000)}),
    Hard("pitch-1", "turns closer than the elements", {f"{WINDING}.pitch": "1 mm"}),
    Hard("pitch-20", "rubber bulging between turns", {f"{WINDING}.pitch": "20 mm"}),
    Hard(
        "slack",
        "fibers that go slack under a vacuum",
        {f"{WINDING}.tension_only": True, TO: "-10 kPa", "solver.max_step": "1 kPa"},
    ),
    Hard("tension-only", "fibers that may go slack", {f"{WINDING}.tension_only": True}),
    Hard(
        "floor-0.01",
        "a floor softer than the wall",
        {"materials.floor": {"law": "yeoh", "c1": "0.079 MPa"}},
    ),
    Hard(
        "floor-100",
        "a floor as stiff as a plastic",
        {"materials.floor": {"law": "yeoh", "c1": "790 MPa"}, TO: "180 kPa"},
    ),
    Hard("bulk-10", "compressible rubber", bulky(1e1)),
    Hard("bulk-1000", "nearly incompressible rubber", bulky(1e3)),
    Hard("bulk-1000000", "so nearly incompressible that a displacement element locks", bulky(1e6)),
    Hard("vacuum-15", "a vacuum that the crown just bears", {TO: "-15 kPa"}),
    Hard(
        "vacuum-20",
        "a vacuum that the crown does not bear",
        {TO: "-20 kPa"},
        refused=dict.fromkeys(MODELS, "collapses"),
    ),
    Hard(
        "vacuum-100",
        "a vacuum far beyond the collapse",
        {TO: "-100 kPa"},
        refused=dict.fromkeys(MODELS, "collapses"),
    ),
    Hard(
        "sheath-soft",
        "a sheath 100 times softer than the wall",
        {"materials.sheath": {"law": "yeoh", "c1": "0.0011 MPa"}},
    ),
    Hard("sheath-none", "no sheath", {"actuator.sheath": None, "materials.sheath": None}),
    Hard(
        "balloon",
        "neo-Hookean rubber without winding: a limit point",
        SOFT,
        models=("section", "body"),
        absent="cell: nothing in it but a winding would repeat along the axis",
        own={"body": {"effects": [{"pressure": {"to": "100 kPa"}}]}},
        refused={"section": "balloons", "body": "balloons"},
        warns=("limit point",),
    ),
)


def find(name: str) -> Hard:
    """The case of a name."""
    return next(hard for hard in HARD if hard.name == name)

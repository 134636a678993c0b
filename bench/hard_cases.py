"""Hard cases as data: what makes each hard, which models support it, how it has to end."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Mapping
from typing import Any

from fiberbend.schema.paths import put

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


def like(name: str, within: float) -> dict[str, tuple[str, str, float]]:
    """The angle of another case in every model."""
    return {model: (name, model, within) for model in MODELS}


@dataclasses.dataclass(frozen=True)
class Hard:
    """A hard case.

    Attributes:
        name: unique, of letters, digits and dashes.
        why: what is hard about it.
        changes: to `BASE`, by dotted path; None takes a key away.
        models: those that support it.
        absent: why not the others.
        own: further changes by model; a key that is None there keeps what `OWN` has not.
        refused: by model, a word that the reason has to contain; reached where it is not named.
        warns: words, each in some warning of every model.
        beside: least and greatest pressure over that of the section at the same angle, by model;
            None where that is no measure.
        against: by model, another case, a model of it, and how far the angles may be apart,
            relative.
        procedure: name of what is done with it in bench/hard_procedures.py.
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
    beside: Mapping[str, tuple[float, float] | None] = dataclasses.field(default_factory=dict)
    against: Mapping[str, tuple[str, str, float]] = dataclasses.field(default_factory=dict)
    procedure: str = "plain"
    fast: tuple[str, ...] = ("section", "cell")
    stable: bool = True
    balance: float = 3e-3

    def other(self, name: str) -> Hard:
        """Another case of the table."""
        return find(name)

    def case(self, model: str) -> dict[str, Any]:
        """The case for one of its models, as YAML would give it."""
        data = copy.deepcopy(BASE) | {"title": self.name, "model": model}
        changes = {**OWN[model], **self.changes, **self.own.get(model, {})}
        if "effects" in changes:
            # another list of effects: settings at the place of a winding have none
            data["effects"] = copy.deepcopy(changes["effects"])
        for path, value in changes.items():
            if not ("effects" in changes and path.startswith("effects")):
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
"""Without a winding, and its floor is only twice as stiff as its wall."""


def weight(direction: str) -> dict[str, Any]:
    """The actuator under its weight first, then under pressure."""
    floor = {"law": "yeoh", "c1": "7.9 MPa", "density": "1200 kg/m^3"}
    return {
        "materials.floor": floor,
        "effects": [
            {"gravity": {"direction": direction}},
            {"pressure": {"to": "60 kPa"}},
            {"winding": {**BASE["effects"][1]["winding"], "as": "smeared"}},
        ],
    }


NO_WEIGHT = "section, cell: weight bends no uniform arc"

HARD: tuple[Hard, ...] = (
    Hard("base", "what the others are measured by"),
    Hard("wall-1", "a thin wall", {"actuator.wall": "1 mm"}),
    Hard(
        "wall-0.5",
        "a wall half as thick as the sheath",
        {"actuator.wall": "0.5 mm"},
        warns=("passes through itself",),
    ),
    Hard("wall-4", "a thick wall", {"actuator.wall": "4 mm", TO: "450 kPa"}),
    Hard(
        "radius-6",
        "a full turn of a short body, the crown at 1.7 times its length",
        {"actuator.radius": "6 mm", "actuator.length": "100 mm", TO: None, ANGLE: "360 deg"},
        warns=("passes through itself",),
    ),
    Hard(
        "turns-2",
        "two full turns of the paper's actuator, through itself",
        {"actuator.length": "160 mm", TO: None, ANGLE: "720 deg"},
        own={"body": {"solver.max_turn": "60 deg"}},
        warns=("passes through itself",),
    ),
    Hard(
        "one-step",
        "the whole pressure asked for in one step",
        {"solver.first_step": "180 kPa", "solver.max_turn": "720 deg"},
        balance=0.1,
        against=like("base", 1e-6),
    ),
    Hard("fiber-0.001", "fibers that are hardly there", {FIBER: thread(1e-3)}),
    Hard("fiber-0.1", "soft fibers", {FIBER: thread(0.1)}),
    Hard("fiber-10", "stiff fibers", {FIBER: thread(10)}),
    Hard(
        "fiber-1000",
        "fibers 1e8 times as stiff as the rubber",
        {FIBER: thread(1000)},
        fast=("section",),
    ),
    Hard("pitch-1", "turns closer to each other than elements", {f"{WINDING}.pitch": "1 mm"}),
    Hard(
        "pitch-20",
        "rubber bulging out between turns that are wider apart than the chamber is high",
        {f"{WINDING}.pitch": "20 mm"},
        # no smeared model has the bulges: pitch-20-turns is the measure
        beside={"cell": None},
    ),
    Hard(
        "pitch-20-turns",
        "the same with every turn by itself",
        {f"{WINDING}.pitch": "20 mm"},
        models=("body",),
        absent="section, cell: pitch-20 is it",
        own={"body": {f"{WINDING}.as": "discrete"}},
        beside={"body": None},
        # the same fibers without caps; a body of 80 mm feels its caps
        against={"body": ("pitch-20", "cell", 0.03)},
    ),
    Hard(
        "slack",
        "a vacuum under which fibers go slack that carry no compression",
        {f"{WINDING}.tension_only": True, TO: "-5 kPa", "solver.max_step": "1 kPa"},
        # its angle is next to nothing
        beside={"cell": None, "body": None},
    ),
    Hard(
        "tension-only",
        "fibers that may go slack under pressure",
        {f"{WINDING}.tension_only": True},
    ),
    Hard(
        "floor-0.01",
        "a floor softer than the wall: it bends the other way",
        {"materials.floor": {"law": "yeoh", "c1": "0.079 MPa"}},
        refused={"cell": "balloons"},
        fast=("section",),
    ),
    Hard(
        "floor-100",
        "a floor as stiff as a plastic",
        {"materials.floor": {"law": "yeoh", "c1": "790 MPa"}, "solver.max_turn": "3 deg"},
        # it bends as much near its caps as between them, where the angle is that of a fit
        beside={"body": (0.94, 1.001)},
    ),
    Hard("bulk-10", "compressible rubber, bulk modulus 10 times the shear modulus", bulky(1e1)),
    Hard("bulk-1000", "nearly incompressible rubber", bulky(1e3), against=like("base", 2e-3)),
    Hard(
        "bulk-1000000",
        "so nearly incompressible that an element without a pressure locks",
        bulky(1e6),
        against=like("base", 2e-6),
    ),
    Hard(
        "vacuum-10",
        "a vacuum that the crown bears",
        {TO: "-10 kPa", "solver.max_step": "2 kPa"},
        # the crown between the turns is softer
        beside={"cell": (0.5, 1.5)},
    ),
    Hard(
        "vacuum-20",
        "a vacuum that the crown does not bear; beyond, in the cell, the surface creases",
        {TO: "-20 kPa"},
        refused=dict.fromkeys(MODELS, "collapses")
        | {"cell": "wrinkle of less than three elements"},
        warns=("collapses",),
        fast=("section",),
    ),
    Hard(
        "vacuum-100",
        "a vacuum far beyond the collapse",
        {TO: "-100 kPa"},
        models=("section", "cell"),
        absent="body: with vacuum-20 it ends at the same limit point",
        refused={"section": "collapses", "cell": "wrinkle of less than three elements"},
        warns=("collapses",),
        fast=("section",),
    ),
    *(
        Hard(
            f"gravity{direction}",
            f"weight along {direction}, then pressure",
            weight(direction),
            models=("body",),
            absent=NO_WEIGHT,
            own={"body": {"solver.max_turn": "12 deg"}},
            procedure="hanging",
        )
        for direction in ("-y", "+y", "+x", "+z", "-z")
    ),
    Hard(
        "sheath-soft",
        "a sheath 100 times softer than the wall",
        {"materials.sheath": {"law": "yeoh", "c1": "0.0011 MPa"}},
    ),
    Hard("sheath-none", "no sheath", {"actuator.sheath": None, "materials.sheath": None}),
    Hard(
        "stretched",
        "elements 20 times as long as they are thick",
        models=("cell", "body"),
        absent="section: its elements have no length",
        own={
            "cell": {f"{WINDING}.pitch": "20 mm", "mesh.axial": "10 mm", "mesh.section": 2},
            "body": {"mesh.axial": "20 mm"},
        },
        # four elements of a body bend by 45° each: a tenth stiffer
        beside={"cell": None, "body": (0.95, 1.12)},
        # one layer of elements where pitch-20 has four
        against={"cell": ("pitch-20", "cell", 0.05)},
    ),
    Hard(
        "distorted",
        "nodes inside the body moved at random by a third of their distance",
        {"mesh.section": 2},
        own={"body": {TO: "90 kPa"}},
        procedure="distorted",
        fast=("section",),
    ),
    Hard(
        "tetrahedra",
        "quadratic tetrahedra with a linear pressure",
        {"mesh.element": "tetrahedron"},
        models=("body",),
        absent="section, cell: tetrahedra are for a body",
        beside={"body": (0.97, 1.04)},
    ),
    Hard(
        "whole",
        "the whole body, free to leave the plane x = 0",
        {"mesh.symmetry": "full"},
        models=("cell", "body"),
        absent="section: half of it is all there is",
        against=like("base", 1e-7),
        fast=("section",),
    ),
    Hard(
        "unloaded",
        "to 180 kPa and back to zero",
        procedure="unloaded",
        balance=1.0,
    ),
    Hard("perturbed", "a start that is off at random", procedure="perturbed"),
    Hard(
        "resumed",
        "killed in the middle",
        {"solver.max_turn": "30 deg"},
        models=("body",),
        absent="section, cell: seconds long, they start again and keep no checkpoint",
        procedure="resumed",
    ),
    Hard(
        "balloon",
        "neo-Hookean rubber without winding: a limit point",
        SOFT,
        models=("section", "body"),
        absent="cell: without a winding nothing repeats along the axis",
        refused={"section": "balloons", "body": "balloons"},
        warns=("limit point",),
    ),
)


ORDERS: tuple[tuple[str, ...], ...] = (
    ("base", "wall-1", "wall-0.5"),
    ("floor-100", "base"),
    ("base", "sheath-soft", "sheath-none"),
    ("fiber-0.1", "base", "fiber-10"),
    ("pitch-20", "base", "pitch-1"),
    ("base", "bulk-1000", "bulk-10"),
)
"""Cases at the same pressure, each of which bends further than the one before, in every model: a
softer wall, floor or sheath; a stiffer winding; a rubber that gives in volume too."""


def find(name: str) -> Hard:
    """The case of a name."""
    return next(hard for hard in HARD if hard.name == name)

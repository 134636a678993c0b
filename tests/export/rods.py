"""A made-up actuator as it is handed over, and the same as a rod of this project."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

from fiberbend.export import record
from fiberbend.export.ends import Caps
from fiberbend.export.section import Handed, Section
from fiberbend.export.targets import TARGETS
from fiberbend.sectionlaw.ends import Ends
from rod.functions import Floats
from rod.inertia import SectionMass, spread
from rod.law import Linear, Zones
from rod.layout import Layout
from rod.loads import TipForce, Weight
from rod.rod import Level, Rod
from rod.statics import Path as LoadPath
from rod.statics import State, march
from tests.conftest import ROOT

PYTHON = ROOT / "build" / "peers" / "robots" / "bin" / "python"
"""Of the environment that `make robots` makes."""
STRAINS = ("stretch", "curvature", "side_curvature", "twist")
LENGTH, CAP = 160.0, 15.0
DENSITY = 1.1e-9
MASS = SectionMass(220 * DENSITY, (0.0, -1.0), (8000 * DENSITY, 6000 * DENSITY, 0.0))
CAP_MASS = SectionMass(350 * DENSITY, (0.0, 0.2), (12000 * DENSITY, 9000 * DENSITY, 0.0))
CAP_STIFFNESS = np.diag([400.0, 9000.0, 20000.0, 8000.0])
_TURNS = np.array([[1.0, 0.10, 0.0, 0.0], [2.0, 0.25, 0.0, 0.0]])
"""Of a cap and of an end of the chamber, a MPa: lengthening in mm and turns in rad."""
CAPS = Caps(Ends(15.0, np.array([_TURNS[[n]] * [[1.0], [-0.5]] for n in (0, 1, 1, 0)]), 1.0), 1.15)
LEVER = -4.5


def section(lever: float = LEVER) -> Section:
    """Of about the baseline's numbers: stiffness that changes with the pressure.

    Args:
        lever: y of the elastic centre, mm.
    """
    pressure = np.linspace(0.0, 0.2, 11)
    bent = 0.23 * pressure - 0.06 * pressure**2
    rest = np.zeros((11, 4))
    rest[:, 0], rest[:, 1] = 1.0 + 0.25 * pressure - lever * bent, bent
    stiffness = np.zeros((11, 4, 4))
    axial = 2000.0 - 4000.0 * pressure
    stiffness[:, 0, 0] = axial
    stiffness[:, 0, 1] = stiffness[:, 1, 0] = lever * axial
    stiffness[:, 1, 1] = 3900.0 + 1500.0 * pressure + lever**2 * axial
    stiffness[:, 2, 2], stiffness[:, 3, 3] = 30000.0, 9000.0 + 2000.0 * pressure
    return Section(pressure, rest, stiffness, np.full(11, 100.0))


def handed(made: Section | None = None, weighs: bool = True) -> Handed:
    """All of it."""
    t = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    made = section() if made is None else made
    # so stiff that the exact rod without shear is near
    shear = 0.3 * np.column_stack([made.stiffness[:, 0, 0]] * 2)
    return Handed(
        section=made,
        cap=CAP_STIFFNESS,
        mass=MASS if weighs else None,
        cap_mass=CAP_MASS if weighs else None,
        no_mass=""
        if weighs
        else "no density of floor is known, expected such as --density floor=1",
        length=LENGTH,
        cap_length=CAP,
        outline=np.column_stack([11 * np.cos(t), 9 * np.sin(t)]),
        caps=CAPS,
        shear=shear,
        cap_shear=0.3 * np.full(2, CAP_STIFFNESS[0, 0]),
        shear_centre=-3.5,
        about={
            "title": 'A "made-up" rod -- & more',
            "provenance": {
                "program": "fiberbend",
                "program_version": "0",
                "case_sha256": 64 * "0",
                "case": {},
                "law_by": "section",
                "left_out": [],
                "density_given_kg_per_m3": {},
            },
            "validity": {
                "pressure_kPa": [0.0, 200.0],
                "straightened": {
                    "pressure_kPa": [100.0],
                    "moment_N_mm": [80.0],
                    "by_stiffness_N_mm": [85.0],
                },
            },
        },
    )


def write(folder: Path, to: str, given: Handed | None = None) -> dict[str, Any]:
    """The files of a target."""
    made = record.record_of(handed() if given is None else given)
    (folder / "rod.json").write_text(record.text(made), encoding="utf-8")
    for name, content in TARGETS[to].contents(made).items():
        (folder / name).write_text(content, encoding="utf-8")
    return made


def rested(
    pressure: float,
    gravity: tuple[float, float, float] = (0.0, 0.0, 0.0),
    force: tuple[float, float, float] = (0.0, 0.0, 0.0),
    lever: float = LEVER,
) -> State:
    """The rod of this project under the same linear law of a pressure.

    Args:
        pressure: MPa.
        gravity: mm/s².
        force: dead, at the tip, N.
        lever: of the section.
    """
    made, ends, middle = section(lever), 4, 64
    lengths = np.repeat([CAP / ends, LENGTH / middle, CAP / ends], [ends, middle, ends])
    layout = Layout(lengths, STRAINS, place=np.array([0.0, 0.0, -CAP]))
    rest = np.array([np.interp(pressure, made.pressures, column) for column in made.rest.T])
    stiffness = np.array(
        [
            [np.interp(pressure, made.pressures, made.stiffness[:, a, b]) for b in range(4)]
            for a in range(4)
        ]
    )
    straight = np.array([1.0, 0.0, 0.0, 0.0])
    places = np.repeat([0, 1, 2], [ends, middle, ends])
    caps = [Linear(stiff * CAP_STIFFNESS, straight) for stiff in (CAPS.root, 1.0)]
    zones = Zones([caps[0], Linear(stiffness, rest), caps[1]], places.tolist())
    law = CAPS.ends.offset(zones, layout, slice(ends, ends + middle))
    masses = spread(layout, [MASS if place == 1 else CAP_MASS for place in places])
    rod = Rod(layout, law, masses, (Weight(masses, gravity), TipForce(force)))
    start: Floats = np.where(places[:, None] == 1, rest, straight)
    path = LoadPath(Level(pressure), Level(pressure, (1.0, 1.0)))
    return march(rod, start, path, [0.25, 0.5, 0.75, 1.0])[-1]


def angle_of(state: State) -> float:
    """By which the tip is bent, degrees."""
    return float(np.degrees(np.sum(state.shape.layout.weights("curvature") * state.strains)))


def run(folder: Path, script: str, *arguments: str) -> dict[str, Any]:
    """What a script prints in the environment of the other programs."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(
        [PYTHON, folder / script, *arguments],
        env=environment | {"NUMBA_CACHE_DIR": str(PYTHON.parents[1] / "numba")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return found

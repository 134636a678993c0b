"""Scenes in which the rod is compared with the body: each differs from the other's by its model."""

from __future__ import annotations

import copy
import dataclasses
from pathlib import Path
from typing import Any

import yaml

CASES = Path(__file__).resolve().parent.parent.parent / "cases"
FREE = "free_bending_smeared"
SHORT = "120 mm"
"""Length of the baseline that loads act on."""
LOADED = "60 kPa"
COARSE, FINE = "coarse", "fine"
PLAIN = "plain"
"""In place of a mesh, of the record of a rod without shear."""
SECTION = "section"
"""The model whose uniform bend is that of the rod."""
MESHES = (COARSE, FINE)
"""The reference, and one by which its own error is known."""


@dataclasses.dataclass(frozen=True)
class Scene:
    """A scene.

    Attributes:
        name: of its records.
        title: in the table.
        file: case it is made from.
        changes: entries of the case that differ.
        axial: lengths of the body's elements, coarse and fine, mm.
        section: elements through its parts, coarse and fine.
        angle: column of the turn that is compared.
        obstacle: whose touch and force are compared; of strips the column of the force.
        band: of the tip that is asked for, mm.
        force_band: of the obstacle's force, in parts.
    """

    name: str
    title: str
    file: str
    changes: dict[str, Any]
    axial: tuple[float, float] = (8.0, 4.0)
    section: tuple[int, int] = (1, 2)
    angle: str = "angle_deg"
    obstacle: str = ""
    band: float = 1.5
    force_band: float = 0.06

    def case(self, model: str, mesh: str = COARSE) -> dict[str, Any]:
        """The case of a model: nothing differs but that line.

        Args:
            model: that solves it.
            mesh: one of `MESHES`.
        """
        text = (CASES / f"{self.file}.yaml").read_text(encoding="utf-8")
        case: dict[str, Any] = yaml.safe_load(text)
        case.pop("compare", None)
        case |= copy.deepcopy(self.changes)
        number = MESHES.index(mesh)
        case["mesh"] = {"axial": f"{self.axial[number]:g} mm", "section": self.section[number]}
        case["output"] = case.get("output", {}) | {"pictures": False}
        case["model"] = model
        case["title"] = self.title
        if model == SECTION:
            # it has no ends, and its own mesh
            del case["actuator"]["cap"], case["support"], case["mesh"]
        return case


def _actuator(**changes: str) -> dict[str, Any]:
    text = (CASES / f"{FREE}.yaml").read_text(encoding="utf-8")
    actuator: dict[str, Any] = yaml.safe_load(text)["actuator"] | changes
    return actuator


WINDING = {"pattern": "double-helix", "pitch": "3 mm", "fiber": "kevlar", "as": "smeared"}
TUBE_WINDING = {
    "fiber": "kevlar",
    "as": "smeared",
    "families": [{"angle_from_axis": "30 deg", "hand": "left", "starts": 6}],
}
WITH_WEIGHT = {
    "wall": "elastosil-m4601",
    "floor": {"name": "combined-base", "density": "1.2 g/cm^3"},
    "sheath": "ecoflex-0030",
}
WEIGHT = {"gravity": {"direction": "-y"}}


def _loaded(
    name: str,
    title: str,
    *loads: dict[str, Any],
    after: bool = False,
    angle: str = "angle_deg",
    finer: int = 2,
) -> Scene:
    """The short baseline under loads that act before the pressure, or after it."""
    inflation = {"pressure": {"to": LOADED}}
    acting = [inflation, *loads] if after else [*loads, inflation]
    changes: dict[str, Any] = {
        "actuator": _actuator(length=SHORT),
        "effects": [*acting, {"winding": WINDING}],
        "output": {"at_pressures": [f"{p} kPa" for p in range(5, 65, 5)]},
    }
    if WEIGHT.keys() & {key for load in loads for key in load}:
        changes["materials"] = WITH_WEIGHT
    return Scene(name, title, FREE, changes, section=(1, finer), angle=angle)


def _force(x: float, y: float) -> dict[str, Any]:
    return {"tip-load": {"force": [f"{x:g} N", f"{y:g} N", "0 N"]}}


_TUBE = {"to": "30 kPa"}
_TUBE_OUTPUT = {"at_pressures": [f"{p} kPa" for p in range(5, 35, 5)]}


def _tube(name: str, title: str, *loads: dict[str, Any]) -> Scene:
    actuator = {"section": "circle", "radius": "5 mm", "length": "100 mm", "wall": "1.5 mm"}
    changes = {
        "actuator": actuator | {"cap": "6 mm"},
        "effects": [*loads, {"pressure": _TUBE}, {"winding": TUBE_WINDING}],
        "output": _TUBE_OUTPUT,
    }
    return Scene(
        name,
        title,
        "twisting",
        changes,
        axial=(4.0, 2.0),
        section=(1, 1),
        angle="twist_deg",
        band=3.0,
    )


_TOUCHING = {"at_pressures": [f"{p / 2:g} kPa" for p in range(10, 210, 10)]}
_LONG = {
    "at_pressures": [f"{p} kPa" for p in range(10, 180, 10)],
    "at_angles": ["90 deg", "180 deg", "270 deg", "360 deg"],
    "stop_at_angle": "360 deg",
}
_BLOCKED = {"at_pressures": [f"{p} kPa" for p in range(10, 210, 10)]}
_STRIPS = [
    {"pressure": {"to": "200 kPa"}},
    {"winding": WINDING},
    {"blocked-tip": {"roof_width": "4 mm", "post_length": "2 mm"}},
]
_HELIX = {"at_pressures": [f"{p} kPa" for p in range(10, 110, 10)]}
_THUMB = {"at_pressures": [f"{p} kPa" for p in range(2, 26, 2)]}

SCENES = (
    dataclasses.replace(_loaded("free", "free bending, 120 mm"), band=1.0),
    _loaded("weight_down", "weight along −y", WEIGHT),
    _loaded("weight_up", "weight along +y", {"gravity": {"direction": "+y"}}),
    _loaded("weight_back", "weight along −z", {"gravity": {"direction": "-z"}}),
    _loaded("tip_down", "tip force 0.2 N along −y", _force(0.0, -0.2), finer=1),
    _loaded(
        "tip_side", "tip force 0.2 N along x", _force(0.2, 0.0), angle="side_angle_deg", finer=1
    ),
    _loaded("tip_after", "the force along −y after the pressure", _force(0.0, -0.2), after=True),
    _loaded(
        "tip_moment",
        "tip moment 50 N mm",
        {"tip-load": {"moment": ["50 N mm", "0 N mm", "0 N mm"]}},
    ),
    _loaded("tip_mass", "tip mass 20 g, weight along −y", WEIGHT, {"tip-mass": {"mass": "20 g"}}),
    Scene("long", "free bending, 160 mm to 360°", FREE, {"output": _LONG}, (4.0, 2.0), (1, 1),
        band=1.0,
    ),
    Scene(
        "bar", "around a bar", "grasp", {"output": _TOUCHING}, (4.0, 2.0), (1, 1),
        obstacle="cylinder",
    ),
    Scene(
        "table", "on a table", "grasp_table", {"output": _TOUCHING}, (4.0, 2.0), (1, 1),
        obstacle="plane",
    ),
    Scene(
        "blocked", "between roof and post", "blocked_contact", {"output": _BLOCKED}, (4.0, 2.0),
        (1, 1), obstacle="post", force_band=0.1,
    ),
    Scene(
        "strips", "kept straight by strips", "blocked_tip",
        {"effects": _STRIPS, "output": _BLOCKED}, (4.0, 2.0), (1, 1),
        obstacle="tip_force_N", force_band=0.1,
    ),
    _tube("tube", "a tube that twists"),
    _tube("tube_weight", "the tube, weight along −y", WEIGHT),
    Scene(
        "s_shape", "an S, fabric below, then above", "s_shape", {"output": _THUMB}, (2.0, 1.0),
        (1, 1), angle="zone_1_angle_deg", band=3.0,
    ),
    Scene(
        "helix", "one helix alone", "single_helix", {"output": _HELIX}, (8.0, 4.0), (1, 1),
        band=3.0,
    ),
    Scene(
        "thumb", "a thumb of three zones", "thumb", {"output": _THUMB}, (4.0, 2.0), (1, 1),
        band=3.0,
    ),
)  # fmt: skip
BY_NAME = {scene.name: scene for scene in SCENES}

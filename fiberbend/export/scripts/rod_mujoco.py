"""An actuator as a chain of bodies in MuJoCo: rod.xml and rod.json beside this file.

    python rod_mujoco.py --pressure 100 --gravity 0 -9.81 0
    python rod_mujoco.py --pressure 100 --tip-force 0 0.1 0 --as-actuator

In your own scene include rod.xml. Its control 'pressure' is in kPa: rest strains that are linear in
it, with constant stiffness. `follow` sets springs and control to the table of rod.json instead,
whenever the pressure changes; --as-actuator leaves that out.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import mujoco
import numpy as np

MM = 1e-3
KINDS = ("stretch", "curvature", "side", "twist")
"""Of the joints of a piece."""


class Table:
    """Rest strains and stiffness by pressure, as rod.json has them.

    Args:
        path: of rod.json.
        model: from rod.xml.
    """

    def __init__(self, path: Path, model: mujoco.MjModel) -> None:
        data = json.loads(path.read_text(encoding="utf-8"))
        if (data["format"], data["version"]) != ("fiberbend-rod", 2):
            raise ValueError(f"{path}: version 2 of the format fiberbend-rod expected")
        axis, cap, geometry = data["axis"], data["cap"], data["geometry"]
        self.pressures = np.array(data["section"]["pressure_kPa"])
        bent = [axis[f"rest_{n}_1_per_mm"] for n in ("curvature", "side_curvature", "twist")]
        rest = np.array([np.array(axis["rest_stretch"]) - 1, *(np.array(row) / MM for row in bent)])
        compliance = np.linalg.inv(np.array(axis["bending_stiffness_N_mm2"]) * MM**2)
        own = 1 / np.diagonal(compliance, axis1=1, axis2=2)
        stiffness = np.column_stack([axis["axial_stiffness_N"], own])
        names = [model.body(number).name for number in range(model.nbody)]
        pieces = [name for name in names if name.startswith(("root_", "chamber_", "tip_"))]
        inside = np.array([name.startswith("chamber_") for name in pieces])
        length = geometry["chamber_length_mm"] * MM / inside.sum()
        joints = [[model.joint(f"{kind}_{name}").id for kind in KINDS] for name in pieces]
        self._joints = np.array(joints)
        self._springs = model.jnt_qposadr[self._joints]
        tendon = model.tendon("pressure").id
        wraps = slice(model.tendon_adr[tendon], model.tendon_adr[tendon] + model.tendon_num[tendon])
        pull = np.zeros(model.njnt)
        pull[model.wrap_objid[wraps]] = model.wrap_prm[wraps]
        self._pull = pull[self._joints]
        count = len(self.pressures)
        self._stiffness = np.tile(model.jnt_stiffness[self._joints], (count, 1, 1))
        self._stiffness[:, inside] = stiffness[:, None] / length
        self._rest = np.zeros((count, len(pieces), len(KINDS)))
        """Of the joints without load, by pressure, in m and rad."""
        self._rest[:, inside] = length * rest.T[:, None]
        first, last = np.flatnonzero(inside)[[0, -1]]
        near = round(data["ends"]["zone_mm"] * MM / length)
        near = max(1, min(near, int(inside.sum()) // 2))
        borders = (0, first, first + near, last + 1 - near, last + 1, len(pieces))
        for number, part in ((0, "root_cap"), (1, "root_end"), (3, "tip_end"), (4, "tip_cap")):
            x, y = ((cap if part.endswith("cap") else axis)[key] * MM for key in ("x_mm", "y_mm"))
            ends = data["ends"][part]
            turns = [np.array(ends[key]) for key in ("turn_rad", "side_turn_rad", "twist_rad")]
            longer = np.array(ends["lengthening_mm"]) * MM + y * turns[0] - x * turns[1]
            there = slice(borders[number], borders[number + 1])
            added = np.array([longer, *turns]).T / (there.stop - there.start)
            self._rest[:, there] += added[:, None]

    def follow(self, model: mujoco.MjModel, data: mujoco.MjData, kpa: float) -> None:
        """Set control and springs to a pressure.

        Args:
            model: its springs are set.
            data: its control is set.
            kpa: within the range of rod.json.
        """
        low, high = self.pressures[[0, -1]]
        if not low <= kpa <= high:
            raise ValueError(f"{kpa:g} kPa: rod.json reaches from {low:g} to {high:g} kPa")
        data.actuator("pressure").ctrl = kpa
        after = min(int(np.searchsorted(self.pressures, kpa, "right")), len(self.pressures) - 1)
        before = after - 1
        part = (kpa - self.pressures[before]) / (self.pressures[after] - self.pressures[before])
        rest, stiffness = (
            (1 - part) * table[before] + part * table[after]
            for table in (self._rest, self._stiffness)
        )
        model.jnt_stiffness[self._joints] = stiffness
        # what the actuator does not do
        model.qpos_spring[self._springs] = rest - self._pull * kpa / stiffness


def main() -> None:
    """Bend, wait, print the tip."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--pressure", type=float, required=True, help="kPa")
    options.add_argument("--gravity", type=float, nargs=3, help="m/s²")
    options.add_argument("--tip-force", type=float, nargs=3, default=(0, 0, 0), help="N")
    options.add_argument("--seconds", type=float, default=4.0)
    options.add_argument("--ramp", type=float, default=1.0, help="s")
    options.add_argument("--damping", type=float, default=0.15, help="s, over stiffness")
    options.add_argument("--as-actuator", action="store_true", help="the control alone")
    given = options.parse_args()
    here = Path(__file__).parent
    model = mujoco.MjModel.from_xml_path(str(here / "rod.xml"))
    data = mujoco.MjData(model)
    table = Table(here / "rod.json", model)
    if given.gravity is not None:
        model.opt.gravity[:] = given.gravity
    model.dof_damping[:] = given.damping * model.jnt_stiffness
    tip, last = model.site("tip").id, model.site("tip").bodyid
    least = 0.0 if given.as_actuator else float(table.pressures[0])
    for _ in range(round(given.seconds / model.opt.timestep)):
        part = min(1.0, data.time / given.ramp)
        kpa = least + (given.pressure - least) * part
        if given.as_actuator:
            data.actuator("pressure").ctrl = kpa
        elif part < 1 or data.actuator("pressure").ctrl != kpa:
            table.follow(model, data, kpa)
        if any(given.tip_force):
            data.qfrc_applied[:] = 0.0
            force = np.array(given.tip_force, dtype=float)
            place = data.site_xpos[tip]
            mujoco.mj_applyFT(
                model, data, force, np.zeros(3), place, int(last[0]), data.qfrc_applied
            )
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    bends = [n for n in range(model.njnt) if model.joint(n).name.startswith("curvature")]
    angle = float(np.degrees(data.qpos[model.jnt_qposadr[bends]].sum()))
    print(
        json.dumps(
            {
                "pressure_kPa": given.pressure,
                "tip_angle_deg": round(angle, 4),
                "tip_mm": [round(float(part) / MM, 4) for part in data.site_xpos[tip]],
                "speed": round(float(np.abs(data.qvel).max()), 6),
            }
        )
    )


if __name__ == "__main__":
    main()

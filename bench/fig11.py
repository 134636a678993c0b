"""An actuator of Fig. 11 of Polygerinos et al. 2015 in every model."""

from __future__ import annotations

import copy
import dataclasses
from typing import Any

import numpy as np

from analytic.bending import Hemicircle
from bench.contact_runs import PRESSURES, Solved, fixed, percent, read, solve

LEVER = 14.0
"""From the end of the chamber to the middle of a post of 2 mm, mm."""
MOMENT, ROOF_AREA, POST_GAP = (
    "blocked_moment_Nmm",
    "contact_roof_area_mm2",
    "contact_post_gap_mm",
)
KPA = [f"{kpa} kPa" for kpa in PRESSURES]


@dataclasses.dataclass(frozen=True)
class Fig11:
    """An actuator of Fig. 11 in every model.

    Attributes:
        radius: of the chamber, mm.
        length: of the chamber, mm.
        guided: body with strips of roof and post fixed.
        contact: body between obstacles.
        section: section kept straight, its axis free to stretch.
        cell: the same of a cell with every fiber.
    """

    radius: int
    length: int
    guided: Solved
    contact: Solved
    section: Solved
    cell: Solved

    @classmethod
    def solve(cls, radius: int, length: int) -> Fig11:
        """Run the four models."""
        name = f"radius{radius}_length{length}"
        guided, contact = (read(f"fig11/{name}_{tip}.yaml") for tip in ("guided", "contact"))
        straight = copy.deepcopy(guided) | {"mesh": {}}
        straight["effects"][2] = {"straight": {"stretch": "free"}}
        discrete = copy.deepcopy(straight) | {"model": "cell"}
        discrete["effects"][1]["winding"]["as"] = "discrete"
        return cls(
            radius,
            length,
            solve(f"{name}_guided", guided),
            solve(f"{name}_contact", contact, states=True),
            solve(f"{name}_section", straight | {"model": "section"}),
            solve(f"{name}_cell", discrete),
        )

    def kappa(self, acts: Any = "chamber") -> float:
        """κ of eq. (21), or that of all inside the winding, mm³."""
        return Hemicircle(self.radius, 2.0, 2.0, self.length, acts=acts).kappa

    def rows(self) -> list[list[str]]:
        """One for each quantity."""
        held, pushed = (s.column("tip_force_N") for s in (self.guided, self.contact))
        pressures = np.array(PRESSURES) * 1e-3
        return [
            ["F held, N", *fixed(held, 3)],
            ["F pushed, N", *fixed(pushed, 3)],
            ["… against held, %", *percent(pushed, held)],
            ["F pushed · L_f, N mm", *fixed([LEVER * f for f in pushed], 1)],
            ["κ P, eq. (21), N mm", *fixed(list(self.kappa() * pressures), 1)],
            ["κ P, area up to the winding", *fixed(list(self.kappa("winding") * pressures), 1)],
            ["M of the straight section, N mm", *fixed(self.section.column(MOMENT), 1)],
            ["M of the straight cell, N mm", *fixed(self.cell.column(MOMENT), 1)],
            ["force on the roof, held, N", *fixed(self.guided.column("roof_force_N"), 3)],
            ["force on the roof, pushed, N", *fixed(self.contact.column("roof_force_N"), 3)],
            ["rotation of z = L, pushed, °", *fixed(self.contact.column("angle_deg"), 1)],
            ["touching of the roof's strip, mm²", *fixed(self.contact.column(ROOF_AREA), 0)],
            ["depth in the post, µm", *fixed([-1e3 * g for g in self.contact.column(POST_GAP)], 1)],
        ]

    def cost(self) -> list[Any]:
        """Of the two bodies: steps; iterations; cut-backs; worst balance; seconds."""
        row: list[Any] = [f"{self.radius}, {self.length}"]
        for found in (self.guided, self.contact):
            data = found.run
            worst = max(max(r["balance_force"], r["balance_moment"]) for r in found.rows[1:])
            steps = f"{data['load_steps']}; {data['newton_iterations']}; {data['cutbacks']}"
            row += [steps, f"{worst:.0e}", f"{data['wall_s']['solve']:.0f}"]
        return row

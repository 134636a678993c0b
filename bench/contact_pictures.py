"""Pictures of docs/contact.md: forces against pressure, bodies from the side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench.contact_runs import Solved
from bench.fig11 import Fig11
from fiberbend.case import convert
from fiberbend.drawing.page import COLORS, figure, save
from fiberbend.effects.contact import placed_obstacles
from fiberbend.models.choice import meshed
from fiberbend.reader.reader import as_case
from geometry.mesh.data import FACET_VERTICES, vertex_positions

Floats = npt.NDArray[np.float64]

RING = (0, 1, 3, 2)
"""Corners of a facet around it."""
_STEEL, _INK = "#8a8f98", "#222222"
_BLUE, _RED, _GREEN, _BROWN, _GRAY = "#1f5a99", "#c0392b", "#2e7d32", "#a8641a", "#6b6b6b"


def forces(
    actuators: Sequence[Fig11], lever: float, pressures: Sequence[float], path: Path
) -> None:
    """F(P) of every actuator with all models beside it.

    Args:
        actuators: those of Fig. 11.
        lever: L_f, mm.
        pressures: that were asked for, kPa.
        path: of the picture.
    """
    page = figure((1500, 560))
    panels = page.subplots(1, len(actuators), sharey=True)
    at = np.array([0.0, *pressures])

    def through(values: Sequence[float]) -> Floats:
        return np.array([0.0, *values])

    for panel, found in zip(panels, actuators, strict=True):
        moments = (
            ("M/L_f, straight cell", found.cell, _GREEN, "-"),
            ("M/L_f, straight section", found.section, _GREEN, "--"),
        )
        winding = 1e-3 * at * found.kappa("winding") / lever
        panel.plot(at, winding, color=_BROWN, ls="-.", label="κP/L_f, area up to the winding")
        for label, solved, color, style in moments:
            values = through(solved.column("blocked_moment_Nmm")) / lever
            panel.plot(at, values, color=color, ls=style, label=label)
        held = through(found.guided.column("tip_force_N"))
        pushed = through(found.contact.column("tip_force_N"))
        panel.plot(at, held, color=_BLUE, label="body, held by strips")
        panel.plot(at, pushed, "o", color=_RED, ms=6, label="body, pushed by roof and post")
        chamber = 1e-3 * at * found.kappa() / lever
        panel.plot(at, chamber, color=_GRAY, ls=":", lw=2, label="κP/L_f, eq. (21)")
        panel.set_title(f"radius {found.radius} mm, length {found.length} mm", fontsize=12)
        panel.set_xlabel("chamber pressure, kPa")
        panel.grid(alpha=0.3)
        panel.set_xlim(0, at[-1])
        panel.set_ylim(bottom=0)
    panels[0].set_ylabel("tip force, N")
    panels[0].legend(fontsize=9, loc="upper left", framealpha=1)
    page.tight_layout()
    save(page, path)


class _Side:
    """The mirror plane of a half body, seen from the side: z to the right, y up.

    Args:
        solved: a finished run of a half body with its states.
    """

    def __init__(self, solved: Solved) -> None:
        self.case = as_case(solved.case)
        self.folder = solved.folder
        mesh = meshed(self.case).mesh(self.case)
        pairs = mesh.facets["symmetry"]
        corners = np.array(vertex_positions(mesh.cell_type))[
            np.array(FACET_VERTICES[mesh.cell_type])
        ]
        self.mesh, self.corners = mesh, corners
        self.faces = mesh.cells[pairs[:, :1], corners[pairs[:, 1]]][:, RING]
        names = {number: name for name, number in mesh.regions.items()}
        regions = mesh.cell_region[pairs[:, 0]]
        self.colors = [COLORS.get(names[int(r)], "#999999") for r in regions]

    def strip(self, surface: str, label: str | None) -> float:
        """Where a surface begins along z in a state, mm."""
        pairs = self.mesh.facets[surface]
        nodes = self.mesh.cells[pairs[:, :1], self.corners[pairs[:, 1]]]
        return float(self._at(label)[nodes, 2].min())

    def _at(self, label: str | None) -> Floats:
        """Positions of the nodes in a state by its label, or at rest, mm."""
        if label is None:
            return self.mesh.nodes
        with np.load(self.folder / "snapshots" / f"{label}.npz") as shot:
            moved: Floats = self.mesh.nodes + shot["displacement"]
        return moved

    def draw(self, panel: Any, label: str | None, alpha: float = 1.0) -> Floats:
        """Draw a state by its label, or the body at rest; the points, (n, 4, 2), z and y in mm."""
        from matplotlib.collections import PolyCollection

        x = self._at(label)
        points: Floats = x[self.faces][:, :, [2, 1]]
        edges = [(0, 0, 0, 0.25 * alpha)] * len(points)
        panel.add_collection(
            PolyCollection(
                list(points), facecolors=self.colors, edgecolors=edges, linewidths=0.3, alpha=alpha
            )
        )
        return points

    def obstacles(self, panel: Any, reach: float) -> None:
        """Bars as disks and planes as hatched lines."""
        from matplotlib.patches import Circle, Rectangle

        actuator = convert.dimensions(self.case.actuator)
        for name, item in placed_obstacles(self.case.effects, actuator).items():
            numbers = item.numbers()
            if name == "cylinder":
                y, z, radius = numbers
                panel.add_patch(Circle((z, y), radius, fc="#d8dbe0", ec=_STEEL, lw=1.5))
            elif name == "plane":
                y = numbers[3] / numbers[1]
                panel.add_patch(Rectangle((-15, y - 4), reach + 15, 4, fc="#d8dbe0", ec="none"))
                panel.plot([-15, reach], [y, y], color=_STEEL, lw=1.5)


def _clean(panel: Any) -> None:
    panel.set_aspect("equal")
    panel.set_xlabel("z, mm")
    panel.set_ylabel("y, mm")
    panel.grid(alpha=0.25)
    panel.set_axisbelow(True)


def blocked(solved: Solved, path: Path) -> None:
    """The blocked actuator at rest and at 200 kPa."""
    from matplotlib.patches import Rectangle

    side = _Side(solved)
    page = figure((1500, 620))
    panels = page.subplots(2, 1, sharex=True)
    length, cap = side.case.actuator.length, side.case.actuator.cap
    top = float(side.mesh.nodes[:, 1].max())
    bottom = float(side.mesh.nodes[:, 1].min())
    for panel, kpa in zip(panels, (0, 200), strict=True):
        side.draw(panel, f"{kpa}kPa" if kpa else None)
        row = solved.at(kpa)
        panel.add_patch(Rectangle((0, top), length, 4, fc="#d8dbe0", ec=_STEEL, lw=1.2))
        start = side.strip("post", f"{kpa}kPa" if kpa else None)
        panel.add_patch(Rectangle((start, bottom - 4), 14, 4, fc="#d8dbe0", ec=_STEEL, lw=1.2))
        text = "at rest"
        if kpa:
            text = (
                f"{kpa} kPa: the roof pushes {row['roof_force_N']:.2f} N down, the post "
                f"{row['tip_force_N']:.2f} N up; z = L has turned by {row['angle_deg']:.1f}°"
            )
        panel.set_title(text, fontsize=12, loc="left")
        _clean(panel)
        panel.set_xlim(-20, length + cap + 20)
        panel.set_ylim(bottom - 8, top + 8)
    panels[0].set_xlabel("")
    page.tight_layout()
    save(page, path)


def grasps(bar: Solved, plane: Solved, path: Path) -> None:
    """Bar and table with the body at several pressures, and the forces."""
    page = figure((1500, 1050))
    panels = page.subplots(2, 2, width_ratios=(1.5, 1))
    for (left, right), solved, name in zip(
        panels, (bar, plane), ("cylinder", "plane"), strict=True
    ):
        side = _Side(solved)
        points = []
        for label, alpha in ((None, 0.25), ("25kPa", 0.35), ("50kPa", 0.5), ("last", 1.0)):
            points.append(side.draw(left, label, alpha))
        side.obstacles(left, 200.0)
        _clean(left)
        every = np.concatenate(points).reshape(-1, 2)
        low, high = every.min(axis=0), every.max(axis=0)
        left.set_xlim(low[0] - 5, high[0] + 10)
        left.set_ylim(low[1] - 10, high[1] + 5)
        end = solved.rows[-1]["pressure_kPa"]
        left.set_title(f"at rest, at 25, 50 and {end:g} kPa", fontsize=12, loc="left")
        rows = solved.rows[1:]
        at = [r["pressure_kPa"] for r in rows]
        up, along = ([r[f"contact_{name}_{c}_N"] for r in rows] for c in ("y", "z"))
        right.plot(at, up, "o-", color=_RED, ms=4, label="upward")
        right.plot(at, along, "s--", color=_BLUE, ms=4, label="along z")
        right.set_xlabel("chamber pressure, kPa")
        right.set_ylabel("force on the body, N")
        right.grid(alpha=0.3)
        right.legend(loc="upper left")
    page.tight_layout()
    save(page, path)

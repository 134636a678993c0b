"""What has to be solved for the page: sweeps in folders, so that what is finished is kept."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fiberbend.api.calls import sweep
from fiberbend.api.result import Result
from fiberbend.api.sweep import Sweep
from geometry.mesh.data import Floats
from materials.named.table import named_thread

ROOT = Path(__file__).resolve().parent.parent.parent
SWEEPS = ROOT / "cases" / "sweeps"
CELL_MESH = ("mesh.axial=0.375 mm",)
"""Four elements along half a pitch: P within 0.5 % of the cell's limit."""
FULL = "make paper FULL=1"
Key = tuple[float, float, float]
"""(a, L, t) in mm."""


@dataclasses.dataclass(frozen=True)
class Curve:
    """A finished run.

    Attributes:
        rows: of its history.
        run: its run.json.
        folder: of the run.
    """

    rows: Sequence[Mapping[str, Any]]
    run: Mapping[str, Any]
    folder: Path

    def column(self, name: str) -> Floats:
        """A column of the history, nan where it is empty."""
        return np.array([math.nan if (v := row.get(name)) is None else v for row in self.rows])

    @property
    def pressure(self) -> Floats:
        """P in kPa, (n,)."""
        return self.column("pressure_kPa")

    @property
    def angle(self) -> Floats:
        """θ in degrees, (n,)."""
        return self.column("angle_deg")

    def at_angle(self, degrees: float) -> float:
        """P in kPa at an angle that was asked for; nan where the run does not reach it."""
        return self._at(self.angle, degrees, self.pressure)

    def at_pressure(self, kpa: float, name: str) -> float:
        """A column at a pressure that was asked for; nan where the run does not reach it."""
        return self._at(self.pressure, kpa, self.column(name))

    @staticmethod
    def _at(along: Floats, value: float, wanted: Floats) -> float:
        place = int(np.argmin(np.abs(along - value)))
        return float(wanted[place]) if abs(along[place] - value) < 1e-4 * abs(value) else math.nan


@dataclasses.dataclass(frozen=True)
class Solved:
    """A sweep that is done.

    Attributes:
        model: of its runs in a legend, "cell".
        curves: its runs in the order of the points.
        table: the row of sweep.csv of each.
        command: that makes it.
    """

    model: str
    curves: Sequence[Curve]
    table: Sequence[Mapping[str, Any]]
    command: str

    @property
    def sizes(self) -> dict[Key, Curve]:
        """The runs of actuators by (a, L, t)."""
        return {self._key(row): curve for row, curve in zip(self.table, self.curves, strict=True)}

    def number(self, key: Key, name: str) -> float:
        """A number of sweep.csv; nan where it is empty."""
        (row,) = (row for row in self.table if self._key(row) == key)
        value = row.get(name)
        return float(value) if isinstance(value, (int, float)) else math.nan

    @staticmethod
    def _key(row: Mapping[str, Any]) -> Key:
        return float(row["radius_mm"]), float(row["length_mm"]), float(row["wall_mm"])


@dataclasses.dataclass
class Runs:
    """Everything that is solved; each sweep the first time that a part asks for it.

    Attributes:
        folder: where the sweeps are.
        bodies: bodies are solved too.
        jobs: processes that solve at once.
        settings: changes to all cases, for a quick look.
        cell: changes to those of cells.
    """

    folder: Path
    bodies: bool = False
    jobs: int = 2
    settings: Sequence[str] = ()
    cell_mesh: Sequence[str] = CELL_MESH

    @functools.cached_property
    def section(self) -> Solved:
        """Table I by the section, winding spread over its surface."""
        return self.solve("section", "table1.yaml", "section")

    @functools.cached_property
    def thick_floor(self) -> Solved:
        """The same with a floor of 3 mm."""
        return self.solve("section", "table1_floor3.yaml", "section_floor3")

    @functools.cached_property
    def cell(self) -> Solved:
        """Table I by the cell, every turn by itself."""
        return self.solve("cell", "table1_cell.yaml", "cell", self.cell_mesh)

    @functools.cached_property
    def straight(self) -> Solved:
        """Section and cell of Fig. 11, kept straight."""
        return self.solve("straight", "fig11_straight.yaml", "straight")

    @functools.cached_property
    def body(self) -> Solved | None:
        """Table I by bodies, every turn by itself; None in the quick form."""
        return self.solve("body", "table1_body.yaml", "body") if self.bodies else None

    @functools.cached_property
    def blocked(self) -> Solved | None:
        """Bodies of Fig. 11 whose tip is blocked; None in the quick form."""
        return self.solve("body", "fig11_body.yaml", "blocked") if self.bodies else None

    @functools.cached_property
    def pictures(self) -> Path:
        """Folder of the baseline with pictures: a body, in the quick form a cell."""
        case = "free_bending" if self.bodies else "cell"
        return self._one(f"pictures_{case}", case, {"output.pictures": True}).folder / "pictures"

    @functools.cached_property
    def whole_thread(self) -> Curve:
        """The baseline's cell with a thread of the whole radius, which is four times as stiff."""
        thread = named_thread("kevlar")
        changes: dict[str, Any] = {
            "effects.1.winding.fiber": {
                "modulus": f"{thread.modulus} MPa",
                "diameter": f"{thread.diameter} mm",
                "radius_factor": 1.0,
            },
            "mesh": {"section": 2},
            "output": {},
        }
        changes |= dict(change.split("=") for change in self.cell_mesh)
        return self._one("whole_thread", "cell", changes)

    def _one(self, out: str, case: str, changes: Mapping[str, Any]) -> Curve:
        """A single run, kept as a sweep of one point."""
        file = {
            "title": out,
            "case": str(ROOT / "cases" / f"{case}.yaml"),
            "set": dict(changes),
            "points": [{"actuator.radius": "8 mm"}],
            "report": {"history": ["angle_deg"]},
        }
        (found,) = self._finished(
            sweep(file, self.folder / out, settings=self.settings, retry=True)
        )
        return found

    def solve(self, model: str, name: str, out: str, settings: Sequence[str] = ()) -> Solved:
        """Solve what is left of a sweep.

        Args:
            model: of its runs in a legend.
            name: of the sweep file.
            out: name of its folder.
            settings: changes to the base case.

        Raises:
            RuntimeError: a point has failed.
        """
        changes = [*settings, *self.settings]
        done = sweep(
            SWEEPS / name,
            self.folder / out,
            self.jobs,
            settings=changes,
            retry=True,
            quiet=False,
        )
        curves = self._finished(done)
        words = "".join(f" --set '{change}'" for change in changes)
        shown = f"cases/sweeps/{name} -j {self.jobs} --out runs/paper/{out}"
        return Solved(model, curves, done.rows, f"fiberbend sweep {shown}{words}")

    @staticmethod
    def _finished(done: Sweep) -> list[Curve]:
        curves = []
        for row in done.rows:
            if row["status"] not in ("converged", "stopped"):
                raise RuntimeError(f"{done.folder}, {row['point']}: {row['reason']}")
            point: Result = done.points[str(row["point"])]
            assert point.folder is not None
            curves.append(Curve(point.rows, point.run, point.folder))
        return curves

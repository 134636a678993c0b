"""What `fiberbend.run` and `fiberbend.load` return."""

from __future__ import annotations

import dataclasses
import functools
import tempfile
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fiberbend import columns as col
from fiberbend.api import reading
from fiberbend.api.reading import Reading
from fiberbend.models.result import RunResult
from fiberbend.process.ranks import rank
from fiberbend.results.folder import HISTORY_COLUMNS, HISTORY_FILE, REPORT, RunFolder
from fiberbend.schema.problems import CaseError, Problem, found

if TYPE_CHECKING:
    import pandas as pd
    import pyvista as pv
    from matplotlib.figure import Figure

    from fiberbend.answer.answer import Answer
    from fiberbend.api.runs import RunData
    from fiberbend.case.case import Case
    from fiberbend.drawing.style import Style
    from fiberbend.results.space import Space
    from fiberbend.results.states import Kept, States
    from fiberbend.states.snapshot import Snapshot


@dataclasses.dataclass(frozen=True, eq=False, repr=False)
class Result(RunResult):
    """A run: its history, its states, its answer and its pictures.

    Attributes:
        status: 'converged', 'stopped' (a requested output was not reached) or 'failed'; of a
            folder also 'interrupted', or 'running' where nothing says that it has ended.
        reason: why not converged; empty otherwise.
        rows: rows of history.csv as mappings, the first at rest; columns in docs/columns.md, with
            their units in their names.
        run: content of run.json.
        folder: where the results are, or None of a run without `out`.
        case: the case that was run.
        kept_in: folder with mesh and states; that of the run, or one that goes with this object.
    """

    case: Case
    kept_in: Path | None

    def __repr__(self) -> str:
        """Title, model, how it ended, and where it is."""
        end = "no load step"
        if len(self.rows) > 1:
            last = self.rows[-1]
            end = (
                f"{last[col.STEP]} load steps to {last[col.PRESSURE]:.4g} kPa, "
                f"{last[col.ANGLE]:.4g}°"
            )
        why = f": {self.reason}" if self.reason else ""
        where = "" if self.folder is None else f", in {self.folder}"
        title = self.case.title or "without a title"
        return f"<Result {title!r}, {self.model} model, {end}, {self.status}{why}{where}>"

    def _repr_html_(self) -> str:
        """End, curve, answer and load steps, as a notebook shows them."""
        from fiberbend.api import shown

        return shown.run(self)

    @property
    def model(self) -> str:
        """Name of the model that was solved."""
        from fiberbend.models.choice import choose_model

        return str(self.run.get("model") or choose_model(self.case)[0].name)

    def last(self, column: str) -> float:
        """Value of a column at the end.

        Args:
            column: its name, such as "tip_force_N".

        Raises:
            CaseError: the run has no row.
            KeyError: it has no such column there.
        """
        if not self.rows:
            raise CaseError([Problem(HISTORY_FILE, "no row, expected a run with a load step")])
        value = self.rows[-1].get(column)
        if value is None:
            raise KeyError(f"{column!r} is not known at the end of the run")
        return float(value)

    @functools.cached_property
    def frame(self) -> pd.DataFrame:
        """The rows as a pandas.DataFrame, columns in the order of history.csv.

        Counts are integers where every row has them, everything else is float64; what a row does
        not have is NaN.
        """
        import pandas as pd

        names = list(dict.fromkeys([*HISTORY_COLUMNS, *(key for row in self.rows for key in row)]))
        frame = pd.DataFrame(self.rows, columns=names).astype(float)
        whole = [name for name in names if name in col.COUNTS and frame[name].notna().all()]
        return frame.astype(dict.fromkeys(whole, int))

    def at(
        self,
        *,
        pressure: str | None = None,
        angle: str | None = None,
        step: int | None = None,
    ) -> Reading:
        """All columns at a pressure, at a bending angle or at a load step.

        A load step that has the value is taken as it is. Between two steps every column but counts
        is interpolated along the branch by the cubic through two steps on either side, within the
        values of the two steps.
        `output.at_pressures` and `output.at_angles` of a case make load steps where they are
        wanted.

        Args:
            pressure: such as "100 kPa".
            angle: such as "90 deg".
            step: number of a load step, 0 at rest.

        Returns:
            Values by column name: `r.at(pressure="100 kPa")["angle_deg"]`.

        Raises:
            CaseError: not one of the three, the run does not reach it, or it passes it more than
                once: the message lists the steps.
        """
        key, value = reading.asked("at", pressure=pressure, angle=angle, step=step)
        return reading.read_at(self.rows, key, value)

    # --- states in space ------------------------------------------------------------------------

    @property
    def states(self) -> tuple[Kept, ...]:
        """The states of which there is a mesh: label, step, pressure in kPa, angle in degrees.

        Raises:
            CaseError: the run kept none.
        """
        return self._states.kept

    def mesh(
        self,
        label: str | None = None,
        *,
        pressure: str | None = None,
        angle: str | None = None,
        step: int | None = None,
    ) -> pv.UnstructuredGrid:
        """The body in a state, with quadratic cells; of half a body the half that is modelled.

        The points lie where they are at rest, in mm: x to the side, y up, z along the axis.
        `grid.warp_by_vector("displacement_mm")` bends it. Point data: displacement_mm,
        cauchy_stress_MPa, von_mises_MPa, principal_stretch, max_principal_log_strain and more;
        cell data: material, volume_error. A section or a cell is put together to the whole length
        between the caps.

        Args:
            label: "last", "rest", or another label of `states`.
            pressure: such as "100 kPa", of a load step.
            angle: such as "90 deg", of a load step.
            step: number of a load step.

        Raises:
            CaseError: not one of the four, no such state, or several; the message lists those that
                there are. The nearest one is not taken for it.
        """
        from fiberbend.states.paraview import body_grid

        kept = self._chosen(label, pressure, angle, step)
        space, state = self._space, self._read(kept)
        return body_grid(space.model_mesh, space.snapshot(state), space.fields(state))

    def fibers(
        self,
        label: str | None = None,
        *,
        pressure: str | None = None,
        angle: str | None = None,
        step: int | None = None,
    ) -> pv.PolyData:
        """The fibers in a state as polylines that lie where they are at rest, like `mesh`.

        Point data: displacement_mm; tension_N of a line and fiber_tension_N of the whole fiber.
        Cell data: curve, its number.

        Args:
            label: as of `mesh`.
            pressure: as of `mesh`.
            angle: as of `mesh`.
            step: as of `mesh`.

        Raises:
            CaseError: as of `mesh`; or the winding is smeared, so that it has no lines, or there
                is none.
        """
        from fiberbend.states.fiber_lines import fiber_lines

        kept = self._chosen(label, pressure, angle, step)
        state = self._space.snapshot(self._read(kept))
        mesh, lines = self._space.model_mesh.mesh, self._space.model_mesh.lines
        if lines is None:
            what = "no winding" if self._space.own.fibers is None else "a smeared winding, no lines"
            text = f"{what}, expected one that is discrete, in a cell or a body"
            raise CaseError([Problem("fibers", text)])
        at_rest = fiber_lines(mesh, lines, None, state.fiber_force)
        moved = fiber_lines(mesh, lines, state.displacement)
        at_rest.point_data["displacement_mm"] = moved.points - at_rest.points
        return at_rest

    @functools.cached_property
    def _states(self) -> States:
        from fiberbend.models.choice import MODELS
        from fiberbend.results.states import States

        if self.model in MODELS and MODELS[self.model].line:
            text = f"model {self.model} is a closed form without states, expected section or dearer"
            raise CaseError([Problem("mesh", text)])
        if self.kept_in is None or not self.kept_in.is_dir():
            text = "its states are gone, expected a run with `out`, or with states=True"
            raise CaseError([Problem("mesh", text)])
        states = States(self.kept_in, self.case, self.rows, self._warn)
        if len(states) == 1 and len(self.rows) > 1:
            text = "no state was kept, expected output.report, pictures or fields in the case"
            raise CaseError([Problem("mesh", text)])
        return states

    @functools.cached_property
    def _space(self) -> Space:
        from fiberbend.results.space import Space

        return Space(self.case, self._states.model_mesh)

    def _read(self, kept: Kept) -> Snapshot:
        state = self._states.read(kept)
        if state is None:
            raise CaseError([Problem(str(kept.path), "damaged, expected a whole file")])
        return state

    def _chosen(
        self, label: str | None, pressure: str | None, angle: str | None, step: int | None
    ) -> Kept:
        """The one state that is asked for."""
        kept = self.states
        if label is not None:
            if not (pressure is None and angle is None and step is None):
                raise CaseError([Problem("mesh", "a label and more, expected one of them")])
            if label == "last":
                step = int(self.rows[-1][col.STEP])
            for state in kept:
                if label == state.label:
                    return state
        if label not in (None, "last"):
            names = ["last", "rest", *(state.label for state in kept if state.asked)]
            known = f"{', '.join(dict.fromkeys(names))}, or a step"
            raise CaseError([Problem("label", f"{found(label)}, expected {known}")])
        key, value = reading.asked("mesh", pressure=pressure, angle=angle, step=step)
        along = [_along(state, key) for state in kept]
        span = max(map(abs, along))
        hits = [
            state
            for state, x in zip(kept, along, strict=True)
            if (x == value if key == "step" else reading.close(x, value, span))
        ]
        at = reading.words(key, value)
        if len(hits) > 1:
            text = f"{at} is that of {_listed(hits)}: expected a step"
            raise CaseError([Problem(key, text)])
        if not hits:
            order = sorted(range(len(kept)), key=lambda i: abs(along[i] - value))
            near = [kept[i] for i in sorted(order[:3])]
            hint = "" if key == "step" else f" (output.at_{key}s of the case makes one)"
            text = f"no state at {at}{hint}, expected one of {len(kept)}; nearest: {_listed(near)}"
            raise CaseError([Problem(key, text)])
        return hits[0]

    @staticmethod
    def _warn(text: str) -> None:
        warnings.warn(text, stacklevel=2)

    # --- words and pictures ---------------------------------------------------------------------

    @property
    def answer(self) -> Answer:
        """What the run answers, in words and numbers."""
        from fiberbend.answer.answer import answer

        return answer(self.case, self.rows, self.run)

    def plot(
        self,
        x: str = "",
        y: str | Sequence[str] = "",
        *,
        beside: Sequence[Result | Path | str] = (),
        measured: Path | str | Sequence[Path | str] = (),
        target: Path | str | None = None,
        style: Style | None = None,
        labels: Sequence[str] = (),
    ) -> Figure:
        """Draw columns of the run over each other, other runs and measured points beside it.

        Args:
            x: column along the lower axis; the pressure unless given.
            y: one or several columns of one unit; the angle, or the force of a body that touches
                something, unless given.
            beside: further runs, and folders of runs and sweeps.
            measured: CSV files of measured points.
            target: file to write; none is written unless given.
            style: format, width in mm, dpi and letters, `fiberbend.Style("svg", width=85)`; one
                column of a journal, as a PDF, unless given.
            labels: names of the curves, in place of what differs between the runs.

        Returns:
            The matplotlib figure.

        Raises:
            CaseError: no such column, wrong measured data, or too little room.
        """
        from fiberbend.api.plot import PAPER, plot

        runs = [run.drawn() if isinstance(run, Result) else run for run in (self, *beside)]
        return plot(runs, x, y, measured, target, style or PAPER, labels)

    def drawn(self) -> RunData:
        """The run, as far as curves of it go."""
        from fiberbend.api.runs import RunData

        name = self.case.title or self.model if self.folder is None else self.folder.resolve().name
        return RunData(name, self.case.resolved(), self.rows)

    def report(self, out: Path | str | None = None) -> Path:
        """Write the run's page, one HTML file that needs no network; under mpirun from rank 0.

        Args:
            out: the file; report.html in the run folder unless given.

        Returns:
            Where it is.

        Raises:
            CaseError: a run without a folder, and no `out`; or states that do not fit the case.
        """
        from fiberbend.report.page import links_to
        from fiberbend.report.run_page import report, write_report

        if self.folder is not None and out is None:
            write_report(RunFolder(self.folder, rank() == 0), self.case, self.rows, self.run)
            return self.folder / REPORT
        if out is None:
            text = "a run without a folder, expected the name of a file"
            raise CaseError([Problem("out", text)])
        target = Path(out)
        if rank() == 0:
            with tempfile.TemporaryDirectory() as nothing:
                path = self.folder or self.kept_in or Path(nothing)
                if self.folder is None:
                    # the page contains them as downloads
                    folder = RunFolder(path, durable=False)
                    folder.write_case(self.case)
                    folder.write_history(self.rows)
                    folder.write_run(**self.run)
                links, loose = links_to(self.folder, target), self.folder is None
                page = report(path, self.case, self.rows, self.run, links, loose)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(page, encoding="utf-8")
        return target


def _along(state: Kept, key: str) -> float:
    return {"pressure": state.pressure_kpa, "angle": state.angle_deg, "step": state.step}[key]


def _listed(kept: Sequence[Kept]) -> str:
    """States in words."""
    lines = [f"step {k.step} ({k.pressure_kpa:.6g} kPa, {k.angle_deg:.6g} deg)" for k in kept]
    most = 6
    more = [f"{len(lines) - most} more"] if len(lines) > most else []
    return ", ".join([*lines[:most], *more])

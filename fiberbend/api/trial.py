"""`fiberbend.trial`: states of uniform bending in a loop of one's own."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from fiberbend import columns as col
from fiberbend.api.calls import TURN, AnyCase, Settings
from fiberbend.reader.reader import as_case
from fiberbend.schema.problems import CaseError, Problem, found
from fiberbend.schema.units import parse

if TYPE_CHECKING:
    import pandas as pd

    from fiberbend.trial.wanted import Answer, Point

KEPT = "kept"
"""Whether a state bends freely or is kept straight: 'free' or 'straight'."""
STRAIN = "greatest_log_strain"
"""Greatest maximum principal strain of the rubber, logarithmic."""


@dataclasses.dataclass(frozen=True)
class Trial:
    """The states of a case that were asked for.

    Attributes:
        rows: a state each, in the order in which they were asked for: values by the columns of
            history.csv, `kept` and `greatest_log_strain`. What was not found is left out.
        status: 'converged', or 'failed' where a state was not found.
        reason: why not; empty where all were.
        remarks: what casts doubt on the calibration of its winding.
    """

    rows: list[dict[str, Any]]
    status: str
    reason: str
    remarks: tuple[str, ...] = ()

    @property
    def frame(self) -> pd.DataFrame:
        """The rows as a pandas.DataFrame."""
        import pandas as pd

        return pd.DataFrame(self.rows)

    def __repr__(self) -> str:
        """How it ended, and the table."""
        how = f"{self.status}: {self.reason}" if self.reason else self.status
        return "\n".join([f"<Trial {how}", self.frame.to_string(index=False), *self.remarks]) + ">"


def trial(
    case: AnyCase,
    *,
    angles: Iterable[str] | str = (),
    pressures: Iterable[str] | str = (),
    straight: Iterable[str] | str = (),
    settings: Settings = (),
) -> Trial:
    """Solve a section or a cell at a few states, and write nothing.

    For loops of many cases: a case that differs from one before by numbers alone takes a tenth of a
    second. The case's own pressure, and what keeps it straight, do not count; on several ranks each
    solves what it is asked.

    Args:
        case: a case of model section or cell, a mapping as its YAML gives it, or the path of a
            case file.
        angles: bending angles at which the pressure is found, such as `["90 deg", "180 deg"]`.
        pressures: pressures at which the angle is found, such as `"100 kPa"`.
        straight: pressures under which it is kept straight, and the tip force is found.
        settings: changes to the case, as of `run`.

    Returns:
        The states; look at its `status` and `reason`.

    Raises:
        CaseError: everything that is wrong with the case or a value, no uniform bending, or a
            winding that cannot be calibrated.
    """
    checked = as_case(case, settings)
    given = {"angles": angles, "pressures": pressures, "straight": straight}
    values = {name: tuple(_values(name, texts)) for name, texts in given.items()}
    if not any(values.values()):
        text = "no state given, expected angles, pressures or straight"
        raise CaseError([Problem("trial", text)])
    from fiberbend.running import launch

    with TURN:
        launch.start_mpi()
        from fiberbend.trial.solve import solve
        from fiberbend.trial.wanted import Wanted

        return _told(solve(checked, Wanted(**values)))


def _values(name: str, texts: Iterable[str] | str) -> Iterator[float]:
    kind = "angle" if name == "angles" else "pressure"
    for number, text in enumerate((texts,) if isinstance(texts, str) else texts):
        try:
            yield parse(text, kind)
        except ValueError as error:
            raise CaseError([Problem(f"{name}.{number}", f"{found(text)}, {error}")]) from None


def _told(answer: Answer) -> Trial:
    rows = [_row("free", point) for point in answer.free]
    rows += [_row("straight", point) for point in answer.straight]
    status = "converged" if answer.converged else "failed"
    return Trial(rows, status, answer.reason, answer.remarks)


def _row(kept: str, point: Point) -> dict[str, Any]:
    row = {
        KEPT: kept,
        col.PRESSURE: 1e3 * point.pressure,
        col.ANGLE: math.degrees(point.angle),
        col.SIDE_ANGLE: math.degrees(point.side_angle),
        col.TWIST: math.degrees(point.twist),
        col.AXIS_STRETCH: point.stretch,
        col.VOLUME: point.volume,
        col.TIP_FORCE: point.tip_force,
        col.MOMENT: point.moment,
        col.TORQUE: point.torque,
        col.FIBER_MIN: point.fiber_low,
        col.FIBER_MAX: point.fiber_high,
        col.STORED: point.work,
        STRAIN: point.strain,
    }
    return row

"""A user's measured points: pressure with bending angle, or pressure with tip force.

A case names the CSV file; with the case is checked that the run can be compared with what is
in the file. numpy is imported where it is used: a case that is wrong fails without it.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING

from analytic.table import read_columns
from fiberbend import columns as col
from fiberbend.case.case import Case

if TYPE_CHECKING:
    from geometry.mesh.data import Floats


@dataclasses.dataclass(frozen=True, eq=False)
class Measured:
    """Measured points of one actuator.

    Attributes:
        quantity: what was measured, as its column is called.
        pressure: pressures, (n,), MPa.
        value: bending angles in rad, or tip forces in N, (n,).
        source: name of the file.
    """

    quantity: str
    pressure: Floats
    value: Floats
    source: str

    def shown(self) -> tuple[Floats, Floats]:
        """The points as plots and tables show them: kPa, and degrees or N, (n,) each."""
        import numpy as np

        value = np.degrees(self.value) if self.quantity == col.ANGLE else self.value
        return 1e3 * self.pressure, value


def expected_quantity(blocked: bool) -> str:
    """The column that a measurement needs beside pressure_kPa."""
    return col.TIP_FORCE if blocked else col.ANGLE


def what_is_wrong(file: str, blocked: bool) -> str | None:
    """Why a file cannot be compared with a run.

    Args:
        file: its path.
        blocked: the tip is blocked, so that forces were measured and not angles.

    Returns:
        What was found and what was expected, or None.
    """
    wanted = f"columns pressure_kPa and {expected_quantity(blocked)}"
    path = Path(file)
    try:
        read_columns(path, (col.PRESSURE, expected_quantity(blocked)))
    except FileNotFoundError:
        return f'"{file}", no such file, expected a CSV file with {wanted}'
    except OSError as error:
        return f'"{file}", {error.strerror}, expected a CSV file with {wanted}'
    except ValueError as error:
        return f"{error}, expected {wanted}"
    return None


def read_measured(case: Case) -> Measured | None:
    """The measured points that a checked case names, or None.

    Raises:
        ValueError: the file has changed since and has no points any more.
        OSError: the file is gone.
    """
    import numpy as np

    file = case.output.measured
    if file is None:
        return None
    quantity = expected_quantity(case.straight)
    pressure, value = np.array(read_columns(Path(file), (col.PRESSURE, quantity))).T
    if quantity == col.ANGLE:
        value = value * (math.pi / 180)
    return Measured(quantity, 1e-3 * pressure, value, Path(file).name)

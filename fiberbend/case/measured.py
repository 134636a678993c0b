"""A user's measured points: pressure with bending angle, or pressure with tip force.

A case names the CSV file; with the case is checked that the file holds what the run can be
compared with. numpy is imported where it is used: a case that is wrong fails without it.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from analytic.table import read_columns
from fiberbend.case.case import Case

if TYPE_CHECKING:
    from geometry.mesh.data import Floats

Quantity = Literal["angle_deg", "tip_force_N"]


@dataclasses.dataclass(frozen=True, eq=False)
class Measured:
    """Measured points of one actuator.

    Attributes:
        quantity: what was measured, as its column is called.
        pressure: pressures, (n,), MPa.
        value: bending angles in rad, or tip forces in N, (n,).
        source: name of the file.
    """

    quantity: Quantity
    pressure: Floats
    value: Floats
    source: str

    def shown(self) -> tuple[Floats, Floats]:
        """The points as plots and tables show them: kPa, and degrees or N, (n,) each."""
        import numpy as np

        value = np.degrees(self.value) if self.quantity == "angle_deg" else self.value
        return 1e3 * self.pressure, value


def expected_quantity(blocked: bool) -> Quantity:
    """What a measurement has to hold beside pressure_kPa."""
    return "tip_force_N" if blocked else "angle_deg"


def what_is_wrong(file: str, blocked: bool) -> str | None:
    """Why a file cannot be compared with a run.

    Args:
        file: its path.
        blocked: the tip is held, so that forces were measured and not angles.

    Returns:
        What was found and what was expected, or None.
    """
    wanted = f"columns pressure_kPa and {expected_quantity(blocked)}"
    path = Path(file)
    try:
        read_columns(path, ("pressure_kPa", expected_quantity(blocked)))
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
        ValueError: the file has changed since and holds no points any more.
        OSError: the file is gone.
    """
    import numpy as np

    file = case.output.measured
    if file is None:
        return None
    quantity = expected_quantity(case.straight)
    pressure, value = np.array(read_columns(Path(file), ("pressure_kPa", quantity))).T
    if quantity == "angle_deg":
        value = value * (math.pi / 180)
    return Measured(quantity, 1e-3 * pressure, value, Path(file).name)

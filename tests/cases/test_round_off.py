"""What is said of computed numbers does not turn with their last digits."""

from __future__ import annotations

import numpy as np
import pytest

from fiberbend.drawing.curves import contact_forces
from fiberbend.sweep.trends import _shape


@pytest.mark.parametrize("last", [-1e-13, 0.0, 1e-13])
@pytest.mark.parametrize(
    ("values", "sign"), [([1.0, 2.0, 2.0], "↑"), ([2.0, 2.0, 1.0], "↓"), ([1.0, 3.0, 1.0], "∩")]
)
def test_a_plateau_is_no_turn(values: list[float], sign: str, last: float) -> None:
    assert _shape(np.add(values, [0.0, last, -last])) == sign


@pytest.mark.parametrize("rest", [0.0, 1e-15, -1e-15])
def test_strips_that_are_kept_in_place_meet_nothing(rest: float) -> None:
    rows = [
        {"pressure_kPa": p, "roof_force_N": rest + 0.03 * p, "tip_force_N": rest + 0.01 * p}
        for p in (0.0, 50.0, 100.0)
    ]
    found = contact_forces(rows)
    assert [force.name for force in found] == ["roof", "post"]
    assert [force.touch for force in found] == [None, None]

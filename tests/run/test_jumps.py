"""A step to a neighbouring branch shows in the energies alone, and may not pass in silence."""

from __future__ import annotations

import numpy as np
import pytest

from bench.hard_cases import find
from fiberbend import run
from fiberbend.running.history import departures, work_of

VOLUME = np.linspace(1.0, 4.0, 13)
# P = √V − 1 stores 2/3 (V^1.5 − 1) − (V − 1)
PRESSURE = np.sqrt(VOLUME) - 1
STORED = 2 / 3 * (VOLUME**1.5 - 1) - (VOLUME - 1)


def steps(stored: np.ndarray) -> list[int]:
    return departures(*work_of(PRESSURE[:, None], VOLUME[:, None]), stored)


def test_a_smooth_path_has_no_jump() -> None:
    assert steps(STORED) == []


@pytest.mark.parametrize("step", [3, 7, 10])
def test_energy_out_of_nowhere_is_found(step: int) -> None:
    jump = np.where(np.arange(13) >= step, -1e-3 * STORED[-1], 0.0)
    assert steps(STORED + jump) == [step]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_uneven_steps_on_a_smooth_path_are_no_jump(sign: float) -> None:
    # volumes that fall: P = V^-3 − 1 under vacuum, steps of 1 to 6
    sizes = np.array([1, 1, 1, 4, 2, 6, 1, 4, 1, 1, 3, 1, 1])
    volume = 1 + np.r_[0, np.cumsum(sizes)] / sizes.sum()
    pressure = volume**-3 - 1
    stored = (1 - volume**-2) / 2 - (volume - 1)
    work, uncertainty = work_of(sign * pressure[:, None], sign * volume[:, None])
    assert departures(work, uncertainty, stored) == []
    assert work.sum() == pytest.approx(stored[-1], rel=1e-3)
    jump = np.where(np.arange(14) >= 6, 0.1 * stored[-1], 0.0)
    assert departures(work, uncertainty, stored + jump) == [6]


def test_few_steps_are_not_judged() -> None:
    few = [0, 6, 12]
    work, uncertainty = work_of(PRESSURE[few, None], VOLUME[few, None])
    assert departures(work, uncertainty, STORED[few]) == []


@pytest.mark.hard
def test_a_cell_of_very_stiff_fibers_says_that_it_jumped() -> None:
    # by steps of 45° it leaves its branch twice, by steps of 15° never; the ends differ by 0.1 %
    case = find("fiber-1000").case("cell")
    jumped, stayed = run(case), run(case | {"solver": {"max_turn": "15 deg"}})
    assert any("neighbouring state" in text for text in jumped.run["warnings"])
    assert stayed.run["warnings"] == []
    assert jumped.last("angle_deg") == pytest.approx(stayed.last("angle_deg"), rel=2e-3)

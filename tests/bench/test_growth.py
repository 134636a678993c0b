"""Powers and scaling of time and memory."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from bench.growth_model import Scaling, fitted, powers


@dataclasses.dataclass(frozen=True)
class Run:
    """A run as the model reads it."""

    ranks: int
    unknowns: int
    factorisations: int
    seconds: dict[str, float]
    memory_mb: float


def test_a_power_law_is_found_again_and_its_spread_is_said() -> None:
    n = [10_000, 40_000, 90_000, 500_000]
    fit = fitted(n, [3e-6 * x**1.25 for x in n])
    assert fit.exponent == pytest.approx(1.25, abs=1e-12)
    assert fit.factor == pytest.approx(3e-6, rel=1e-9)
    assert fit.spread < 1e-9
    assert fit(np.array([1e6])) == pytest.approx(3e-6 * 1e6**1.25)
    bent = fitted(n, [1.0, 4.0, 9.0, 60.0])
    assert bent.spread > 0.03
    assert powers({"time 1": fit}) == [
        "- time on 1 rank: unknowns to the power 1.25, measured values within 0 % of it"
    ]


def test_ranks_share_what_two_of_them_shared() -> None:
    one = Run(1, 100, 3, {"all": 21.0, "factor": 10.0, "tangent": 8.0}, 1000.0)
    # the factor keeps a fifth of its time, the tangent nothing, the rest all
    two = Run(2, 100, 3, {"all": 13.0, "factor": 6.0, "tangent": 4.0}, 1300.0)
    scaling = Scaling.of([Run(1, 50, 3, one.seconds, 1.0), one, two])
    assert scaling.unknowns == 100
    assert scaling.stays == pytest.approx({"factor": 0.2, "tangent": 0.0, "rest": 1.0})
    assert [scaling.time(n) for n in (1, 2)] == pytest.approx([21.0, 13.0])
    # on more than two ranks by MUMPS
    assert scaling.time(10**9) == pytest.approx(2.2 * 0.2 * 10 + 3.0)
    assert scaling.more_gb == pytest.approx(0.3)
    with pytest.raises(ValueError, match="two ranks"):
        Scaling.of([one])

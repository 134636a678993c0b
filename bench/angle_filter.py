"""Time of the analytical model: P(θ) at 100 points, θ(P) sample by sample.

Prints only. On an idle machine: `.venv/bin/python bench/angle_filter.py`.
"""

from __future__ import annotations

import time

import numpy as np

from analytic.bending import Hemicircle
from analytic.control.filter import AngleFilter, seconds_per_sample

BASELINE = (8.0, 2.0, 2.0, 160.0)
"""a, b, t, L of Polygerinos et al. 2015, mm."""


def main() -> None:
    """Print the times."""
    actuator = Hemicircle(*BASELINE)
    angles = np.linspace(0, 2 * np.pi, 100)
    actuator.pressure(angles)
    times = []
    for _ in range(20):
        start = time.perf_counter()
        actuator.pressure(angles)
        times.append(time.perf_counter() - start)
    print(f"P(θ), 100 points:   {1e3 * min(times):.3f} ms")
    start = time.perf_counter()
    angle_filter = AngleFilter.from_model(actuator)
    print(f"filter, set-up:     {1e3 * (time.perf_counter() - start):.2f} ms")
    each = 1e6 * seconds_per_sample(angle_filter)
    print(f"filter, one sample: {each:.2f} µs, error {angle_filter.error:.1e} rad")


if __name__ == "__main__":
    main()

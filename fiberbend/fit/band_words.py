"""The pressure at angles and its errors, in words."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from fiberbend.fit.words import aligned

if TYPE_CHECKING:
    from fiberbend.fit.band import Band
    from materials.stretches import Floats


def band_lines(band: Band, others: Mapping[str, Floats], reach: float) -> Iterator[str]:
    """A row for each angle, and what has to be said.

    Args:
        band: of the law.
        others: pressures of other laws, kPa, by their names.
        reach: greatest stretch of the tests.
    """
    yield f"pressure in kPa where the {band.part} is of {band.law}, with the band of 95 %"
    rows = []
    for i, angle in enumerate(np.rad2deg(band.angles)):
        pressure, half = 1e3 * band.pressure[i], 1.96e3 * band.error[i]
        rows.append(
            (
                f"{angle:.4g}°",
                f"{pressure:.2f}",
                f"± {half:.2f} ({100 * half / abs(pressure):.1f} %)",
                f"{band.stretch[i]:.3f}",
                *(f"{values[i]:.2f}" for values in others.values()),
            )
        )
    yield from aligned(("angle", band.law, "95 %", "greatest stretch", *others), rows)
    if len(band.refits):
        count = len(band.refits)
        yield f"{100 * band.covered:.0f} % of {count} refits to resampled tests lie within the band"
    far = band.stretch > reach * (1 + 1e-6)
    if far.any():
        first = np.rad2deg(band.angles[np.flatnonzero(far)[0]])
        yield (
            f"from {first:.4g}° on rubber is stretched beyond the tests, which end at {reach:.4g}: "
            "the band says nothing of that"
        )
    if others:
        yield "the other laws fit the same tests: where they differ by more, that is the error"

"""How often a motion is kept and shown: a film of it runs in real time."""

from __future__ import annotations

import math

FRAME = 0.04
"""Seconds between the states that are kept and shown: 25 in a second, as a film has them."""
_MOST_FRAMES = 500
_FEWEST_FRAMES = 20
_CENTI = 0.01
"""A film tells the time of its frames in hundredths of a second."""


def frame_time(duration: float) -> float:
    """Seconds from one state that is shown to the next.

    Args:
        duration: of the motion, s.
    """
    wanted = min(max(FRAME, duration / _MOST_FRAMES), max(duration / _FEWEST_FRAMES, _CENTI))
    return _CENTI * math.ceil(wanted / _CENTI - 1e-9)

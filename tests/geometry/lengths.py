"""Lengths of helices in closed form."""

from __future__ import annotations

from geometry.actuator import Actuator
from geometry.winding.helix import Winding


def curve_length(winding: Winding, actuator: Actuator) -> float:
    """Length of each curve of a pattern in mm over the chamber, L/pitch √(S² + pitch²)."""
    return actuator.length / winding.pitch * winding.turn_length(actuator)

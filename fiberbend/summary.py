"""Parts of run.json."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from typing import Any

from fem import compat
from fiberbend import __version__, bridge
from fiberbend.case import Actuator
from fiberbend.case_effects import BlockedTipEffect


def versions() -> dict[str, str]:
    """Versions that a result depends on."""
    return {
        "fiberbend": __version__,
        "python": platform.python_version(),
        **compat.versions(),
    }


def blocked_tip(
    actuator: Actuator, effect: BlockedTipEffect, row: Mapping[str, Any]
) -> dict[str, float]:
    """F L_f beside κ P of Polygerinos et al. 2015, eqs. (20) and (21).

    Args:
        actuator: dimensions; κ is the chamber's first moment about y = 0.
        effect: the strips; L_f reaches from z = L to the middle of the post.
        row: the last row of the history.
    """
    kappa = bridge.dimensions(actuator).chamber_moment
    lever = actuator.cap - effect.post_length / 2
    return {
        "L_f_mm": lever,
        "tip_force_N": row["tip_force_N"],
        "roof_force_N": row["roof_force_N"],
        "F_L_f_Nmm": row["tip_force_N"] * lever,
        "kappa_P_Nmm": kappa * row["pressure_kPa"] * 1e-3,
        "tip_section_rotation_deg": row["angle_deg"],
        "balance_force": row["balance_force"],
        "balance_moment": row["balance_moment"],
    }

"""Parts of run.json."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from typing import Any

from fem import kernels
from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.effects.contact import obstacles, stiffness
from fiberbend.models.closed_form import lever_arm
from fiberbend.version import __version__


def versions() -> dict[str, str]:
    """Versions that a result depends on."""
    return {
        "fiberbend": __version__,
        "python": platform.python_version(),
        **kernels.versions(),
    }


def blocked_tip(case: Case, row: Mapping[str, Any]) -> dict[str, float]:
    """F L_f beside κ P of Polygerinos et al. 2015, eqs. (20) and (21).

    Args:
        case: κ is its chamber's first moment about y = 0, L_f reaches from z = L to the middle of
            the post.
        row: the last row of the history, under load.
    """
    kappa, lever = convert.dimensions(case.actuator).chamber_moment, lever_arm(case)
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


def contact(case: Case, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """When each obstacle was touched and left, and the force on the body at the end.

    Args:
        case: a case with obstacles.
        rows: its history, from rest on.
    """
    entry: dict[str, Any] = {"stiffness_MPa_per_mm": stiffness(case)}
    for name in obstacles(case):
        touching = [bool(row.get(f"contact_{name}_area_mm2")) for row in rows]
        changes = [i for i in range(1, len(rows)) if touching[i] != touching[i - 1]]
        depth = max(-row.get(f"contact_{name}_gap_mm", 0.0) for row in rows)
        entry[name] = {
            "touched_at_kPa": [rows[i]["pressure_kPa"] for i in changes if touching[i]],
            "left_at_kPa": [rows[i]["pressure_kPa"] for i in changes if not touching[i]],
            "force_y_N": rows[-1].get(f"contact_{name}_y_N"),
            "force_z_N": rows[-1].get(f"contact_{name}_z_N"),
            "greatest_depth_mm": max(depth, 0.0),
        }
    return entry

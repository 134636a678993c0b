"""The closed forms of bending that are drawn beside a run: what they are called, once."""

from __future__ import annotations

ZERO_FIT = "zero-fit"
"""Eq. (19) with the case's own rubber, nothing fitted."""
WINDING = "winding"
"""The same, the pressure acting on all inside the winding."""
PAPER = "paper"
"""Eq. (19) without its extra L, with the paper's μ̄."""

NAMES = {ZERO_FIT: "analytic", WINDING: "analytic_winding", PAPER: "analytic_paper"}
"""What columns and run.json call them."""
LABELS = {
    ZERO_FIT: "analytic (own rubber)",
    WINDING: "analytic (area to winding)",
    PAPER: "analytic (paper's μ̄)",
}
"""What plots and messages call them."""

"""docs/verification.md, from what the ladders found; no times, so that a rerun changes nothing."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import fill

from tests.verify.helix import EXACT, TEXT, TITLE, Pitch
from tests.verify.ladder import FAMILIES, Ladder, Rung, rates
from tests.verify.uniform_limits import ALL as LIMITS

LIMITS_TITLE = "Uniform bending: the section model at exact limits"
LIMITS_TEXT = (
    "Section models of refinement n (n elements through every thickness) beside closed forms: "
    "composite beam theory at k → 0; the first-order bending of a bare section, which for any "
    "shape is (1 − 2ν) P A (ȳ − ȳ_solid)/(E I) and so vanishes with the compressibility, and of "
    "three incompressible materials likewise; round tubes with closed free ends, bare, wound by a "
    "double helix and by a single one (extension, inflation and torsion in one, found by making "
    "their potential stationary), and twisted at constant length. Errors are relative; absolute "
    "where the exact value is zero: the slope of the wound baseline is 0.21."
)

HEAD = """# Verification

Exact solutions of incompressible elasticity against the finite elements. `make verify` solves all
of them, checks the rates and writes this page; the solutions are in `tests/exact/solutions.py`,
whose own tests differentiate the fields and find them in equilibrium.

The rubber is Yeoh's with C1 = 0.11 and C2 = 0.02 MPa; mm, N, MPa. Errors are relative, in the L2
norm over the body at rest; h is halved from row to row unless a pitch is given. Quadratic
displacements and linear pressures should give the rates 3 and 2, and the ladder demands 2.7 and
1.7 of the last two meshes.
"""


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def _rate(value: float | None) -> str:
    return "" if value is None else f"{value:.2f}"


def ladder_section(ladder: type[Ladder], climbed: dict[str, list[Rung]]) -> str:
    """Table of one problem, all element families."""
    names = list(ladder.reference)
    head = ["elements", "cells", "unknowns", "‖u‖ error", "rate", "‖p‖ error", "rate", *names]
    lines = [
        f"## {ladder.title}",
        "",
        fill(ladder.text, 100),
        "",
        _row(head),
        _row(["---"] * len(head)),
    ]
    for cell, rungs in climbed.items():
        h = [1 / rung.n for rung in rungs]
        u = [None, *rates([rung.u for rung in rungs], h)]
        p = [None, *rates([rung.p for rung in rungs], h)]
        for i, rung in enumerate(rungs):
            found = [f"{rung.values[name]:.8g}" for name in names]
            cells = [FAMILIES[cell], str(rung.cells), str(rung.unknowns)]
            errors = [f"{rung.u:.2e}", _rate(u[i]), f"{rung.p:.2e}", _rate(p[i])]
            lines.append(_row([*cells, *errors, *found]))
    exact = [f"{value:.9g}" for value, _ in ladder.reference.values()]
    lines.append(_row(["exact", "", "", "", "", "", "", *exact]))
    return "\n".join(lines) + "\n"


def limits_section(refinements: Sequence[int] = (1, 2, 4)) -> str:
    """Table of the section model at its exact limits."""
    rungs = [[c for limit in LIMITS for c in limit(n)] for n in refinements]
    lines = [f"## {LIMITS_TITLE}", "", fill(LIMITS_TEXT, 100), ""]
    head = ["quantity", "exact", *(f"error, n = {n}" for n in refinements)]
    lines += [_row(head), _row(["---"] * len(head))]
    for checks in zip(*rungs, strict=True):
        errors = [f"{check.error:.1e}" for check in checks]
        lines.append(_row([checks[0].name, f"{checks[0].exact:.8g}", *errors]))
    return "\n".join(lines) + "\n"


def helix_section(pitches: Sequence[Pitch], extrapolated: float) -> str:
    """Table of the double helix."""
    head = ["pitch [mm]", "unknowns", "p [MPa]", "error", "order"]
    lines = [f"## {TITLE}", "", fill(TEXT, 100), "", _row(head), _row(["---"] * len(head))]
    order = [None, *rates([x.error for x in pitches], [x.pitch for x in pitches])]
    for x, rate in zip(pitches, order, strict=True):
        numbers = [f"{x.pitch:.4g}", str(x.unknowns), f"{x.pressure:.6f}", f"{100 * x.error:.2f} %"]
        lines.append(_row([*numbers, _rate(rate)]))
    limit = f"{EXACT.pressure * (1 + extrapolated):.6f}"
    lines.append(_row(["0, by the last two", "", limit, f"{100 * extrapolated:.2f} %", ""]))
    lines.append(_row(["exact", "", f"{EXACT.pressure:.6f}", "", ""]))
    return "\n".join(lines) + "\n"

"""Writes docs/evidence/iterative.md from what bench/iterative.py has measured."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from machine import origin

PAGE = Path(__file__).resolve().parent.parent / "docs" / "evidence" / "iterative.md"
Row = Mapping[str, Any]

HEAD = """\
# Iterative solvers

Made by `python -m bench.iterative --bodies {bodies}` on {machine}, PETSc {version}:
the baseline's body at rest, bent to 45° and to 180°. The tangent of that state is solved for the
response to the pressure until 1e-8 of the right side is left. Seconds are of the processor, in one
process on one core, beside other work: good to a fifth. Memory is that of the factors by MUMPS's
own count. *Error* is that of the displacements against the direct solution.

- **direct**: what every run takes, a long body in layers; its analysis, done once, is not counted.
- **MUMPS**: the general direct solver, with the memory of its factor. (L of the layers is smaller.)
- **slabs**: what `solver: {{linear: iterative}}` takes. The body is cut across its axis. Each slab,
  overlapped by its neighbours, is factorised by MUMPS with displacements and pressures; a coarse
  system has six rigid motions a slab; GMRES. All slabs on this one rank; their memory
  has the factors of the strips in which slabs overlap.
- **augmented Lagrangian**: A + γ Bᵀ W⁻¹ B factorised exactly, block triangular with the pressures.
- **A alone**: conjugate gradients for A x = f, without pressures, at most 5 s and 400 iterations:
  a solver of the whole system would do this in every iteration.
"""


def page(rows: Sequence[Row], version: Sequence[int]) -> None:
    """Write the page.

    Args:
        rows: a row for each body, state and solver.
        version: of PETSc.
    """
    machine = origin.machine()["processor"]
    bodies = dict.fromkeys((r["section"], r["axial"], r["winding"], r["unknowns"]) for r in rows)
    release = ".".join(map(str, version))
    lines = [HEAD.format(bodies=len(bodies), machine=machine, version=release)]
    for section, axial, winding, unknowns in bodies:
        lines += [
            f"## {unknowns} unknowns, {winding} winding",
            "",
            f"`mesh.section` {section}, `mesh.axial` {axial:g} mm.",
            "",
            "| at | solver | factor, s | iterations | solve, s | memory, MB | error | |",
            "|---|---|---|---|---|---|---|---|",
        ]
        key = (section, axial, winding)
        lines += [
            _line(row) for row in rows if (row["section"], row["axial"], row["winding"]) == key
        ]
        lines.append("")
    PAGE.write_text("\n".join([*lines, *_summary(rows)]) + "\n", encoding="utf-8")


def _line(row: Row) -> str:
    def shown(name: str, form: str) -> str:
        return format(row[name], form) if name in row else ""

    cells = [f"{row['angle']}°", row["solver"], shown("factor", ".2f"), shown("iterations", "d")]
    cells += [shown("solve", ".2f"), shown("memory", ".0f"), shown("error", ".0e")]
    return f"| {' | '.join(cells)} | {row.get('why', '')} |"


def _summary(rows: Sequence[Row]) -> list[str]:
    """What the numbers say, with their ranges."""
    slabs = [row for row in rows if "slabs" in row["solver"]]
    direct = {_state(row): row for row in rows if row["solver"] == "direct"}
    general = {_state(row): row for row in rows if row["solver"] == "MUMPS"}
    times = [
        (row["factor"] + row["solve"])
        / (direct[_state(row)]["factor"] + direct[_state(row)]["solve"])
        for row in slabs
        if "why" not in row
    ]
    solves = [row["solve"] / direct[_state(row)]["solve"] for row in slabs if "why" not in row]
    memory = [row["memory"] / general[_state(row)]["memory"] for row in slabs if "why" not in row]
    counts = [row["iterations"] for row in slabs if "why" not in row]
    alone = [row for row in rows if row["solver"].endswith("A alone")]
    done = [row for row in alone if "why" not in row]
    lines = [
        "## What they say",
        "",
        f"- **Slabs converge at every state**: {min(counts)} to {max(counts)} iterations in "
        f"all that was measured; {len(slabs) - len(counts)} of {len(slabs)} were refused.",
        f"- **On one core they pay nothing.** Factor and one solve take {min(times):.1f} to "
        f"{max(times):.1f} times the direct solver's time, a solve alone {min(solves):.0f} to "
        f"{max(solves):.0f} times, and the factors {min(memory):.2f} to {max(memory):.2f} times "
        "MUMPS's memory. What they are for is more than two ranks, where only MUMPS is left: "
        "each rank has its own slabs. Beyond two ranks nothing was measured, for want of cores.",
    ]
    if alone:
        lines.append(
            f"- **Multigrid meets the winding.** For A alone, {len(done)} of {len(alone)} solves "
            "reach 1e-8"
            + (
                f", in {min(r['iterations'] for r in done)} to "
                f"{max(r['iterations'] for r in done)} iterations"
                if done
                else ""
            )
            + ". 5 s are more than ten times what either direct solver takes for everything."
        )
    exact = [row for row in rows if row["solver"].endswith("γ = 100") and "why" not in row]
    if exact:
        most = max(row["iterations"] for row in exact)
        lines.append(
            f"- **The pressures are no difficulty.** With γ = 100 and an exact inner solve at most "
            f"{most} iterations are left. But the augmented A costs what K costs."
        )
    return lines


def _state(row: Row) -> tuple[Any, ...]:
    return row["section"], row["axial"], row["winding"], row["angle"]

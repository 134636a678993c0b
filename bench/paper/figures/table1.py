"""Table I: nodes and elements of the paper's simulations beside what ours take to 360°."""

from __future__ import annotations

import numpy as np

from bench.paper.facts import TABLE_I, Size, grouped
from bench.paper.figures.fig8 import solved
from bench.paper.part import Found, Table
from bench.paper.runs import FULL, Curve, Runs, Solved
from bench.paper.verdict import Verdict, unknown


def found(runs: Runs) -> Found:
    """The paper's counts beside ours."""
    every = solved(runs)
    words = [
        "The paper counts the nodes and elements of its tetrahedra and beams, and does not say how "
        "long they took; its Figs. 8 and 10 have all ten of them at 360°. Ours are half models "
        "(x ≥ 0), so that a whole one has twice the elements. Seconds are those of the solution "
        "alone, on this machine, other work beside it.",
    ]
    if runs.body is None:
        words.append(f"Bodies: `{FULL}`.")
    head = (
        "a, L, t, mm",
        "paper: nodes",
        "elements",
        "model",
        "nodes",
        "elements",
        "unknowns",
        "angle",
        "steps",
        "iterations",
        "s",
    )
    rows = []
    for size in TABLE_I:
        for place, (name, done) in enumerate(every.items()):
            rows.append(_row(size, place == 0, name, done.sizes[size.key]))
    return Found(
        words=words,
        tables=[Table("What a curve to 360° takes; angle: where it ends", head, rows)],
        verdicts=[_verdict(size, every) for size in TABLE_I],
        commands=[done.command for done in every.values()],
    )


def _row(size: Size, first: bool, name: str, curve: Curve) -> list[str]:
    known = [
        f"{size.radius:g}, {size.length:g}, {size.wall:g}",
        grouped(size.nodes),
        grouped(size.elements),
    ]
    run = curve.run
    return [
        *(known if first else ("", "", "")),
        name,
        grouped(nodes(curve)),
        grouped(run["elements"]),
        grouped(run["unknowns"]),
        f"{curve.angle.max():.0f}°",
        str(run["load_steps"]),
        str(run["newton_iterations"]),
        f"{run['wall_s']['solve']:.1f}",
    ]


def nodes(curve: Curve) -> int:
    """Nodes of the mesh of a run."""
    with np.load(curve.folder / "mesh.npz") as mesh:
        return len(mesh["nodes"])


def _verdict(size: Size, every: dict[str, Solved]) -> Verdict:
    """No count is right or wrong; what ours reach with how many is said."""
    name = list(every)[-1]
    curve = every[name].sizes[size.key]
    ours = f"{grouped(nodes(curve))} nodes, {grouped(curve.run['elements'])} elements"
    why = (
        f"a count has no right value; our half of a {name} reaches {curve.angle.max():.0f}° with "
        f"{nodes(curve) / size.nodes:.3f} times the nodes"
    )
    return unknown(f"mesh_{size.radius:g}_{size.length:g}_{size.wall:g}", name, ours, why)

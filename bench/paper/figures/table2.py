"""Table II: the signs with which pressure and force change with radius, length and wall."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from bench.paper.facts import FIG_8, STATED
from bench.paper.figures.fig8 import PLACE, series, solved
from bench.paper.figures.fig11 import forces
from bench.paper.lines import CLOSED, force, kpa, paper
from bench.paper.part import Found, Table
from bench.paper.runs import Key, Runs
from bench.paper.verdict import Verdict, trend, unknown

PRESSURE = 100.0
"""Of the forces, kPa."""
Value = Callable[[Key], float]


def found(runs: Runs) -> Found:
    """A sign for every model."""
    made = [*pressures(runs), *blocked(runs)]
    keys = [f"{name}_{kind}" for kind in ("pressure", "force") for name in FIG_8]
    head = ("", *(f"{letter}: {name}" for letter in "PF" for name in FIG_8))
    rows = [["paper", *(STATED[key].printed for key in keys)]]
    for model in dict.fromkeys(verdict.model for verdict in made):
        ours = {verdict.stated.key: verdict.ours for verdict in made if verdict.model == model}
        rows.append([model, *(ours.get(key, "") for key in keys)])
    return Found(
        words=(
            "Signs over the sizes of Table I that differ from the baseline in one dimension: "
            "radius 6 to 12, length 100 to 160, wall 1 to 3 mm; force at 100 kPa, kept straight. "
            "— is within 1 %; ∪ falls, then rises.",
            "The floor decides the sign of the radius: with 2 mm of the combined base a wide floor "
            "gives way, with 3 mm the pressure falls as in the paper, which does not state its "
            "floor.",
        ),
        tables=[Table("P at 360° and F at 0° as radius, length and wall grow", head, rows)],
        verdicts=made,
        commands=[
            *(done.command for done in solved(runs).values()),
            runs.thick_floor.command,
        ],
    )


def pressures(runs: Runs) -> list[Verdict]:
    """Of the pressure at 360°."""
    models: dict[str, Value] = {
        name: (lambda key, form=form: float(kpa(form(key), 360.0)))  # type: ignore[misc]
        for name, (_, form) in CLOSED.items()
    }
    every = {**solved(runs), "section, floor 3 mm": runs.thick_floor}
    models |= {
        name: (lambda key, done=done: done.sizes[key].at_angle(360.0))  # type: ignore[misc]
        for name, done in every.items()
    }
    return _signs("pressure", models)


def blocked(runs: Runs) -> list[Verdict]:
    """Of the force at 0°."""
    models: dict[str, Value] = {"eq. (20)": lambda key: float(force(paper(key), PRESSURE))}
    straight = {"section": runs.section, "cell": runs.cell, "section, floor 3 mm": runs.thick_floor}
    models |= {
        name: (lambda key, done=done: done.number(key, "blocked_force_N"))  # type: ignore[misc]
        for name, done in straight.items()
    }
    made = _signs("force", models)
    if runs.blocked is not None:
        made += _bodies(forces(runs))
    return made


def _bodies(every: Mapping[str, Mapping[Key, list[float]]]) -> list[Verdict]:
    """Of the three bodies of Fig. 11, at 100 kPa."""
    made = []
    for name, of in every.items():
        if not name.startswith("body"):
            continue
        at = {key: values[1] for key, values in of.items()}
        for dimension in ("radius", "length"):
            keys = [key for key in series(dimension) if key in at]
            over = ", ".join(f"{key[PLACE[dimension]]:g}" for key in keys) + " mm"
            made.append(trend(f"{dimension}_force", name, [at[key] for key in keys], over))
    return made


def _signs(kind: str, models: Mapping[str, Value]) -> list[Verdict]:
    made = []
    for name in FIG_8:
        keys = series(name)
        over = ", ".join(f"{key[PLACE[name]]:g}" for key in keys) + " mm"
        for model, value in models.items():
            found = trend(f"{name}_{kind}", model, [value(key) for key in keys], over)
            if STATED[f"{name}_{kind}"].printed == "n/a":
                found = unknown(f"{name}_{kind}", model, found.ours, "the paper has no sign for it")
            made.append(found)
    return made

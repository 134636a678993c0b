"""Fig. 8: pressure at 90, 180 and 360° over radius, length and wall."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.paper.facts import ANGLES, BASELINE, FIG_8, TABLE_I
from bench.paper.lines import CLOSED, LOOKS, kpa, legend, named, page, paper, printed
from bench.paper.part import Erratum, Figure, Found, Table
from bench.paper.runs import Key, Runs, Solved
from bench.paper.verdict import FALLS, Verdict, holds, percent, sign_of

PLACE = {"radius": 0, "length": 1, "wall": 2}
"""Of a dimension in (a, L, t)."""
NAMES = {"radius": "radius a, mm", "length": "length L, mm", "wall": "wall t, mm"}
LABELS = {"radius": 7.0, "length": 170.0, "wall": 2.6}
"""Where the lines of (19) are named, mm."""
HOOP = 0.5


def solved(runs: Runs) -> dict[str, Solved]:
    """Table I by every model that is solved."""
    every = {"section": runs.section, "cell": runs.cell, "body": runs.body}
    return {name: done for name, done in every.items() if done is not None}


def series(name: str) -> list[Key]:
    """Sizes of Table I that differ from the baseline in one dimension, in its order."""
    place = PLACE[name]
    others = [i for i in range(3) if i != place]
    keys = [size.key for size in TABLE_I]
    found = [key for key in keys if all(key[i] == BASELINE[i] for i in others)]
    return sorted(found, key=lambda key: key[place])


def changed(name: str, value: float) -> Key:
    """The baseline with another value of a dimension in mm."""
    radius, length, wall = BASELINE
    return {
        "radius": (value, length, wall),
        "length": (radius, value, wall),
        "wall": (radius, length, value),
    }[name]


def found(runs: Runs) -> Found:
    """Lines of the closed forms, points of the models."""
    every = solved(runs)
    return Found(
        words=(
            "The paper draws eq. (19) as lines and its simulations as points, in three panels. It "
            "prints none of the pressures; their signs are in Table II.",
        ),
        figures=[
            Figure(
                "fig8",
                _draw(every),
                "Pressure over (a) radius, (b) length and (c) wall at 90, 180 and 360°.",
            )
        ],
        tables=[_table(every)],
        verdicts=verdicts(runs),
        errata=[
            Erratum(
                "V-A",
                "'for an increase in the length, higher air pressure was required'",
                "lower: Table II, Fig. 10, and (19) without its extra factor L; with it (19) rises "
                f"from {_wrong(100.0):.1f} MPa at L = 100 mm to {_wrong(160.0):.1f} MPa at 160 mm",
            ),
            Erratum(
                "III-B",
                "1 ≤ λ < 1.5, and s2 as significantly smaller than s1",
                f"λ reaches {max(crown(size.key) for size in TABLE_I):.2f} at the top of the wall, "
                "and s2/s1 = λ/(λ² + 1) starts at 0.50: (19) leaves out a stress of that size",
            ),
        ],
        commands=[done.command for done in every.values()],
    )


def _table(every: dict[str, Solved]) -> Table:
    rows = []
    for size in TABLE_I:
        for degrees in ANGLES:
            closed = [float(kpa(form(size.key), degrees)) for _, form in CLOSED.values()]
            models = [done.sizes[size.key].at_angle(degrees) for done in every.values()]
            name = size.name if degrees == ANGLES[0] else ""
            rows.append([name, f"{degrees:g}°", *(f"{v:.1f}" for v in (*closed, *models))])
    return Table("Pressure, kPa", ("", "", *CLOSED, *every), rows)


def verdicts(runs: Runs) -> list[Verdict]:
    """On the sizes, on what (19) assumes, and on the sentence about the length."""
    sizes = {size.key for size in TABLE_I}
    spans = ", ".join(f"{low:g} to {high:g}" for low, high in FIG_8.values())
    drawn = all(np.isfinite(_line(name, 360.0, paper)[1]).all() for name in FIG_8)
    stretch = {
        name: [done.number(size.key, "greatest_stretch") for size in TABLE_I]
        for name, done in (("section", runs.section), ("cell", runs.cell))
    }
    stretch = {"eq. (17)": [crown(size.key) for size in TABLE_I]} | stretch
    made = [
        holds(
            "sizes",
            " and ".join(solved(runs)),
            f"{len(sizes)} sizes",
            all(set(done.sizes) == sizes for done in solved(runs).values()),
            "the same ones are solved",
        ),
        holds("ranges", "eq. (19)", f"{spans} mm", drawn, "the lines are drawn over all of them"),
    ]
    for name, values in stretch.items():
        beyond = sum(value >= 1.5 for value in values)
        made.append(
            holds(
                "stretch",
                name,
                f"up to {max(values):.2f}",
                beyond == 0,
                f"{beyond} of {len(values)} sizes of Table I pass 1.5 at 360°",
            )
        )
    most = max(stretch["eq. (17)"])
    ends = [x / (x * x + 1) for x in (1.0, most)]
    made.append(
        holds(
            "hoop",
            "eqs. (8), (9)",
            f"s2/s1 = {ends[0]:.2f} to {ends[1]:.2f}",
            max(ends) <= HOOP,
            f"λ/(λ² + 1) from λ = 1 to {most:.2f}: below a half, but not small beside it",
        )
    )
    return [*made, *lengths(runs)]


def lengths(runs: Runs) -> list[Verdict]:
    """On the text's sentence about the length."""
    keys = series("length")
    made = []
    every = {"eq. (19)": [float(kpa(paper(key), 360.0)) for key in keys]}
    every |= {
        name: [done.sizes[key].at_angle(360.0) for key in keys]
        for name, done in solved(runs).items()
    }
    for name, values in every.items():
        sign, change = sign_of(values), percent(values[-1] / values[0] - 1)
        why = f"{change} from L = {keys[0][1]:g} to {keys[-1][1]:g} mm"
        made.append(holds("length_text", name, sign, sign != FALLS, why))
    return made


def crown(key: Key) -> float:
    """λ of eq. (17) at the top of the wall at 360°."""
    return 1 + paper(key).roof * 2 * math.pi / key[1]


def _wrong(length: float) -> float:
    """P in MPa at 360° by (19) with the factor L of (14), L in mm."""
    return float(kpa(printed(changed("length", length)), 360.0)) / 1e3


def _line(name: str, degrees: float, form: Any) -> tuple[Any, Any]:
    """A dimension over its range, and P of a closed form in kPa."""
    across = np.linspace(*FIG_8[name], 41)
    return across, np.array([float(kpa(form(changed(name, x)), degrees)) for x in across])


def _draw(every: dict[str, Solved]) -> Any:
    figure, panels = page(5.4, ncols=3, sharey=True)
    for panel, (letter, name) in zip(panels, zip("abc", FIG_8, strict=True), strict=True):
        for look, form in CLOSED.values():
            for degrees in ANGLES:
                line = look.line()
                if degrees != ANGLES[0]:
                    del line["label"]
                panel.plot(*_line(name, degrees, form), **line)
        _points(panel, name, every)
        _angles(panel, name)
        named(panel, NAMES[name], "pressure, kPa" if letter == "a" else "", f"({letter})")
        panel.set_ylim(0, 425)
    legend(figure, panels[0], 3, 0.6)
    return figure


def _angles(panel: Any, name: str) -> None:
    """The angle above each line of (19)."""
    across = LABELS[name]
    for degrees in ANGLES:
        panel.annotate(
            f"{degrees:g}°",
            (across, float(kpa(paper(changed(name, across)), degrees))),
            xytext=(-6, 5) if name == "wall" else (0, 5),
            textcoords="offset points",
            ha="right" if name == "wall" else "center",
            fontsize=10.5,
            color=CLOSED["eq. (19)"][0].color,
        )


def _points(panel: Any, name: str, every: dict[str, Solved]) -> None:
    keys: Sequence[Key] = series(name)
    across = [key[PLACE[name]] for key in keys]
    for model, done in every.items():
        look = LOOKS[model]
        for degrees in ANGLES:
            values = [done.sizes[key].at_angle(degrees) for key in keys]
            label = {"label": look.label} if degrees == ANGLES[0] else {}
            panel.plot(across, values, **look.points(), **label)

"""Fig. 11: force of an actuator that is kept straight, and the errors of 4.3 % and 10.3 %."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from bench.paper.facts import CAP, FIG_11, STATED
from bench.paper.lines import CELL, FLOOR, PAPER, SECTION, force, legend, named, page, paper
from bench.paper.part import Erratum, Figure, Found, Table
from bench.paper.runs import FULL, Curve, Key, Runs
from bench.paper.verdict import STAYS, Verdict, holds, percent, possible, shared, sign_of, unknown

PRESSURES = (50.0, 100.0, 150.0, 200.0, 250.0)
"""kPa; the paper states no range."""
KEYS: tuple[Key, ...] = tuple((float(a), float(length), float(t)) for a, length, t in FIG_11)
MOMENT, TIP = "blocked_moment_Nmm", "tip_force_N"
HELD, PUSHED = "body, tip held", "body, tip pushed"
STRAIGHT = {"section": "section, kept straight", "cell": "cell, kept straight"}
NOT_BLOCKED = (
    "a section that is kept straight is no blocked tip, whose soft cap passes on half; bodies: "
    f"{FULL}"
)
ERRORS = (STATED["force_closed"].value, STATED["force_solid"].value)
Forces = dict[str, dict[Key, list[float]]]
"""F in N at `PRESSURES`, by model and actuator."""


def found(runs: Runs) -> Found:
    """Forces of every model."""
    every = forces(runs)
    rows = [
        [f"a = {key[0]:g}, L = {key[1]:g} mm" if name == "eq. (20)" else "", name, *_fixed(of[key])]
        for key in KEYS
        for name, of in every.items()
    ]
    words = [
        "The top of the actuator is kept from rising, its tip presses on a post. The paper draws "
        "(20) and its simulation with measured forces, without numbers. L_f is not stated: the cap "
        f"of {CAP.value:g} mm. The floor is {FLOOR:g} mm.",
        "Section and cell are kept straight, which gives a moment; their force is M/L_f.",
    ]
    if runs.blocked is None:
        words.append(f"The force of a blocked tip takes a body: `{FULL}`.")
    commands = [runs.straight.command]
    if runs.blocked is not None:
        words.append(
            "Two bodies: 'held' by strips that keep their height, 'pushed' by obstacles that it "
            "can leave, winding spread, elements 4 mm long (docs/contact.md)."
        )
        commands.append(runs.blocked.command)
        words.append(
            "One L_f for all three actuators and all of these pressures would leave room for both "
            f"stated errors: {_lever(every, HELD)} with the tip held, {_lever(every, PUSHED)} with "
            "it pushed."
        )
    head = ("", "", *(f"{p:g} kPa" for p in PRESSURES))
    return Found(
        words=words,
        figures=[Figure("fig11", _draw(every), "Force at the tip over the pressure.")],
        tables=[Table("Force, N", head, rows)],
        verdicts=[*errors(every), *lengths(every)],
        errata=[Erratum("V-C", "'6.0-mm diameter'", "radius: Table I and Fig. 11(d)")],
        commands=commands,
    )


def forces(runs: Runs) -> Forces:
    """Forces of (20), of straight sections and cells, and of bodies where they are solved."""
    every: Forces = {
        "eq. (20)": {key: list(force(paper(key), np.array(PRESSURES))) for key in KEYS}
    }
    for row, curve in zip(runs.straight.table, runs.straight.curves, strict=True):
        moments = [curve.at_pressure(p, MOMENT) / CAP.value for p in PRESSURES]
        every.setdefault(STRAIGHT[str(row["model"])], {})[_key(row)] = moments
    if runs.blocked is not None:
        for row, curve in zip(runs.blocked.table, runs.blocked.curves, strict=True):
            name = PUSHED if pushes(curve) else HELD
            every.setdefault(name, {})[_key(row)] = [curve.at_pressure(p, TIP) for p in PRESSURES]
    return every


def pushes(curve: Curve) -> bool:
    """Whether a body is between obstacles; else strips of it are held."""
    return "contact" in curve.run


def _key(row: Any) -> Key:
    return float(row["radius_mm"]), float(row["length_mm"]), 2.0


def errors(every: Forces) -> list[Verdict]:
    """On 4.3 and 10.3 %: could one measured force be that near to (20) and to a body?"""
    if HELD not in every:
        return [
            unknown(name, model, f"{of[KEYS[0]][1]:.2f} N at 100 kPa", NOT_BLOCKED)
            for name, model in (
                ("force_closed", "eq. (20)"),
                ("force_solid", STRAIGHT["section"]),
                ("force_solid", STRAIGHT["cell"]),
            )
            for of in (every[model],)
        ]
    return [
        _error(stated, every, model, key)
        for stated, model in (("force_closed", HELD), ("force_solid", PUSHED))
        for key in KEYS
    ]


def _error(stated: str, every: Forces, model: str, key: Key) -> Verdict:
    """The verdict at the pressure where both models are least alike."""
    pairs = list(zip(every["eq. (20)"][key], every[model][key], strict=True))
    spans = [shared(pair, ERRORS) for pair in pairs]
    worst = int(np.argmax([low / high for low, high in spans]))
    size = f"a = {key[0]:g}, L = {key[1]:g} mm"
    where = f"{size} at {PRESSURES[worst]:g} kPa with L_f = {CAP.value:g} mm:"
    return possible(stated, ("eq. (20)", model), pairs[worst], ERRORS, where, "N")


def levers(every: Forces, model: str) -> tuple[float, float]:
    """Least and greatest L_f in mm with which both errors could hold everywhere.

    F of (20) goes with 1/L_f. None is left where the first number is above the second.

    Args:
        every: forces, those of (20) with the cap as L_f.
        model: of the bodies.
    """
    closed, solid = ERRORS
    parts = [
        a / b
        for key in KEYS
        for a, b in zip(every["eq. (20)"][key], every[model][key], strict=True)
    ]
    low = max(parts) * (1 - solid) / (1 + closed)
    high = min(parts) * (1 + solid) / (1 - closed)
    return low * CAP.value, high * CAP.value


def _lever(every: Forces, model: str) -> str:
    low, high = levers(every, model)
    return f"{low:.1f} to {high:.1f} mm" if low <= high else "none"


def lengths(every: Forces) -> list[Verdict]:
    """On the influence of the length: 130 beside 160 mm."""
    made = []
    for name, of in every.items():
        shorter, longer = of[KEYS[1]], of[KEYS[0]]
        parts = [a / b - 1 for a, b in zip(longer, shorter, strict=True)]
        most = max(parts, key=abs)
        signs = {sign_of(pair) for pair in zip(shorter, longer, strict=True)}
        why = "L = 160 beside 130 mm at 50 to 250 kPa, within 1 % counts as small"
        made.append(holds("force_length", name, percent(most, 2), signs == {STAYS}, why))
    return made


def _fixed(values: Sequence[float]) -> list[str]:
    return [f"{value:.2f}" for value in values]


def _draw(every: Forces) -> Any:
    figure, panels = page(5.0, ncols=3, sharey=True)
    at = [0.0, *PRESSURES]
    looks: dict[str, dict[str, Any]] = {
        "eq. (20)": PAPER.line() | {"label": "eq. (20), L_f = 15 mm"},
        STRAIGHT["section"]: SECTION.line() | {"label": "section, kept straight"},
        STRAIGHT["cell"]: CELL.line() | {"label": "cell, kept straight", "lw": 2.4},
        HELD: {"color": "black", "ls": "-", "lw": 1.8, "label": HELD},
        PUSHED: {"color": "black", "ls": "none", "marker": "^", "ms": 7, "label": PUSHED}
        | {"clip_on": False},
    }
    for panel, letter, key in zip(panels, "bcd", KEYS, strict=True):
        for name, of in every.items():
            panel.plot(at, [0.0, *of[key]], **looks[name])
        named(
            panel,
            "pressure, kPa",
            "force, N" if letter == "b" else "",
            f"({letter}) a = {key[0]:g}, L = {key[1]:g} mm",
        )
        panel.set_xlim(0, PRESSURES[-1])
        panel.set_xticks(range(0, 201, 50))
        panel.set_ylim(bottom=0)
    legend(figure, panels[0], 3, 0.65)
    return figure

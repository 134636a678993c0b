"""What the paper leaves open: what each matter costs, and which values explain best what it states.

Read from bench/paper/assumed/record.json, which `make paper ASSUME=1` makes again.
"""

from __future__ import annotations

import math

from bench.paper.assumed.flat import Directions
from bench.paper.assumed.record import COMMAND, Record
from bench.paper.assumptions import CHOICES, DEFAULT, RANGES
from bench.paper.combination import Best, alone, closed_form, statements
from bench.paper.facts import STATED
from bench.paper.figures import assumed_draw
from bench.paper.figures.assumed_words import (
    KEPT,
    interval,
    misfit_of,
    number,
    other,
    values,
    words,
)
from bench.paper.lines import kpa, printed
from bench.paper.part import Erratum, Figure, Found, Table
from bench.paper.priced import SIGNS, Price, price, prices
from bench.paper.runs import Runs
from bench.paper.verdict import percent


def found(_runs: Runs) -> Found:
    """Prices, the best combination, and what it leaves."""
    record = Record.load()
    return Found(
        words=words(record),
        figures=[
            Figure(
                "assumed",
                assumed_draw.prices(record.grid),
                "One open matter at a time, all others as elsewhere on this page; above P(360°) of "
                "the baseline, thick where P falls with the radius by 1 % and more at every step "
                "from 6 to 12 mm, gray 196 kPa ±1.5 %; below the force at 200 kPa and 0°, gray "
                "what the stated errors of both models leave to the simulation.",
            ),
            Figure(
                "assumed_best",
                assumed_draw.best(record),
                "(a) The pressure of the baseline and the radius's trend under floors from 1.5 to "
                "3 mm (dots every 0.5 mm) and three pitches: what is stated is the gray field. "
                "(b) to (d) Least misfit at each value of an open number, all others and all "
                "readings free.",
            ),
        ],
        tables=[
            _open(),
            _prices(prices(record.grid)),
            _combinations(record),
            _statements(record),
            _readings(record),
            _determined(record),
            _confirmed(record),
        ],
        errata=[
            Erratum(
                "eq. (19)",
                f"with the factor L of (14): {float(kpa(printed(), 360.0)) / 1e3:.0f} MPa at 360°",
                f"without it {closed_form():.1f} kPa, which is what the bands above are taken from",
            )
        ],
        commands=[COMMAND],
    )


def _open() -> Table:
    rows = [
        (
            each.what,
            each.words(each.default),
            f"{each.low:g} to {each.high:g} {each.unit}",
            each.reason,
            each.fields,
        )
        for each in RANGES
    ]
    rows += [
        (
            choice.what,
            choice.words(choice.default),
            choice.words(not choice.default),
            choice.reason,
            choice.fields,
        )
        for choice in CHOICES
    ]
    head = ("open", "ours", "bounds, or the other reading", "why", "fields of a case")
    return Table("What is open", head, rows, words=True)


def _prices(found: list[Price]) -> Table:
    ours = found[0]
    rows = []
    for one in found:
        rows.append(
            [
                one.what,
                one.reading,
                f"{one.pressure:.1f}",
                _change(one.pressure, ours.pressure),
                f"{one.force:.2f}",
                _change(one.force, ours.force),
                f"{one.formula:.2f}",
                *one.signs.values(),
            ]
        )
    signs = [("F" if key.endswith("force") else "P", STATED[key]) for key in SIGNS]
    head = (
        "open",
        "at",
        "P(360°), kPa",
        "change",
        "F at 200 kPa, N",
        "change",
        "eq. (20), N",
        *(f"{what} over {fact.what.partition(' ')[0]} ({fact.printed})" for what, fact in signs),
    )
    return Table(
        "What each costs, the baseline, all others as ours; signs as of Table II, the paper's in "
        "brackets",
        head,
        rows,
        words=True,
    )


def _change(value: float, ours: float) -> str:
    return "" if math.isclose(value, ours, rel_tol=1e-9) else percent(value / ours - 1)


def _combinations(record: Record) -> Table:
    names = [each.what for each in (*RANGES, *CHOICES)]
    shown = [values(given) for given in (DEFAULT, record.best[0].given, record.ends.given)]
    rows = [list(row) for row in zip(names, *shown, strict=True)]
    head = ("open", "ours", "best", "best if of the radius only 6 and 12 mm count")
    return Table("Combinations", head, rows, words=True)


def _statements(record: Record) -> Table:
    ours, best = alone(record.grid, DEFAULT), alone(record.grid, record.best[0].given)
    rows = []
    for one in statements():
        fact = STATED[one.key]
        row = [f"{one.what} ({fact.place})", interval(one), one.why]
        for at in (ours, best):
            row += [number(one, at), f"{float(one.misfit(at)):.2f}"]
        rows.append([*row, "yes" if float(one.misfit(best)) <= KEPT else "no"])
    total = ["all", "", "root of the sum of squares", "", f"{misfit_of(record, DEFAULT):.2f}"]
    total += ["", f"{record.best[0].misfit:.2f}", ""]
    head = ("stated", "as an interval", "from", "ours", "misfit", "best", "misfit", "explained")
    return Table(
        "What is stated, with ours elsewhere on this page and with the best combination. A misfit "
        "of 1 is one scale outside the interval, which is what our number may be off by; nothing "
        "of it is a verdict, since the best combination was searched for",
        head,
        [*rows, total],
        words=True,
    )


def _readings(record: Record) -> Table:
    """The best combination with one reading turned around, everything else free."""
    best = record.best[0]
    lines: list[tuple[str, Best]] = [("best of all", best)]
    for choice in CHOICES:
        value = bool(getattr(best.given, choice.key))
        lines.append((f"{choice.what}: {choice.words(not value)}", other(record, choice.key)))
    rows = []
    for what, one in lines:
        at = price(record.grid, one.given, "", "")
        numbers = (one.given.pitch, one.given.thickness, one.given.lever)
        rows.append(
            [
                what,
                *(f"{value:.2f}" for value in numbers),
                f"{at.pressure:.1f}",
                at.signs["radius_pressure"],
                f"{at.force / at.formula:.2f}",
                f"{one.misfit:.2f}",
            ]
        )
    head = (
        "with",
        "pitch, mm",
        "of C = 7.9 MPa, mm",
        "L_f, mm",
        "P(360°), kPa",
        "sign over radius",
        "F over (20)",
        "misfit",
    )
    return Table("The best with one reading turned around, all others free", head, rows, words=True)


def _determined(record: Record) -> Table:
    least = record.best[0].misfit
    rows = []
    for profile, each in zip(record.profiles, RANGES, strict=True):
        low, high = profile.allowed(least) or (0.0, 0.0)
        part = (high - low) / (each.high - each.low)
        shown = f"{low:.2f} to {high:.2f} mm" if high else "none"
        rows.append([each.what, shown, f"{100 * part:.0f} %"])
    rows += _flat(record.directions)
    return Table(
        "What is determined: values with a misfit² no more than 1 above the best one's; and by how "
        "many scales the numbers that are stated move along directions at the best "
        "combination, the last the flattest",
        ("", "values, or direction", "part of the bounds, or scales"),
        rows,
        words=True,
    )


def _flat(found: Directions) -> list[list[str]]:
    rows = []
    for place, (moves, vector) in enumerate(zip(found.moves, found.vectors, strict=True)):
        text = ", ".join(
            f"{key} {value:+.2f}".replace("-", "−")
            for key, value in zip(found.keys, vector, strict=True)
        )
        rows.append([f"direction {place + 1}, in parts of the bounds", text, f"{moves:.3g}"])
    return rows


def _confirmed(record: Record) -> Table:
    rows = [
        [
            f"P(360°), a = {one.key[0]:g}, L = {one.key[1]:g}, t = {one.key[2]:g} mm",
            f"{one.grid:.1f} kPa",
            f"{one.cell:.1f} kPa",
            percent(one.grid / one.cell - 1),
        ]
        for one in record.cells
    ]
    rows += [
        [
            f"F at 200 kPa, held by a strip, a = {one.radius:g} mm",
            f"{one.grid:.2f} N",
            f"{one.body:.2f} N",
            percent(one.grid / one.body - 1),
        ]
        for one in record.bodies
    ]
    head = ("", "as found", "cell or body", "off")
    return Table("The best combination solved anew: cells with every turn, bodies", head, rows)

"""What the paper leaves open: what each matter costs, and which values explain best what it states.

Read from bench/paper/assumed/record.json, which `make paper ASSUME=1` makes again.
"""

from __future__ import annotations

import math

from bench.paper.assumed.flat import SLACK, Directions
from bench.paper.assumed.record import COMMAND, Record
from bench.paper.assumed.solving import PRESSURE
from bench.paper.assumptions import CHOICES, DEFAULT, RANGES, Combination, changed, ranges
from bench.paper.combination import (
    SERIES,
    Best,
    Predicted,
    Statement,
    alone,
    closed_form,
    kappa,
    statements,
)
from bench.paper.facts import BASELINE, STATED
from bench.paper.figures import assumed_draw
from bench.paper.lines import kpa, printed
from bench.paper.part import Erratum, Figure, Found, Table
from bench.paper.priced import SIGNS, Price, price, prices
from bench.paper.runs import Runs
from bench.paper.verdict import percent

KEPT = 1.0
"""Greatest misfit with which a statement is explained: what our own number may be off by."""


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
                "from 6 to 12 mm; below the force at 200 kPa and 0°, with what the stated errors "
                "of both models leave to the simulation.",
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


def words(record: Record) -> list[str]:
    """What is open, how it is priced, what follows from what is stated, and what is left."""
    return [
        "The paper does not say everything that its simulations assume. The first table has what "
        "is open, our value, bounds and the reason for each; the second what each costs, one at a "
        "time. Pressures are those of sections with the cell's correction, the winding calibrated. "
        "They are solved on a grid of pitch and thickness; in between they are polynomials, off by "
        f"{100 * max(abs(part) for part in record.held_out):.1f} % at most at "
        f"{len(record.held_out)} places that were solved beside the grid. A wall of 1 or 3 mm and "
        "a shorter chamber have the correction of 2 and 160 mm.",
        _forces(record),
        _pressures(),
        *_outcome(record),
    ]


def _forces(record: Record) -> str:
    """What follows from the stated errors of the force, and what does not."""
    force = kappa(BASELINE[0]) * PRESSURE / 1e3 / DEFAULT.lever
    low, high = _band("force_solid")
    straight = float(alone(record.grid, DEFAULT).ratio(BASELINE[0]))
    held = float(alone(record.grid, changed(DEFAULT, "guided", True)).ratio(BASELINE[0]))
    return (
        f"Forces. The paper states none. Eq. (20) has {force:.2f} N at 200 kPa with L_f = 15 mm. "
        "Errors of 10.3 and 4.3 % against one measured force leave the simulation "
        f"{low:.3f} to {high:.3f} times that. Kept straight, a section has {straight:.2f} times "
        "that, whatever L_f is, since both have the same: no L_f explains the force, and the force "
        "does not determine L_f. A body whose crown a strip holds down, as the plate of Fig. 11, "
        f"has {held:.2f} times that with L_f = 15 mm: within the band. So the force says how the "
        "simulation was held, and bounds L_f only then. Its insensitivity to the length follows "
        "from nothing that is open: a section does not know its length, and bodies do not show it."
    )


def _pressures() -> str:
    """What follows from the stated error of the pressure."""
    low, high = _band("pressure")
    times = float(kpa(printed(), 360.0)) / closed_form()
    return (
        "Pressures. Errors of 10.9 % of both models against one measured pressure leave the "
        f"simulation {low:.3f} to {high:.3f} times eq. (19). As printed that equation is "
        f"{times:.0f} times too high. Without its extra L it has {closed_form():.1f} kPa with the "
        f"stated 0.314 MPa; 196 kPa are {percent(196 / closed_form() - 1)} from it, within the "
        "band. So the two numbers do not contradict each other, and the band says nothing of the "
        "simulation that 196 kPa does not."
    )


def _band(key: str) -> tuple[float, float]:
    (one, *_) = (each for each in statements() if each.key == key)
    return one.low, one.high


def _outcome(record: Record) -> list[str]:
    """The best combination in words: how well it does, what stays unexplained, what is flat."""
    best = record.best[0]
    given = alone(record.grid, best.given)
    stated = statements()
    left = [one for one in stated if float(one.misfit(given)) > KEPT]
    unkept = "; ".join(
        f"{one.what}: {_number(one, given)}, stated {_interval(one)}" for one in left
    )
    unexplained = f"Unexplained stays: {unkept}." if left else "Nothing stays unexplained."
    radii = ", ".join(f"{float(given.pressures[key]):.1f}" for key in SERIES["radius"])
    unexplained += f" P is {radii} kPa for radii of 6, 8, 10 and 12 mm."
    ends = [
        each.what
        for each in ranges(best.given.readings)
        if min(abs(getattr(best.given, each.key) - end) for end in each.bounds)
        < 1e-3 * (each.high - each.low)
    ]
    at_ends = f" At the end of its bounds: {', '.join(ends)}." if ends else ""
    loose = [
        choice.what
        for choice in CHOICES
        if _other(record, choice.key).misfit ** 2 <= best.misfit**2 + SLACK
    ]
    flat = (
        f" Not determined, since the other reading adds less than 1 to misfit²: {'; '.join(loose)}."
        if loose
        else ""
    )
    cells = max(abs(one.grid / one.cell - 1) for one in record.cells)
    by_cell = {one.key: one.cell for one in record.cells}
    around = ", ".join(f"{by_cell[key]:.1f}" for key in SERIES["radius"])
    bodies = max(abs(one.grid / one.body - 1) for one in record.bodies)
    return [
        f"The best combination within the bounds: {_combination(best.given)}. Its misfit is "
        f"{best.misfit:.2f}, that of ours elsewhere on this page {_misfit(record, DEFAULT):.2f}. "
        "It explains "
        f"{len(stated) - len(left)} of {len(stated)} statements. {unexplained}{at_ends}{flat}",
        "Solved anew, cells with every turn are within "
        f"{100 * cells:.1f} % of the pressures with which it was found, bodies within "
        f"{100 * bodies:.1f} % of the forces; both have the sheath all around. Over the radius the "
        f"cells have {around} kPa.",
    ]


def _other(record: Record, key: str) -> Best:
    """The best combination with one reading turned around."""
    value = bool(getattr(record.best[0].given, key))
    return min(
        (one for one in record.best if bool(getattr(one.given, key)) is not value),
        key=lambda one: one.misfit,
    )


def _misfit(record: Record, given: Combination) -> float:
    at = alone(record.grid, given)
    return math.sqrt(sum(float(one.misfit(at)) ** 2 for one in statements()))


def _combination(given: Combination) -> str:
    numbers = [
        f"{each.what} {each.words(float(getattr(given, each.key)))}"
        for each in RANGES
        if each.key not in ("floor", "layer") or each.key == given.base
    ]
    readings = [
        f"{choice.what}: {choice.words(bool(getattr(given, choice.key)))}" for choice in CHOICES
    ]
    return "; ".join([*numbers, *readings])


def _number(one: Statement, at: Predicted) -> str:
    return _show(one, float(one.of(at)))


def _show(one: Statement, value: float) -> str:
    if one.unit:
        return f"{value:.1f} {one.unit}"
    # steps are changes, ratios are not
    return percent(value) if "step" in one.what else f"{value:.3f}"


def _interval(one: Statement) -> str:
    if math.isinf(one.low):
        return f"≤ {_show(one, one.high)}"
    if math.isinf(one.high):
        return f"≥ {_show(one, one.low)}"
    return f"{_show(one, one.low)} to {_show(one, one.high)}"


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
    return Table("What is open", head, rows)


def _prices(found: list[Price]) -> Table:
    ours = found[0]
    rows = []
    for one in found:
        first = one is ours
        change = "" if first else percent(one.pressure / ours.pressure - 1)
        rows.append(
            [
                one.what,
                one.reading,
                f"{one.pressure:.1f}",
                change,
                f"{one.force:.2f}",
                "" if first else percent(one.force / ours.force - 1),
                f"{one.formula:.2f}",
                *one.signs.values(),
            ]
        )
    signs = [STATED[key] for key in SIGNS]
    head = (
        "open",
        "at",
        "P(360°), kPa",
        "change",
        "F at 200 kPa, N",
        "change",
        "eq. (20), N",
        *(f"{fact.what}; paper {fact.printed}" for fact in signs),
    )
    return Table("What each costs, the baseline; all others as ours", head, rows)


def _statements(record: Record) -> Table:
    ours, best = alone(record.grid, DEFAULT), alone(record.grid, record.best[0].given)
    rows = []
    for one in statements():
        fact = STATED[one.key]
        row = [f"{one.what} ({fact.place})", _interval(one), one.why]
        for at in (ours, best):
            row += [_number(one, at), f"{float(one.misfit(at)):.2f}"]
        rows.append([*row, "yes" if float(one.misfit(best)) <= KEPT else "no"])
    total = ["all", "", "root of the sum of squares", "", f"{_misfit(record, DEFAULT):.2f}"]
    total += ["", f"{record.best[0].misfit:.2f}", ""]
    head = ("stated", "as an interval", "from", "ours", "misfit", "best", "misfit", "explained")
    return Table(
        "What is stated, with ours elsewhere on this page and with the best combination. A misfit "
        "of 1 is one scale outside the interval, which is what our number may be off by; nothing "
        "of it is a verdict, since the best combination was searched for",
        head,
        [*rows, total],
    )


def _readings(record: Record) -> Table:
    """The best combination with one reading turned around, everything else free."""
    best = record.best[0]
    lines: list[tuple[str, Best]] = [("best of all", best)]
    for choice in CHOICES:
        value = bool(getattr(best.given, choice.key))
        lines.append((f"{choice.what}: {choice.words(not value)}", _other(record, choice.key)))
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
    return Table("The best with one reading turned around, all others free", head, rows)


def _determined(record: Record) -> Table:
    least = record.best[0].misfit
    rows = []
    for profile, each in zip(record.profiles, RANGES, strict=True):
        low, high = profile.allowed(least) if min(profile.misfit) ** 2 <= least**2 + 1 else (0, 0)
        part = (high - low) / (each.high - each.low)
        shown = f"{low:.2f} to {high:.2f} mm" if high else "none"
        rows.append([each.what, shown, f"{100 * part:.0f} %"])
    rows += _flat(record.directions)
    return Table(
        "What is determined: values with a misfit² no more than 1 above the best one's, and how "
        "many scales the stated numbers move along directions at the best combination",
        ("", "values, or direction", "part of the bounds, or scales"),
        rows,
    )


def _flat(found: Directions) -> list[list[str]]:
    rows = []
    for number, (moves, vector) in enumerate(zip(found.moves, found.vectors, strict=True)):
        text = ", ".join(
            f"{key} {value:+.2f}".replace("-", "−")
            for key, value in zip(found.keys, vector, strict=True)
        )
        rows.append([f"direction {number + 1}, in parts of the bounds", text, f"{moves:.3g}"])
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

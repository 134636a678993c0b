"""Fits in words and tables."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from materials.fit.drucker import MOST
from materials.fit.modes import MODES

if TYPE_CHECKING:
    from fiberbend.fit.comparison import Comparison
    from materials.fit.fit import Fit
    from materials.fit.modes import Measurement

HEADS = ("law", "rms error", "AIC", "stable to stretch", "parameters")
"""Of the columns of `summary`."""
_AT_REST = 0.005
"""Part of a test's greatest logarithmic strain up to which it is at rest."""
_OFF = 0.03
"""Part of its greatest stress from which on that at rest is told; a stiff beginning has less."""
_SLACK = 0.005
"""Part of its greatest stress below which a test has hardly one."""
_FAR = 0.1
"""Part of its greatest logarithmic strain from which on it should have one."""
_SMALL = 0.1
"""MPa below which the moduli of a law are shown in kPa."""


def lines(found: Comparison) -> Iterator[str]:
    """What was read, the laws beside each other, what has to be said of them, and other modes."""
    for read in found.reads:
        yield read.said
    yield ""
    yield from aligned(HEADS, [summary(fit, found) for fit in found.fits])
    remarks = list(remarks_of(found))
    if remarks:
        yield ""
        yield from remarks
    yield ""
    what = "fitted" if found.beside else "measured"
    yield f"stress in kPa, ± its standard error, at the stretch in brackets; * mode not {what}"
    heads, rows = modes(found)
    yield from aligned(heads, rows)
    if found.beside:
        yield ""
        yield "tests that were not fitted: how far a law is off at most, and at their end"
        yield from aligned(*beside(found))


def summary(fit: Fit, found: Comparison) -> tuple[str, ...]:
    """A law as a row: name, error, criterion above the least one, stability, parameters."""
    least = min(other.criterion for other in found.fits)
    above = fit.criterion - least
    stable = fit.stability
    reach = f"{MOST:g} and more" if stable.across is None else f"{stable.stretch:.3g}"
    return (
        fit.form.name,
        percent(fit.rms),
        f"+{above:.1f}" if math.isfinite(above) else "too few points",
        f"{reach}{', ' * bool(stable.where)}{stable.where}",
        parameters(fit),
    )


def parameters(fit: Fit) -> str:
    """Parameters with their errors and units."""
    units = {p.name: p.unit for p in fit.form.parameters}
    texts = []
    for name, value in fit.parameters.items():
        error, scale, unit = fit.errors[name], 1.0, ""
        if units[name] == "MPa":
            kilo = min(abs(v) for v in fit.moduli) < _SMALL
            scale, unit = (1e3, " kPa") if kilo else (1.0, " MPa")
        texts.append(f"{name} {with_error(scale * value, scale * error)}{unit}")
    return ", ".join(texts)


def with_error(value: float, error: float) -> str:
    """A value with as many digits as its error says, of two digits: 90.4 ± 2.5."""
    if not math.isfinite(error) or error > 100 * abs(value):
        return f"{value:.3g} (not settled)"
    if error <= 1e-9 * abs(value):
        return f"{value:.6g}"
    digits = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def remarks_of(found: Comparison) -> Iterator[str]:
    """What has to be said of the tests and the fits, a line each."""
    for read in found.reads:
        yield from _off_zero(read.measurement)
    for fit in found.fits:
        name = fit.form.name
        if fit.held:
            free = fit.rms * fit.free_rms
            yield (
                f"{name}: held back so that it is stable up to stretch {fit.reach:.4g}; what fits "
                f"best is not, with an rms error of about {percent(free)}"
            )
        if fit.reach is None and fit.stability.stretch < found.reach:
            yield (
                f"{name}: not stable beyond stretch {fit.stability.stretch:.3g} "
                f"({fit.stability.where}), within its tests: a run there may fail"
            )
        if fit.unsettled:
            yield from _unsettled(fit)
        if fit.loose:
            yield f"{name}: its terms nearly cancel, so that it comes last"
    for text in found.left_out:
        yield f"left out: {text}"
    if len(found.measured) == 1:
        what = "fitted" if found.beside else "measured"
        yield f"only {found.measured[0]} was {what}: below is how far laws differ in other modes"


def _off_zero(test: Measurement) -> Iterator[str]:
    """A stress at rest, or none far from it: no law has that, and a fit spreads it over all."""
    strain, stress = np.abs(np.log(test.stretch)), np.abs(test.stress)
    rest = strain <= _AT_REST * strain.max()
    off = float(stress[rest].mean()) if rest.any() else 0.0
    part = off / max(float(stress.max()), 1e-300)
    if part > _OFF:
        yield (
            f"{test.name}: {1e3 * off:.3g} kPa at rest, {percent(part)} of the greatest stress: "
            "the zero of the load may be off, and moduli with it"
        )
    slack = (stress <= _SLACK * stress.max()) & (strain > _FAR * strain.max())
    if slack.any():
        reach = test.stretch[slack][np.argmax(strain[slack])]
        yield (
            f"{test.name}: hardly a stress at stretch {reach:.4g}: slack, or lengths in place of "
            "displacements, and moduli are too small"
        )


def _unsettled(fit: Fit) -> Iterator[str]:
    """What is said of parameters that tests do not settle."""
    gone = [name for name in fit.unsettled if fit.errors[name] == 0]
    wide = [name for name in fit.unsettled if name not in gone]
    if wide:
        many = "their errors are above their values" if len(wide) > 1 else "its error is above it"
        yield f"{fit.form.name}: the tests do not settle {', '.join(wide)}, {many}"
    if gone:
        what = ", ".join(f"{name} {fit.parameters[name]:g}" for name in gone)
        yield f"{fit.form.name}: {what} is at the end of what is searched: the law does without it"


def modes(found: Comparison) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Names and rows of the stresses at the end of every mode, by laws."""
    heads = ["law"]
    for name in MODES:
        mark = "" if name in found.measured else " *"
        heads.append(f"{name} ({found.end(name):.4g}){mark}")
    rows, columns = [], []
    for fit in found.fits:
        row = [fit.form.name]
        values = []
        for mode in MODES.values():
            stretch = np.array([found.end(mode.name)])
            stress = 1e3 * float(fit.stress(mode, stretch)[0])
            error = 1e3 * float(fit.stress_error(mode, stretch)[0])
            beyond = not math.isfinite(stress)
            known = f"{stress:.4g}" if fit.loose else with_error(stress, error)
            row.append("beyond its limit" if beyond else known)
            values.append(stress)
        rows.append(tuple(row))
        columns.append(values)
    if len(columns) > 1:
        rows.append(("greatest over least", *(_ratio(column) for column in np.array(columns).T)))
    return tuple(heads), rows


def percent(part: float) -> str:
    """A part in percent with two digits."""
    return f"{100 * part:#.2g}".rstrip(".") + " %"


def beside(found: Comparison) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Names and rows of the errors of laws beside tests that they were not fitted to.

    Errors are in parts of the measured stress, from a tenth of the greatest one on.
    """
    tests = [read.measurement.sorted() for read in found.beside]
    heads = ["law"]
    for test in tests:
        heads += [f"{test.name}, {test.mode.name}", f"at {test.stretch[-1]:.4g}"]
    rows = []
    for fit in found.fits:
        row = [fit.form.name]
        for test in tests:
            far = np.abs(test.stress) > 0.1 * np.abs(test.stress).max()
            off = fit.residuals(test)[far] / test.stress[far]
            worst = off[np.argmax(np.abs(off))] if np.isfinite(off).all() else np.nan
            row += [_signed(float(worst)), _signed(float(off[-1]))]
        rows.append(tuple(row))
    return tuple(heads), rows


def _signed(part: float) -> str:
    return f"{100 * part:+.1f} %" if math.isfinite(part) else "beyond its limit"


def case_lines(fit: Fit, part: str, file: Path) -> Iterator[str]:
    """Lines of a case, each of which has the law with its numbers."""
    yield f"  {part}: {file.name}"
    yield f"  {part}: {{law: {fit.form.law.name}, {', '.join(coefficients(fit))}}}"


def coefficients(fit: Fit) -> list[str]:
    """The law's parameters as a case has them, "c1: 0.0904 MPa"."""
    units = {p.name: p.unit for p in fit.form.parameters}
    # of terms that cancel the difference counts
    digits = 6 + math.ceil(math.log10(fit.cancelling))
    return [
        f"{name}: {value:.{digits}g}{' MPa' if units[name] == 'MPa' else ''}"
        for name, value in fit.parameters.items()
    ]


def _ratio(values: Sequence[float]) -> str:
    there = [v for v in values if math.isfinite(v)]
    if len(there) < 2 or min(there) <= 0:
        return "-"
    return f"{max(there) / min(there):.2f}"


def aligned(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Columns under their names; the last one ends where it ends."""
    widths = [max(len(row[i]) for row in [heads, *rows]) for i in range(len(heads))]
    for row in [heads, *rows]:
        yield "  ".join(text.ljust(w) for text, w in zip(row, widths, strict=True)).rstrip()

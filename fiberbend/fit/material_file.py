"""A fitted rubber as a file that a case names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fiberbend.fit.words import coefficients, parameters, percent
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import parse
from fiberbend.version import __version__

if TYPE_CHECKING:
    from fiberbend.fit.comparison import Comparison
    from materials.fit.fit import Fit


def text(found: Comparison, fit: Fit, density: str = "") -> str:
    """The file's content.

    Args:
        found: the comparison that the fit is of.
        fit: the law.
        density: as a case gives it; empty: none.
    """
    tests = [read.measurement for read in found.reads]
    names = ", ".join(f"{test.name} ({test.mode.name})" for test in tests)
    low = min(1.0, *(float(test.stretch.min()) for test in tests))
    high = max(1.0, *(float(test.stretch.max()) for test in tests))
    head = [
        f"# {fit.form.name}, fitted by fiberbend {__version__}",
        *(f"# {read.said}" for read in found.reads),
        f"# rms error {percent(fit.rms)} of the greatest stress; {parameters(fit)}",
    ]
    if fit.unsettled:
        head.append(f"# the tests do not settle {', '.join(fit.unsettled)}")
    body = [
        f"law: {fit.form.law.name}",
        *coefficients(fit),
        *([f"density: {density}"] if density else []),
        f"tested: [{low:.4g}, {high:.4g}]   # least and greatest stretch",
        f'source: "{fit.form.name} fitted to {_plain(names)}"',
    ]
    return "\n".join([*head, *body]) + "\n"


def check_density(where: str, text: str) -> None:
    """Refuse what is no density of a case; empty: none is given.

    Raises:
        CaseError: it is none; at `where`.
    """
    if not text:
        return
    try:
        value = parse(text, "density")
    except ValueError as error:
        raise CaseError([Problem(where, f'"{text}", {error}')]) from None
    if value < 0:
        raise CaseError([Problem(where, f'"{text}", expected a density zero or above')])


def _plain(name: str) -> str:
    return name.replace("\\", "/").replace('"', "'")

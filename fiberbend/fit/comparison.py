"""Laws fitted to the same tests, side by side."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fiberbend.schema.problems import CaseError, Problem
from fiberbend.tensile.reading import ModeName, Read, Wanted, read_test

if TYPE_CHECKING:
    from materials.fit.fit import Fit, Weights

USUAL = ("neo-hooke", "mooney-rivlin", "yeoh-2", "yeoh", "gent", "ogden-1", "ogden-2")
"""Laws that are compared unless some are asked for."""


@dataclasses.dataclass(frozen=True)
class Asked:
    """What is fitted to what.

    Attributes:
        files: how each specimen was loaded, and its file.
        laws: names of laws; none: the usual ones.
        wanted: what is read of the files.
        weights: how points of a mode weigh.
        stable: stability is asked for, up to the greatest stretch.
    """

    files: tuple[tuple[ModeName, Path], ...]
    laws: tuple[str, ...] = ()
    wanted: Wanted = dataclasses.field(default_factory=Wanted)
    weights: Weights = "plain"
    stable: bool = True


@dataclasses.dataclass(frozen=True, eq=False)
class Comparison:
    """Fits of laws to the same tests.

    Attributes:
        reads: the tests.
        fits: the laws, the best one first: those whose numbers the tests settle before others, and
            of these by Akaike's criterion.
        left_out: laws that could not be fitted, and why.
    """

    reads: tuple[Read, ...]
    fits: tuple[Fit, ...]
    left_out: tuple[str, ...] = ()

    @property
    def best(self) -> Fit:
        """The first one."""
        return self.fits[0]

    @property
    def reach(self) -> float:
        """Greatest stretch of the tests, or up to which they were asked for."""
        return max(
            *(fit.reach or 1.0 for fit in self.fits),
            *(read.measurement.greatest for read in self.reads),
        )

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of the modes that were measured."""
        return tuple(dict.fromkeys(read.measurement.mode.name for read in self.reads))


def compared(asked: Asked) -> Comparison:
    """Read tests and fit laws to them.

    Raises:
        CaseError: a file or a law is wrong.
    """
    from fiberbend.tensile.shipped import test_file
    from materials.fit.fit import fit_law

    if not asked.files:
        raise CaseError([Problem("fiberbend fit", "no test, expected a file such as DATA.csv")])
    reads = tuple(read_test(test_file(path), mode, asked.wanted) for mode, path in asked.files)
    tests = [read.measurement for read in reads]
    fits, left_out = [], []
    for law in asked.laws or USUAL:
        try:
            fits.append(fit_law(law, tests, asked.weights, asked.wanted.most, asked.stable))
        except ValueError as error:
            if asked.laws:
                raise CaseError([Problem("--law", str(error))]) from None
            left_out.append(f"{law}: {error}")
    if not fits:
        raise CaseError([Problem("fiberbend fit", left_out[0])])
    fits.sort(key=lambda fit: (bool(fit.unsettled), fit.criterion))
    return Comparison(reads, tuple(fits), tuple(left_out))


def law_names(given: Sequence[str]) -> tuple[str, ...]:
    """Names between commas, each once."""
    names = (name.strip() for text in given for name in text.split(","))
    return tuple(dict.fromkeys(name for name in names if name))

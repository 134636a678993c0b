"""Laws fitted to the same tests, side by side."""

from __future__ import annotations

import dataclasses
import itertools
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
        only: modes that are fitted; tests of others are only compared. None: all.
    """

    files: tuple[tuple[ModeName, Path], ...]
    laws: tuple[str, ...] = ()
    wanted: Wanted = dataclasses.field(default_factory=Wanted)
    weights: Weights = "plain"
    stable: bool = True
    only: tuple[ModeName, ...] = ()


@dataclasses.dataclass(frozen=True, eq=False)
class Comparison:
    """Fits of laws to the same tests.

    Attributes:
        reads: the tests.
        fits: the laws, the best one by Akaike's criterion first; of few points, which have none,
            that with the fewest parameters. Laws whose terms cancel come last.
        left_out: laws that could not be fitted, and why.
        beside: tests that were not fitted.
    """

    reads: tuple[Read, ...]
    fits: tuple[Fit, ...]
    left_out: tuple[str, ...] = ()
    beside: tuple[Read, ...] = ()

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

    def end(self, mode: str) -> float:
        """Greatest stretch of a mode's tests, or of all tests where it was not measured."""
        tests = [read.measurement for read in (*self.reads, *self.beside)]
        ends = [float(t.stretch.max()) for t in tests if t.mode.name == mode]
        return max(ends, default=self.reach)

    @property
    def measured(self) -> tuple[str, ...]:
        """Names of the modes that were fitted."""
        return tuple(dict.fromkeys(read.measurement.mode.name for read in self.reads))


def compared(asked: Asked) -> Comparison:
    """Read tests and fit laws to them.

    Raises:
        CaseError: a file or a law is wrong.
    """
    from fiberbend.tensile.shipped import file_of
    from materials.fit.fit import fit_law

    if not asked.files:
        raise CaseError([Problem("fiberbend fit", "no test, expected a file such as DATA.csv")])
    given = [(mode, path.resolve()) for mode, path in asked.files]
    for mode, path in given:
        if given.count((mode, path)) > 1:
            # errors would be those of twice as many points
            raise CaseError([Problem(str(path), "given more than once, expected each test once")])
    every = [(mode, read_test(file_of(path), mode, asked.wanted)) for mode, path in asked.files]
    _each_once([read for _, read in every])
    reads = tuple(read for mode, read in every if not asked.only or mode in asked.only)
    beside = tuple(read for mode, read in every if asked.only and mode not in asked.only)
    if not reads:
        raise CaseError([Problem("--only", f"no test in {' or '.join(asked.only)}, expected one")])
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
    fits.sort(key=lambda fit: (fit.loose, fit.criterion, len(fit.values), fit.rms))
    return Comparison(reads, tuple(fits), tuple(left_out), beside)


def _each_once(reads: Sequence[Read]) -> None:
    """Refuse the points of one test in two files, or in two modes.

    Raises:
        CaseError: two tests with the same points.
    """
    import numpy as np

    tests = [read.measurement for read in reads]
    points = [np.unique(np.stack([t.stretch, t.stress], axis=1), axis=0) for t in tests]
    for (i, one), (k, other) in itertools.combinations(enumerate(points), 2):
        if np.array_equal(one, other):
            text = f"the same points as {tests[i].name}, expected each test once, in one mode"
            raise CaseError([Problem(tests[k].name, text)])


def law_names(given: Sequence[str]) -> tuple[str, ...]:
    """Names between commas, each once."""
    names = (name.strip() for text in given for name in text.split(","))
    return tuple(dict.fromkeys(name for name in names if name))

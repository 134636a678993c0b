"""Fit the rubbers of materials/named/tensile.py again, and say what has changed.

`python -m bench.rubbers` fits those whose tests come with the program. Those of the Soft Robotics
Materials Database that do not are fitted with `--database FOLDER`, a clone of
github.com/LucMarechal/Soft-Robotics-Materials-Database.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from fiberbend.tensile.reading import Wanted, read_test
from materials.fit.fit import Fit, fit_law
from materials.fit.modes import Measurement
from materials.material import Material
from materials.named.entry import Rubber
from materials.named.tensile import TENSILE

SAME = 1e-3
"""Part of the greatest stress by which stored and fitted curves may differ: digits are rounded."""
_DATABASE = "Tensile-Tests-Data"


@dataclasses.dataclass(frozen=True, eq=False)
class Refit:
    """A rubber fitted again.

    Attributes:
        entry: the rubber.
        fit: to its tests.
    """

    entry: Rubber
    fit: Fit

    @property
    def apart(self) -> float:
        """Greatest difference of the stored law from the fitted one, over the greatest stress."""
        most = 0.0
        for test in self.fit.tests:
            stored = _stress(self.entry.material, test)
            found = self.fit.stress(test.mode, test.stretch)
            most = max(most, float(np.abs(stored - found).max() / np.abs(test.stress).max()))
        return most

    @property
    def rms(self) -> float:
        """Root mean square of what the stored law misses, over the greatest stress of each way."""
        rest = [
            (_stress(self.entry.material, t) - t.stress) / np.abs(t.stress).max()
            for t in self.fit.tests
        ]
        return float(np.sqrt(np.mean(np.concatenate(rest) ** 2)))

    @property
    def coefficients(self) -> dict[str, float]:
        """Those of the fit, as the table would have them."""
        return {name: float(f"{value:.4g}") for name, value in self.fit.parameters.items()}


def refits(database: Path | None = None) -> Iterator[Refit]:
    """Every rubber that is fitted, where its tests are at hand.

    Args:
        database: a clone of the Soft Robotics Materials Database, for the tests that are not part
            of the program.
    """
    for entry in TENSILE:
        assert entry.fitted is not None
        paths = entry.fitted.shipped
        if paths is None and database is not None:
            paths = tuple((way, database / _DATABASE / file) for way, file in entry.fitted.tests)
        if paths is not None:
            wanted = Wanted(most=entry.fitted.upto)
            tests = [read_test(path, way, wanted).measurement for way, path in paths]
            yield Refit(entry, fit_law(entry.fitted.law, tests))


def _stress(material: Material, test: Measurement) -> np.ndarray:
    along, _, free = material.principal(*test.mode.stretches(test.stretch))
    return np.asarray((along - free) / test.stretch)


def main() -> int:
    """Print every refit beside what is stored; 1 where they differ."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--database", type=Path)
    changed = 0
    for found in refits(parser.parse_args().database):
        entry = found.entry
        same = found.apart <= SAME
        changed += not same
        print(
            f"{entry.name:<28} {'same' if same else 'CHANGED':<8} apart {found.apart:.1e}, rms "
            f"{found.rms:.2g}, stable to {found.fit.stability.stretch:.3g}: {found.coefficients}"
        )
    return min(changed, 1)


if __name__ == "__main__":
    sys.exit(main())

"""Powers of time and memory, and what more ranks would take, from what was measured."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
SHOWN = (1, 2, 4, 8, 16, 32)
OWN_FACTORS = 2
"""Ranks up to which long bodies are factorised in blocks; on more MUMPS does it."""
MUMPS = 2.2
"""Time of MUMPS for that of the blocks on one rank: 4.8 and 2.2 s for 118 231 unknowns."""


class Measured(Protocol):
    """A run as this module reads it."""

    @property
    def ranks(self) -> int:
        """Number of processes."""

    @property
    def unknowns(self) -> int:
        """Displacements and pressures."""

    @property
    def factorisations(self) -> int:
        """Tangents and their factors."""

    @property
    def seconds(self) -> dict[str, float]:
        """Wall time by phase, s."""

    @property
    def memory_mb(self) -> float:
        """Greatest memory of all ranks, MB."""


@dataclasses.dataclass(frozen=True)
class Fit:
    """A power of the number of unknowns.

    Attributes:
        factor: value for one unknown.
        exponent: power.
        spread: greatest relative distance of a measured value from it.
    """

    factor: float
    exponent: float
    spread: float

    def __call__(self, unknowns: Floats) -> Floats:
        """Values for numbers of unknowns."""
        return np.asarray(self.factor * unknowns**self.exponent, dtype=float)


def fitted(unknowns: Sequence[int], values: Sequence[float]) -> Fit:
    """The power through measured values, by least squares of their logarithms.

    Args:
        unknowns: of at least two runs.
        values: above zero.
    """
    n, v = np.log(np.asarray(unknowns, float)), np.log(np.asarray(values, float))
    exponent, constant = np.polyfit(n, v, 1)
    spread = np.max(np.abs(np.expm1(v - constant - exponent * n)))
    return Fit(float(np.exp(constant)), float(exponent), float(spread))


def powers(fits: Mapping[str, Fit]) -> list[str]:
    """The exponents in words."""
    lines = []
    for name, fit in fits.items():
        what, ranks = name.split()
        lines.append(
            f"- {what} on {ranks} rank{'s' * (ranks != '1')}: unknowns to the power "
            f"{fit.exponent:.2f}, measured values within {100 * fit.spread:.0f} % of it"
        )
    return lines


@dataclasses.dataclass(frozen=True)
class Scaling:
    """Time on n ranks from one and two: of each phase a part stays, the rest is shared.

    T(n) = T(1) [s + (1 − s)/n] with s from T(2)/T(1) (Amdahl 1967, doi 10.1145/1465482.1465560);
    memory M(n) = M(1) + (n − 1) m, with m from M(2) − M(1). On more than two ranks MUMPS
    factorises: the factor takes `MUMPS` times as long, and is shared out in the same way.

    Attributes:
        unknowns: of the run that it is taken from, the largest on one and two ranks.
        seconds: on one rank, by phase.
        stays: part of each phase that more ranks do not shorten.
        memory_gb: on one rank.
        more_gb: of each further rank.
    """

    unknowns: int
    seconds: dict[str, float]
    stays: dict[str, float]
    memory_gb: float
    more_gb: float

    @classmethod
    def of(cls, points: Sequence[Any]) -> Scaling:
        """From the largest run that was made on one and on two ranks.

        Raises:
            ValueError: there is none.
        """
        pairs: dict[int, dict[int, Measured]] = {}
        for point in points:
            pairs.setdefault(point.unknowns, {})[point.ranks] = point
        both = [n for n, found in pairs.items() if {1, 2} <= {*found}]
        if not both:
            raise ValueError("no mesh was solved on one and on two ranks")
        one, two = (pairs[max(both)][ranks] for ranks in (1, 2))
        seconds = _phases(one)
        stays = {
            phase: float(np.clip(2 * _phases(two)[phase] / value - 1, 0, 1)) if value else 0.0
            for phase, value in seconds.items()
        }
        memory, more = one.memory_mb / 1000, (two.memory_mb - one.memory_mb) / 1000
        return cls(max(both), seconds, stays, memory, more)

    def time(self, ranks: int) -> float:
        """Seconds on a number of ranks."""
        slower = {"factor": MUMPS} if ranks > OWN_FACTORS else {}
        return sum(
            slower.get(phase, 1.0) * value * (self.stays[phase] + (1 - self.stays[phase]) / ranks)
            for phase, value in self.seconds.items()
        )

    def text(self) -> list[str]:
        """What it says, and what it cannot know."""
        parts = ", ".join(f"{phase} {100 * self.stays[phase]:.0f} %" for phase in self.seconds)
        return [
            f"From the phases of {self.unknowns} unknowns on one and two ranks: of each phase a "
            f"part stays whatever the number of ranks ({parts}), the rest is shared out. Memory "
            f"grows by {self.more_gb:.2f} GB a rank. On more than two ranks MUMPS factorises in "
            f"place of the blocks, which on one rank takes {MUMPS} times as long. Beyond two ranks "
            "nothing was measured: this is a plan, not a result.",
            "",
            "| ranks | seconds | times as fast | memory of all, GB |",
            "|---|---|---|---|",
            *(
                f"| {n} | {self.time(n):.1f} | {self.time(1) / self.time(n):.2f} "
                f"| {self.memory_gb + (n - 1) * self.more_gb:.2f} |"
                for n in SHOWN
            ),
        ]


def _phases(point: Measured) -> dict[str, float]:
    """Seconds of each phase, and of what is in none."""
    parts = {name: value for name, value in point.seconds.items() if name != "all"}
    return parts | {"rest": point.seconds["all"] - sum(parts.values())}

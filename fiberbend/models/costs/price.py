"""Seconds and memory of a run by the size of its problem; `make times` measures the numbers."""

from __future__ import annotations

import dataclasses
import functools
import json
from pathlib import Path
from typing import Any

from machine.factors import LARGE

FILE = Path(__file__).parent / "prices.json"
AT_REST = 2
"""Factorisations beside those of Newton's method: of the response at rest, and of the last state,
whose stability is looked at."""
Pair = tuple[float, float]


@dataclasses.dataclass(frozen=True)
class Price:
    """Processor time and memory of one kind of elements of a model, on one rank, kernels compiled.

    Of n unknowns and m elements in L layers along the axis. Linear pairs (a, b) mean `a + b m` or
    `a + b n`, power pairs (c, p) mean c L (n/L)^p: what is long costs by its length, what is wide
    by a power.

    Attributes:
        begin: s, and s an element: imports, mesh, kernels, the section that guides a body, and what
            follows the last step.
        step: s, and s an unknown, of a step beside its iterations: its start, rows, looks.
        residual: s, and s an element, of an iteration.
        tangent: s, and s an element, of a factorisation.
        factor: (c, p) in s, of a factorisation.
        solve: (c, p) in s, of an iteration.
        memory: (c, p) in MB, beside `base_mb`.
        base_mb: of libraries and program, MB.
        iterations: of Newton's method in a step, below `LARGE` unknowns and from there on: there
            are more of them, as a factor serves several.
        factorisations: in an iteration, likewise.
    """

    begin: Pair
    step: Pair
    residual: Pair
    tangent: Pair
    factor: Pair
    solve: Pair
    memory: Pair
    base_mb: float
    iterations: Pair
    factorisations: Pair

    def start_seconds(self, elements: int, unknowns: int, layers: float) -> float:
        """Seconds beside the steps."""
        factored = self._factorisation(elements, unknowns, layers)
        return linear(self.begin, elements) + AT_REST * factored

    def _factorisation(self, elements: int, unknowns: int, layers: float) -> float:
        return linear(self.tangent, elements) + power(self.factor, unknowns, layers)

    def step_seconds(
        self, elements: int, unknowns: int, layers: float, iterations: float | None = None
    ) -> float:
        """Seconds of a step.

        Args:
            elements: m.
            unknowns: n.
            layers: L.
            iterations: of the step; as in free bending unless given.
        """
        large = unknowns >= LARGE
        iteration = linear(self.residual, elements) + power(self.solve, unknowns, layers)
        factored = self._factorisation(elements, unknowns, layers)
        iteration += self.factorisations[large] * factored
        return linear(self.step, unknowns) + (iterations or self.iterations[large]) * iteration

    def memory_mb(self, unknowns: int, layers: float) -> float:
        """Greatest memory, MB, without that of pieces of thread."""
        return self.base_mb + power(self.memory, unknowns, layers)


def linear(pair: Pair, count: float) -> float:
    """a + b x."""
    return pair[0] + pair[1] * count


def power(pair: Pair, unknowns: float, layers: float) -> float:
    """c L (n/L)^p."""
    return float(pair[0] * layers * (unknowns / layers) ** pair[1])


@functools.cache
def _measured() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return found


def machine() -> str:
    """Processor, and kernel of the linear algebra, that the prices were measured with."""
    return str(_measured()["origin"]["machine"])


@functools.cache
def price(model: str, kind: str) -> Price:
    """What a model takes; `make times` has fitted it.

    Args:
        model: its name.
        kind: of its elements, as `ProblemSize.kind` has it.
    """
    entry: dict[str, Any] = _measured()["prices"][f"{model} {kind}"]
    numbers: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in entry.items()
    }
    return Price(**numbers)

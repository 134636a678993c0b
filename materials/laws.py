"""Isochoric strain energies as pure functions of invariants; MPa.

The functions use arithmetic only, so the same definition takes numpy arrays and ufl expressions.
i1 and i2 are the invariants of the unimodular right Cauchy–Green tensor; for an incompressible
material those of C itself.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any


def neo_hooke(i1: Any, i2: Any, mu: Any) -> Any:
    """W = μ/2 (I1 − 3)."""
    return mu / 2 * (i1 - 3)


def mooney_rivlin(i1: Any, i2: Any, c10: Any, c01: Any) -> Any:
    """W = C10 (I1 − 3) + C01 (I2 − 3)."""
    return c10 * (i1 - 3) + c01 * (i2 - 3)


def yeoh(i1: Any, i2: Any, c1: Any, c2: Any, c3: Any) -> Any:
    """W = C1 (I1 − 3) + C2 (I1 − 3)² + C3 (I1 − 3)³."""
    return c1 * (i1 - 3) + c2 * (i1 - 3) ** 2 + c3 * (i1 - 3) ** 3


@dataclasses.dataclass(frozen=True)
class Law:
    """A strain energy and its parameters.

    Attributes:
        name: name in a case.
        energy: strain energy in MPa, a function of i1, i2 and the parameters in order.
        parameters: names of the parameters, all in MPa.
        defaults: values of the parameters that may be left out.
    """

    name: str
    energy: Callable[..., Any]
    parameters: tuple[str, ...]
    defaults: Mapping[str, float]


LAWS: dict[str, Law] = {
    law.name: law
    for law in (
        Law("neo-hooke", neo_hooke, ("mu",), {}),
        Law("mooney-rivlin", mooney_rivlin, ("c10", "c01"), {"c01": 0.0}),
        Law("yeoh", yeoh, ("c1", "c2", "c3"), {"c2": 0.0, "c3": 0.0}),
    )
}

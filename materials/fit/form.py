"""A law with a number of its terms: what a fit chooses numbers for."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping, Sequence

import numpy as np

from materials.fit.modes import Mode
from materials.laws.law import Law, Parameter
from materials.laws.table import LAWS
from materials.stretches import Floats, Stretches, slopes

Numbers = Sequence[float] | Floats


@dataclasses.dataclass(frozen=True)
class Form:
    """A law whose first moduli are fitted; the others are left out.

    Attributes:
        law: the law.
        moduli: parameters in MPa that are fitted; the energy is linear in them.
        shape: pure numbers that are fitted.
    """

    law: Law
    moduli: tuple[Parameter, ...]
    shape: tuple[Parameter, ...]

    @property
    def name(self) -> str:
        """Name as of `form_of`: that of the law, and how many moduli where some are left out."""
        whole = len(self.moduli) == len(_moduli(self.law))
        return self.law.name if whole else f"{self.law.name}-{len(self.moduli)}"

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """What is fitted: moduli, then pure numbers."""
        return self.moduli + self.shape

    def named(self, moduli: Numbers, shape: Numbers) -> dict[str, float]:
        """Values by the names of the parameters, in the law's order."""
        values = [*moduli, *shape]
        given = {p.name: float(v) for p, v in zip(self.parameters, values, strict=True)}
        return {name: given[name] for name in self.law.names if name in given}

    def slopes(self, stretches: Sequence[Floats], shape: Numbers) -> Floats:
        """λi ∂W/∂λi of each modulus at 1 MPa by itself; NaN where the law has no value.

        Args:
            stretches: principal stretches, three arrays of n.
            shape: values of the pure numbers.

        Returns:
            (moduli, 3, n).
        """
        ones = np.eye(len(self.moduli))
        with np.errstate(all="ignore"):
            return np.stack([self._slopes(stretches, one, shape) for one in ones])

    def stress(self, mode: Mode, stretch: Floats, shape: Numbers) -> Floats:
        """Nominal stress of each modulus at 1 MPa by itself, (n, moduli)."""
        along, _, free = np.moveaxis(self.slopes(mode.stretches(stretch), shape), 1, 0)
        return np.asarray((along - free) / stretch).T

    def _slopes(self, stretches: Sequence[Floats], moduli: Numbers, shape: Numbers) -> Floats:
        values = self.law.complete(self.named(moduli, shape))
        used = {name: values[name] for name in self.law.used([values])}
        return np.stack(slopes(lambda *s: self.law.energy(Stretches(*s), **used), stretches))

    def check(self) -> None:
        """Refuse a law that is not linear in its moduli.

        Raises:
            ValueError: it is not.
        """
        state = [np.array([1.02]), np.array([0.99]), np.array([1 / (1.02 * 0.99)])]
        shape = [1.7 + i for i, _ in enumerate(self.shape)]
        moduli = np.array([0.7, 1.3, 0.4, 1.1, 0.9, 0.6])[: len(self.moduli)]
        whole = self._slopes(state, moduli, shape)
        parts = np.tensordot(moduli, self.slopes(state, shape), 1)
        if not np.allclose(whole, parts, rtol=1e-9, atol=1e-14):
            raise ValueError(f"{self.law.name} is not linear in its moduli and cannot be fitted")


def form_of(name: str, laws: Mapping[str, Law] = LAWS) -> Form:
    """A form by its name: of a law, with all its terms, or a law with a number, such as yeoh-2.

    Args:
        name: the name.
        laws: the laws that there are.

    Raises:
        ValueError: an unknown name; lists what there is.
    """
    match = re.fullmatch(r"(.+?)(?:-(\d+))?", name)
    law = laws.get(name) or (laws.get(match[1]) if match else None)
    known = ", ".join(_choice(law) for law in laws.values())
    if law is None or match is None:
        raise ValueError(f"law {name!r}, expected one of {known}")
    moduli = _moduli(law)
    count = int(match[2]) if match[2] and name not in laws else len(moduli)
    if not _least(law) <= count <= len(moduli):
        raise ValueError(f"law {name!r}, expected one of {known}")
    kept = moduli[:count]
    names = {p.name for p in kept}
    shape = tuple(
        p for p in law.parameters if p.unit == "1" and (p.term is None or p.term in names)
    )
    form = Form(law, kept, shape)
    form.check()
    return form


def _moduli(law: Law) -> tuple[Parameter, ...]:
    return tuple(p for p in law.parameters if p.unit == "MPa")


def _least(law: Law) -> int:
    """Moduli that cannot be left out."""
    return sum(p.default is None and p.term is None for p in _moduli(law))


def _choice(law: Law) -> str:
    least, most = _least(law), len(_moduli(law))
    return law.name if least == most else f"{law.name} ({law.name}-{least} to -{most})"

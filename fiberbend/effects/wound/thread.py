"""What a winding is made of: its thread, and the rubber that bulges between its turns."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic import Field

from fiberbend.schema.problems import Problem, found, meant
from fiberbend.schema.quantities import (
    Length,
    Modulus,
    Named,
    PenaltyStiffness,
    Spec,
    by_names,
)

if TYPE_CHECKING:
    from materials.bedding import Bedding
    from materials.bulging import Bulging
    from materials.fiber import Fiber


class FiberSpec(Named):
    """The thread of a winding: a name, or modulus and diameter."""

    name: str | None = None
    """A named fiber; written alone, `fiber: kevlar`, or with the diameter of one that is made in
    many. A file of your own, `fiber: my-thread.yaml`, is written alone too: it has these keys."""
    modulus: Modulus | None = None
    """Young's modulus of the thread."""
    diameter: Length | None = None
    """Diameter of the thread."""
    radius_factor: float | None = Field(default=None, gt=0, le=1)
    """Part of the radius that carries; 0.5 where the paper halves it, 1 by default."""
    source: str | None = None
    """Where the numbers come from, for the reader."""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """A name alone is allowed too, and a file of one's own."""
        from materials.named.table import THREADS_BY_NAME

        return {"anyOf": [*by_names(THREADS_BY_NAME), handler.resolve_ref_schema(handler(schema))]}

    def thread(self) -> Fiber:
        """The thread as the geometry takes it; a described one carries with all of its radius.

        Raises:
            ValueError: an unknown name, or one without modulus and diameter.
        """
        from materials.fiber import Fiber
        from materials.named.table import named_thread

        if self.name is not None:
            return named_thread(self.name, self.diameter)
        if self.modulus is None or self.diameter is None:
            raise ValueError("a fiber without a name needs modulus and diameter")
        factor = 1.0 if self.radius_factor is None else self.radius_factor
        return Fiber(self.modulus, self.diameter, factor, source=self.source or "the case")

    def plain(self) -> FiberSpec:
        """With its defaults; one by its name has none."""
        if self.name is None and self.radius_factor is None:
            return self.model_copy(update={"radius_factor": 1.0})
        return self

    def by_numbers(self) -> FiberSpec:
        """Modulus, diameter and the part that carries of a named one."""
        if self.name is None:
            return self
        thread = self.thread()
        names = ("modulus", "diameter", "radius_factor")
        return self.model_copy(update={"name": None, **{n: getattr(thread, n) for n in names}})

    def problems(self, path: str) -> Iterator[Problem]:
        """What is missing, unknown or without effect."""
        if self.name is None:
            for key in ("modulus", "diameter"):
                if getattr(self, key) is None:
                    text = f"missing, expected the {key} of an unnamed fiber"
                    yield Problem(f"{path}.{key}", text)
            return
        from materials.named.table import THREADS_BY_NAME, hint

        own = ["modulus", "diameter", "radius_factor", "source"]
        known = THREADS_BY_NAME.get(self.name)
        if known is None:
            wanted = f"expected {hint(self.name, THREADS_BY_NAME)}, or modulus and diameter"
            near = meant(self.name, THREADS_BY_NAME)
            yield Problem(path, f"{found(self.name)}, {wanted}{near}")
        elif known.diameter is None:
            own.remove("diameter")
            if self.diameter is None:
                text = f"missing, expected the diameter of {self.name}, which is made in many"
                yield Problem(f"{path}.diameter", text)
        for key in own:
            if getattr(self, key) is not None:
                yield Problem(f"{path}.{key}", "no effect on a named fiber, expected no value")


class BulgingSpec(Spec):
    """How stiff rubber is against bulging between the turns, K0 [1 + a1 (λ_z − 1) + a2 (λ_z − 1)²].

    λ_z is the stretch along the axis at a point of the winding.
    """

    stiffness: PenaltyStiffness
    """K0: pressure per depth of the bulge, at rest."""
    linear: float = 0.0
    """a1: how it grows with the stretch along the axis."""
    quadratic: float = 0.0
    """a2: how it grows with the square of that."""

    @classmethod
    def of(cls, bulging: Bulging) -> BulgingSpec:
        """From three numbers."""
        return cls.model_construct(
            stiffness=bulging.stiffness, linear=bulging.linear, quadratic=bulging.quadratic
        )

    def problems(self, path: str) -> Iterator[Problem]:
        """A stiffness that is not positive at every stretch."""
        try:
            self.bulging()
        except ValueError as error:
            yield Problem(path, str(error))

    def bulging(self) -> Bulging:
        """As the finite-element code takes it."""
        from materials.bulging import Bulging

        return Bulging(self.stiffness, self.linear, self.quadratic)


class BeddingSpec(Spec):
    """How stiff rubber is under threads of families, per length of a thread.

    k = k0 exp[a (λ_n − 1) + c p/k0] against sinking, k_s against slip along the thread; λ_n is the
    stretch of the surface across the thread, p the pressure in the chamber.
    """

    normal: Modulus
    """k0: force across the surface per length and depth, at rest."""
    along: Modulus
    """k_s: force along the thread per length and slip."""
    across: float = 0.0
    """a: how k grows with the stretch of the surface across the thread."""
    pressure: float = 0.0
    """c: how it grows with the pressure."""

    @classmethod
    def of(cls, bedding: Bedding) -> BeddingSpec:
        """From four numbers."""
        return cls.model_construct(**dataclasses.asdict(bedding))

    def bulging(self) -> Bedding:
        """As the finite-element code takes it."""
        from materials.bedding import Bedding

        return Bedding(self.normal, self.along, self.across, self.pressure)

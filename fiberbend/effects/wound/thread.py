"""What a winding is made of: its thread, and the rubber that bulges between its turns."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic import Field

from fiberbend.schema.problems import Problem, found, meant
from fiberbend.schema.quantities import Length, Modulus, Named, PenaltyStiffness, Spec

if TYPE_CHECKING:
    from materials.bulging import Bulging
    from materials.fiber import Fiber


class FiberSpec(Named):
    """The thread of a winding: a name, or modulus and diameter."""

    name: str | None = None
    """A named fiber; written alone, `fiber: kevlar`."""
    modulus: Modulus | None = None
    """Young's modulus of the thread."""
    diameter: Length | None = None
    """Diameter of the thread."""
    radius_factor: float | None = Field(default=None, gt=0, le=1)
    """Part of the radius that carries; 0.5 where the paper halves it, 1 by default."""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """A name alone is allowed too."""
        return {"anyOf": [{"type": "string"}, handler.resolve_ref_schema(handler(schema))]}

    def thread(self) -> Fiber:
        """The thread as the geometry takes it; a described one carries with all of its radius.

        Raises:
            ValueError: an unknown name, or one without modulus and diameter.
        """
        from materials.fiber import FIBERS, Fiber

        if self.name is not None:
            if self.name not in FIBERS:
                known = ", ".join(FIBERS)
                raise ValueError(f"fiber {self.name!r} is unknown: expected one of {known}")
            return FIBERS[self.name]
        if self.modulus is None or self.diameter is None:
            raise ValueError("a fiber without a name needs modulus and diameter")
        factor = 1.0 if self.radius_factor is None else self.radius_factor
        return Fiber(self.modulus, self.diameter, factor, source="the case")

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
        own = ("modulus", "diameter", "radius_factor")
        if self.name is None:
            for key in own[:2]:
                if getattr(self, key) is None:
                    text = f"missing, expected the {key} of an unnamed fiber"
                    yield Problem(f"{path}.{key}", text)
            return
        from materials.fiber import FIBERS

        if self.name not in FIBERS:
            names = ", ".join(FIBERS)
            wanted = f"expected {names}, or modulus and diameter{meant(self.name, FIBERS)}"
            yield Problem(path, f"{found(self.name)}, {wanted}")
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

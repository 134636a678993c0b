"""Materials of a case: by name, or by a law with its coefficients."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import create_model, model_serializer, model_validator

from fiberbend.case.coefficients import coefficient_fields
from fiberbend.schema.quantities import Density, Modulus, Spec
from materials.laws.table import LAWS

if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(LAWS)]


class _Source(Spec):
    """Where a material's behaviour comes from."""

    name: str | None = None
    """A named material; written alone where nothing else is given, `wall: elastosil-m4601`."""
    law: LawName | None = None
    """Law of a material that has no name here."""


_COEFFICIENTS = coefficient_fields()
"""Keys of the laws' parameters; `materials.laws.table.LAWS` lists those of each law."""

if TYPE_CHECKING:
    _Coefficients = _Source
else:
    _Coefficients = create_model("_Coefficients", __base__=_Source, **_COEFFICIENTS)


class MaterialSpec(_Coefficients):
    """A material by name, or a law with its coefficients."""

    density: Density | None = None
    """Density; gravity needs it. "0 g/cm^3" is a part without weight."""
    bulk: Modulus | None = None
    """Bulk modulus of a nearly incompressible material; exactly incompressible by default."""

    @property
    def coefficients(self) -> dict[str, float]:
        """The coefficients that are given, in MPa where they have a unit."""
        given = {key: getattr(self, key) for key in _COEFFICIENTS}
        return {key: value for key, value in given.items() if value is not None}

    def plain(self, weighs: bool) -> Self:
        """The same without keys whose zero says no more than leaving them out.

        Args:
            weighs: densities count: a part of none is weightless.
        """
        if self.law is None:
            off = set()
        else:
            given = self.coefficients
            off = given.keys() - LAWS[self.law].plain(given).keys()
        if self.density == 0 and not weighs:
            off = {*off, "density"}
        return self.model_copy(update=dict.fromkeys(off)) if off else self

    def by_numbers(self) -> Self:
        """Law, coefficients and bulk modulus of a named one."""
        if self.name is None:
            return self
        from materials.named import named_material

        found = named_material(self.name)
        bulk = found.bulk if self.bulk is None else self.bulk
        update = {"name": None, "law": found.law, "bulk": bulk, **found.parameters}
        return self.model_copy(update=update)

    @model_validator(mode="before")
    @classmethod
    def _from_name(cls, data: Any) -> Any:
        return {"name": data} if isinstance(data, str) else data

    @model_serializer(mode="wrap")
    def _to_name(self, write: Any) -> Any:
        return self.name if self.model_fields_set == {"name"} else write(self)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """A name alone is allowed too."""
        return {"anyOf": [{"type": "string"}, handler.resolve_ref_schema(handler(schema))]}


class Materials(Spec):
    """Material of each part."""

    wall: MaterialSpec
    """Wall and end caps."""
    floor: MaterialSpec | None = None
    """Floor under the chamber, where the actuator has one."""
    sheath: MaterialSpec | None = None
    """Sheath, where the actuator has one."""
    layer: MaterialSpec | None = None
    """Strain-limiting layer, where the actuator has one."""

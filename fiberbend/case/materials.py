"""Materials of a case: by name, by a law with its coefficients, by moduli, or by tests."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, create_model, model_serializer, model_validator

from fiberbend.case.coefficients import coefficient_fields
from fiberbend.schema.quantities import Density, Modulus, Spec, by_names
from materials.laws.table import LAWS

if TYPE_CHECKING:
    LawName = str
else:
    LawName = Literal[tuple(LAWS)]


class _Source(Spec):
    """Where a material's behaviour comes from."""

    name: str | None = None
    """A named material; written alone where nothing else is given, `wall: elastosil-m4601`. A file
    of your own, `wall: my-rubber.yaml`, is written alone too: it has these keys, and is seen from
    the case file."""
    law: LawName | None = None
    """Law of a material that has no name here."""
    young: Modulus | None = None
    """Young's modulus at rest, in place of a law: neo-Hooke."""
    poisson: Annotated[float, Field(ge=0, le=0.5)] | None = None
    """Poisson's ratio beside it, 0.5 by default: it keeps its volume. Below it the bulk modulus is
    young/(3 (1 - 2 poisson))."""


_COEFFICIENTS = coefficient_fields()
"""Keys of the laws' parameters; `materials.laws.table.LAWS` lists those of each law."""

if TYPE_CHECKING:
    _Coefficients = _Source
else:
    _Coefficients = create_model("_Coefficients", __base__=_Source, **_COEFFICIENTS)


class TestFiles(Spec):
    """Tests of one rubber that was loaded in several ways; each a CSV file."""

    uniaxial: str | None = None
    """Pulled or pressed along one axis."""
    pure_shear: str | None = Field(default=None, alias="pure-shear")
    """A wide sheet that is pulled across its width."""
    equibiaxial: str | None = None
    """A sheet that is pulled alike to all sides."""


class MaterialSpec(_Coefficients):
    """A material by name, or a law with its coefficients."""

    density: Density | None = None
    """Density; gravity needs it. "0 g/cm^3" is a part without weight."""
    bulk: Modulus | None = None
    """Bulk modulus of a nearly incompressible material; exactly incompressible by default."""
    data: str | TestFiles | None = None
    """CSV file of a tensile test with columns stretch or strain and engineering stress, seen from
    the case file, in place of coefficients: the law is fitted to it when the case is read. Tests
    that come with the program go by their name, `data: dragon-skin-30`."""
    upto: float | str | None = None
    """Greatest stretch of the test that the fit sees, such as 2 or "strain 50 %"; all of it by
    default."""
    tested: tuple[float, float] | None = Field(default=None, strict=False)
    """Least and greatest stretch of its tests; a run that goes beyond says so."""
    source: str | None = None
    """Where the numbers come from, for the reader."""

    @property
    def coefficients(self) -> dict[str, float]:
        """The coefficients that are given, in MPa where they have a unit."""
        given = {key: getattr(self, key) for key in _COEFFICIENTS}
        return {key: value for key, value in given.items() if value is not None}

    @property
    def moduli(self) -> tuple[float, float | None]:
        """Shear and bulk modulus of Young's modulus and Poisson's ratio, MPa.

        The bulk modulus is None where it keeps its volume exactly.
        """
        assert self.young is not None
        ratio = 0.5 if self.poisson is None else self.poisson
        bulk = None if ratio == 0.5 else self.young / (3 * (1 - 2 * ratio))
        return self.young / (2 * (1 + ratio)), bulk

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
        from materials.named.table import named_material

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
        """A name alone is allowed too, and a file of one's own."""
        from materials.named.table import SOLIDS

        return {"anyOf": [*by_names(SOLIDS), handler.resolve_ref_schema(handler(schema))]}


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

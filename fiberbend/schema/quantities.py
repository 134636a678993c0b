"""Building blocks of the case schema: quantities with units, and the base of all its parts."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from typing import Annotated, Any, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError, core_schema

from fiberbend.schema.slips import DIMENSION, LENGTH, LIMITS, Limits
from fiberbend.schema.units import KINDS, factor, parse, show

Sign = Literal["above zero", "zero or above", "other than zero", "any"]


class Spec(BaseModel):
    """A part of a case as a file gives it: frozen, and without room for keys that nobody reads."""

    # built when a case is read: Case builds all parts of it anyway
    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False, defer_build=True
    )

    def by_numbers(self) -> Self:
        """The same in numbers alone, where it may be given by a name."""
        return self


class Named(Spec):
    """A part that may be given by its name alone; a subclass has the field `name`."""

    @model_validator(mode="before")
    @classmethod
    def _from_name(cls, data: Any) -> Any:
        return {"name": data} if isinstance(data, str) else data

    @model_serializer(mode="wrap")
    def _to_name(self, write: Any) -> Any:
        given = {key: value for key, value in self if value is not None}
        return given["name"] if given.keys() == {"name"} else write(self)


def by_names(names: Iterable[str]) -> list[dict[str, Any]]:
    """The schema of what is written alone: one of the names, or a file of one's own."""
    return [
        {"enum": sorted(names), "type": "string"},
        {"pattern": r"\.ya?ml$", "type": "string"},
    ]


@dataclasses.dataclass(frozen=True)
class Quantity:
    """Annotation of a float that a case gives as text with a unit.

    Attributes:
        kind: a key of `fiberbend.schema.units.KINDS`.
        sign: which values are allowed.
        limits: magnitudes beyond which a value is asked back; those of its kind by default.
    """

    kind: str
    sign: Sign = "above zero"
    limits: Limits | None = None

    @property
    def expected(self) -> str:
        """What a message expects in its place."""
        kind = KINDS[self.kind]
        return f'{kind.name} with its unit such as "{kind.example}"'

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Read with `parse`, write with `show`."""
        return core_schema.no_info_plain_validator_function(
            self._read,
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda value: show(value, self.kind)
            ),
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Text that begins with a number and goes on with a unit."""
        # "0.5 1/s": a unit that begins with a digit stands behind a space
        unit = r"\s+1/" if KINDS[self.kind].shown.startswith("1/") else r"\s*[^\s0-9.]"
        return {
            "type": "string",
            "pattern": rf"^\s*[+-]?[0-9.]+([eE][+-]?[0-9]+)?{unit}.*$",
            "examples": [KINDS[self.kind].example],
        }

    def _read(self, text: Any) -> float:
        try:
            value = parse(text, self.kind)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{message}", {"message": str(error)}) from None
        allowed = {
            "above zero": value > 0,
            "zero or above": value >= 0,
            "other than zero": value != 0,
            "any": True,
        }
        if not allowed[self.sign]:
            message = f"expected {KINDS[self.kind].name} {self.sign}"
            raise PydanticCustomError("quantity", "{message}", {"message": message})
        limits = self.limits or LIMITS.get(self.kind)
        if limits is not None:
            refusal = limits.refusal(value, self.kind, small=self.sign != "any")
            if refusal is not None:
                raise PydanticCustomError("quantity", "{message}", {"message": refusal})
        return value


@dataclasses.dataclass(frozen=True)
class UnitName:
    """Annotation of a text that names a unit.

    Attributes:
        kind: a key of `fiberbend.schema.units.KINDS`.
    """

    kind: str

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """The text as it is, where it is a unit of the kind."""
        return core_schema.no_info_after_validator_function(self._read, handler(source))

    def _read(self, text: str) -> str:
        try:
            factor(text, self.kind)
        except ValueError as error:
            raise PydanticCustomError("unit", "{message}", {"message": str(error)}) from None
        return text


NONE = "none"
"""What a case writes where a part of it is to be absent."""


class OrNone:
    """Annotation of a part of a case that may be the word `none` in its place: absent there."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """The word as it is, anything else as the part reads and writes it."""
        return core_schema.no_info_wrap_validator_function(
            lambda value, read: value if value == NONE else read(value),
            handler(source),
            serialization=core_schema.wrap_serializer_function_ser_schema(
                lambda value, write: value if value == NONE else write(value)
            ),
        )

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """The word is allowed too."""
        return {"anyOf": [{"const": NONE}, handler(schema["schema"])]}


Length = Annotated[float, Quantity("length")]
"""mm, above zero."""
LengthOrZero = Annotated[float, Quantity("length", "zero or above")]
"""mm, zero allowed."""
Dimension = Annotated[float, Quantity("length", limits=DIMENSION)]
"""mm, above zero, across a body."""
DimensionOrZero = Annotated[float, Quantity("length", "zero or above", limits=DIMENSION)]
"""mm, zero allowed, across a body."""
BodyLength = Annotated[float, Quantity("length", limits=LENGTH)]
"""mm, above zero, along a body."""
Coordinate = Annotated[float, Quantity("length", "any")]
"""mm, of either sign."""
Pressure = Annotated[float, Quantity("pressure")]
"""MPa, above zero."""
SignedPressure = Annotated[float, Quantity("pressure", "other than zero")]
"""MPa; negative is a vacuum."""
Modulus = Annotated[float, Quantity("modulus")]
"""MPa, above zero."""
Angle = Annotated[float, Quantity("angle", "other than zero")]
"""rad."""
Volume = Annotated[float, Quantity("volume")]
"""mm³, above zero."""
Density = Annotated[float, Quantity("density", "zero or above")]
"""t/mm³, zero allowed."""
PenaltyStiffness = Annotated[float, Quantity("penalty stiffness")]
"""MPa/mm, above zero."""
Acceleration = Annotated[float, Quantity("acceleration")]
"""mm/s², above zero."""
SignedForce = Annotated[float, Quantity("force", "any")]
"""N, of either sign."""
SignedMoment = Annotated[float, Quantity("moment", "any")]
"""N mm, of either sign."""
Mass = Annotated[float, Quantity("mass")]
"""t, above zero."""
AngleOrZero = Annotated[float, Quantity("angle", "any")]
"""rad, zero allowed."""
Accuracy = Annotated[float, Quantity("accuracy")]
"""Percent, above zero."""

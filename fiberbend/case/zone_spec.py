"""What a case says of a zone along the length."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, model_validator
from pydantic_core import PydanticCustomError, core_schema

from fiberbend.case.materials import MaterialSpec
from fiberbend.effects.strip import StripEffect
from fiberbend.effects.winding import WindingEffect
from fiberbend.schema.quantities import NONE, Dimension, OrNone, Spec

if TYPE_CHECKING:
    from fiberbend.effects.effect import Effect


class _OneOrMore:
    """Annotation of a list that may be one entry in its place."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """One as a list of one."""
        return core_schema.no_info_before_validator_function(
            lambda value: [value] if isinstance(value, dict | Spec) else value, handler(source)
        )

    def __get_pydantic_json_schema__(
        self, schema: Any, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """One entry is allowed too."""
        several = handler(schema["schema"])
        return {"anyOf": [several["items"], several]}


def _all(value: Any) -> tuple[Effect, ...]:
    if value == NONE:
        return ()
    return value if isinstance(value, tuple) else (value,)


class ZoneSpec(Spec):
    """A length of the actuator with a winding and materials of its own; else the case's."""

    length: Dimension | None = None
    """Its part of the chamber's length; one zone may leave it out and is what the others leave."""
    winding: Annotated[WindingEffect, OrNone()] | None = None
    """In place of the case's winding, its phase from the zone's own root end; "none": unwound."""
    strip: Annotated[tuple[StripEffect, ...], _OneOrMore(), OrNone()] | None = Field(
        default=None, strict=False
    )
    """One strip or a list of them, in place of the case's strips; "none": without any."""
    floor: MaterialSpec | None = None
    """Material of its floor, in place of materials.floor."""
    layer: MaterialSpec | None = None
    """Material of its strain-limiting layer, in place of materials.layer."""

    @model_validator(mode="before")
    @classmethod
    def _no_nothing(cls, data: Any) -> Any:
        for key, value in data.items() if isinstance(data, dict) else ():
            if value is None:
                text = f"{key}: nothing, expected a value; without the key it is the case's"
                raise PydanticCustomError("zone", "{text}", {"text": text})
        return data

    @property
    def effects(self) -> dict[str, tuple[Effect, ...]]:
        """Effects that it has in place of the case's of that name; nothing: absent here."""
        given = {name: getattr(self, name) for name in (WindingEffect.name, StripEffect.name)}
        return {name: _all(value) for name, value in given.items() if value is not None}

    @property
    def materials(self) -> dict[str, MaterialSpec]:
        """Materials that it has in place of the case's, by part."""
        given = {part: getattr(self, part) for part in ("floor", "layer")}
        return {part: spec for part, spec in given.items() if spec is not None}

    def completed(self, offers: frozenset[str] | None, weighs: bool) -> Self:
        """The zone with the defaults of its effects, and without zeros that say nothing.

        Args:
            offers: what the model of the case offers; None where the model is still to be chosen.
            weighs: densities count.
        """
        update: dict[str, Any] = {}
        for name in self.effects:
            value = getattr(self, name)
            if isinstance(value, tuple):
                update[name] = tuple(effect.completed(offers) for effect in value)
            elif value != NONE:
                update[name] = value.completed(offers)
        update |= {part: spec.plain(weighs) for part, spec in self.materials.items()}
        return self.model_copy(update=update) if update else self

"""Keys of a case for the parameters of the laws, made from the laws' own declarations."""

from __future__ import annotations

import dataclasses
import math
from typing import Annotated, Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.fields import FieldInfo
from pydantic_core import PydanticCustomError, core_schema

from fiberbend.schema.quantities import Quantity
from materials.laws.law import Law, Parameter
from materials.laws.table import LAWS


@dataclasses.dataclass(frozen=True)
class Number:
    """Annotation of a float that a case gives as a bare number.

    Attributes:
        parameter: has the values that are allowed.
    """

    parameter: Parameter

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """A float, checked against what is allowed."""
        return core_schema.no_info_after_validator_function(self._read, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """A number within its bounds."""
        result = handler(schema)
        if math.isfinite(self.parameter.most):
            result |= {"minimum": -self.parameter.most, "maximum": self.parameter.most}
        if self.parameter.allowed == "above zero":
            result |= {"exclusiveMinimum": 0}
        return result

    def _read(self, value: float) -> float:
        reason = self.parameter.refusal(value)
        if reason is not None:
            raise PydanticCustomError("number", "{message}", {"message": reason})
        return value


def coefficient_fields() -> dict[str, tuple[Any, FieldInfo]]:
    """Annotation and default of a key for every parameter of every law.

    Laws that share a key share its field. Where they allow different values it takes any number,
    and what the law of a material allows is checked with its law.

    Raises:
        ValueError: laws that mean different units by one key.
    """
    owners: dict[str, list[tuple[Law, Parameter]]] = {}
    for law in LAWS.values():
        for parameter in law.parameters:
            owners.setdefault(parameter.name, []).append((law, parameter))
    fields: dict[str, tuple[Any, FieldInfo]] = {}
    for name, pairs in owners.items():
        law, first = pairs[0]
        for other, parameter in pairs[1:]:
            if parameter.unit != first.unit:
                raise ValueError(f"{name}: {law.name} and {other.name} give it different units")
            if (parameter.allowed, parameter.most) != (first.allowed, first.most):
                first = dataclasses.replace(first, allowed="any", most=math.inf)
        kind = Number(first) if first.unit == "1" else Quantity("modulus", first.allowed)
        meanings: dict[str, list[str]] = {}
        for owner, parameter in pairs:
            meanings.setdefault(parameter.meaning, []).append(owner.name)
        text = "; ".join(f"{what}; {', '.join(laws)}" for what, laws in meanings.items()) + "."
        annotation: Any = Annotated[float, kind] | None
        fields[name] = (annotation, FieldInfo(default=None, description=text))
    return fields

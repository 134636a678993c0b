"""Every quantity that a design can ask for; a new one is a class here and a line below."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, Field, create_model, model_validator
from pydantic_core import PydanticCustomError

from fiberbend.design.quantities.bending import AngleAt, CurvatureAt, PressureAt
from fiberbend.design.quantities.force import BlockedForceAt, StraightMomentAt
from fiberbend.design.quantities.material import StrainAt
from fiberbend.design.quantities.quantity import Quantity
from fiberbend.design.quantities.size import Height, Rubber, WholeLength, Width
from fiberbend.design.quantities.tip import TipY, TipZ
from fiberbend.design.quantities.work import VolumeAt, WorkTo
from fiberbend.schema.quantities import Spec

QUANTITIES: dict[str, type[Quantity[Any]]] = {
    quantity.name: quantity
    for quantity in (
        AngleAt,
        PressureAt,
        CurvatureAt,
        TipY,
        TipZ,
        BlockedForceAt,
        StraightMomentAt,
        StrainAt,
        WorkTo,
        VolumeAt,
        Width,
        Height,
        WholeLength,
        Rubber,
    )
}


class _OneQuantity(Spec):
    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    @model_validator(mode="after")
    def _exactly_one(self) -> _OneQuantity:
        if len(self.model_fields_set) != 1:
            raise PydanticCustomError("one_quantity", "expected exactly one quantity in this entry")
        return self


QuantityEntry: Any = create_model(
    "QuantityEntry",
    __base__=_OneQuantity,
    __doc__="One quantity with what is wanted of it.",
    **{
        name.replace("-", "_"): (quantity, Field(default=None, alias=name))
        for name, quantity in QUANTITIES.items()
    },  # type: ignore[call-overload]
)


def unwrap(entry: Any) -> Quantity[Any]:
    """The single quantity of an entry."""
    (key,) = entry.model_fields_set
    quantity: Quantity[Any] = getattr(entry, key)
    return quantity

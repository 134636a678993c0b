"""Every effect that a case can list. A new effect is a file here and a line in `EFFECTS`."""

from __future__ import annotations

from typing import Any

from pydantic import ConfigDict, Field, create_model, model_validator
from pydantic_core import PydanticCustomError

from fiberbend.effects.blocked_tip import BlockedTipEffect
from fiberbend.effects.contact import ContactEffect
from fiberbend.effects.effect import Effect
from fiberbend.effects.gravity import GravityEffect
from fiberbend.effects.hold import HoldEffect
from fiberbend.effects.hoops import HoopsEffect
from fiberbend.effects.pressure import PressureEffect
from fiberbend.effects.straight import StraightEffect
from fiberbend.effects.strip import StripEffect
from fiberbend.effects.tip.load import TipLoadEffect
from fiberbend.effects.tip.mass import TipMassEffect
from fiberbend.effects.winding import WindingEffect
from fiberbend.schema.quantities import Spec

EFFECTS: dict[str, type[Effect]] = {
    effect.name: effect
    for effect in (
        PressureEffect,
        WindingEffect,
        HoopsEffect,
        GravityEffect,
        BlockedTipEffect,
        ContactEffect,
        StraightEffect,
        StripEffect,
        HoldEffect,
        TipLoadEffect,
        TipMassEffect,
    )
}
"""Each at most once in a case, but for those of which there may be several."""


class _OneEffect(Spec):
    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    @model_validator(mode="after")
    def _exactly_one(self) -> _OneEffect:
        if len(self.model_fields_set) != 1:
            raise PydanticCustomError("one_effect", "expected exactly one effect in this entry")
        return self


EffectEntry: Any = create_model(
    "EffectEntry",
    __base__=_OneEffect,
    __doc__="An entry of the list of effects: one name with its settings.",
    **{
        name.replace("-", "_"): (effect, Field(default=None, alias=name))
        for name, effect in EFFECTS.items()
    },  # type: ignore[call-overload]
)


def unwrap(entry: Any) -> Effect:
    """The single effect of an entry."""
    (key,) = entry.model_fields_set
    effect: Effect = getattr(entry, key)
    return effect

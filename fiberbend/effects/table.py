"""Effects that a case can list, each with its settings. One class here, one line in `EFFECTS`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, ClassVar, Literal

from pydantic import ConfigDict, Field, create_model, model_serializer, model_validator
from pydantic_core import PydanticCustomError

from fiberbend.schema.quantities import (
    Acceleration,
    Angle,
    Bedding,
    Length,
    Model,
    Modulus,
    Position,
    SignedPressure,
    Volume,
    Width,
)


class Effect(Model):
    """One effect of a case."""

    name: ClassVar[str]
    """The key under which a case lists it."""
    load: ClassVar[bool] = False
    """True where the march has something to ramp."""


class PressureEffect(Effect):
    """Pressure in the closed chamber: by its value, by the volume or by the bend that it holds."""

    name = "pressure"
    load = True

    to: SignedPressure | None = None
    """Chamber pressure at the end; negative is a vacuum."""
    volume: Volume | None = None
    """Chamber volume at the end; the pressure is found."""
    angle: Angle | None = None
    """Bending angle at the end; the pressure is found. Never meets a pressure limit."""


class Fiber(Model):
    """The thread of a winding: a name, or modulus and diameter."""

    name: str | None = None
    """A named fiber; written alone, `fiber: kevlar`."""
    modulus: Modulus | None = None
    """Young's modulus of the thread."""
    diameter: Length | None = None
    """Diameter of the thread."""
    radius_factor: float | None = Field(default=None, gt=0, le=1)
    """Part of the radius that carries; 0.5 where the paper halves it, 1 unless said."""

    @model_validator(mode="before")
    @classmethod
    def _from_name(cls, data: Any) -> Any:
        return {"name": data} if isinstance(data, str) else data

    @model_serializer(mode="wrap")
    def _to_name(self, write: Any) -> Any:
        return self.name if self.name is not None else write(self)

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """A name alone is allowed too."""
        return {"anyOf": [{"type": "string"}, handler.resolve_ref_schema(handler(schema))]}


class WindingEffect(Effect):
    """Inextensible thread around wall and floor (and layer), between the caps."""

    name = "winding"

    pattern: Literal["double-helix", "single-helix-right", "single-helix-left"]
    """Double helix: one right-handed and one left-handed, crossing on the plane of symmetry."""
    pitch: Length
    """Length along the axis of one turn."""
    fiber: Fiber
    """A named fiber or its modulus and diameter."""
    representation: Literal["discrete", "smeared"] | None = Field(default=None, alias="as")
    """Every turn by itself, or the same thread spread over its surface. Unless said, every turn
    where the model has turns, and spread in the models section and analytic."""
    width: Width | None = None
    """Width of the ribbon that stands for the thread, its diameter unless said; discrete only.
    "0 mm" makes it a line, under which the pressure drifts with the mesh."""
    lines: int | None = Field(default=None, ge=1)
    """Parallel curves across the ribbon, 5 unless said; discrete only."""
    tension_only: bool = False
    """The thread goes slack instead of carrying compression."""


class HoopsEffect(Effect):
    """Hoops that cannot stretch, without pitch or thread: the ideal winding of closed forms."""

    name = "hoops"


class GravityEffect(Effect):
    """Weight of the body; every material needs a density."""

    name = "gravity"
    load = True

    direction: Literal["-y", "+y", "+x", "-x", "+z", "-z"]
    """Where the weight points; -y is from the crown to the floor, +z from the root to the tip."""
    acceleration: Acceleration = 9810.0
    """Standard gravity unless said."""


class BlockedTipEffect(Effect):
    """Roof along the top and post under the tip, held in y: the paper's test of the tip force."""

    name = "blocked-tip"

    roof_width: Length = 4.0
    """Width of the strip along the crown on which the roof holds the body."""
    post_length: Length = 2.0
    """Length of the strip at the end of the tip cap's underside that rests on the post."""


class Roof(Model):
    """A rigid, straight bar over the chamber."""

    gap: Width = 0.0
    """Clearance at rest over the highest line of the body."""
    width: Length = 4.0
    """Width of the strip along the crown that may touch it."""


class Post(Model):
    """A rigid plane under the end of the tip cap."""

    gap: Width = 0.0
    """Clearance at rest under the cap."""
    length: Length = 2.0
    """Length of the strip at the end of the tip cap's underside that may rest on it."""


class Plane(Model):
    """A rigid plane; the body stays on the side to which its normal points."""

    point: tuple[Position, Position, Position] = Field(strict=False)
    """x, y and z of one of its points; z = 0 is the root end of the chamber, y = 0 the lower face
    of the floor, and the body bends toward -y."""
    normal: tuple[float, float, float] = Field(strict=False)
    """Direction out of the obstacle, of any length; [0, 1, 0] is a table under the body."""


class Cylinder(Model):
    """A rigid round bar across the body, along x."""

    center: tuple[Position, Position] = Field(strict=False)
    """y and z of its axis."""
    radius: Length
    """Radius of the bar."""


Obstacle = Roof | Post | Plane | Cylinder
"""Anything rigid that a body may touch."""


class ContactEffect(Effect):
    """Rigid obstacles without friction that the outer surface may touch and leave."""

    name = "contact"

    roof: Roof | None = None
    """A straight roof over the chamber; with a post, the paper's test of the tip force."""
    post: Post | None = None
    """A post under the tip."""
    plane: Plane | None = None
    """A plane anywhere."""
    cylinder: Cylinder | None = None
    """A round bar to be grasped."""
    stiffness: Bedding | None = None
    """Pressure per depth with which the obstacles yield; unless said a hundred times the modulus by
    the thickness of what touches, between roof and post with the wall's modulus."""

    @property
    def obstacles(self) -> dict[str, Obstacle]:
        """Those that the case names."""
        all_of_them: dict[str, Obstacle | None] = {
            "roof": self.roof,
            "post": self.post,
            "plane": self.plane,
            "cylinder": self.cylinder,
        }
        return {name: item for name, item in all_of_them.items() if item is not None}


class StraightEffect(Effect):
    """The body held straight, zero curvature: the blocked state of uniform bending."""

    name = "straight"

    stretch: Literal["free", "held"] = "free"
    """Whether the axis may stretch, or is held in length as well."""


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
    )
}
"""Every effect that a case can name; each at most once in a case."""


def hold_straight(effects: Iterable[Effect]) -> bool:
    """Whether effects keep the actuator from bending: its force is asked for, not its angle."""
    return any(
        isinstance(effect, BlockedTipEffect | StraightEffect)
        or (isinstance(effect, ContactEffect) and bool(effect.roof and effect.post))
        for effect in effects
    )


class _OneEffect(Model):
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

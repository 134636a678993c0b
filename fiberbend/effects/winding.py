"""Inextensible thread around wall and floor, between the caps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field, model_serializer, model_validator

from fiberbend.effects.effect import (
    THREAD,
    TURNS,
    TWIST,
    WOUND,
    Built,
    Draft,
    Effect,
    Requests,
    Site,
    Turns,
)
from fiberbend.schema.problems import Problem, found, meant
from fiberbend.schema.quantities import Length, LengthOrZero, Modulus, Spec
from fiberbend.schema.units import show
from geometry.winding.patterns import PATTERNS, least_pitch, turn_spacing

if TYPE_CHECKING:
    PatternName = str
    from geometry.actuator import Actuator
    from geometry.mesh.data import Floats, MeshData
    from geometry.winding.helix import Winding
    from materials.fiber import Fiber
else:
    PatternName = Literal[tuple(PATTERNS)]

DEFAULT_LINES = 5
_POINTS_A_TURN = 24
_ROUNDING = 1e-9
_STIFF = 1e3
"""Modulus in MPa from which a thread hardly stretches."""


class FiberSpec(Spec):
    """The thread of a winding: a name, or modulus and diameter."""

    name: str | None = None
    """A named fiber; written alone, `fiber: kevlar`."""
    modulus: Modulus | None = None
    """Young's modulus of the thread."""
    diameter: Length | None = None
    """Diameter of the thread."""
    radius_factor: float | None = Field(default=None, gt=0, le=1)
    """Part of the radius that carries; 0.5 where the paper halves it, 1 by default."""

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


class WindingEffect(Effect):
    """Inextensible thread around wall and floor (and layer), between the caps."""

    name = "winding"

    pattern: PatternName
    """Double helix: one right-handed and one left-handed, crossing on the plane of symmetry."""
    pitch: Length
    """Length along the axis of one turn."""
    fiber: FiberSpec
    """A named fiber or its modulus and diameter."""
    representation: Literal["discrete", "smeared"] | None = Field(default=None, alias="as")
    """Every turn by itself, or the same thread spread over its surface. By default every turn
    where the model has turns, and spread in the models section and analytic."""
    width: LengthOrZero | None = None
    """Width of the ribbon that stands for the thread, its diameter by default; discrete only.
    "0 mm" makes it a line, under which the pressure drifts with the mesh."""
    lines: int | None = Field(default=None, ge=1)
    """Parallel curves across the ribbon, 5 by default; discrete only."""
    tension_only: bool = False
    """The thread goes slack instead of carrying compression."""

    @property
    def _twists(self) -> bool:
        return not PATTERNS[self.pattern].mirrored

    def needs(self) -> dict[str, str]:
        """Turns where every one is to lie by itself, twist where the pattern has a hand."""
        needed = {WOUND: "it has no thread around the body"}
        if self.representation == "discrete":
            needed[TURNS] = (
                "only cell and body have turns (as: smeared, or leave `as` to the model)"
            )
        if self._twists:
            needed[TWIST] = "the closed form has no twist"
        return needed

    def wants(self) -> dict[str, str]:
        """A thread of its own pitch and stretch."""
        return {THREAD: "in closed forms a winding has neither pitch nor stretch (effect hoops)"}

    def hardly_felt(self, resolved: bool) -> dict[str, str]:
        """Of a stiff thread its modulus; spread over the surface, also what lies between turns."""
        felt = {}
        stiff = self.fiber.thread().modulus >= _STIFF
        if not resolved:
            felt["pitch"] = (
                "its winding is spread over the surface, so that no rubber bulges between the "
                "turns: a pitch of 1.5 to 6 mm moves the pressure for 90° by 1 %, by 11 % where "
                "every turn lies by itself (docs/sweep.md)"
            )
            spread = "its winding is spread over the surface, without a width"
            felt |= dict.fromkeys(("width", "lines"), spread)
            if stiff:
                felt["fiber"] = (
                    "its winding is spread over the surface, and its thread hardly stretches: a "
                    "diameter of 0.1 to 1 mm moves the pressure for 90° by +1 %, by −3 % where "
                    "every turn lies by itself (docs/sweep.md)"
                )
        if stiff:
            felt["fiber.modulus"] = (
                "a thread of 1 GPa or more hardly stretches: 1 to 300 GPa move the pressure for "
                "90° by 1 % in every model (docs/sweep.md)"
            )
        return felt

    def in_turns(self) -> dict[str, Any]:
        """Every turn by itself."""
        return {} if self.turns().discrete else {"as": "discrete"}

    def mirror_breaker(self) -> str:
        """A pattern with a hand."""
        meaning = PATTERNS[self.pattern].meaning
        return f"{meaning} is not its own mirror image" if self._twists else ""

    def bends(self) -> bool:
        """Half a turn about the axis maps every pattern onto itself, half a pitch on."""
        return False

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """Ribbon and thread, and whether there is room for them."""
        if self.representation == "smeared":
            for key in ("width", "lines"):
                if getattr(self, key) is not None:
                    text = "no effect on a smeared winding, expected no value"
                    yield Problem(f"{path}.{key}", text)
        elif self.width == 0 and (self.lines or 1) > 1:
            yield Problem(f"{path}.lines", f"{self.lines}, expected 1 line where the width is zero")
        wrong = list(self.fiber.problems(f"{path}.fiber"))
        yield from wrong
        if not wrong and draft.actuator is not None:
            yield from self._room(path, draft.actuator)

    def _room(self, path: str, actuator: Actuator) -> Iterator[Problem]:
        """A thread or ribbon that lies over itself, or that no place around the body holds."""
        diameter, width = self.fiber.thread().diameter, self.width or 0.0
        wide, what = (diameter, "thread") if diameter >= width else (width, "ribbon")
        perimeter = actuator.winding_perimeter
        apart = turn_spacing(self.pattern, self.pitch, perimeter)
        if wide > apart * (1 + _ROUNDING):
            least = least_pitch(self.pattern, wide, perimeter)
            wanted = f"a thinner {what}"
            if least is not None:
                wanted = f'at least "{show(_rounded_up(least), "length")}" or {wanted}'
            yield Problem(
                f"{path}.pitch",
                f'"{show(self.pitch, "length")}" lays the turns over each other, {apart:.3g} mm '
                f"apart where the {what} is {wide:.3g} mm wide, expected {wanted}",
            )
        if actuator.sheath is not None:
            under = min(actuator.wall, actuator.profile.bottom - actuator.outline_bottom)
            most, place = under + actuator.sheath, "wall or floor and sheath together"
        else:
            high = actuator.outline_top - actuator.outline_bottom
            most, place = min(2 * actuator.outline_half_width, high), "the body within"
        if diameter > most * (1 + _ROUNDING):
            yield Problem(
                f"{path}.fiber",
                f"a thread {diameter:.4g} mm thick, expected one not thicker than {place}, "
                f"{most:.4g} mm",
            )

    def completed(self, offers: frozenset[str] | None) -> Self:
        """As finely as the model can have it; every turn where the model is to be chosen."""
        fiber = self.fiber
        if fiber.name is None and fiber.radius_factor is None:
            fiber = fiber.model_copy(update={"radius_factor": 1.0})
        kind = self.representation
        if kind is None:
            ribbon = self.width is not None or self.lines is not None
            spread = offers is not None and TURNS not in offers and not ribbon
            kind = "smeared" if spread else "discrete"
        update: dict[str, Any] = {"fiber": fiber, "representation": kind}
        if kind == "discrete":
            width = fiber.thread().diameter if self.width is None else self.width
            update["width"] = width
            update["lines"] = self.lines or (DEFAULT_LINES if width else 1)
        return self.model_copy(update=update)

    def representations(self) -> tuple[Self, ...]:
        """Spread and in turns, unless the case says which; a ribbon lies in turns."""
        if not {"representation", "width", "lines"}.isdisjoint(self.model_fields_set):
            return (self,)
        plain = self.model_copy(update={"width": None, "lines": None})
        return tuple(
            plain.model_copy(update={"representation": kind}) for kind in ("smeared", "discrete")
        )

    def turns(self) -> Turns:
        """Pitch, pattern and thread."""
        discrete = self.representation != "smeared"
        thread = self.fiber.thread()
        lines = (self.lines or DEFAULT_LINES) if discrete else 1
        return Turns(
            self.pitch,
            discrete,
            self._twists,
            thread.stiffness,
            thread.modulus,
            lines * len(PATTERNS[self.pattern].helices),
        )

    def fixes_circumference(self) -> bool:
        """Its thread hardly stretches."""
        return True

    def assumed(self) -> Iterator[str]:
        """Rigid, without pitch and twist."""
        yield "the winding fixes the circumference; its pitch does not enter"
        if self._twists:
            yield f"the twist of {PATTERNS[self.pattern].meaning} is not in it"

    def curves(self, actuator: Actuator) -> list[Floats]:
        """The axis of every fiber."""
        helix, turns = self.helix(), math.ceil(actuator.length / self.pitch)
        count = turns * _POINTS_A_TURN
        return [helix.points(actuator, curve, count)[0] for curve in range(helix.curves)]

    def follows_section(self) -> bool:
        """A body that twists leaves the plane of its section."""
        return not self._twists

    def beside(self) -> WindingEffect:
        """The same thread, spread."""
        return self.model_copy(update={"representation": "smeared", "width": None, "lines": None})

    def uncertainties(self, straight: bool) -> Iterator[str]:
        """None: the model's own errors were measured with it."""
        yield from ()

    def alone(self) -> str:
        """The section has it too."""
        return ""

    def steps(self) -> int:
        """It is no load."""
        return 0

    def helix(self) -> Winding:
        """The curves as the geometry takes them; a width of zero is one line."""
        from geometry.winding.helix import Winding

        width = self.width if self.width is not None else self.fiber.thread().diameter
        lines = self.lines if self.lines is not None else DEFAULT_LINES
        return Winding(self.pattern, self.pitch, width, lines if width > 0 else 1)

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """The thread on the faces of the mesh."""
        from fem.effects.winding import SmearedWinding, Winding
        from geometry.winding.embed import embed
        from geometry.winding.smear import smear

        smeared = self.representation == "smeared"
        fibers = (smear if smeared else embed)(mesh, site.actuator, self.helix())
        kind = SmearedWinding if smeared else Winding
        term = kind(fibers, self.fiber.thread().stiffness, self.tension_only)
        return Built((term,), (), fibers, smeared)


def _rounded_up(length: float) -> float:
    """The next length of four digits."""
    step = 10.0 ** (math.floor(math.log10(length)) - 3)
    return float(f"{math.ceil(length / step) * step:.4g}")

"""A strip of inextensible fabric along the body, anywhere on the outline."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field

from fiberbend.effects.effect import (
    SIDE,
    THREAD,
    Built,
    Draft,
    Effect,
    Requests,
    Site,
    Stretch,
)
from fiberbend.schema.problems import Problem, found, meant
from fiberbend.schema.quantities import Angle as AngleOtherThanZero
from fiberbend.schema.quantities import Coordinate, Length, Modulus, Named, Quantity, by_names
from fiberbend.schema.units import show

if TYPE_CHECKING:
    from geometry.actuator import Actuator
    from geometry.mesh.data import MeshData
    from geometry.winding.strip import Window

PLACES = {"top": 0.0, "right": math.pi / 2, "bottom": math.pi, "left": 3 * math.pi / 2}
"""Names of places by the angle from the top toward +x, rad."""
_ROUNDING = 1e-9
_LENGTHS = {
    "thickness": Quantity("length").expected,
    "modulus": f"{Quantity('modulus').expected}, or a fabric",
}
"""What a message expects."""


class PlaceSpec(Named):
    """A place on the outline of wall and floor: by a name, an angle, or an arc length."""

    name: Literal["top", "right", "bottom", "left"] | None = None
    """Written alone, `at: bottom`; right and left are half-way up, right toward +x."""
    angle: AngleOtherThanZero | None = None
    """Share of the outline, 360 deg for once around, from the top toward +x, as places of
    threads."""
    arc: Coordinate | None = None
    """Arc length of the outline from the top toward +x."""

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Any, handler: Any) -> dict[str, Any]:
        """A name alone is allowed too."""
        names = {"enum": list(PLACES), "type": "string"}
        return {"anyOf": [names, handler.resolve_ref_schema(handler(schema))]}

    def problems(self, path: str) -> Iterator[Problem]:
        """One of the three."""
        given = [key for key in ("name", "angle", "arc") if getattr(self, key) is not None]
        if len(given) != 1:
            names = ", ".join(PLACES)
            yield Problem(path, f"{len(given)} places, expected one: {names}, an angle or an arc")

    @property
    def turned(self) -> float | None:
        """Name or share from the top toward +x, rad, from 0 to 2π; None of an arc length."""
        if self.name is not None:
            return PLACES[self.name]
        return None if self.angle is None else self.angle % (2 * math.pi)

    def along(self, actuator: Actuator) -> float:
        """Arc length from the top toward +x, mm, from 0 to the perimeter."""
        from geometry.winding.strip import arc_at

        perimeter = actuator.winding_perimeter
        if self.arc is not None:
            return self.arc % perimeter
        turned = self.turned
        assert turned is not None, "a place has a name, an angle or an arc"
        if self.name is not None:
            return arc_at(actuator, turned)
        return turned / (2 * math.pi) * perimeter

    def __str__(self) -> str:
        if self.name is not None:
            return self.name
        if self.angle is not None:
            return show(self.angle, "angle")
        return show(self.arc or 0.0, "length")


class FabricName:
    """Annotation of a text that names a fabric or a paper."""

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> dict[str, Any]:
        """A name, or a file of one's own."""
        from materials.named.table import SHEETS_BY_NAME

        return {"anyOf": by_names(SHEETS_BY_NAME)}


class StripEffect(Effect):
    """Inextensible fabric on wall and floor, under the sheath, along the body between the caps."""

    name = "strip"
    several = True

    at: PlaceSpec
    """Its middle: top, right (+x), bottom, left, an angle or an arc length."""
    width: Length
    """Along the outline."""
    fabric: Annotated[str, FabricName()] | None = None
    """A named fabric or paper in place of the modulus, and of the thickness where it has one; or a
    file of your own with both, `fabric: my-fabric.yaml`."""
    thickness: Length | None = None
    """Of the fabric; with the modulus it gives the stiffness of warp and of weft."""
    modulus: Modulus | None = None
    """Young's modulus of warp and weft; there is none against shear and bending."""
    source: str | None = None
    """Where the numbers come from, for the reader."""
    tension_only: bool = Field(default=False)
    """The fabric goes slack instead of carrying compression."""

    def needs(self) -> dict[str, str]:
        """Threads that stretch; away from x = 0 also a bend to the side."""
        needed = {THREAD: "no closed form has a strip of fabric"}
        if self.mirror_breaker():
            needed[SIDE] = "the closed form does not bend to the side"
        return needed

    def mirror_breaker(self) -> str:
        """Any place but top and bottom, also of one that is opposite."""
        turned = self.at.turned
        middle = self.at.arc == 0 if turned is None else _multiple(turned, math.pi)
        return "" if middle else f"a strip at {self.at} is not its own mirror image"

    def slackens(self) -> bool:
        """Fabric that is not bonded, point by point."""
        return self.tension_only

    def end_breaker(self) -> str:
        """None: it is alike all along."""
        return ""

    def turn_breaker(self) -> str:
        """Half a turn about y moves it to the other side, as a mirror does."""
        return self.mirror_breaker()

    def bends(self) -> bool:
        """Anywhere but in the middle of a side."""
        turned = self.at.turned
        return turned is None or not _multiple(turned - math.pi / 2, math.pi)

    @property
    def stiffness(self) -> float:
        """Of warp and of weft, N/mm; of a strip that is valid."""
        given = self.by_numbers()
        assert given.modulus is not None
        assert given.thickness is not None
        return given.modulus * given.thickness

    def by_numbers(self) -> Self:
        """Modulus and thickness of a named fabric."""
        if self.fabric is None:
            return self
        from materials.named.table import SHEETS_BY_NAME

        sheet = SHEETS_BY_NAME[self.fabric]
        thickness = sheet.thickness or self.thickness
        update = {"fabric": None, "modulus": sheet.modulus, "thickness": thickness}
        return self.model_copy(update=update)

    def _made_of(self, path: str) -> Iterator[Problem]:
        """What is missing, unknown or without effect of what it is made of."""
        needed, idle = ["thickness", "modulus"], dict[str, str]()
        if self.fabric is not None:
            from materials.named.table import SHEETS_BY_NAME, hint

            sheet = SHEETS_BY_NAME.get(self.fabric)
            if sheet is None:
                known = hint(self.fabric, SHEETS_BY_NAME)
                near = meant(self.fabric, SHEETS_BY_NAME)
                text = f"expected {known}, or modulus and thickness{near}"
                yield Problem(f"{path}.fabric", f"{found(self.fabric)}, {text}")
                return
            needed = [] if sheet.thickness else ["thickness"]
            idle = dict.fromkeys(("modulus", "source"), f"beside {self.fabric}")
            idle |= {} if needed else {"thickness": f"beside {self.fabric}"}
        for key in needed:
            if getattr(self, key) is None:
                yield Problem(f"{path}.{key}", f"missing, expected {_LENGTHS[key]}")
        for key, where in idle.items():
            if getattr(self, key) is not None:
                yield Problem(f"{path}.{key}", f"no effect {where}, expected no value")

    def problems(self, path: str, draft: Draft) -> Iterator[Problem]:
        """A place, a width that the outline has, and none over another strip."""
        wrong = [*self.at.problems(f"{path}.at"), *self._made_of(path)]
        yield from wrong
        if wrong or draft.actuator is None:
            return
        perimeter = draft.actuator.winding_perimeter
        if self.width > perimeter * (1 + _ROUNDING):
            yield Problem(
                f"{path}.width",
                f'"{show(self.width, "length")}", expected no more than the outline is long, '
                f'"{show(perimeter, "length")}"',
            )
            return
        if self.at.arc is not None and not 0 <= self.at.arc <= perimeter:
            yield Problem(
                f"{path}.at.arc",
                f'"{show(self.at.arc, "length")}", expected an arc length from zero to that of the '
                f'outline, "{show(perimeter, "length")}"',
            )
        own = self.at.along(draft.actuator)
        for other, effect in draft.effects.items():
            if other == path:
                return
            if not isinstance(effect, StripEffect) or any(effect.at.problems("")):
                continue
            apart = abs(own - effect.at.along(draft.actuator))
            apart = min(apart, perimeter - apart)
            room = (self.width + effect.width) / 2
            if apart < room * (1 - _ROUNDING):
                yield Problem(
                    path,
                    f"lies over {other}, its middle {apart:.4g} mm from that one's, expected "
                    f"{room:.4g} mm or more",
                )

    def follows_section(self) -> bool:
        """A body that bends to the side leaves the plane of its section."""
        return not self.mirror_breaker()

    def beside(self) -> StripEffect:
        """It is in the section too."""
        return self

    def alone(self) -> str:
        """The section has it too."""
        return ""

    def unmeasured(self) -> str:
        """Meshes were measured without any."""
        return "a strip of fabric lies on it"

    def no_closed_form(self) -> str:
        """In closed forms the floor alone does not stretch."""
        return "a strip of fabric, of which the closed form knows nothing"

    def steps(self) -> int:
        """It is no load."""
        return 0

    def windows(self, actuator: Actuator) -> list[Window]:
        """Where it lies."""
        from geometry.winding.strip import Window

        return [Window(self.at.along(actuator), self.width)]

    def build(self, site: Site, mesh: MeshData, requests: Requests) -> Built:
        """Warp and weft on the faces of the mesh."""
        from fem.effects.fabric import Strip
        from geometry.winding.strip import lay

        (window,) = self.windows(site.actuator)
        laid = lay(mesh, site.actuator, window)
        return Built((Strip(str(self.at), laid, self.stiffness, self.tension_only),))

    def unlike(self, other: Effect) -> str:
        """Fabric may differ in all: every zone has its own."""
        return ""

    def build_along(self, zones: Sequence[Stretch], requests: Requests) -> Built:
        """A term of each, by its place and its zone."""
        from fem.effects.fabric import Strip
        from geometry.winding.strip import lay

        terms = []
        for zone in zones:
            strip, actuator = zone.effect, zone.site.actuator
            assert isinstance(strip, StripEffect)
            (window,) = strip.windows(actuator)
            laid = lay(zone.mesh, actuator, window)
            laid = dataclasses.replace(laid, z=laid.z + zone.start)
            name = f"{strip.at} from {show(zone.start, 'length')} on"
            terms.append(Strip(name, laid, strip.stiffness, strip.tension_only))
        return Built(tuple(terms))


def _multiple(angle: float, step: float) -> bool:
    """Whether an angle is a whole number of steps but for rounding."""
    return abs(math.remainder(angle, step)) < _ROUNDING

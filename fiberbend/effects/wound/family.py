"""A family of threads of a winding, as a case gives it: angle or pitch, hand, starts, place."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from fiberbend.effects.wound.thread import FiberSpec
from fiberbend.schema.problems import Problem
from fiberbend.schema.quantities import Length, Quantity, Spec
from fiberbend.schema.units import show
from geometry.winding.families import (
    UPRIGHT,
    Family,
    along,
    angle_at,
    helix,
    hoops,
    pitch_at,
    placed,
    wall_reach,
)

if TYPE_CHECKING:
    from geometry.actuator import Actuator

Around = Literal["all", "wall"]
HANDS = {"right": 1, "left": -1}
_NEAR = 1e-9
"""Rad within which an angle is 0 or 90°."""
_HOOPS = "hoops, at 90° from the axis"
_ALONG = "threads along the axis, at 0°"


class FamilySpec(Spec):
    """Threads side by side that all run at one angle; angle_from_axis or pitch, one of the two."""

    angle_from_axis: Annotated[float, Quantity("angle", "zero or above")] | None = None
    """Between thread and axis on the winding's own surface, unrolled: 0 deg along the axis, 90 deg
    hoops."""
    pitch: Length | None = None
    """Length along the axis of one turn, in place of the angle; longer than the chamber too."""
    hand: Literal["right", "left"] | None = None
    """Right turns like a common screw; not of hoops and not along the axis."""
    starts: int | None = Field(default=None, ge=1)
    """Threads side by side, evenly around the body, 1 by default; not of hoops."""
    phase: Annotated[float, Quantity("angle", "any")] | None = None
    """Where the first one lies, 0 by default: how high it crosses the top, x = 0, 360 deg for a
    pitch; of hoops 360 deg for the spacing; along the axis its place, 360 deg for once around, from
    the top toward +x."""
    spacing: Length | None = None
    """Distance of hoops along the axis; of hoops only."""
    at: tuple[Annotated[float, Quantity("angle", "any")], ...] | None = Field(
        default=None, strict=False, min_length=1
    )
    """Places of threads along the axis in place of starts, 360 deg for once around the outline,
    from the top toward +x: 180 deg is the middle of the floor. They stay there, also smeared."""
    around: Around | None = None
    """All around, or wall: not under the floor; as the winding has it by default."""
    fiber: FiberSpec | None = None
    """What it is made of; by default what the winding is made of."""

    @property
    def angle(self) -> float | None:
        """Its angle in rad, exactly 0 or 90° where it is near; None where the pitch is given."""
        angle = self.angle_from_axis
        if angle is None:
            return None
        if angle <= _NEAR:
            return 0.0
        return UPRIGHT if abs(angle - UPRIGHT) <= _NEAR else angle

    def plain(self) -> FamilySpec:
        """With the defaults of its fiber."""
        if self.fiber is None:
            return self
        return self.model_copy(update={"fiber": self.fiber.plain()})

    def problems(self, path: str) -> Iterator[Problem]:
        """What is missing or without effect, the actuator unknown."""
        if (self.angle_from_axis is None) == (self.pitch is None):
            both = "neither {} nor {}" if self.pitch is None else "both {} and {}"
            text = both.format("angle_from_axis", "pitch")
            yield Problem(path, f"{text}, expected one of them")
            return
        angle = self.angle
        if angle is not None and angle > UPRIGHT:
            shown = show(angle, "angle")
            text = f'"{shown}", expected one from "0 deg" to "90 deg", and a hand'
            yield Problem(f"{path}.angle_from_axis", text)
            return
        idle = {"spacing": "but of hoops", "at": "but along the axis, at 0°"}
        if angle == UPRIGHT:
            idle = dict.fromkeys(("hand", "starts", "at"), f"on {_HOOPS}")
            if self.spacing is None:
                yield Problem(f"{path}.spacing", "missing, expected the distance of hoops")
        elif angle == 0:
            idle = dict.fromkeys(("hand", "spacing"), f"on {_ALONG}")
            if self.at is not None:
                idle |= dict.fromkeys(("starts", "phase"), "beside `at`")
        elif self.hand is None:
            yield Problem(f"{path}.hand", "missing, expected right or left")
        for key, where in idle.items():
            if getattr(self, key) is not None:
                yield Problem(f"{path}.{key}", f"no effect {where}, expected no value")

    def laid(self, actuator: Actuator, around: Around) -> list[Family]:
        """The family on an actuator, as single lines of the first thread.

        Args:
            actuator: its outline.
            around: where threads lie that do not say.
        """
        perimeter = actuator.winding_perimeter
        reach = math.inf if (self.around or around) == "all" else wall_reach(actuator) or 0.0
        return self.on(perimeter, reach)

    def on(self, perimeter: float, reach: float) -> list[Family]:
        """The family on an outline of a perimeter, within a reach from the top, mm."""
        phase, starts, angle = (self.phase or 0.0) / (2 * math.pi), self.starts or 1, self.angle
        if angle == 0 and self.at is not None:
            places = (place / (2 * math.pi) % 1 for place in self.at)
            found = [placed(perimeter, place * perimeter) for place in places]
        elif angle == 0:
            found = [along(perimeter, starts, phase)]
        elif angle == UPRIGHT:
            found = [hoops(self.spacing or 1.0, phase)]
        else:
            pitch = self.pitch if angle is None else pitch_at(angle, perimeter)
            found = [helix(perimeter, pitch or 1.0, HANDS[self.hand or "right"], starts, phase)]
        return [dataclasses.replace(family, reach=reach) for family in found]

    def words(self, perimeter: float, around: Around) -> str:
        """Angle, pitch, starts, spacing and hand, as a plan shows them.

        Args:
            perimeter: of the outline, mm.
            around: where threads lie that do not say.
        """
        (family, *_) = self.on(perimeter, math.inf)
        where = ", around the wall alone" if (self.around or around) == "wall" else ""
        if not family.angle:
            if self.at is not None:
                shown = ", ".join(f"{math.degrees(place):.6g}°" for place in self.at)
                return f"0° from the axis, at {shown} around{where}"
            count = self.starts or 1
            apart = f", {family.spacing:.4g} mm apart" if count > 1 else ""
            return f"0° from the axis, {count} around{apart}{where}"
        if not family.hand:
            return f"90° from the axis, hoops {family.spacing:.4g} mm apart{where}"
        count = self.starts or 1
        pitch = family.period * count
        degrees = math.degrees(angle_at(pitch, perimeter))
        starts = "1 start" if count == 1 else f"{count} starts"
        return (
            f"{degrees:.4g}° from the axis, pitch {pitch:.4g} mm, {starts}, threads "
            f"{family.spacing:.4g} mm apart, {self.hand}{where}"
        )


def fiber_problems(
    path: str, whole: FiberSpec | None, families: Sequence[FamilySpec]
) -> Iterator[Problem]:
    """What is wrong with the fibers of a winding.

    Args:
        path: of the winding.
        whole: of the winding.
        families: which may have their own.
    """
    own = [(number, each.fiber) for number, each in enumerate(families) if each.fiber is not None]
    for number, fiber in own:
        yield from fiber.problems(f"{path}.families.{number}.fiber")
    every = bool(own) and len(own) == len(families)
    if whole is not None:
        yield from whole.problems(f"{path}.fiber")
        if every:
            text = "no effect where every family has its own, expected no value"
            yield Problem(f"{path}.fiber", text)
    elif not every:
        text = "missing, expected a named fiber or its modulus and diameter"
        yield Problem(f"{path}.fiber", text)

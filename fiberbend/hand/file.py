"""A hand file: fingers with their places, and what they touch.

The classes check the file's own values. `fiberbend.hand.reading.read_hand` reads a file: it also
checks the case of every finger, and reports every problem at once.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from pydantic import Field

from fiberbend.effects.gravity import GravityEffect
from fiberbend.hand.objects import Objects
from fiberbend.hand.pose import NO_TURN, Pose, about, after
from fiberbend.schema.problems import Problem, found
from fiberbend.schema.quantities import (
    AngleOrZero,
    Coordinate,
    PenaltyStiffness,
    SignedPressure,
    Spec,
)

MOST_FINGERS = 12
"""More are taken for a mistake."""


class TurnSpec(Spec):
    """A turn of a finger about an axis through the origin of its case."""

    axis: tuple[float, float, float] = Field(strict=False)
    """Direction of the axis in the hand, of any length."""
    angle: AngleOrZero
    """Angle, by the rule of the right hand."""


class FingerSpec(Spec):
    """An actuator of the hand."""

    name: str | None = None
    """Its name in tables and pictures; "finger 1", "finger 2", … unless given."""
    case: str | None = None
    """Its case file, seen from the hand file; that of the whole hand unless given."""
    set: dict[str, Any] = Field(default={})
    """Changes to its case, by dotted path, after those of the whole hand."""
    place: tuple[Coordinate, Coordinate, Coordinate] = Field(default=(0.0, 0.0, 0.0), strict=False)
    """Where the origin of its case is in the hand: in the middle of its width, at the lower face of
    the floor, where the chamber begins."""
    turns: tuple[TurnSpec, ...] = Field(default=(), strict=False)
    """How its case is turned about that origin, one turn after the other, each about an axis of the
    hand; without any its axes are those of the hand."""
    pressure: SignedPressure | None = None
    """Its pressure at the end; that of the whole hand, or of its case, unless given."""

    @property
    def pose(self) -> Pose:
        """Where it stands."""
        turn = NO_TURN
        for each in self.turns:
            turn = after(about(each.axis, each.angle), turn)
        return Pose(turn, self.place)


class HandOutput(Spec):
    """What is written beside history.csv and run.json."""

    steps: int = Field(default=20, ge=1, le=1000)
    """States from rest to the whole pressure."""
    pictures: bool = True
    """The hand at rest, on the way and at the end, from three sides."""
    animation: bool = True
    """All states in motion, pictures/animation.gif."""


class HandFile(Spec):
    """A hand file."""

    title: str = ""
    """A line for the reader."""
    case: str | None = None
    """Case file of fingers that have none of their own, seen from the hand file."""
    set: dict[str, Any] = Field(default={})
    """Changes to the cases of all fingers, by dotted path."""
    fingers: tuple[FingerSpec, ...] = Field(strict=False)
    """The actuators, each with its place; as rods, whatever model their cases name."""
    pressure: SignedPressure | None = None
    """Pressure of all fingers at the end; that of their cases unless given."""
    gravity: GravityEffect | None = None
    """Weight of all fingers, along an axis of the hand; none unless given."""
    objects: Objects = Objects()
    """What they may touch, rigid and fixed: plane, cylinder, sphere."""
    stiffness: PenaltyStiffness | None = None
    """Pressure per depth with which objects and fingers yield to each other; by default a hundred
    times the modulus over the thickness of what touches."""
    output: HandOutput = HandOutput()
    """What is written."""


def problems(file: HandFile) -> Iterator[Problem]:
    """What is wrong with a hand file beyond its single values and its cases."""
    if not file.fingers:
        yield Problem("fingers", "no finger, expected at least one")
    if len(file.fingers) > MOST_FINGERS:
        yield Problem("fingers", f"{len(file.fingers)}, expected at most {MOST_FINGERS}")
    seen: dict[str, int] = {}
    for number, finger in enumerate(file.fingers):
        path = f"fingers.{number}"
        if finger.case is None and file.case is None:
            yield Problem(f"{path}.case", "missing, expected a case file, or case of the hand")
        for index, turn in enumerate(finger.turns):
            if not math.hypot(*turn.axis):
                yield Problem(f"{path}.turns.{index}.axis", "[0, 0, 0], expected a direction")
        name = name_of(file, number)
        if name in seen:
            text = f"{found(name)}, the name of fingers.{seen[name]} again, expected another"
            yield Problem(f"{path}.name", text)
        seen.setdefault(name, number)
        if finger.name is not None and not finger.name.strip():
            yield Problem(f"{path}.name", f"{found(finger.name)}, expected a name")
    for name, item in file.objects.each.items():
        yield from item.problems(f"objects.{name}")


def name_of(file: HandFile, number: int) -> str:
    """What a finger is called."""
    given = file.fingers[number].name
    return f"finger {number + 1}" if given is None else given

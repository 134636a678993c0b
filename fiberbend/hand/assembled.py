"""A hand as a system of rods: fingers where they stand, their weight, and what they touch."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np

from fiberbend.case import convert
from fiberbend.effects.contact import ContactEffect
from fiberbend.hand.reading import Finger, Hand
from fiberbend.hand.symmetry import out_of_plane
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.schema.units import show
from fiberbend.slender.actuator import Slender, slender
from rod.contact.hull import Hull
from rod.contact.skin import Skin, face, ring, side
from rod.contact.touch import Touch, Touched
from rod.contact.tube import Tube
from rod.functions import Floats
from rod.loads import Weight
from rod.rod import Level, Rod
from rod.several.meeting import Meeting
from rod.several.system import Levels, System
from rod.shape import Shape
from rod.term import Term

ALONG, AROUND = 1.0, 2.0
"""Greatest distances of points that may touch an object, along a finger and around it, mm."""
_ROUND_OFF = 1e-9
"""Part of a length by which round-off may put one thing into another."""


@dataclasses.dataclass(frozen=True)
class Digit:
    """A finger as a rod of the hand.

    Attributes:
        finger: as the file has it.
        slender: its actuator as a rod at the origin.
        rod: the same where it stands, with weight and objects as its terms.
        touches: of each object by its name.
        heavy: its first term is its weight.
    """

    finger: Finger
    slender: Slender
    rod: Rod
    touches: dict[str, Touch]
    heavy: bool

    def level(self, weight: float, pressure: float) -> Level:
        """What acts on it: shares of its weight and of its pressure; objects act whole."""
        own = (weight,) if self.heavy else ()
        return Level(pressure * self.finger.pressure, (*own, *(1.0 for _ in self.touches)))

    def tip(self, shape: Shape) -> Floats:
        """The centroid of the tip's outer face, (3,), mm."""
        return self.slender.tip(shape)

    def turn(self, shape: Shape, strain: str = "curvature") -> float:
        """By how much it bends, bends aside or twists between the caps, rad."""
        return float(np.sum(self.slender.weights(strain) * shape.strains))

    def touched(self, name: str, shape: Shape) -> Touched:
        """What an object does to it."""
        return self.touches[name].touched(shape, 1.0)


class Assembled:
    """A hand that can be solved.

    Args:
        hand: as its file has it.

    Attributes:
        hand: as given.
        digits: the fingers.
        pairs: places of the fingers that may touch each other.
        system: all rods.

    Raises:
        CaseError: something is pushed out of its plane, or lies in something else at rest.
    """

    def __init__(self, hand: Hand) -> None:
        self.hand = hand
        # fingers of one case are one actuator
        made: dict[str, Slender] = {}
        for finger in hand.fingers:
            key = repr(finger.case.resolved())
            made[key] = made.get(key) or slender(finger.case, touched=True)
        own = [made[repr(finger.case.resolved())] for finger in hand.fingers]
        _refuse_lopsided(hand, own)
        yields = [
            hand.stiffness or ContactEffect().yields(convert.site(finger.case))
            for finger in hand.fingers
        ]
        parts = zip(hand.fingers, own, yields, strict=True)
        self.digits = tuple(_digit(hand, *part) for part in parts)
        tubes = [_tube(each) for each in self.digits]
        self.pairs = tuple(itertools.combinations(range(len(self.digits)), 2))
        self.meetings = tuple(
            Meeting((a, b), (tubes[a], tubes[b]), min(yields[a], yields[b])) for a, b in self.pairs
        )
        self.system = System([digit.rod for digit in self.digits], self.meetings)
        self._refuse_overlaps()

    def levels(self, weight: float, pressure: float) -> Levels:
        """What acts: shares of the weight and of all pressures."""
        levels = tuple(digit.level(weight, pressure) for digit in self.digits)
        return Levels(levels, (1.0,) * len(self.meetings))

    def place(self, number: int) -> tuple[int, str] | tuple[int, int]:
        """What a term is that a march has found to touch: a finger with an object or another one.

        Args:
            number: as of `System.closing`.
        """
        for place, digit in enumerate(self.digits):
            if number < len(digit.rod.terms):
                return place, list(digit.touches)[number - digit.heavy]
            number -= len(digit.rod.terms)
        return self.pairs[number]

    def _refuse_overlaps(self) -> None:
        """Raises where fingers lie in objects or in each other at rest."""
        shapes = self.system.shape(self.system.at_rest())
        wrong = []
        for digit, shape in zip(self.digits, shapes.each, strict=True):
            size = float(digit.rod.layout.lengths.sum())
            for name, touch in digit.touches.items():
                room = touch.clearance(shape, 1.0)
                if room < -_ROUND_OFF * size:
                    text = (
                        f"reaches {show(-room, 'length')} into {digit.finger.name} at rest, "
                        "expected room for it"
                    )
                    wrong.append(Problem(f"objects.{name}", text))
        for (a, b), meeting in zip(self.pairs, self.meetings, strict=True):
            room = meeting.gap(self.system.own(meeting, shapes))
            if room < -_ROUND_OFF * float(self.digits[a].rod.layout.lengths.sum()):
                other = self.digits[a].finger.name
                text = f"lies {show(-room, 'length')} in {other} at rest, expected room for it"
                wrong.append(Problem(f"fingers.{b}.place", text))
        if wrong:
            raise CaseError(wrong)


def _refuse_lopsided(hand: Hand, own: list[Slender]) -> None:
    """Raises for fingers that are pushed out of the plane in which they are known to bend."""
    wrong = []
    for number, what in out_of_plane(hand):
        if "side_curvature" not in own[number].rod.layout.strains:
            text = (
                f"{what} pushes {hand.fingers[number].name} out of the plane in which it bends, "
                "where the law of its section is not known: expected what is the same on both "
                "sides of that plane"
            )
            wrong.append(Problem(f"fingers.{number}", text))
    if wrong:
        raise CaseError(dict.fromkeys(wrong))


def _digit(hand: Hand, finger: Finger, own: Slender, stiffness: float) -> Digit:
    """A finger where it stands."""
    turn = np.array(finger.pose.turn)
    root = own.rod.layout
    layout = dataclasses.replace(
        root, rotation=turn @ root.rotation, place=np.array(finger.pose.place) + turn @ root.place
    )
    skin = _skin(own)
    touches = {name: Touch(skin, item.rigid(), stiffness) for name, item in hand.objects.items()}
    terms: list[Term] = list(touches.values())
    if hand.gravity is not None:
        terms.insert(0, Weight(own.rod.inertia, hand.gravity))
    rod = Rod(layout, own.rod.law, own.rod.inertia, terms)
    return Digit(finger, own, rod, touches, hand.gravity is not None)


def _corners(own: Slender) -> Floats:
    """The outer outline of a section about the rod's line, clockwise, (k, 2), mm."""
    height = float(own.rod.layout.place[1])
    return np.array(own.site.actuator.outer_outline(AROUND)) - [0.0, height]


def _skin(own: Slender) -> Skin:
    """The sides and the tip's outer face."""
    layout, outline = own.rod.layout, ring(_corners(own).tolist(), AROUND)
    return side(layout, outline, ALONG).joined(face(layout, outline))


def _tube(digit: Digit) -> Tube:
    """The same for other fingers."""
    places = ring(_corners(digit.slender).tolist(), AROUND).places[::-1]
    return Tube(Hull(places), digit.rod.layout.lengths)

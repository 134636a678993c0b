"""Whether fingers stay in their planes: x = 0 of each case is a mirror of all that acts on it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fiberbend.hand.pose import Mirror, unit
from fiberbend.hand.reading import Finger, Hand


def out_of_plane(hand: Hand) -> Iterator[tuple[int, str]]:
    """Fingers that something pushes out of their planes, with what does.

    An actuator whose own section or winding has no such mirror plane is another matter.
    """
    for number, finger in enumerate(hand.fingers):
        mirror = Mirror.of(finger.pose)
        if hand.gravity is not None and not mirror.keeps(unit(hand.gravity)):
            yield number, "its weight"
        for name, item in hand.objects.items():
            if not item.mirrored(mirror):
                yield number, f"the {name}"
        for other in hand.fingers:
            if other is not finger and _near(finger, other) and not _mirrored(hand, mirror, other):
                yield number, other.name


def _mirrored(hand: Hand, mirror: Mirror, finger: Finger) -> bool:
    """Whether there is a finger where the mirror shows one."""
    size = finger.case.actuator.length
    return any(
        mirror.shows(finger.pose, each.pose, size)
        and each.case.actuator == finger.case.actuator
        and each.case.materials == finger.case.materials
        and each.case.effects == finger.case.effects
        for each in hand.fingers
    )


def _near(one: Finger, other: Finger) -> bool:
    """Whether two fingers can ever touch: roots no farther apart than both are long."""
    reach = sum(2 * (f.case.actuator.length + f.case.actuator.cap) for f in (one, other))
    return math.dist(one.pose.place, other.pose.place) < reach

"""States at given times, and events between them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rod.contact.obstacles import Plane
from rod.contact.touch import Touch
from rod.inertia import spread
from rod.loads import Weight
from rod.motion import Motion
from rod.motion.course import Course, Event, Watch
from rod.motion.motion import retarded
from rod.rod import Level, Rod
from tests.rod.bars import DOWN, PLANE, Bar
from tests.rod.contact.test_touch import skin
from tests.rod.motion.test_energy import hinged

BAR = Bar()


def test_events_have_the_times_of_a_pendulum() -> None:
    """Small swings about the hanging state pass it at every half period T/2 = π √(l/g)."""
    rod, small = hinged(), 1e-2
    motion = Motion(rod, lambda time: Level(amounts=(1.0,)))
    strains = np.zeros((3, 1))
    strains[0] = (math.pi / 2 - small) / 1e-3
    lowest = Watch("lowest", lambda state: float(state.strains[0, 0]) * 1e-3 - math.pi / 2)
    half = math.pi * math.sqrt(100.0 / 9810)
    times = [number * half / 40 for number in range(1, 91)]
    found = [
        e for p in Course(motion, motion.at(strains), [lowest]).through(times) for e in p.events
    ]
    assert [event.below for event in found] == [False, True]
    # the midpoint rule's own period is longer by (ω Δt)²/12 of it
    exact = np.array([0.5, 1.5]) * half * (1 + (math.pi / 40) ** 2 / 12)
    np.testing.assert_allclose([event.time for event in found], exact, rtol=3e-4)


def test_touch_and_lift_off_are_where_the_gap_is_zero() -> None:
    layout = BAR.layout(8)
    inertia = spread(layout, [BAR.mass()])
    floor = Touch(skin(layout), Plane((0.0, -25.0, 0.0), (0.0, 1.0, 0.0)), 0.05)
    rod = Rod(layout, BAR.law(PLANE), inertia, [Weight(inertia, DOWN), floor])
    motion = Motion(rod, lambda time: Level(amounts=(1.0, 1.0)), retarded(rod, 0.002))
    gap = Watch("floor", lambda state: floor.gap(state.shape, 1.0))
    found: dict[float, list[Event]] = {}
    for step in (4e-3, 2e-3, 1e-3):
        course = Course(motion, motion.at(layout.at_rest()), [gap])
        found[step] = []
        rows = 0
        for passed in course.through([step * (i + 1) for i in range(round(0.2 / step))]):
            rows += not passed.events
            for event in passed.events:
                assert abs(gap.value(passed.moving)) < 1e-3
                assert event.time == passed.moving.time
                found[step].append(event)
        assert rows == round(0.2 / step)
    first = [events[0].time for events in found.values()]
    assert [event.below for event in found[1e-3][:2]] == [True, False]
    assert abs(first[0] - first[2]) < 1e-3
    # of second order up to the first event
    assert math.log2((first[0] - first[1]) / (first[1] - first[2])) == pytest.approx(2.0, abs=0.4)


def test_steps_end_at_corners_of_what_acts() -> None:
    """A jump of the pressure within a step is met as if the steps had ended there."""
    rod = BAR.rod(6, PLANE)

    def level(time: float) -> Level:
        return Level(amounts=(1.0 if time < 0.0137 else 0.0,))

    motion = Motion(rod, level, retarded(rod, 0.003))
    ends = []
    for times in ([0.004 * i for i in range(1, 6)], [0.004, 0.008, 0.012, 0.0137, 0.016, 0.02]):
        *_, last = Course(motion, motion.at(rod.layout.at_rest()), (), [0.0137]).through(times)
        ends.append(last.moving)
    assert ends[0].time == ends[1].time == 0.02
    np.testing.assert_allclose(ends[0].frames, ends[1].frames, atol=1e-12)


def test_a_watch_that_is_below_at_first_says_so_when_it_leaves() -> None:
    rod = BAR.rod(4, PLANE)
    motion = Motion(rod, lambda time: Level(amounts=(1.0,)))
    low = Watch("low", lambda state: -10.0 - float(state.shape.places[-1, 1]))
    course = Course(motion, motion.at(rod.layout.at_rest()), [low])
    events = [
        event
        for passed in course.through([0.01 * i for i in range(1, 12)])
        for event in passed.events
    ]
    assert [event.below for event in events] == [False]
